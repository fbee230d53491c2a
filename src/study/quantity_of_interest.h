#pragma once

#include <optional>
#include <string>
#include <vector>

#include "problems/scene.h"
#include "study/stored_run.h"

namespace taut {

/// What a person wants to know of the end of a run.
struct QuantityOfInterest {
  enum class Kind {
    probe,         ///< a probe of the problem, in its own unit
    displacement,  ///< the largest displacement of a vertex, m
    shape,         ///< where the surfaces are; its distance is the root mean square over common material points, m
    frequency,     ///< a natural frequency, Hz
    tension,       ///< the largest tension of a triangle (peak_tension()), N/m
    energy         ///< an energy, or the sum of all, J
  };
  Kind kind = Kind::displacement;
  std::string name;  ///< of the probe or the energy; empty: all energies
  int mode = 1;      ///< of the frequency

  /// "probe:tip", "frequency:2", as on the command line.
  std::string text() const;
  /// "mm" for lengths and so on; empty where it is not known.
  std::string unit() const;
};

/// "probe:NAME", "displacement", "shape", "frequency:K", "tension", "energy" or "energy:NAME". Throws InputError.
QuantityOfInterest parse_quantity(const std::string& text);

/// The names of the probes or energies that a scene has must have the quantity. Throws InputError.
void check_quantity(const QuantityOfInterest& quantity, const Scene& scene);

/// How exact an answer has to be.
struct AnswerTolerance {
  double value = 0;
  bool relative = true;  ///< to Answer::magnitude; else in the unit of the quantity, SI

  double allowed(double magnitude) const { return relative ? value * magnitude : value; }
};

/// "5%", "0.05", "abs:0.002", or with a unit that the quantity has: "2mm", "0.1Hz", "3N/m", "1J". Throws InputError.
AnswerTolerance parse_tolerance(const std::string& text, const QuantityOfInterest& quantity);

/// What a run says.
struct Answer {
  Vector values;         ///< one number, or 3 entries for the displacement of each material point
  double magnitude = 0;  ///< what relative tolerances are relative to: of shapes the root mean square displacement, of
                         ///< the sum of energies that of their magnitudes, else the magnitude of the number
};

/// How far two answers to the same question are apart: the difference of two numbers, or the root mean square distance
/// of the material points.
double distance(const Answer& a, const Answer& b);

/// Takes the answer to one question from runs of one scene and of simpler models of it.
class Observer {
 public:
  /// `full` is the scene as written; its vertices, at most a few thousand of each body, are the material points of
  /// shapes. Throws InputError where the scene cannot be built or cannot answer.
  Observer(QuantityOfInterest quantity, const Scene& full);

  /// Nothing where the run has not reached its end or its answer is not finite.
  std::optional<Answer> operator()(const StoredRun& run) const;
  const QuantityOfInterest& quantity() const { return quantity_; }

 private:
  /// Points of a body where it starts, m.
  struct MaterialPoints {
    std::string body;
    std::vector<Vector3> places;
  };
  Answer shape(const StoredRun& run) const;

  QuantityOfInterest quantity_;
  std::vector<MaterialPoints> points_;
};

}  // namespace taut
