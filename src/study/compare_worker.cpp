#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <new>
#include <stdexcept>

#include "files/atomic_file.h"
#include "files/checkpoint.h"
#include "files/json_lines.h"
#include "problems/build.h"
#include "study/compare_job.h"
#include "study/compare_json.h"
#include "study/machine.h"
#include "study/state_arrays.h"
#include "study/step_trial.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

TrialOptions trial_options(const CompareJob& job) {
  using Clock = std::chrono::steady_clock;
  TrialOptions options;
  options.repeat = job.repeat;
  options.cold = job.cold;
  options.warm_up = !job.untimed;
  if (job.seconds > 0) {
    options.budget.deadline =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(job.seconds));
  }
  return options;
}

State read_state(const fs::path& folder, int step) {
  const Checkpoint checkpoint = read_checkpoint(step_file(folder, step));
  return state_from(static_cast<int>(checkpoint.step), checkpoint.arrays);
}

int carry_out(const CompareJob& job, const fs::path& folder) {
  const TrialOptions options = trial_options(job);
  const Scene scene = read_scene(job.problem, job.overrides);
  if (!job.scene_hash.empty() && scene.hash != job.scene_hash)
    throw std::runtime_error(job.problem + " has changed since the comparison began");
  const std::unique_ptr<Solver> solver = build_solver(scene, job.threads > 0 ? job.threads : this_machine().cores);
  StepTrials trials(scene, *solver, options);
  const bool own_trajectory = job.records || job.states.empty();
  const fs::path states = folder / job.states;
  fs::create_directories(folder / solutions_folder);
  LineFile lines(folder / trials_file);
  const int steps = job.steps > 0 ? job.steps : scene.time.steps;
  for (int step = 0; step < steps; ++step) {
    if (options.budget.out_of_time()) return worker_out_of_time;
    const State state = own_trajectory ? trials.state() : read_state(states, step);
    if (job.records) write_checkpoint(step_file(states, step), {scene.hash, step, state_arrays(state), {}});
    const StepTrial trial = trials.run(state);
    write_checkpoint(step_file(folder / solutions_folder, trial.step),
                     {scene.hash, trial.step, solution_arrays(trial.result, trials.model()), {}});
    lines.append(trial_line(trial));
    if (!own_trajectory) continue;
    const bool ends = (job.records || job.untimed) && trial.judged != Status::solved;
    if (!trial.result.x.allFinite() || ends) break;
    trials.accept();
  }
  return options.budget.out_of_time() ? worker_out_of_time : worker_finished;
}

}  // namespace

int work(const fs::path& job) {
  try {
    return carry_out(parse_job(read_bytes(job)), job.parent_path());
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "out of memory\n");
    return worker_out_of_memory;
  } catch (const InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return worker_refused;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return worker_failed;
  }
}

}  // namespace taut
