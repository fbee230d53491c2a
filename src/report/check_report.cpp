#include "report/check_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "study/residuals_json.h"

namespace taut {
namespace {

using Json = nlohmann::ordered_json;
using Out = std::back_insert_iterator<std::string>;

constexpr std::size_t most_lines = 20;

void print_lines(Out out, const std::vector<std::string>& lines) {
  const std::size_t shown = std::min(lines.size(), most_lines);
  for (std::size_t i = 0; i < shown; ++i) fmt::format_to(out, "  {}\n", lines[i]);
  if (shown < lines.size()) fmt::format_to(out, "  and {} more (--json has all)\n", lines.size() - shown);
}

void print_last_step(Out out, const CheckReport& report) {
  if (!report.last_step) return;
  const Residuals& r = report.last_step->residuals;
  fmt::format_to(out, "residuals of step {}, computed anew (relative)\n", report.last_step->step);
  fmt::format_to(out, "  {:<18} {:.2e}  {}\n", "stationarity", r.stationarity, r.worst_node);
  fmt::format_to(out, "  {:<18} {:.2e}\n", "feasibility", r.feasibility);
  fmt::format_to(out, "  {:<18} {:.2e}\n", "complementarity", r.complementarity);
  if (!report.last_step->negative_curvatures) return;
  const Index negative = *report.last_step->negative_curvatures;
  fmt::format_to(out, "  {:<18} {}\n", "curvature",
                 negative == 0 ? "positive in every direction left: a minimum"
                               : fmt::format("negative in {} directions: a saddle, not a minimum", negative));
}

void print_probes(Out out, const CheckReport& report) {
  if (report.probes.empty()) return;
  fmt::format_to(out, "probes, computed anew\n");
  for (const ProbeValue& probe : report.probes) {
    fmt::format_to(out, "  {:<18} {:.6g}", probe.name, probe.value);
    if (probe.expected) fmt::format_to(out, "  expected {:.6g} within {:.2g}", probe.expected->value, probe.allowed());
    fmt::format_to(out, "\n");
  }
}

Json probes_json(const CheckReport& report) {
  Json json = Json::object();
  for (const ProbeValue& probe : report.probes) {
    json[probe.name] = {{"value", probe.value}, {"within", probe.within()}};
    if (!probe.expected) continue;
    json[probe.name]["expected"] = probe.expected->value;
    json[probe.name]["allowed"] = probe.allowed();
  }
  return json;
}

void print_worst(Out out, const CheckReport& report) {
  if (report.worst.empty()) return;
  fmt::format_to(out, "violations over {} frames\n  {:<18} {:>9} {:>9} {:>9} {:>9}  where\n", report.frames.size(), "",
                 "max", "99 %", "allowed", "violated");
  for (const Verdict& v : report.worst) {
    fmt::format_to(out, "  {:<18} {:>9.2e} {:>9.2e} {:>9.2e} {:>8.3g}%  {}\n", v.constraint, v.max, v.percentile99,
                   v.allowed, 100 * v.share(), v.where);
  }
}

/// The largest of what a frame's verdicts violate, each as a multiple of what is allowed.
double badness(const FrameVerdict& frame) {
  double worst = 0;
  for (const Verdict& v : frame.verdicts) {
    if (!v.within()) worst = std::max(worst, v.max / v.allowed);
  }
  return worst;
}

/// Only where frames differ in more than the worst shows: the frames outside, worst first.
void print_frames(Out out, const CheckReport& report) {
  std::vector<const FrameVerdict*> outside;
  for (const FrameVerdict& frame : report.frames) {
    if (!frame.within()) outside.push_back(&frame);
  }
  if (outside.empty()) return;
  std::stable_sort(outside.begin(), outside.end(),
                   [](const FrameVerdict* a, const FrameVerdict* b) { return badness(*a) > badness(*b); });
  fmt::format_to(out, "frames that violate something, worst first\n  {:>6} {:>10}  {:<18} {:>9} {:>9} {:>9}  where\n",
                 "frame", "time", "", "max", "99 %", "violated");
  std::size_t lines = 0;
  for (std::size_t i = 0; i < outside.size(); ++i) {
    if (lines >= most_lines) {
      fmt::format_to(out, "  and {} more frames (--csv FILE has all)\n", outside.size() - i);
      break;
    }
    for (const Verdict& v : outside[i]->verdicts) {
      if (v.within()) continue;
      fmt::format_to(out, "  {:>6} {:>10.4g}  {:<18} {:>9.2e} {:>9.2e} {:>4}/{:<4}  {}\n", outside[i]->number,
                     outside[i]->time, v.constraint, v.max, v.percentile99, v.violated, v.elements, v.where);
      ++lines;
    }
  }
}

Json verdict_json(const Verdict& v) {
  return {{"max", v.max},           {"percentile99", v.percentile99},
          {"allowed", v.allowed},   {"elements", v.elements},
          {"violated", v.violated}, {"share", v.share()},
          {"where", v.where},       {"within", v.within()}};
}

Json verdicts_json(const std::vector<Verdict>& verdicts) {
  Json json = Json::object();
  for (const Verdict& verdict : verdicts) json[verdict.constraint] = verdict_json(verdict);
  return json;
}

Json last_step_json(const CheckReport& report) {
  if (!report.last_step) return nullptr;
  const RecomputedStep& step = *report.last_step;
  const Residuals& r = step.residuals;
  Json violations = Json::object();
  for (const Violation& v : r.violations) violations[v.constraint] = {{"max", v.max}, {"where", v.where}};
  Json json{{"step", step.step}, {"claimed_status", to_string(step.claimed)}};
  json.update(residuals_json(r));
  json["violations"] = violations;
  if (step.negative_curvatures) json["negative_curvatures"] = *step.negative_curvatures;
  return json;
}

/// A field in quotes, as commas occur in names.
std::string quoted(const std::string& text) {
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? "\"\"" : std::string(1, c);
  return field + "\"";
}

}  // namespace

std::string check_table(const CheckReport& report) {
  std::string text;
  const Out out(text);
  fmt::format_to(out, "{}: {}, {} (tolerance of violations {:.3g})\n", report.problem, report.subject,
                 to_string(report.verdict()), report.tolerance);
  if (!report.unusable.empty()) fmt::format_to(out, "cannot be judged\n");
  print_lines(out, report.unusable);
  if (!report.findings.empty()) fmt::format_to(out, "found\n");
  print_lines(out, report.findings);
  print_last_step(out, report);
  print_probes(out, report);
  print_worst(out, report);
  print_frames(out, report);
  return text;
}

std::string check_json(const CheckReport& report) {
  Json frames = Json::array();
  for (const FrameVerdict& frame : report.frames) {
    frames.push_back({{"file", frame.file},
                      {"number", frame.number},
                      {"time", frame.time},
                      {"within", frame.within()},
                      {"constraints", verdicts_json(frame.verdicts)}});
  }
  const Json json = {{"format", 1},
                     {"problem", report.problem},
                     {"subject", report.subject},
                     {"verdict", to_string(report.verdict())},
                     {"tolerance", report.tolerance},
                     {"unusable", report.unusable},
                     {"findings", report.findings},
                     {"last_step", last_step_json(report)},
                     {"probes", probes_json(report)},
                     {"worst", verdicts_json(report.worst)},
                     {"frames", frames}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string check_csv(const CheckReport& report) {
  std::string text = "file,number,time,constraint,max,percentile99,allowed,violated,elements,share,where\n";
  for (const FrameVerdict& frame : report.frames) {
    for (const Verdict& v : frame.verdicts) {
      fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{},{},{}\n", quoted(frame.file), frame.number,
                     frame.time, quoted(v.constraint), v.max, v.percentile99, v.allowed, v.violated, v.elements,
                     v.share(), quoted(v.where));
    }
  }
  return text;
}

}  // namespace taut
