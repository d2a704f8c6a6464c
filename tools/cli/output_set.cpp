#include "tools/cli/output_set.h"

#include <fmt/format.h>
#include <algorithm>
#include <atomic>
#include <filesystem>
#include <iterator>
#include <optional>

#include "core/parallel.h"
#include "tools/cli/paths.h"

namespace krok::cli {

namespace {

// Nothing if write() returns false.
Result<std::optional<OutputFile>> written(const std::string& path, OutputFile::Options options,
                                          const std::function<Result<bool>(OutputFile&)>& write) {
  auto file = OutputFile::create(path, options);
  if (!file) return file.error();
  auto wanted = write(*file);
  if (!wanted) return std::move(wanted).error().in_file(path);
  if (!*wanted) return std::optional<OutputFile>();
  if (Status status = file->seal(); !status) return status.error();
  return std::optional<OutputFile>(std::move(*file));
}

}  // namespace

Status OutputSet::add(const std::string& path, const std::function<Status(OutputFile&)>& write) {
  if (path.empty()) return {};
  return add_all({path}, 1, [&](std::size_t, OutputFile& file) { return write(file); });
}

Status OutputSet::add(const std::string& path, std::string_view text) {
  return add(path, std::as_bytes(std::span(text)));
}

Status OutputSet::add(const std::string& path, std::span<const std::byte> bytes) {
  return add(path, [&](OutputFile& file) { return file.write(bytes); });
}

Status OutputSet::add_all(const std::vector<std::string>& paths, int jobs,
                          const std::function<Status(std::size_t, OutputFile&)>& write) {
  return add_some(paths, jobs, [&](std::size_t i, OutputFile& file) -> Result<bool> {
    if (Status status = write(i, file); !status) return std::move(status).error();
    return true;
  });
}

Status OutputSet::add_some(const std::vector<std::string>& paths, int jobs,
                           const std::function<Result<bool>(std::size_t, OutputFile&)>& write) {
  for (const std::string& path : paths) {
    if (Status status = context_.check_output(path); !status) return status;
    const std::string place = place_of(path);
    if (!place.empty() && !places_.insert(place).second) return twice_error(path);
  }
  std::vector<std::optional<Result<std::optional<OutputFile>>>> made(paths.size());
  std::atomic<bool> failed = false;
  parallel_for(paths.size(), 1, jobs, [&](std::size_t i, std::size_t) {
    if (failed) return;
    made[i] = written(paths[i], context_.output_options(),
                      [&](OutputFile& file) { return write(i, file); });
    if (!*made[i]) failed = true;
  });
  // Files are started in order, so the first failing file is always among those started.
  for (std::size_t i = 0; i < made.size(); ++i) {
    if (made[i] && !*made[i]) return made[i]->error();
  }
  for (std::size_t i = 0; i < made.size(); ++i) {
    if (!**made[i]) continue;
    files_.push_back(std::move(***made[i]));
    paths_.push_back(paths[i]);
  }
  return {};
}

Status OutputSet::finish() {
  const bool foreseen = std::all_of(paths_.begin(), paths_.end(), [&](const std::string& path) {
    return context_.is_destination(path);
  });
  if (context_.one_of_many != nullptr && !foreseen) {
    std::move(files_.begin(), files_.end(), std::back_inserter(context_.one_of_many->held_files));
    auto& held_paths = context_.one_of_many->held_paths;
    held_paths.insert(held_paths.end(), paths_.begin(), paths_.end());
  } else if (context_.one_of_many == nullptr && !context_.report_path.empty()) {
    std::move(files_.begin(), files_.end(), std::back_inserter(context_.files_with_report));
  } else if (Status status = OutputFile::place_all(files_); !status) {
    return status;
  }
  files_.clear();
  for (const std::string& path : paths_) context_.wrote(path);
  return {};
}

std::string OutputSet::names() const {
  std::string names;
  for (const std::string& path : paths_) names += (names.empty() ? "" : ", ") + path;
  return names;
}

namespace fs = std::filesystem;

NewFolders::~NewFolders() {
  std::error_code ignored;
  // Only empty folders are removed.
  for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) fs::remove(*folder, ignored);
}

Status NewFolders::make(const std::string& folder) {
  std::error_code trouble;
  std::vector<fs::path> missing;
  for (fs::path path = folder; !path.empty() && !fs::exists(path, trouble);
       path = path.parent_path()) {
    missing.push_back(path);
  }
  trouble.clear();
  for (auto path = missing.rbegin(); path != missing.rend() && !trouble; ++path) {
    if (fs::create_directory(*path, trouble)) made_.push_back(path->string());
  }
  if (!trouble && fs::is_directory(folder, trouble)) return {};
  return Error("file-unwritable", fmt::format("cannot create folder: {}",
                                              trouble ? trouble.message() : "a file has this name"))
      .in_file(folder);
}

}  // namespace krok::cli
