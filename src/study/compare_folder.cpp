#include "study/compare_folder.h"

#include <nlohmann/json.hpp>

#include "files/atomic_file.h"
#include "study/compare_json.h"
#include "study/frame_output.h"
#include "study/run_folder.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

constexpr const char* comparison_file = "compare.json";

}  // namespace

CompareFolder::CompareFolder(fs::path path, bool resume) : path_(std::move(path)), resume_(resume) {
  std::error_code error;
  if (!fs::exists(path_, error)) return;
  if (!fs::is_directory(path_, error)) throw RunRefused(path_.string() + ": is not a directory");
  if (fs::is_empty(path_, error)) return;
  try {
    const nlohmann::json json = nlohmann::json::parse(read_bytes(path_ / comparison_file));
    for (const auto& problem : json.at("problems")) {
      const std::string folder = problem.at("folder");
      if (folder == file_name(folder) && folder != "." && folder != "..") earlier_.push_back(folder);
    }
  } catch (const std::exception&) {
    throw RunRefused(path_.string() +
                     ": is not empty and holds no comparison of taut; nothing was touched, choose another directory");
  }
}

void CompareFolder::begin(const Comparison& comparison) {
  std::error_code error;
  fs::create_directories(path_, error);
  if (error) throw RunRefused(path_.string() + ": cannot be created: " + error.message());
  if (!resume_) {
    for (const std::string& folder : earlier_) fs::remove_all(path_ / folder);
    for (const char* table : {"compare.md", "compare.csv"}) fs::remove(path_ / table);
  }
  write(comparison);
}

void CompareFolder::write(const Comparison& comparison) const {
  write_atomically(path_ / comparison_file, comparison_text(comparison));
}

}  // namespace taut
