#include "core/parallel.h"

#include <tbb/parallel_for.h>

namespace taut {

void parallel_for(int count, const std::function<void(int)>& task) {
  if (count == 1) {
    task(0);
  } else {
    tbb::parallel_for(
        0, count, [&](int i) { task(i); }, tbb::simple_partitioner{});
  }
}

}  // namespace taut
