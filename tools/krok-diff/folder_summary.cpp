// Reports on two folders: text and JSON.

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/numbers.h"
#include "core/text.h"
#include "tools/krok-diff/compare_files.h"
#include "tools/krok-diff/folders.h"

namespace krok::cli::diff {

namespace {

constexpr std::array kStatuses = {FileStatus::same,          FileStatus::differs,
                                  FileStatus::only_in_first, FileStatus::only_in_second,
                                  FileStatus::unreadable,    FileStatus::not_compared};
// [FileStatus]
constexpr std::array kKeys = {"same",           "differs",    "only_in_first",
                              "only_in_second", "unreadable", "not_compared"};

const char* status_key(FileStatus status) {
  return kKeys[static_cast<std::size_t>(status)];
}

std::string safe(const std::string& text) {
  return printable(to_utf8(text));
}

}  // namespace

std::string title_of(const Options& options) {
  return fmt::format("{} against {}", safe(options.first), safe(options.second));
}

std::vector<std::pair<std::string, std::size_t>> counts_of(const FolderOutcome& outcome,
                                                           const Options& options) {
  std::vector<std::pair<std::string, std::size_t>> counts;
  for (const FileStatus status : kStatuses) {
    const std::size_t count = outcome.count(status);
    if (count > 0 || status == FileStatus::same) {
      counts.emplace_back(status_words(status, options), count);
    }
  }
  return counts;
}

std::string status_words(FileStatus status, const Options& options) {
  if (status == FileStatus::only_in_first) return "only in " + safe(options.first);
  if (status == FileStatus::only_in_second) return "only in " + safe(options.second);
  constexpr std::array kWords = {"the same", "differs", "", "", "cannot be read", "not compared"};
  return kWords[static_cast<std::size_t>(status)];
}

std::string to_text(const FolderOutcome& outcome, const Options& options, bool all) {
  std::string text;
  for (const FileResult& file : outcome.files) {
    const bool listed = file.status != FileStatus::same && file.status != FileStatus::not_compared;
    if (!listed && !all) continue;
    text += fmt::format("{}: {}{}{}\n", status_words(file.status, options), safe(file.path),
                        file.what.empty() ? "" : ": ", safe(file.what));
  }
  for (const std::string& note : outcome.notes) text += "note: " + safe(note) + "\n";
  const auto counts = counts_of(outcome, options);
  std::size_t width = 0;
  for (const auto& [words, count] : counts) width = std::max(width, words.size());
  text += fmt::format("{}: {}\n", title_of(options), counted(outcome.files.size(), "file"));
  for (const auto& [words, count] : counts) {
    text += fmt::format("  {:<{}}  {:>5}\n", words, width, count);
  }
  return text;
}

Json to_json(const FolderOutcome& outcome, const Options& options) {
  Json json;
  json["kind"] = "folders";
  json["same"] = outcome.count(FileStatus::same) == outcome.files.size();
  json["first"] = options.first;
  json["second"] = options.second;
  json["tolerance"] = to_json(options.tolerance);
  Json& counts = json["counts"];
  for (const FileStatus status : kStatuses) counts[status_key(status)] = outcome.count(status);
  json["notes"] = outcome.notes;
  json["files"] = Json::array();
  for (const FileResult& file : outcome.files) {
    Json entry;
    entry["path"] = file.path;
    entry["status"] = status_key(file.status);
    if (!file.what.empty()) entry["what"] = file.what;
    if (!file.outcome.is_null()) entry["difference"] = file.outcome;
    json["files"].push_back(std::move(entry));
  }
  return json;
}

}  // namespace krok::cli::diff
