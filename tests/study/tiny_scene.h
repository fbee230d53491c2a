#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "problems/read_scene.h"

namespace taut {

/// A hanging cloth of 32 triangles that meets its limit, written to `folder` and read with `overrides`. A step takes a
/// millisecond.
inline Scene tiny_scene(const std::filesystem::path& folder, const Overrides& overrides = {}) {
  const std::filesystem::path file = folder / "tiny.json";
  std::ofstream(file) << R"({
    "format": 1,
    "time": { "integrator": "bdf2", "step": 0.02, "steps": 8 },
    "gravity": [0, 0, -9.81],
    "bodies": { "cloth": {
      "mesh": { "grid": { "size": [1, 1], "cells": [4, 4] } }, "thickness": 0.0003, "density": 500,
      "membrane": { "law": "stvk", "young_modulus": 8000, "poisson_ratio": 0.25 } } },
    "constraints": {
      "held": { "type": "pin", "body": "cloth", "select": { "corners": ["x0y1", "x1y1"] } },
      "limit": { "type": "strain_limit", "body": "cloth", "max": 1.02 } },
    "solver": {},
    "output": { "every": 3, "pictures": 2 }
  })";
  return read_scene(file, overrides);
}

}  // namespace taut
