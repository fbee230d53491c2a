#include "cli/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace taut {
namespace {

using Seconds = std::chrono::duration<double>;

std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

bool locale_is_utf8() {
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const std::string_view value = environment(name);
    if (!value.empty()) return value.find("UTF-8") != value.npos || value.find("utf8") != value.npos;
  }
  return false;
}

std::size_t columns(std::FILE* stream) {
  winsize size{};
  if (::ioctl(::fileno(stream), TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return 80;
}

bool starts_character(char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }

/// The first `width` characters (not bytes) of `text`, without what would move the cursor.
std::string clipped(std::string_view text, std::size_t width) {
  std::string kept;
  for (const char c : text) {
    if (starts_character(c) && width-- == 0) break;
    kept += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return kept;
}

std::string duration_text(double seconds) {
  if (seconds < 60) return fmt::format("{:.{}f} s", seconds, seconds < 9.95 ? 1 : 0);
  const long whole = static_cast<long>(std::min(seconds, 1e12));
  if (whole < 3600) return fmt::format("{}:{:02} min", whole / 60, whole % 60);
  return fmt::format("{}:{:02} h", whole / 3600, whole / 60 % 60);
}

std::string rate_text(double rate) {
  return rate >= 1 || rate == 0 ? fmt::format("{:.3g}/s", rate) : fmt::format("{:.3g} s each", 1 / rate);
}

}  // namespace

Progress::Progress(std::string label, long total, std::FILE* stream, long already_done, Clock clock)
    : label_(std::move(label)),
      total_(std::max(total, 0L)),
      already_done_(already_done),
      done_(already_done),
      printed_done_(already_done),
      stream_(stream),
      clock_(std::move(clock)),
      start_(clock_()),
      printed_(start_),
      terminal_(::isatty(::fileno(stream)) && environment("TERM") != "dumb"),
      colour_(terminal_ && environment("NO_COLOR").empty()),
      unicode_(locale_is_utf8()) {}

Progress::~Progress() { clear(); }

double Progress::rate() const {
  const double seconds = Seconds(clock_() - start_).count();
  return seconds > 0 ? static_cast<double>(done_ - already_done_) / seconds : 0;
}

std::string Progress::plain_line(std::string_view note) const {
  std::string line = fmt::format("{}: {}/{}", label_, done_, total_);
  const double speed = rate();
  if (speed > 0) {
    line += ", " + rate_text(speed);
    if (done_ < total_) line += ", " + duration_text(static_cast<double>(total_ - done_) / speed) + " left";
  }
  if (!note.empty()) line += ", " + clipped(note, note.size());
  return line;
}

std::string Progress::bar_line(std::string_view note) const {
  const std::size_t width = columns(stream_);
  const int length = static_cast<int>(std::clamp<std::size_t>(width / 5, 8, 24));
  const double fraction =
      total_ > 0 ? std::clamp(static_cast<double>(done_) / static_cast<double>(total_), 0.0, 1.0) : 0;
  const int full = static_cast<int>(fraction * length);
  // A line that fills the last column would wrap, and could not be redrawn.
  std::size_t room = width - 1;
  const auto piece = [&room](std::string_view text) {
    const std::string kept = clipped(text, room);
    room -= static_cast<std::size_t>(std::count_if(kept.begin(), kept.end(), starts_character));
    return kept;
  };
  const auto repeated = [](std::string_view mark, int times) {
    std::string text;
    for (int i = 0; i < times; ++i) text += mark;
    return text;
  };
  std::string line = piece(label_ + " ");
  if (colour_) line += "\x1b[36m";
  line += piece(repeated(unicode_ ? "█" : "#", full));
  if (colour_) line += "\x1b[2m";
  line += piece(repeated(unicode_ ? "░" : "-", length - full));
  if (colour_) line += "\x1b[0m";
  line += piece(fmt::format(" {:3.0f}%", std::floor(100 * fraction)));
  const std::string details = plain_line(note);
  line += piece("  " + details.substr(label_.size() + 2));
  return line;
}

bool Progress::plain_line_is_due(Time now) const {
  const Seconds silence = now - printed_;
  const bool tenth = 10 * (done_ - printed_done_) >= total_;
  return (silence >= Seconds(2) && tenth) || silence >= Seconds(60);
}

void Progress::update(long done, std::string_view note) {
  if (finished_) return;
  done_ = done;
  const Time now = clock_();
  const bool due = terminal_ ? !drawn_ || now - printed_ >= std::chrono::milliseconds(100) : plain_line_is_due(now);
  if (!due) return;
  printed_ = now;
  printed_done_ = done;
  const std::string line = terminal_ ? "\r" + bar_line(note) + "\x1b[K" : plain_line(note) + "\n";
  drawn_ = terminal_;
  std::fwrite(line.data(), 1, line.size(), stream_);
  std::fflush(stream_);
}

void Progress::clear() {
  if (!std::exchange(drawn_, false)) return;
  std::fputs("\r\x1b[K", stream_);
  std::fflush(stream_);
}

void Progress::finish() {
  if (std::exchange(finished_, true)) return;
  clear();
  const std::string line =
      fmt::format("{}: {}/{} in {}\n", label_, done_, total_, duration_text(Seconds(clock_() - start_).count()));
  std::fwrite(line.data(), 1, line.size(), stream_);
  std::fflush(stream_);
}

}  // namespace taut
