#include "cli/stop_signals.h"

#include <signal.h>
#include <unistd.h>

#include "cli/commands.h"

namespace taut {
namespace {

std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler stores to it");

extern "C" void request_stop(int) {
  // The second time nobody wants to wait for the checkpoint.
  if (stop_requested.exchange(true)) ::_exit(exit_interrupted);
}

}  // namespace

const std::atomic<bool>& stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = request_stop;
  action.sa_flags = SA_RESTART;
  ::sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  return stop_requested;
}

}  // namespace taut
