#pragma once

#include <filesystem>

#include "geometry/topology.h"
#include "geometry/triangle_mesh.h"

namespace taut {

/// Reads a triangle mesh from an .obj, .ply, .off or .stl file, told by the ending of its name in either case; PLY and
/// STL may be text or binary.
///
/// Units are those of the file, taken as metres. Polygons become fans of triangles around the first corner that allows
/// it: every triangle of the fan must face within 60 degrees of the polygon's mean normal and have an area; a polygon
/// without such a corner (dented, twisted or degenerate) is refused. Triangles keep the order of the file's faces. STL
/// corners at the same place become one vertex. OBJ `g` and `o` fill groups with the vertices of their faces, and `vt`
/// fills corner_uv where every face has it.
///
/// OBJ is read by our own reader, with or without CGAL: CGAL 5.5's drops `vt` and groups, lets an index one beyond the
/// end pass and says only that it failed, where ours names the line. PLY, OFF and STL need a build with CGAL.
///
/// Throws MeshError with one line, "cloth.obj:12: what is wrong" where a line is known: a missing, empty, truncated or
/// malformed file, an index out of range, a coordinate that is not finite, no faces. What the mesh is like beyond that
/// is validate()'s to say.
TriangleMesh read_mesh(const std::filesystem::path& path);

}  // namespace taut
