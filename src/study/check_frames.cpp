#include <fmt/format.h>

#include <exception>

#include "problems/build.h"
#include "study/check.h"
#include "study/frame_files.h"

namespace taut {
namespace {

/// When the frames of a list are.
class Clock {
 public:
  Clock(const Scene& scene, const FrameOptions& options, int first_number)
      : step_(options.step.value_or(scene.time.step)),
        first_time_(options.first_time.value_or(0)),
        first_number_(options.step || options.first_time ? first_number : 0) {}
  double time_of(int number) const { return first_time_ + (number - first_number_) * step_; }

 private:
  double step_, first_time_;
  int first_number_;
};

}  // namespace

CheckReport check_frames(const Scene& scene, const FrameOptions& options) {
  CheckReport report;
  report.problem = scene.name;
  report.subject = options.patterns.front();
  if (options.patterns.size() > 1) report.subject += fmt::format(" and {} more", options.patterns.size() - 1);
  report.tolerance = options.tolerance.value_or(scene.solver.tolerance.feasibility);

  const auto model = build_model(scene);
  const PositionJudge judge(*model, report.tolerance);
  FrameList list = find_frames(options.patterns);
  report.unusable = std::move(list.problems);
  if (list.files.empty()) return report;
  const Clock clock(scene, options, list.files.front().number);
  for (const FrameFile& file : list.files) {
    try {
      const Frame frame = read_frame(file.path);
      const std::vector<std::string> problems = misfits(frame, *model);
      for (const std::string& problem : problems) report.unusable.push_back(file.path.string() + ": " + problem);
      if (frame.positions.size() != model->start().size() || !frame.positions.allFinite()) continue;
      FrameVerdict verdict{file.path.string(), file.number, clock.time_of(file.number), {}};
      verdict.verdicts = judge.constraints(frame.positions, verdict.time);
      for (Verdict& faces : judge.faces(frame.positions, options.largest_fold))
        verdict.verdicts.push_back(std::move(faces));
      report.frames.push_back(std::move(verdict));
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {  // of the readers, which begin with the path
      report.unusable.push_back(error.what());
    }
  }
  take_worst(report, list.files.front().number);
  return report;
}

}  // namespace taut
