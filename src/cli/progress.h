#pragma once

#include <chrono>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace taut {

/// Says on a terminal, in one line that is redrawn, how far a run is. Where the stream is no terminal it prints plain
/// lines: one for every tenth of the way but at most one in 2 s, one after a minute of silence, and one at the end.
/// NO_COLOR (not empty) takes the colour away, TERM=dumb the redrawing.
class Progress {
 public:
  using Clock = std::function<std::chrono::steady_clock::time_point()>;

  /// `already_done` of the `total` items were finished before (a resumed run) and say nothing about the speed.
  /// `clock` is there for tests.
  Progress(std::string label, long total, std::FILE* stream = stderr, long already_done = 0,
           Clock clock = std::chrono::steady_clock::now);
  /// Clears the line of a run that did not finish, so that an error message starts on a clean one.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `done` of the total are finished; `note` is one short line on the latest.
  void update(long done, std::string_view note = {});
  /// Takes the redrawn line off the terminal, so that other output can be printed; the next update brings it back.
  void clear();
  /// Replaces the bar by one plain line with the count and the seconds. Later calls do nothing.
  void finish();

 private:
  using Time = std::chrono::steady_clock::time_point;

  double rate() const;
  std::string bar_line(std::string_view note) const;
  std::string plain_line(std::string_view note) const;
  bool plain_line_is_due(Time now) const;

  std::string label_;
  long total_, already_done_, done_, printed_done_;
  std::FILE* stream_;
  Clock clock_;
  Time start_, printed_;
  bool terminal_, colour_, unicode_;
  bool drawn_ = false, finished_ = false;
};

/// The progress of tasks whose number is known only once they are planned; says nothing where `quiet`.
class TaskProgress {
 public:
  TaskProgress(std::string label, bool quiet) : label_(std::move(label)), quiet_(quiet) {}

  void begin(int tasks) {
    if (!quiet_) progress_.emplace(label_, tasks);
  }
  /// One more is finished; `note` is one short line on it.
  void done(std::string_view note) {
    if (progress_) progress_->update(++done_, note);
  }
  /// Leaves a line with the count and the seconds, unless the command was interrupted.
  void end(bool interrupted) {
    if (progress_ && !interrupted) progress_->finish();
    progress_.reset();
  }

 private:
  std::string label_;
  bool quiet_;
  long done_ = 0;
  std::optional<Progress> progress_;
};

}  // namespace taut
