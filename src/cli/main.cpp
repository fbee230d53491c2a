#include <malloc.h>

#include "cli/program.h"

int main(int argc, char** argv) {
  // Vectors that come and go keep their pages: without this 3 % of a solve with 100,000 unknowns goes into giving them
  // back and taking them anew.
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  return taut::run_program(argc, argv);
}
