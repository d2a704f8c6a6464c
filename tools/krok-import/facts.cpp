#include "tools/krok-import/facts.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/file.h"
#include "core/numbers.h"
#include "tools/common/printable.h"
#include "tools/common/role_report.h"

namespace krok::import {

double height_of(const FrameSource& motion) {
  const auto extent = [](const auto& positions) {
    auto low = positions.front().y();
    auto high = low;
    for (const auto& position : positions) {
      low = std::min(low, position.y());
      high = std::max(high, position.y());
    }
    return static_cast<double>(high - low);
  };
  const int frames = motion.frame_count;
  if (frames == 0) {
    std::vector<Vec3> positions;
    for (const Transform& joint : motion.skeleton.reference) positions.push_back(joint.position);
    return extent(positions);
  }
  const auto joints = static_cast<std::size_t>(motion.joint_count());
  std::vector<Vec3f> positions(joints);
  std::vector<Quatf> orientations(joints);
  std::vector<double> heights;
  const int step = std::max(1, frames / 100);
  for (int frame = 0; frame < frames; frame += step) {
    if (motion.read(frame, 1, positions, orientations)) heights.push_back(extent(positions));
  }
  if (heights.empty()) return 0;
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  return *middle;
}

Json to_json(const Choice& choice) {
  return {{"choice", choice.choice},
          {"confidence", confidence_name(choice.confidence)},
          {"reason", choice.reason}};
}

Json facts_of(const Clip& clip) {
  return facts_of(frames_of(clip));
}

Json facts_of(const FrameSource& motion) {
  Json facts;
  facts["joints"] = motion.joint_count();
  facts["frames"] = motion.frame_count;
  facts["rate"] = motion.rate;
  facts["duration"] = motion.duration();
  facts["height"] = height_of(motion);
  return facts;
}

Json facts_of(const Conventions& c) {
  Json facts;
  facts["unit"] = {{"name", c.unit.name},
                   {"metres", c.unit.metres},
                   {"confidence", confidence_name(c.unit_confidence)},
                   {"reason", c.unit_reason}};
  facts["up"] = to_json({std::string(direction_name(c.up)), c.up_reason, c.up_confidence});
  facts["forward"] =
      to_json({std::string(direction_name(c.forward)), c.forward_reason, c.forward_confidence});
  facts["reference_axes"] = {{"up", direction_name(c.reference_up)},
                             {"forward", direction_name(c.reference_forward)}};
  return facts;
}

Json result_of(const Capture& capture, const FrameSource& motion, const Json& details) {
  Json result = facts_of(motion);
  result.update(roles_json(motion.skeleton, capture.roles));
  result.update(facts_of(capture.conventions));
  result["source_rate"] = to_json(capture.rate);
  result.update(details);
  result["repairs"] = capture.repairs;
  return result;
}

void say_roles(const Skeleton& skeleton, const RoleMap& roles, ToolContext& context) {
  if (!context.verbose) return;
  std::string text;
  for (const RoleRow& row : role_rows(skeleton, roles)) {
    text += fmt::format("{}  {:<13}  {}", text.empty() ? "" : "\n", row.label, printable(row.text));
  }
  context.say(text);
}

std::string line_about(const std::string& input, const Clip& clip) {
  return line_about(input, frames_of(clip));
}

std::string line_about(const std::string& input, const FrameSource& motion) {
  const std::string name = input == "-" ? "standard input" : base_name(input);
  return fmt::format("{}: {}, {} at {} /s ({} s), height {} m", name,
                     counted(motion.joint_count(), "joint"), counted(motion.frame_count, "frame"),
                     readable(motion.rate), readable(motion.duration(), 2),
                     readable(height_of(motion), 3));
}

}  // namespace krok::import
