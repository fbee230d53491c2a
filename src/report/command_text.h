#pragma once

#include <string>
#include <vector>

namespace taut {

/// A command as one types it into a shell: words that a shell would take apart are in single quotes.
std::string command_text(const std::vector<std::string>& words);

}  // namespace taut
