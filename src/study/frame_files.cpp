#include "study/frame_files.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <set>

#include "geometry/mesh_file.h"
#include "study/examine.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view digits = "0123456789";

std::vector<std::string> expand(const std::string& pattern) {
  glob_t found{};
  std::vector<std::string> files;
  if (::glob(pattern.c_str(), 0, nullptr, &found) == 0) files.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  ::globfree(&found);
  return files;
}

/// The usual distance between numbers that ascend; the last one, often cut short by the end of a run, counts only where
/// it is alone.
int usual_distance(const std::vector<FrameFile>& files) {
  std::map<int, int> counts;
  for (std::size_t i = 1; i < files.size(); ++i) {
    if (i + 1 < files.size() || files.size() == 2) ++counts[files[i].number - files[i - 1].number];
  }
  const auto most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == counts.end() ? 1 : most->first;
}

void find_gaps(FrameList& list) {
  const int distance = usual_distance(list.files);
  for (std::size_t i = 1; i < list.files.size(); ++i) {
    const int before = list.files[i - 1].number, after = list.files[i].number;
    if (before == after) {
      list.problems.push_back(fmt::format("{} and {}: two frames with the number {}", list.files[i - 1].path.string(),
                                          list.files[i].path.string(), after));
    } else if (after - before > distance) {
      const int first = before + distance, count = (after - before - 1) / distance;
      list.problems.push_back(fmt::format(
          "{} missing between {} and {}",
          count == 1 ? fmt::format("frame {} is", first) : fmt::format("{} frames from {} on are", count, first),
          list.files[i - 1].path.string(), list.files[i].path.string()));
    }
  }
}

/// The corners from the smallest on, in the same sense of rotation.
Triangle canonical(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

std::string text_of(const Triangle& t) { return fmt::format("vertices {}, {}, {}", t[0], t[1], t[2]); }

/// Names the first triangle of the scene that the frame lacks, and counts the others.
std::vector<std::string> wrong_triangles(const std::vector<Triangle>& found, const Model& model) {
  std::map<Triangle, std::size_t> faces;
  for (std::size_t face = 0; face < found.size(); ++face) faces.emplace(canonical(found[face]), face);
  std::vector<std::string> problems;
  int missing = 0;
  for (std::size_t t = 0; t < model.triangles.size(); ++t) {
    const Triangle& expected = model.triangles[t];
    if (faces.contains(canonical(expected)) || ++missing > 1) continue;
    const std::string name = triangle_name(model, static_cast<Index>(t)) + " (" + text_of(expected) + ")";
    const auto turned = faces.find(canonical({expected[0], expected[2], expected[1]}));
    if (turned != faces.end()) {
      problems.push_back(fmt::format("{} is turned over in face {}", name, turned->second));
    } else if (t < found.size()) {
      problems.push_back(fmt::format("{} is not among the faces; face {} has the {}", name, t, text_of(found[t])));
    } else {
      problems.push_back(name + " is not among the faces");
    }
  }
  if (missing > 1) problems.back() += fmt::format("; {} more triangles of the scene are not there", missing - 1);
  if (problems.empty() && found.size() != model.triangles.size()) {
    problems.push_back(fmt::format("has {} faces, the scene has {} triangles", found.size(), model.triangles.size()));
  }
  return problems;
}

}  // namespace

std::optional<int> frame_number(const fs::path& file) {
  const std::string stem = file.stem().string();
  const std::size_t last = stem.find_last_not_of(digits);
  const std::size_t begin = last == stem.npos ? 0 : last + 1;
  int number = 0;
  const auto [end, error] = std::from_chars(stem.data() + begin, stem.data() + stem.size(), number);
  if (begin == stem.size() || error != std::errc()) return {};
  return number;
}

FrameList find_frames(const std::vector<std::string>& patterns) {
  FrameList list;
  std::set<std::string> names;
  for (const std::string& pattern : patterns) {
    const std::vector<std::string> files = expand(pattern);
    if (files.empty()) list.problems.push_back(pattern + ": no file matches");
    names.insert(files.begin(), files.end());
  }
  const auto is_numbered = [](const std::string& name) { return frame_number(name).has_value(); };
  const auto numbered = std::count_if(names.begin(), names.end(), is_numbered);
  if (numbered == 0) {
    for (const std::string& name : names) list.files.push_back({name, static_cast<int>(list.files.size())});
    return list;
  }
  for (const std::string& name : names) {
    if (is_numbered(name)) {
      list.files.push_back({name, *frame_number(name)});
    } else {
      list.problems.push_back(name + ": no number at the end of its name, where other frames have one");
    }
  }
  std::stable_sort(list.files.begin(), list.files.end(),
                   [](const FrameFile& a, const FrameFile& b) { return a.number < b.number; });
  find_gaps(list);
  return list;
}

Frame read_frame(const fs::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".vtu") return read_vtu(file);
  if (extension == ".stl") {
    throw FileError(file, "STL files do not keep the order of vertices; expected .obj, .ply, .off or .vtu");
  }
  TriangleMesh mesh = read_mesh(file);
  Frame frame;
  frame.positions.resize(3 * static_cast<Index>(mesh.vertices.size()));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    frame.positions.segment<3>(3 * static_cast<Index>(v)) = mesh.vertices[v];
  }
  frame.triangles = std::move(mesh.triangles);
  return frame;
}

std::vector<std::string> misfits(const Frame& frame, const Model& model) {
  const Index size = model.start().size();
  if (frame.positions.size() != size) {
    return {fmt::format("has {} vertices, the scene has {}", frame.positions.size() / 3, size / 3)};
  }
  std::vector<std::string> problems;
  Index not_finite = 0;
  for (Index vertex = 0; vertex < frame.positions.size() / 3; ++vertex) {
    if (frame.positions.segment<3>(3 * vertex).allFinite()) continue;
    if (not_finite++ == 0) problems.push_back(vertex_name(model, vertex) + " is not finite");
  }
  if (not_finite > 1) problems.back() += fmt::format(", nor are {} others", not_finite - 1);
  for (std::string& problem : wrong_triangles(frame.triangles, model)) problems.push_back(std::move(problem));
  return problems;
}

}  // namespace taut
