#include "tools/krok-retarget/takes.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/glob.h"
#include "core/text.h"
#include "formats/io/formats.h"
#include "formats/io/open_motion.h"
#include "retarget/stance.h"
#include "retarget/take_pool.h"
#include "tools/cli/folder_inputs.h"

namespace krok::cli::retarget {

namespace {

// All files, each once.
Result<std::vector<std::string>> files_of(const std::vector<std::string>& takes,
                                          ToolContext& context) {
  std::vector<std::string> files;
  for (const std::string& given : takes) {
    std::error_code ignored;
    const bool is_folder = std::filesystem::is_directory(given, ignored);
    const bool is_pattern = has_wildcards(given) && !std::filesystem::exists(given, ignored);
    Result<std::vector<std::string>> found = std::vector{given};
    if (is_folder) found = find_files_below(given);
    if (is_pattern) found = find_files(given);
    if (!found) return found.error();
    if (is_folder) context.diagnose(keep_inputs(given, io::motion_endings(), *found));
    if (found->empty()) {
      return Error("usage", fmt::format("--takes: no {} there", is_folder ? "motion" : "file"))
          .in_file(given);
    }
    files.insert(files.end(), found->begin(), found->end());
  }
  std::ranges::sort(files);
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

}  // namespace

Result<std::vector<Transform>> pose_of_takes(const std::vector<std::string>& takes,
                                             const Clip& source, const RoleMap& roles,
                                             ToolContext& context) {
  const std::vector<Transform>& reference = source.skeleton.reference;
  if (!roles.humanoid || krok::retarget::stands({source.skeleton, roles, reference})) {
    return std::vector<Transform>();
  }
  const auto files = files_of(takes, context);
  if (!files) return files.error();
  krok::retarget::TakePool pool(1 + files->size(), roles);
  pool.add(source);
  std::string stranger, difference;
  std::size_t left_out = 0;
  for (const std::string& path : *files) {
    const auto take = io::open_motion(path, context);
    if (!take) return take.error();
    const std::string other = difference_in_structure(source.skeleton, take->skeleton);
    if (other.empty()) {
      pool.add(*take);
    } else if (++left_out == 1) {
      stranger = path;
      difference = other;
    }
  }
  if (left_out > 0) {
    context.warn("retarget-takes",
                 fmt::format("{} of {} takes have another skeleton and are left out, first {}: {}",
                             left_out, files->size(), shown(stranger), difference));
  }
  auto stance = krok::retarget::find_stance(pool.clip(), roles, std::nullopt);
  if (!stance) return stance.error();
  return std::move(stance->pose);
}

}  // namespace krok::cli::retarget
