#include "tools/krok-import/facts.h"

#include <fmt/format.h>

#include "core/file.h"
#include "core/numbers.h"
#include "core/text.h"
#include "tools/cli/json_object.h"
#include "tools/shared/role_report.h"

namespace krok::cli::import {

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

}  // namespace krok::cli::import
