#include "tools/krok-import/clips.h"

#include <fmt/format.h>

#include <filesystem>

#include "capture/unique_names.h"
#include "core/numbers.h"
#include "core/text.h"
#include "tools/cli/file_name.h"

namespace krok::cli::import {

namespace {

constexpr std::string_view kPlace = "{clip}";
constexpr std::size_t kMaxListed = 20;

std::string name_of(const nodes::Scene& scene, std::size_t index) {
  const std::string& name = scene.animations[index].name;
  return name.empty() ? fmt::format("animation {}", index) : to_utf8(name);
}

std::vector<ChosenClip> all_clips(const nodes::Scene& scene) {
  std::vector<ChosenClip> clips;
  UniqueNames names;
  for (std::size_t i = 0; i < scene.animations.size(); ++i) {
    const std::string name = name_of(scene, i);
    clips.push_back({static_cast<int>(i), name, names.make(file_name_of(name))});
  }
  return clips;
}

std::string list_of(const std::vector<ChosenClip>& clips) {
  std::string list;
  for (std::size_t i = 0; i < clips.size() && i < kMaxListed; ++i) {
    list += fmt::format("{}{} ({})", i == 0 ? "" : ", ", i, shown(clips[i].name));
  }
  return list + (clips.size() > kMaxListed ? ", ..." : "");
}

}  // namespace

Result<std::vector<ChosenClip>> choose_clips(const nodes::Scene& scene, const std::string& wanted,
                                             const std::string& file, ToolContext& context) {
  std::vector<ChosenClip> clips = all_clips(scene);
  if (clips.empty() && (wanted.empty() || wanted == "all")) return clips;
  if (clips.empty()) {
    return Error("import-missing",
                 fmt::format("the file has no animations: --clip {} cannot be used", shown(wanted)))
        .in_file(file);
  }
  for (const ChosenClip& clip : clips) {
    if (clip.name == wanted) return std::vector{clip};
  }
  if (wanted == "all") return clips;
  if (!wanted.empty()) {
    const auto number = parse_integer(wanted);
    if (number && *number >= 0 && *number < static_cast<long long>(clips.size())) {
      return std::vector{clips[static_cast<std::size_t>(*number)]};
    }
    return Error("import-clip", fmt::format("there is no animation {}", shown(wanted)),
                 "available: " + list_of(clips))
        .in_file(file);
  }
  if (clips.size() > 1) {
    Diagnostic diagnostic =
        make_warning("import-clips",
                     fmt::format("using the first of {} animations, {}; available: {}",
                                 clips.size(), shown(clips[0].name), list_of(clips)),
                     "select another with --clip NAME or NUMBER, or all with --clip all");
    diagnostic.where.file = file;
    context.diagnose(std::move(diagnostic));
  }
  clips.resize(1);
  return clips;
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
