#pragma once

#include <atomic>

namespace taut {

/// From now on the first SIGINT or SIGTERM raises the returned flag, and a second one ends the program at once.
const std::atomic<bool>& stop_on_signals();

}  // namespace taut
