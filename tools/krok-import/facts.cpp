#include "tools/krok-import/facts.h"

#include <fmt/format.h>

#include <filesystem>

#include "capture/unique_names.h"
#include "core/file.h"
#include "core/numbers.h"
#include "core/text.h"
#include "tools/cli/paths.h"
#include "tools/cli/report.h"
#include "tools/shared/role_report.h"

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

// Members are added one by one here and below: an initializer list is five times slower, which is
// noticeable for many small files.
Json to_json(const Choice& choice) {
  Json json = object_for(3);
  json["choice"] = choice.choice;
  json["confidence"] = confidence_name(choice.confidence);
  json["reason"] = choice.reason;
  return json;
}

Json facts_of(const FrameSource& motion, const RoleMap& roles) {
  Json facts = object_for(5);
  facts["joints"] = motion.joint_count();
  facts["frames"] = motion.frame_count;
  facts["rate"] = motion.rate;
  facts["duration"] = motion.duration();
  facts["stature"] = stature_json(stature_of(motion.skeleton, roles));
  return facts;
}

Json facts_of(const Conventions& c) {
  Json facts = object_for(4);
  Json& unit = facts["unit"] = object_for(4);
  unit["name"] = c.unit.name;
  unit["metres"] = c.unit.metres;
  unit["confidence"] = confidence_name(c.unit_confidence);
  unit["reason"] = c.unit_reason;
  facts["up"] = to_json({std::string(direction_name(c.up)), c.up_reason, c.up_confidence});
  facts["forward"] =
      to_json({std::string(direction_name(c.forward)), c.forward_reason, c.forward_confidence});
  Json& axes = facts["reference_axes"] = object_for(2);
  axes["up"] = direction_name(c.reference_up);
  axes["forward"] = direction_name(c.reference_forward);
  return facts;
}

// What only some formats know.
Json facts_of(const io::CaptureDetails& details) {
  Json facts = object_for(4);
  if (details.positions) facts["positions"] = to_json(*details.positions);
  if (details.exporter) facts["exporter"] = to_json(*details.exporter);
  if (details.frames_announced) facts["frames_announced"] = *details.frames_announced;
  if (details.first_frame_number) facts["first_frame_number"] = *details.first_frame_number;
  if (details.rest_frame) {
    facts["rest_frame"] = {{"found", details.rest_frame->found},
                           {"left_out", details.rest_frame->left_out}};
  }
  return facts;
}

Json result_of(const io::OpenedCapture& opened, const FrameSource& motion) {
  const Capture& capture = *opened.capture;
  Json result = object_for(32);
  const auto add = [&](Json facts) {
    for (auto& [name, fact] : facts.get_ref<Json::object_t&>()) result[name] = std::move(fact);
  };
  add(facts_of(motion, capture.roles));
  add(roles_json(motion.skeleton, capture.roles));
  add(facts_of(capture.conventions));
  result["source_rate"] = to_json(capture.rate);
  add(facts_of(opened.details));
  result["repairs"] = capture.repairs;
  return result;
}

void log_roles(const Skeleton& skeleton, const RoleMap& roles, ToolContext& context) {
  if (!context.verbose) return;
  std::string text;
  for (const RoleRow& row : role_rows(skeleton, roles)) {
    text += fmt::format("{}  {:<13}  {}", text.empty() ? "" : "\n", row.label, printable(row.text));
  }
  context.log(text);
}

std::string line_about(const std::string& input, const FrameSource& motion, const RoleMap& roles) {
  const std::string name = input == "-" ? "standard input" : base_name(input);
  const auto stature = stature_of(motion.skeleton, roles);
  const double size = stature ? stature->metres : reference_extent(motion.skeleton);
  return fmt::format("{}: {}, {} at {} fps ({} s), {} {} m", name,
                     counted(motion.joint_count(), "joint"), counted(motion.frame_count, "frame"),
                     readable(motion.rate), readable(motion.duration(), 4),
                     stature ? "stature" : "size", readable(size, 3));
}

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
