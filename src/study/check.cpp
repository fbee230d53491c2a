#include "study/check.h"

#include <fmt/format.h>

#include <algorithm>

namespace taut {

std::string_view to_string(CheckVerdict verdict) {
  switch (verdict) {
    case CheckVerdict::within:
      return "within tolerance";
    case CheckVerdict::outside:
      return "not within tolerance";
    case CheckVerdict::unusable:
      break;
  }
  return "unusable";
}

bool FrameVerdict::within() const {
  return std::all_of(verdicts.begin(), verdicts.end(), [](const Verdict& verdict) { return verdict.within(); });
}

CheckVerdict CheckReport::verdict() const {
  if (!unusable.empty()) return CheckVerdict::unusable;
  return findings.empty() ? CheckVerdict::within : CheckVerdict::outside;
}

void take_worst(CheckReport& report, int first_judged) {
  std::vector<int> frames_outside;
  for (const FrameVerdict& frame : report.frames) {
    if (frame.number < first_judged) continue;
    if (report.worst.empty()) {
      for (const Verdict& v : frame.verdicts) report.worst.push_back({v.constraint, 0, 0, v.allowed, 0, 0, ""});
      frames_outside.assign(report.worst.size(), 0);
    }
    for (std::size_t k = 0; k < frame.verdicts.size(); ++k) {
      const Verdict& verdict = frame.verdicts[k];
      Verdict& worst = report.worst[k];
      worst.elements += verdict.elements;
      worst.violated += verdict.violated;
      worst.percentile99 = std::max(worst.percentile99, verdict.percentile99);
      frames_outside[k] += !verdict.within();
      if (!(verdict.max > worst.max)) continue;
      worst.max = verdict.max;
      worst.where = verdict.where + ", frame " + std::to_string(frame.number);
    }
  }
  for (std::size_t k = 0; k < report.worst.size(); ++k) {
    const Verdict& worst = report.worst[k];
    if (worst.within()) continue;
    report.findings.push_back(fmt::format("{}: {:.3g} at {}, allowed is {:.3g}; violated in {} of {} frames",
                                          worst.constraint, worst.max, worst.where, worst.allowed, frames_outside[k],
                                          report.frames.size()));
  }
}

}  // namespace taut
