#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "problems/build.h"
#include "problems/modal_file.h"

namespace taut {
namespace {

struct ModesArguments {
  std::string problem, save;
  std::vector<std::string> settings;
};

int modes(const ModesArguments& arguments) {
  const Scene scene = read_scene(find_problem(arguments.problem), parse_settings(arguments.settings));
  const ModalBasis basis = build_modal_basis(scene);
  try {
    if (!arguments.save.empty()) write_basis(arguments.save, basis);
  } catch (const FileError& error) {
    throw UsageError(error.what());
  }
  fmt::print("{:>5} {:>16} {:>10}\n", "mode", "frequency, Hz", "residual");
  double worst = 0;
  for (Index k = 0; k < basis.modes(); ++k) {
    worst = std::max(worst, basis.residuals[k]);
    const double frequency = std::sqrt(basis.eigenvalues[k]) / (2 * std::numbers::pi);
    fmt::print("{:>5} {:>16.8g} {:>10.1e}{}\n", k + 1, frequency, basis.residuals[k],
               k < basis.rigid ? "  rigid motion" : "");
  }
  fmt::print("mesh {}, body {}\n", basis.mesh_hash, basis.body_hash);
  return worst <= scene.solver.tolerance.stationarity ? exit_solved : exit_not_solved;
}

}  // namespace

void add_modes(CLI::App& program, int& code) {
  CLI::App* command = program.add_subcommand("modes", "Compute the modes of a modal body, with the residual of each");
  command->footer(
      "\nA saved basis names the mesh and the body it belongs to; bodies.NAME.modal.basis takes it, any other mesh,\n"
      "material, mass matrix or clamp refuses it.\n"
      "\n"
      "Exit codes: 0 every residual is within solver.tolerance.stationarity, 1 internal error, 2 wrong usage or input, "
      "3 "
      "one is not.\n"
      "\n"
      "Example:\n"
      "  taut modes modal_cantilever --save cantilever.modes");
  const auto arguments = std::make_shared<ModesArguments>();
  command->add_option("PROBLEM", arguments->problem, "A problem file, or the name of one in the catalogue")->required();
  command->add_option("--save", arguments->save, "Write the modes to this file")->type_name("FILE");
  command
      ->add_option("--set", arguments->settings, "Replace a value of the problem, with a dotted key; may be repeated")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->callback([arguments, &code] { code = modes(*arguments); });
}

}  // namespace taut
