#pragma once

#include <string>

#include "cli/report_option.h"
#include "problems/read_scene.h"

namespace taut {

struct ModelArguments {
  std::string file, out;
  Overrides settings;
  double max_seconds = 0;  ///< 0: no limit
  bool json = false, quiet = false;
  ReportOption report;
};

/// `taut solve MODEL.nl`; returns the exit code.
int solve_model_file(const ModelArguments& arguments);

/// True for `taut STUB -AMPL ...` and `taut MODEL.nl ...`, as AMPL, Pyomo and JuMP call a solver.
bool is_ampl_call(int argc, char** argv);
/// Solves the model and writes its .sol file; 0 whenever that was written, whatever the status. Options are KEY=VALUE
/// of the section `solver` (without "solver."), and max_seconds; those of the command line come after the environment's
/// taut_options.
int run_as_ampl_solver(int argc, char** argv);

}  // namespace taut
