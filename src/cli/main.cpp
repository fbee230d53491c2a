#include "cli/program.h"

int main(int argc, char** argv) { return taut::run_program(argc, argv); }
