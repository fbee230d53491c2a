#include "study/residual_estimate.h"

#include <algorithm>
#include <cmath>

#include "core/assembly.h"
#include "core/stopwatch.h"
#include "dynamics/stepper.h"
#include "geometry/prolongation.h"
#include "linalg/cholesky.h"
#include "problems/build.h"
#include "solvers/newton.h"
#include "study/examine.h"
#include "study/middle_surface.h"
#include "study/probes.h"

namespace taut {
namespace {

/// A correction that is this small against the displacement changes no answer.
constexpr double negligible = 1e-6;

/// Why there is no estimate.
struct Refused {
  std::string why;
};

void refuse_if(bool refused, const char* why) {
  if (refused) throw Refused{why};
}

/// What can be told before anything is computed.
void check(const StoredRun& coarse, const Model& model, const QuantityOfInterest& quantity) {
  refuse_if(quantity.kind == QuantityOfInterest::Kind::frequency, "a natural frequency needs its mode");
  refuse_if(coarse.scene.time.integrator != scene::Integrator::quasi_static, "the problem is not static");
  refuse_if(model.modal != nullptr, "the body moves in modes");
  refuse_if(!model.equalities.empty(), "a cover is coupled to its shell");
  refuse_if(!model.lagged_loads.empty(), "a load depends on the step before");
  const std::vector<Vector>& multipliers = coarse.checkpoint.state.warm.multipliers;
  refuse_if(std::any_of(multipliers.begin(), multipliers.end(), [](const Vector& m) { return !m.isZero(0); }),
            "a constraint is active");
}

/// Where the vertices of the finer model are when they move as the coarse one does at their material points, in each
/// level of its layers.
Vector prolonged(const Model& coarse, const Vector& end, const Model& finer) {
  refuse_if(coarse.bodies.size() != finer.bodies.size(), "the models have other bodies");
  const Vector moved = end - coarse.start();
  Vector x = finer.start();
  for (std::size_t k = 0; k < finer.bodies.size(); ++k) {
    const BodyRange &from = coarse.bodies[k], &to = finer.bodies[k];
    refuse_if(from.levels != to.levels, "the models have other layers");
    const std::vector<Vector3> points = middle_surface(finer, to, finer.start()).start.vertices;
    const Prolongation p = prolongation(middle_surface(coarse, from, end).start, points, to.name);
    for (int level = 0; level < to.levels; ++level) {
      std::vector<Vector3> own;
      for (int vertex = from.first_vertex + level; vertex < from.first_vertex + from.vertices; vertex += from.levels)
        own.push_back(moved.segment<3>(3 * vertex));
      int vertex = to.first_vertex + level;
      for (const Vector3& there : prolonged(p, own)) {
        x.segment<3>(3 * vertex) += there;
        vertex += to.levels;
      }
    }
  }
  return x;
}

/// The last load step of a static model, about to be solved from given positions.
class LastStep {
 public:
  LastStep(const Scene& scene, Model& model, const Vector& positions)
      : scene_(scene), model_(model), stepper_(model, time_options(scene)) {
    start_ = stepper_.state();
    start_.step = scene.time.steps - 1;
    start_.positions = positions;
    stepper_.restore(start_);
    stepper_.prepare();
  }

  const Problem& problem() const { return stepper_.problem(); }

  /// The run that would have ended at x, without forces of constraints.
  StoredRun run_to(const Vector& x) {
    StoredRun run;
    run.scene = scene_;
    run.summary.probes = probes_of(scene_);
    const std::vector<double> values = probe_values(scene_, model_, problem(), x);
    for (std::size_t k = 0; k < values.size(); ++k) run.summary.probes[k].value = values[k];
    Result result;
    result.x = x;
    for (const Constraint* constraint : problem().constraints)
      result.multipliers.emplace_back(Vector::Zero(constraint->rows() * constraint->stencils().count()));
    stepper_.accept(result);
    run.checkpoint.state = stepper_.state();
    run.steps.emplace_back().energies = stepper_.energies();
    return run;
  }

 private:
  const Scene& scene_;
  Model& model_;
  Stepper stepper_;
  State start_;
};

/// Moves x by the Newton step and the simplified one.
void correct(const Problem& problem, const Vector& start, int threads, Vector& x, ResidualEstimate& estimate) {
  Assembly assembly(problem.size(), problem.energies, problem.fixed_variables, threads);
  assembly.set_order(fill_reducing_order(assembly.graph()));
  Cholesky cholesky(assembly.matrix(), threads);
  SubstitutedSystem system(assembly, cholesky);
  Vector residual, step, no_multipliers;
  assembly.hessian(x, Curvature::exact, &residual);
  estimate.work = system.size().factor_flops;
  refuse_if(!residual.allFinite() || !system.factorize(0), "the stiffness is not positive definite there");
  double lengths[2];
  for (double& length : lengths) {
    system.solve(residual, {}, step, no_multipliers);
    ++estimate.linear_solves;
    refuse_if(!step.allFinite() || assembly.largest_step(x, step) <= 1, "the Newton step turns an element over");
    x += step;
    length = step.norm();
    refuse_if(!std::isfinite(assembly.gradient(x, residual)), "the Newton step leaves the domain of an energy");
  }
  estimate.contraction = lengths[0] > 0 ? lengths[1] / lengths[0] : 0;
  refuse_if(lengths[1] > std::max(largest_contraction * lengths[0], negligible * (x - start).norm()),
            "Newton's method does not contract fast enough");
  refuse_if(!worst_elements(problem, x, 1).empty(), "a constraint would be violated");
}

}  // namespace

ResidualEstimate residual_estimate(const StoredRun& coarse, const Scene& finer, const Observer& observer, int threads) {
  ResidualEstimate estimate;
  try {
    const Stopwatch watch(estimate.seconds);
    const auto before = build_model(coarse.scene), model = build_model(finer);
    check(coarse, *model, observer.quantity());
    LastStep last(finer, *model, prolonged(*before, coarse.checkpoint.state.positions, *model));
    Vector x = last.problem().initial_guess;
    correct(last.problem(), model->start(), threads, x, estimate);
    estimate.answer = observer(last.run_to(x));
    refuse_if(!estimate.answer, "the quantity is not there, or not a number");
  } catch (const Refused& refused) {
    estimate.why = refused.why;
  } catch (const MeshError& error) {
    estimate.why = error.what();
  }
  return estimate;
}

}  // namespace taut
