#include "study/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "files/atomic_file.h"

namespace taut {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// The child between fork and exec: only what is safe after a fork of a program with threads.
[[noreturn]] void become(char* const* arguments, const char* log, pid_t parent) {
  constexpr int not_started = 127;
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(not_started);  // it died before it could be watched
  for (const int signal : {SIGINT, SIGTERM}) ::signal(signal, SIG_DFL);
  const int input = ::open("/dev/null", O_RDONLY);
  const int output = ::open(log, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const bool ready = input >= 0 && output >= 0 && ::dup2(input, STDIN_FILENO) >= 0 &&
                     ::dup2(output, STDOUT_FILENO) >= 0 && ::dup2(output, STDERR_FILENO) >= 0;
  if (ready) ::execvp(arguments[0], arguments);
  ::_exit(not_started);
}

pid_t start(const std::vector<std::string>& command, const std::filesystem::path& log) {
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const std::string log_name = log.string();
  const pid_t parent = ::getpid(), child = ::fork();
  if (child < 0) throw std::runtime_error(std::string("cannot start a process: ") + ::strerror(errno));
  if (child == 0) become(arguments.data(), log_name.c_str(), parent);
  ::setpgid(child, child);  // here too, so that the group exists before it is signalled
  return child;
}

/// What the process holds now, bytes; 0 where it is gone.
std::int64_t resident_bytes(pid_t process) {
  std::ifstream statm("/proc/" + std::to_string(process) + "/statm");
  std::int64_t total = 0, resident = 0;
  statm >> total >> resident;
  return resident * ::sysconf(_SC_PAGESIZE);
}

/// Which limit a running child has gone beyond; ChildEnd::exited for none.
ChildEnd reason_to_end(pid_t child, double elapsed, const ChildLimits& limits, const std::atomic<bool>* stop) {
  if (stop && stop->load(std::memory_order_relaxed)) return ChildEnd::interrupted;
  if (limits.seconds > 0 && elapsed > limits.seconds) return ChildEnd::time_limit;
  if (limits.memory_bytes > 0 && resident_bytes(child) > limits.memory_bytes) return ChildEnd::memory_limit;
  return ChildEnd::exited;
}

}  // namespace

ChildOutcome run_child(const std::vector<std::string>& command, const std::filesystem::path& log,
                       const ChildLimits& limits, const std::atomic<bool>* stop) {
  if (command.empty()) throw std::invalid_argument("run_child: expected a command, got none");
  const Clock::time_point begin = Clock::now();
  const pid_t child = start(command, log);

  ChildOutcome outcome;
  rusage usage{};
  int status = 0;
  double asked_at = -1;  // when it was asked to end
  std::chrono::milliseconds pause{1};
  while (::wait4(child, &status, WNOHANG, &usage) == 0) {
    const double elapsed = seconds_since(begin);
    if (asked_at < 0) {
      outcome.end = reason_to_end(child, elapsed, limits, stop);
      if (outcome.end != ChildEnd::exited) {
        asked_at = elapsed;
        ::kill(-child, outcome.end == ChildEnd::memory_limit ? SIGKILL : SIGTERM);
      }
    } else if (elapsed > asked_at + limits.grace_seconds) {
      ::kill(-child, SIGKILL);
    }
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, std::chrono::milliseconds(20));
  }
  ::kill(-child, SIGKILL);  // whatever it has left behind
  outcome.seconds = seconds_since(begin);
  outcome.peak_memory_bytes = 1024 * static_cast<std::int64_t>(usage.ru_maxrss);
  if (outcome.end != ChildEnd::exited) return outcome;
  if (WIFSIGNALED(status)) {
    outcome.end = ChildEnd::crashed;
    outcome.signal = WTERMSIG(status);
  } else {
    outcome.code = WEXITSTATUS(status);
  }
  return outcome;
}

std::string last_line(const std::filesystem::path& log) {
  if (!std::filesystem::exists(log)) return "";
  std::istringstream text(read_bytes(log));
  std::string last;
  for (std::string line; std::getline(text, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

std::string signal_name(int signal) {
  const char* abbreviation = ::sigabbrev_np(signal);
  return abbreviation ? std::string("SIG") + abbreviation : "signal " + std::to_string(signal);
}

}  // namespace taut
