#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dynamics/model.h"
#include "files/vtu.h"

namespace taut {

/// A file with positions, and the number at the end of its name.
struct FrameFile {
  std::filesystem::path path;
  int number = 0;
};

/// Frames in the order of their numbers, and what is wrong with the list, a line each.
struct FrameList {
  std::vector<FrameFile> files;
  std::vector<std::string> problems;
};

/// The number that ends the name of a file before its extension, if there is one: 10 for cloth_00010.obj.
std::optional<int> frame_number(const std::filesystem::path& file);

/// Files that match any of the patterns (as a shell expands *, ? and [...]; a name without them is a file), in the
/// order of the numbers at the end of their names. Where no name has a number the files are numbered from 0 in order of
/// name.
///
/// Problems: a pattern that matches nothing; two files of one number; names with a number among names without; numbers
/// that are missing. The distance expected between numbers is the one found most often, the smaller of two found
/// equally often; a smaller one, as at the end of a run, is no gap.
FrameList find_frames(const std::vector<std::string>& patterns);

/// Positions and triangles of an OBJ, PLY, OFF or VTU file, and the fields of a VTU file. Throws FileError or
/// MeshError; STL files are refused, because they do not keep the order of vertices.
Frame read_frame(const std::filesystem::path& file);

/// What keeps a frame from being one of this model, a line each: another number of vertices, a vertex that is not
/// finite, other triangles. Triangles may come in another order and start at another corner.
std::vector<std::string> misfits(const Frame& frame, const Model& model);

}  // namespace taut
