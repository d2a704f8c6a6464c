#include "tools/cli/folder_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/file.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/io/formats.h"

namespace krok::cli {

namespace {

// A capture and the .anim of its name beside it, which was made of it, are one take.
Diagnostics keep_one_of_each_take(const std::string& folder, std::vector<std::string>& paths) {
  const auto kind_of = [](const std::string& path) { return registry::kind_of_name(path); };
  const auto without_ending = [](const std::string& path) {
    return path.substr(0, path.size() - extension(path).size());
  };
  std::set<std::string> motions;
  for (const std::string& path : paths) {
    if (kind_of(path) == registry::Kind::anim) motions.insert(without_ending(path));
  }
  std::string first;
  const auto count = std::erase_if(paths, [&](const std::string& path) {
    if (kind_of(path) == registry::Kind::anim || !motions.contains(without_ending(path))) {
      return false;
    }
    if (first.empty()) first = base_name(path);
    return true;
  });
  if (count == 0) return {};
  Diagnostic twice = make_warning(
      "folder-twice",
      fmt::format("{} left out as the .anim file of the same name beside it is read: {}{}",
                  counted(static_cast<long long>(count), "capture"), shown(first),
                  count > 1 ? ", ..." : ""),
      "name the files to read both");
  twice.where.file = folder;
  return {std::move(twice)};
}

}  // namespace

Diagnostics keep_inputs(const std::string& folder, const std::vector<std::string>& endings,
                        std::vector<std::string>& paths) {
  const std::size_t all = paths.size();
  std::map<std::string, std::size_t> others;  // by ending
  const io::Format* first_motion = nullptr;
  std::erase_if(paths, [&](const std::string& path) {
    const std::string ending = extension(path);
    if (std::ranges::find(endings, ending) != endings.end()) return false;
    const io::Format& format = io::format_of(registry::kind_of_name(path));
    if (format.kind == registry::Kind::unknown || format.companion) return true;
    ++others[ending];
    if (first_motion == nullptr && format.reads_motion()) first_motion = &format;
    return true;
  });
  // Where each file is a motion; a list of files or a page has all of them.
  Diagnostics notes;
  if (endings == io::motion_endings()) notes = keep_one_of_each_take(folder, paths);
  if (others.empty()) return notes;
  std::string counts;
  std::size_t count = 0;
  for (const auto& [ending, number] : others) {
    counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", number, ending);
    count += number;
  }
  Diagnostic left_out = make_warning(
      "folder-left-out", fmt::format("{} of {} files are left out: {}", count, all, counts));
  if (first_motion != nullptr) {
    left_out.hint = registry::advice(first_motion->kind, registry::Kind::anim);
  } else {
    left_out.severity = Severity::note;
  }
  left_out.where.file = folder;
  notes.push_back(std::move(left_out));
  return notes;
}

}  // namespace krok::cli
