#include "tools/krok-import/clips.h"

#include <fmt/format.h>

#include <filesystem>

#include "capture/unique_names.h"
#include "core/text.h"
#include "tools/cli/file_name.h"

namespace krok::cli::import {

namespace {

constexpr std::string_view kPlace = "{clip}";

std::vector<ChosenClip> all_clips(const nodes::Scene& scene) {
  std::vector<ChosenClip> clips;
  UniqueNames names;
  for (std::size_t i = 0; i < scene.animations.size(); ++i) {
    const std::string name = animation_name(scene, i);
    clips.push_back({static_cast<int>(i), name, names.make(file_name_of(name)), "as given"});
  }
  return clips;
}

}  // namespace

Result<std::vector<ChosenClip>> choose_clips(const nodes::Scene& scene, const std::string& wanted,
                                             const nodes::ChosenAnimation& best,
                                             const std::string& file, ToolContext& context) {
  std::vector<ChosenClip> clips = all_clips(scene);
  if (clips.empty() && (wanted.empty() || wanted == "all")) return clips;
  if (clips.empty()) {
    return Error("import-missing",
                 fmt::format("the file has no animations: --clip {} cannot be used", shown(wanted)))
        .in_file(file);
  }
  if (!wanted.empty()) {
    const auto found = find_animation(scene, wanted, file);
    if (found) return std::vector{clips[static_cast<std::size_t>(*found)]};
    if (wanted == "all") return clips;
    return found.error();
  }
  context.diagnose(
      describe_choice(scene, best, "import-clips",
                      "select another with --clip NAME or NUMBER, or all with --clip all", file));
  ChosenClip chosen = std::move(clips[static_cast<std::size_t>(best.animation)]);
  chosen.why = best.why;
  return std::vector{std::move(chosen)};
}

Result<std::string> clip_path(const std::string& pattern, const std::string& option,
                              const ChosenClip& clip, bool several, const std::string& extension) {
  if (pattern.empty() || pattern == "-") {
    if (several && pattern == "-") {
      return Error("usage",
                   fmt::format("{} -: several clips cannot go to standard output", option));
    }
    return pattern;
  }
  std::string path = pattern;
  std::error_code ignored;
  if (path.ends_with('/') || std::filesystem::is_directory(path, ignored)) {
    path += std::string(path.ends_with('/') ? "" : "/") + std::string(kPlace) + extension;
  }
  const std::size_t base = path.rfind('/') == std::string::npos ? 0 : path.rfind('/') + 1;
  const std::size_t place = path.find(kPlace, base);
  if (place == std::string::npos) {
    if (!several) return path;
    return Error(
        "usage", fmt::format("{} {}: several clips need distinct names", option, pattern),
        fmt::format("use {{clip}} for the clip's name: {} 'walk_{{clip}}{}'", option, extension));
  }
  return path.replace(place, kPlace.size(), clip.file_name);
}

}  // namespace krok::cli::import
