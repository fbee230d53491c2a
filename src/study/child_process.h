#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace taut {

/// What a child process may use.
struct ChildLimits {
  double seconds = 0;        ///< wall clock; then SIGTERM; 0: no limit
  double grace_seconds = 2;  ///< from SIGTERM to SIGKILL
  /// Resident memory, looked at about every 20 ms; then SIGKILL; 0: no limit. What is only reserved does not count:
  /// OpenBLAS reserves 128 MB a thread, and waits for ever where a limit of the system refuses them.
  std::int64_t memory_bytes = 0;
};

enum class ChildEnd {
  exited,        ///< by itself, with an exit code
  crashed,       ///< by a signal that we did not send
  time_limit,    ///< we ended it because its time was over
  memory_limit,  ///< we ended it because it held too much memory
  interrupted    ///< we ended it because of the stop flag
};

struct ChildOutcome {
  ChildEnd end = ChildEnd::exited;
  int code = 0;    ///< where it exited; 127: the program could not be started
  int signal = 0;  ///< where it crashed
  double seconds = 0;
  std::int64_t peak_memory_bytes = 0;
};

/// Runs a command to its end, with nothing to read and its output and errors in the file `log`. The child is the head
/// of a process group of its own, so that Ctrl-C reaches it only through `stop`, and whatever it has started ends with
/// it; it also ends where this process dies. Throws std::runtime_error where no process can be made,
/// std::invalid_argument for an empty command.
ChildOutcome run_child(const std::vector<std::string>& command, const std::filesystem::path& log,
                       const ChildLimits& limits, const std::atomic<bool>* stop = nullptr);

/// The last line of a log that is not empty; nothing where the process ended before it had a log. Throws FileError.
std::string last_line(const std::filesystem::path& log);

/// "SIGSEGV" for 11.
std::string signal_name(int signal);

}  // namespace taut
