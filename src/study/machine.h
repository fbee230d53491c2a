#pragma once

#include <cstdint>

#include "study/records.h"

namespace taut {

/// The machine this runs on, as far as the system tells.
Machine this_machine();

/// The most memory that this process has held, bytes.
std::int64_t peak_memory_bytes();

}  // namespace taut
