#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "problems/read_scene.h"

namespace taut {

/// A clamped strip of 300 x 30 x 1 mm of steel in `modes` modes, its tip pulled up by a hand; written to `folder` and
/// read with `overrides`.
inline Scene modal_scene(const std::filesystem::path& folder, const Overrides& overrides = {}, int modes = 12) {
  const std::filesystem::path file = folder / "modal.json";
  std::ofstream(file) << fmt::format(R"({{
    "format": 1,
    "time": {{ "integrator": "newmark", "step": 0.002, "steps": 6 }},
    "gravity": [0, 0, -9.81],
    "bodies": {{ "ruler": {{
      "model": "modal", "mesh": {{ "grid": {{ "size": [0.3, 0.03], "cells": [12, 2] }} }},
      "thickness": 0.001, "density": 7850, "mass": "consistent",
      "material": {{ "law": "stvk", "young_modulus": 2e11, "poisson_ratio": 0.3 }},
      "modal": {{ "modes": {}, "clamp": {{ "edges": ["x0"] }}, "damping_ratio": 0.01 }} }} }},
    "constraints": {{ "hand": {{
      "type": "pin", "body": "ruler", "select": {{ "corners": ["x1y0", "x1y1"] }}, "axes": "z", "surface": "bottom",
      "motion": {{ "keyframes": [{{ "time": 0, "translation": [0, 0, 0] }}, {{ "time": 0.012, "translation": [0, 0, 0.02] }}] }} }} }},
    "solver": {{}},
    "output": {{ "every": 2, "pictures": 1, "probes": {{
      "force": {{ "quantity": "force_z", "select": {{ "corners": ["x1y0", "x1y1"] }}, "surface": "bottom" }} }} }}
  }})",
                                     modes);
  return read_scene(file, overrides);
}

}  // namespace taut
