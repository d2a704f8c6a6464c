#include "tools/cli/console_progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string_view>
#include <utility>

#include "core/json_internal.h"

namespace krok::cli {

namespace {

using Clock = std::chrono::steady_clock;

// Failures are ignored: there is nowhere to report them.
void put(const std::string& text) {
  (void)std::fflush(
      stdout);  // else results and messages in one terminal or file are mixed in a line
  (void)std::fwrite(text.data(), 1, text.size(), stderr);
}

bool shows_colours() {
  static const bool shown = std::getenv("NO_COLOR") == nullptr && isatty(STDERR_FILENO) == 1;
  return shown;
}

// A message, in colours on a terminal.
void put_message_text(const std::string& text) {
  put(shows_colours() ? in_colours(text) : text);
}

class ConsoleProgress : public Console {
 public:
  explicit ConsoleProgress(ProgressStyle style) : style_(style), color_(shows_colours()) {}

  ~ConsoleProgress() override { ConsoleProgress::end(); }

  void begin(std::string_view what, std::uint64_t total) override {
    const std::lock_guard lock(mutex_);
    what_ = what;
    total_ = total;
    done_ = 0;
    tenth_ = 0;
    active_ = true;
    start_ = last_ = Clock::now();
    if (style_ != ProgressStyle::bar) show();
  }

  void advance(std::uint64_t steps) override {
    const std::lock_guard lock(mutex_);
    done_ += steps;
    if (!active_) return;
    if (style_ == ProgressStyle::bar) {
      const auto now = Clock::now();
      if (now - start_ < std::chrono::milliseconds(500)) return;
      if (now - last_ < std::chrono::milliseconds(100)) return;
      last_ = now;
      show();
      return;
    }
    const std::uint64_t tenth = total_ > 0 ? done_ * 10 / total_ : 0;
    if (tenth > tenth_) {
      tenth_ = tenth;
      show();
    }
  }

  void end() override {
    const std::lock_guard lock(mutex_);
    clear();
    active_ = false;
  }

  void write(const std::string& text) override {
    const std::lock_guard lock(mutex_);
    clear();
    put_message_text(text);
  }

 private:
  void clear() {
    if (drawn_) put("\r\033[K");
    drawn_ = false;
  }

  void show() {
    if (style_ == ProgressStyle::json) {
      const nlohmann::ordered_json line = {
          {"progress", {{"what", what_}, {"done", done_}, {"total", total_}}}};
      put(json_text(line) + "\n");
    } else if (style_ == ProgressStyle::plain) {
      put(fmt::format("{}: {}\n", what_, amount()));
    } else {
      constexpr std::uint64_t kWidth = 30;
      const std::uint64_t filled =
          total_ > 0 ? std::min(kWidth, done_ * kWidth / total_) : std::uint64_t{0};
      put(fmt::format("\r\033[K{} {}{:#<{}}{}{:.<{}} {}", what_, color_ ? "\033[32m" : "", "",
                      filled, color_ ? "\033[0m" : "", "", kWidth - filled, amount() + left()));
      drawn_ = true;
    }
    std::fflush(stderr);
  }

  // The time that is left at the speed so far.
  std::string left() const {
    const double spent = std::chrono::duration<double>(Clock::now() - start_).count();
    if (done_ == 0 || done_ >= total_ || spent < 1) return {};
    const double seconds = spent * static_cast<double>(total_ - done_) / static_cast<double>(done_);
    return ", " + time_left(seconds);
  }

  std::string amount() const {
    if (total_ == 0) return fmt::format("{}", done_);
    return fmt::format("{}/{} ({} %)", done_, total_, done_ * 100 / total_);
  }

  const ProgressStyle style_;
  const bool color_;
  std::mutex mutex_;
  std::string what_;
  std::uint64_t total_ = 0, done_ = 0, tenth_ = 0;
  bool active_ = false, drawn_ = false;
  Clock::time_point start_, last_;
};

}  // namespace

void Console::write(const std::string& text) {
  put_message_text(text);
}

std::string in_colours(const std::string& text) {
  constexpr std::string_view kRed = "\033[1;31m", kYellow = "\033[1;33m", kCyan = "\033[36m";
  constexpr std::string_view kFaint = "\033[2m", kOff = "\033[0m";
  std::string result;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string line = text.substr(begin, end - begin);
    if (line.starts_with("  hint: ")) {
      line = fmt::format("  {}hint:{}{}", kCyan, kOff, line.substr(7));
    } else {
      std::size_t place = std::string::npos;
      std::string_view found, colour;
      for (const auto& [word, its_colour] :
           {std::pair<std::string_view, std::string_view>{"error: ", kRed},
            {"warning: ", kYellow},
            {"note: ", kCyan}}) {
        const std::size_t at = line.starts_with(word) ? 0 : line.find(fmt::format(": {}", word));
        if (at >= place) continue;
        place = at == 0 ? 0 : at + 2;
        found = word;
        colour = its_colour;
      }
      const std::size_t code = line.ends_with(']') ? line.rfind(" [") : std::string::npos;
      if (place != std::string::npos && code != std::string::npos && code > place) {
        line.insert(line.size(), kOff);
        line.insert(code, kFaint);
      }
      if (place != std::string::npos) {
        line.insert(place + found.size() - 1, kOff);
        line.insert(place, colour);
      }
    }
    result += line;
    if (end < text.size()) result += '\n';
    begin = end + 1;
  }
  return result;
}

std::string time_left(double seconds) {
  const auto whole = std::llround(std::clamp(seconds, 0.0, 360000.0));
  if (whole < 60) return fmt::format("{} s left", whole);
  if (whole < 3600) return fmt::format("{}:{:02} min left", whole / 60, whole % 60);
  return fmt::format("{}:{:02} h left", whole / 3600, whole / 60 % 60);
}

void write_message(Console* console, const std::string& text) {
  if (console != nullptr) {
    console->write(text);
  } else {
    put_message_text(text);
  }
}

std::unique_ptr<Console> console_progress(ProgressStyle style) {
  if (style == ProgressStyle::automatic) {
    style = isatty(STDERR_FILENO) == 1 ? ProgressStyle::bar : ProgressStyle::none;
  }
  if (style == ProgressStyle::none) return std::make_unique<Console>();
  return std::make_unique<ConsoleProgress>(style);
}

namespace {

// Max number of files whose messages of one code are printed.
constexpr std::size_t kShown = 3;

}  // namespace

bool AlikeMessages::is_shown(const std::string& code, const std::string& file) {
  if (code.empty()) return true;
  Said& said = by_code_[code];
  if (said.last != file) ++said.files;
  said.last = file;
  return said.files <= kShown;
}

std::string AlikeMessages::more() const {
  std::string text;
  for (const auto& [code, said] : by_code_) {
    if (said.files <= kShown) continue;
    const std::size_t more = said.files - kShown;
    text += fmt::format("  {} more {} such messages; -v and --json have all [{}]\n", more,
                        more == 1 ? "file has" : "files have", code);
  }
  return text;
}

}  // namespace krok::cli
