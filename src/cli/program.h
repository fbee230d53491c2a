#pragma once

namespace taut {

/// The whole program but for main(): reads the arguments, runs the command, returns the exit code.
int run_program(int argc, char** argv);

}  // namespace taut
