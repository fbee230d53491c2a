#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dynamics/model.h"
#include "files/vtu.h"
#include "study/surface_fields.h"

namespace taut {

/// A number for every triangle of a scene in each of some frames; NaN where there is none.
struct TriangleField {
  std::string id, title, unit;
  std::optional<double> low, high;          ///< ends of the colour scale; else the extremes
  std::vector<std::vector<double>> frames;  ///< one value per triangle

  /// The smallest and the largest of the values that are finite; 0 and 0 where none is.
  std::pair<double, double> extremes() const;
};

/// One of the elements that are worst in some field.
struct WorstPlace {
  std::string field, what, unit;  ///< as in TriangleField
  std::string element;            ///< "triangle 17 of cloth", "vertex 3 of cloth"
  double value = 0;
  int frame = 0;               ///< the place of the frame in which it is worst
  std::vector<int> triangles;  ///< that show it
};

/// What a viewer can colour a surface by, collected frame by frame: the largest singular value; tension, where the
/// frames hold it; and for each constraint how far elements violate it. A triangle has the violation of the elements
/// whose vertices it contains or that contain its vertices, the largest of them.
class TriangleFields {
 public:
  /// The model is borrowed.
  explicit TriangleFields(const Model& model);

  /// Appends a frame of this model; obstacles count where they are now.
  void take(const Frame& frame);

  /// Those that say something: a constraint that is nowhere violated and a tension that is nowhere found are left out.
  std::vector<TriangleField> fields() const;
  /// Of each of these fields at most five elements, each in its worst frame, worst first.
  std::vector<WorstPlace> worst() const;

 private:
  struct Violations {
    const Constraint* constraint;
    std::vector<std::vector<int>> triangles;  // of each element
    std::vector<double> largest;              // of each element, over the frames
    std::vector<int> frame;                   // in which it was
    TriangleField field;
  };
  void take_violations(Violations& violations, const Vector& positions);

  const Model& model_;
  SurfaceFields surface_;
  TriangleField stretch_, tension_;
  std::vector<Violations> violations_;
  int frames_ = 0;
};

}  // namespace taut
