#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <string_view>

#include "geometry/polygon_soup.h"
#include "geometry/topology.h"

namespace taut {
namespace {

/// Records that carry no surface of ours: normals, materials, shading, points, lines and display hints.
constexpr std::array<std::string_view, 15> ignored_records{"vn",     "vp",       "s",        "usemtl",     "mtllib",
                                                           "usemap", "p",        "l",        "lod",        "bevel",
                                                           "maplib", "c_interp", "d_interp", "shadow_obj", "trace_obj"};

/// Corners as written: points count from 0, -1 stands for a texture corner that is not there.
struct Face {
  int line;
  std::vector<int> points, textures;
};

class ObjReader {
 public:
  explicit ObjReader(std::string file) : file_(std::move(file)) {}

  PolygonSoup read(std::istream& in) {
    std::string text;
    for (std::string piece; std::getline(in, piece);) {
      ++line_;
      if (line_ == 1 && piece.starts_with("\xEF\xBB\xBF")) piece.erase(0, 3);  // a byte-order mark
      if (!piece.empty() && piece.back() == '\r') piece.pop_back();
      text += piece;
      if (!text.empty() && text.back() == '\\') {  // goes on in the next line
        text.back() = ' ';
        continue;
      }
      read_record(text);
      text.clear();
    }
    if (in.bad()) throw MeshError(file_ + ": cannot be read");
    if (!text.empty()) read_record(text);
    return finish();
  }

 private:
  [[noreturn]] void refuse(const std::string& what, int line) const {
    throw MeshError(file_ + ":" + std::to_string(line) + ": " + what);
  }

  void read_record(const std::string& text) {
    std::istringstream words(text.substr(0, text.find('#')));
    std::string keyword;
    if (!(words >> keyword)) return;
    std::vector<std::string> arguments;
    for (std::string word; words >> word;) arguments.push_back(word);

    if (keyword == "v") {
      read_point(arguments);
    } else if (keyword == "vt") {
      read_texture(arguments);
    } else if (keyword == "f") {
      read_face(arguments);
    } else if (keyword == "g") {
      groups_ = arguments;
    } else if (keyword == "o") {
      object_ = arguments;
    } else if (std::find(ignored_records.begin(), ignored_records.end(), keyword) == ignored_records.end()) {
      refuse("unknown record \"" + keyword.substr(0, 20) + "\"", line_);
    }
  }

  double number(const std::string& word) const {
    double value = 0;
    const char* begin = word.data() + (word.starts_with('+') ? 1 : 0);
    const char* end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error == std::errc::invalid_argument || stop != end) refuse("\"" + word + "\" is not a number", line_);
    if (error != std::errc() || !std::isfinite(value)) refuse("\"" + word + "\" is not a finite number", line_);
    return value;
  }

  void read_point(const std::vector<std::string>& words) {
    // Beyond x y z there may be a weight, a colour, or both.
    const std::size_t count = words.size();
    if (count != 3 && count != 4 && count != 6 && count != 7) {
      refuse("a vertex with " + std::to_string(count) + " numbers, expected 3 coordinates", line_);
    }
    soup_.points.emplace_back(number(words[0]), number(words[1]), number(words[2]));
  }

  void read_texture(const std::vector<std::string>& words) {
    if (words.empty() || words.size() > 3) {
      refuse("a texture vertex with " + std::to_string(words.size()) + " numbers, expected u and v", line_);
    }
    textures_.emplace_back(number(words[0]), words.size() > 1 ? number(words[1]) : 0.0);
  }

  /// An index counts from 1, or back from the last one so far where it is negative.
  int index(std::string_view word, std::size_t count_so_far) const {
    int value = 0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || stop != word.data() + word.size())
      refuse("\"" + std::string(word) + "\" is not an index", line_);
    if (value == 0) refuse("index 0, expected indices to start at 1", line_);
    if (value > 0) return value - 1;
    if (static_cast<std::size_t>(-static_cast<long>(value)) > count_so_far) {
      refuse("index " + std::to_string(value) + " reaches back beyond the first of " + std::to_string(count_so_far),
             line_);
    }
    return static_cast<int>(count_so_far) + value;
  }

  void read_face(const std::vector<std::string>& words) {
    if (words.size() < 3)
      refuse("a face with " + std::to_string(words.size()) + " corners, expected at least 3", line_);
    Face face{line_, {}, {}};
    for (const std::string& word : words) {
      const std::string_view corner = word;
      const std::size_t slash = corner.find('/');
      face.points.push_back(index(corner.substr(0, slash), soup_.points.size()));
      const std::string_view rest = slash == std::string_view::npos ? "" : corner.substr(slash + 1);
      const std::string_view texture = rest.substr(0, rest.find('/'));
      if (!texture.empty()) face.textures.push_back(index(texture, textures_.size()));
    }
    if (!face.textures.empty() && face.textures.size() != face.points.size()) {
      refuse("a face with " + std::to_string(face.points.size()) + " corners, of which " +
                 std::to_string(face.textures.size()) + " have a texture vertex, expected all or none",
             line_);
    }
    for (const auto* names : {&object_, &groups_}) {
      for (const std::string& name : *names) {
        std::vector<int>& members = soup_.groups[name];
        members.insert(members.end(), face.points.begin(), face.points.end());
      }
    }
    faces_.push_back(std::move(face));
  }

  void require_range(const std::vector<int>& indices, std::size_t count, const char* what, int line) const {
    for (const int i : indices) {
      if (static_cast<std::size_t>(i) >= count) {
        refuse(std::string(what) + " " + std::to_string(i + 1L) + " is out of range, the file has " +
                   std::to_string(count),
               line);
      }
    }
  }

  PolygonSoup finish() {
    const bool all_textured =
        std::none_of(faces_.begin(), faces_.end(), [](const Face& face) { return face.textures.empty(); });
    for (Face& face : faces_) {
      require_range(face.points, soup_.points.size(), "vertex", face.line);
      require_range(face.textures, textures_.size(), "texture vertex", face.line);
      if (all_textured) {
        std::vector<Vector2>& uv = soup_.corner_uv.emplace_back();
        for (const int t : face.textures) uv.push_back(textures_[t]);
      }
      soup_.polygons.push_back(std::move(face.points));
      soup_.lines.push_back(face.line);
    }
    for (auto& [name, members] : soup_.groups) {
      std::sort(members.begin(), members.end());
      members.erase(std::unique(members.begin(), members.end()), members.end());
    }
    return std::move(soup_);
  }

  std::string file_;
  int line_ = 0;
  PolygonSoup soup_;
  std::vector<Vector2> textures_;
  std::vector<Face> faces_;
  std::vector<std::string> object_, groups_;
};

}  // namespace

PolygonSoup read_obj(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw MeshError(path.string() + ": cannot be opened");
  return ObjReader(path.string()).read(in);
}

}  // namespace taut
