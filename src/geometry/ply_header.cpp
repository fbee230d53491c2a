#include "geometry/ply_header.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <sstream>
#include <string_view>
#include <vector>

#include "geometry/topology.h"

namespace taut {
namespace {

using Words = std::vector<std::string>;

template <std::size_t size>
bool is_one_of(const std::string& word, const std::array<std::string_view, size>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool is_real(const std::string& type) {
  return is_one_of(type, std::array<std::string_view, 4>{"float", "float32", "double", "float64"});
}
bool is_wide_integer(const std::string& type) {
  return is_one_of(type, std::array<std::string_view, 4>{"int", "int32", "uint", "uint32"});
}
bool is_integer(const std::string& type) {
  return is_wide_integer(type) ||
         is_one_of(type, std::array<std::string_view, 8>{"char", "int8", "uchar", "uint8", "short", "int16", "ushort",
                                                         "uint16"});
}

class PlyHeader {
 public:
  PlyHeader(std::istream& in, const std::string& file, std::uintmax_t file_size)
      : in_(in), file_(file), file_size_(file_size) {}

  void read() {
    if (next_line() != Words{"ply"}) refuse("expected \"ply\"");
    const Words format = next_line();
    const bool known =
        format.size() == 3 && format[0] == "format" &&
        is_one_of(format[1], std::array<std::string_view, 3>{"ascii", "binary_little_endian", "binary_big_endian"});
    if (!known) refuse("expected \"format\" with ascii, binary_little_endian or binary_big_endian, and a version");
    for (Words words = next_line(); words != Words{"end_header"}; words = next_line()) read_record(words);
    for (const char* axis : {"x", "y", "z"}) {
      if (coordinates_.find(axis) == std::string::npos)
        refuse("the vertices have no property " + std::string(axis) + " of type float or double");
    }
    if (!has_faces_) refuse("the faces have no list vertex_indices or vertex_index of type int or uint");
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw MeshError(file_ + ":" + std::to_string(line_) + ": " + what);
  }

  Words next_line() {
    ++line_;
    std::string text;
    if (!std::getline(in_, text)) refuse("the header has no end");
    std::istringstream stream(text);
    Words words;
    for (std::string word; stream >> word;) words.push_back(word);
    if (words.empty()) refuse("blank line in the header");
    return words;
  }

  void read_record(const Words& words) {
    if (words[0] == "comment" || words[0] == "obj_info") return;
    if (words[0] == "element" && words.size() == 3) return read_element(words);
    if (words[0] == "property" && !element_.empty()) {
      if (words.size() == 3 && (is_real(words[1]) || is_integer(words[1]))) return read_number(words[1], words[2]);
      const bool is_list = words.size() == 5 && words[1] == "list" && is_integer(words[2]);
      if (is_list && (is_real(words[3]) || is_integer(words[3]))) return read_list(words[3], words[4]);
    }
    refuse("not a record of a PLY header, or one in the wrong place");
  }

  void read_element(const Words& words) {
    element_ = words[1];
    std::uintmax_t count = 0;
    const char* end = words[2].data() + words[2].size();
    const auto [stop, error] = std::from_chars(words[2].data(), end, count);
    if (error != std::errc() || stop != end || count > file_size_)
      refuse("\"" + words[2].substr(0, 24) + "\" is not a number of items that fits in the file");
  }

  void read_number(const std::string& type, const std::string& name) {
    const bool is_axis = name == "x" || name == "y" || name == "z";
    if ((element_ == "vertex" || element_ == "vertices") && is_axis && is_real(type)) coordinates_ += name;
  }

  void read_list(const std::string& type, const std::string& name) {
    const bool is_corners = name == "vertex_indices" || name == "vertex_index";
    if ((element_ == "face" || element_ == "faces") && is_corners && is_wide_integer(type)) has_faces_ = true;
  }

  std::istream& in_;
  const std::string& file_;
  std::uintmax_t file_size_;
  int line_ = 0;
  std::string element_;
  std::string coordinates_;  // those of x, y, z that the vertices have
  bool has_faces_ = false;
};

}  // namespace

void require_readable_ply_header(std::istream& in, const std::string& file, std::uintmax_t file_size) {
  PlyHeader(in, file, file_size).read();
}

}  // namespace taut
