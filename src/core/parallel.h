#pragma once

#include <functional>

namespace taut {

/// Runs task(0) ... task(count - 1), each once, on as many threads as there are tasks and cores. With one task it is a
/// plain call.
void parallel_for(int count, const std::function<void(int)>& task);

}  // namespace taut
