#include "study/machine.h"

#include <sys/resource.h>
#include <sys/utsname.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <thread>

namespace taut {
namespace {

/// The value of the first line of /proc/cpuinfo that begins with "model name".
std::string cpu_model() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != line.npos) return line.substr(colon + 2);
  }
  return "unknown";
}

}  // namespace

Machine this_machine() {
  utsname system{};
  const bool known = ::uname(&system) == 0;
  return {cpu_model(),
          known ? std::string(system.sysname) + " " + system.release + " " + system.machine : std::string("unknown"),
          static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))};
}

std::int64_t peak_memory_bytes() {
  // VmHWM is this program's alone; ru_maxrss also counts what the process held before exec.
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) return 1024 * std::stoll(line.substr(line.find(':') + 1));
  }
  rusage usage{};
  return ::getrusage(RUSAGE_SELF, &usage) == 0 ? 1024 * static_cast<std::int64_t>(usage.ru_maxrss) : 0;
}

}  // namespace taut
