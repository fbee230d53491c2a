#include "study/residual_estimate.h"

#include <algorithm>
#include <array>
#include <chrono>

#include "core/assembly.h"
#include "dynamics/stepper.h"
#include "geometry/prolongation.h"
#include "linalg/cholesky.h"
#include "problems/build.h"
#include "solvers/newton.h"
#include "study/middle_surface.h"

namespace taut {
namespace {

/// Why the step from one model to the other cannot be posed.
struct Refused {
  std::string why;
};

/// The coarse displacement at the material points of the finer model, level by level.
Vector prolonged(const Model& coarse, const Vector& end, const Model& fine) {
  if (coarse.bodies.size() != fine.bodies.size()) throw Refused{"the models have other bodies"};
  const Vector moved = end - coarse.start();
  Vector x = fine.start();
  for (std::size_t k = 0; k < fine.bodies.size(); ++k) {
    const BodyRange &from = coarse.bodies[k], &to = fine.bodies[k];
    if (from.levels != to.levels) throw Refused{"the models have other layers"};
    const TriangleMesh mesh = middle_surface(coarse, from, end).start;
    const std::vector<Vector3> points = middle_surface(fine, to, x).start.vertices;
    const Prolongation p = prolongation(mesh, points, to.name);
    for (int level = 0; level < to.levels; ++level) {
      std::vector<Vector3> own;
      for (int vertex = 0; vertex < from.vertices / from.levels; ++vertex)
        own.push_back(moved.segment<3>(3 * (from.first_vertex + vertex * from.levels + level)));
      const std::vector<Vector3> there = prolonged(p, own);
      for (std::size_t v = 0; v < there.size(); ++v)
        x.segment<3>(3 * (to.first_vertex + static_cast<int>(v) * to.levels + level)) += there[v];
    }
  }
  return x;
}

}  // namespace

ResidualEstimate residual_estimate(const StoredRun& coarse, const Scene& finer, const Observer& observer, int threads) {
  ResidualEstimate e;
  const auto begin = std::chrono::steady_clock::now();
  try {
    const auto before = build_model(coarse.scene), model = build_model(finer);
    Stepper stepper(*model, time_options(finer));
    State state = stepper.state();
    state.step = finer.time.steps - 1;
    state.positions = prolonged(*before, coarse.checkpoint.state.positions, *model);
    stepper.restore(state);
    const Problem& problem = stepper.prepare();
    Assembly assembly(problem.size(), problem.energies, problem.fixed_variables, threads);
    assembly.set_order(fill_reducing_order(assembly.graph()));
    Cholesky cholesky(assembly.matrix(), threads);
    SubstitutedSystem system(assembly, cholesky);
    Vector x = problem.initial_guess, gradient, step, none;
    assembly.hessian(x, Curvature::exact, &gradient);
    if (!system.factorize(0)) throw Refused{"the stiffness is not positive definite there"};
    e.work = system.size().factor_flops;
    const auto answer = [&] {
      Result r;
      r.x = x;
      for (const Constraint* c : problem.constraints)
        r.multipliers.emplace_back(Vector::Zero(c->rows() * c->stencils().count()));
      StoredRun run;
      run.scene = finer;
      const std::vector<double> values = probe_values(finer, *model, problem, x);
      run.summary.probes = probes_of(finer);
      for (std::size_t k = 0; k < values.size(); ++k) run.summary.probes[k].value = values[k];
      stepper.accept(r);
      run.checkpoint.state = stepper.state();
      run.steps.emplace_back().energies = stepper.energies();
      stepper.restore(state);
      stepper.prepare();
      return observer(run);
    };
    system.solve(gradient, {}, step, none);
    const double first = step.norm();
    x += step;
    e.first = answer();
    assembly.gradient(x, gradient);
    system.solve(gradient, {}, step, none);
    e.contraction = step.norm() / first;
    x += step;
    e.answer = answer();
  } catch (const Refused& refused) {
    e.why = refused.why;
  } catch (const MeshError& error) {
    e.why = error.what();
  }
  e.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return e;
}

}  // namespace taut
