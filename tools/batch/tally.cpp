#include "tools/batch/tally.h"

#include <fmt/format.h>

#include <numeric>

#include "core/numbers.h"

namespace krok::cli::batch {

namespace {

// Max number of failed files that are named.
constexpr std::size_t kNamed = 10;

}  // namespace

const char* name_of(FileState state) {
  constexpr std::array kNames = {"done", "unchanged", "left out", "failed"};  // [FileState]
  return kNames[static_cast<std::size_t>(state)];
}

void BatchTally::add(FileState state, const std::string& name, bool warned) {
  if (state == FileState::done && warned) ++warned_;
  ++counts_[static_cast<std::size_t>(state)];
  if (state == FileState::failed && failed_.size() < kNamed) failed_.push_back(name);
}

std::size_t BatchTally::left() const {
  return files_ - std::accumulate(counts_.begin(), counts_.end(), std::size_t{0});
}

Json BatchTally::result() const {
  Json json;
  json["files"] = files_;
  json["done"] = count(FileState::done);
  json["with_warnings"] = warned_;
  json["unchanged"] = count(FileState::unchanged);
  if (count(FileState::left_out) > 0) json["left_out"] = count(FileState::left_out);
  json["failed"] = failed();
  json["left"] = left();
  return json;
}

std::string BatchTally::summary(const std::string& of_what) const {
  std::string text = counted(files_, "file") + of_what;
  const auto add = [&](std::size_t number, const char* what) {
    if (number > 0) text += fmt::format(", {} {}", number, what);
  };
  add(count(FileState::done), "done");
  add(count(FileState::unchanged), "unchanged");
  add(count(FileState::left_out), "left out");
  add(failed(), "failed");
  add(left(), "left");
  if (warned_ > 0) text += fmt::format("; {} with warnings", warned_);
  return text;
}

Error BatchTally::failure(bool kept_going) const {
  std::string names;
  for (const std::string& name : failed_) names += (names.empty() ? "" : ", ") + name;
  if (!kept_going) {
    return Error("batch-stopped",
                 fmt::format("stopped at {}, the first file that failed; {} left", names, left()),
                 "use --keep-going to process the others; finished files are not processed again");
  }
  const std::size_t more = failed() - failed_.size();
  if (more > 0) names += fmt::format(" and {} more", more);
  return Error("batch-failed", fmt::format("{} failed: {}", counted(failed(), "file"), names));
}

}  // namespace krok::cli::batch
