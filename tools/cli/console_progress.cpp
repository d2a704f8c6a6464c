#include "tools/cli/console_progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <mutex>

#include "core/json_internal.h"

namespace krok::cli {

namespace {

using Clock = std::chrono::steady_clock;

// Failures are ignored: there is nowhere to report them.
void put(const std::string& text) {
  (void)std::fwrite(text.data(), 1, text.size(), stderr);
}

class ConsoleProgress : public Console {
 public:
  explicit ConsoleProgress(ProgressStyle style)
      : style_(style), color_(std::getenv("NO_COLOR") == nullptr && isatty(STDERR_FILENO) == 1) {}

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
    put(text);
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
                      filled, color_ ? "\033[0m" : "", "", kWidth - filled, amount()));
      drawn_ = true;
    }
    std::fflush(stderr);
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
  put(text);
}

void write_message(Console* console, const std::string& text) {
  if (console != nullptr) {
    console->write(text);
  } else {
    put(text);
  }
}

std::unique_ptr<Console> console_progress(ProgressStyle style) {
  if (style == ProgressStyle::automatic) {
    style = isatty(STDERR_FILENO) == 1 ? ProgressStyle::bar : ProgressStyle::none;
  }
  if (style == ProgressStyle::none) return std::make_unique<Console>();
  return std::make_unique<ConsoleProgress>(style);
}

}  // namespace krok::cli
