#include "tools/cli/folder_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/text.h"
#include "formats/io/formats.h"

namespace krok::cli {

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
  if (others.empty()) return {};
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
  return {std::move(left_out)};
}

}  // namespace krok::cli
