#include <fmt/format.h>

#include "core/numbers.h"
#include "describe.h"
#include "formats/bvh/bvh_reader.h"

namespace krok::info {

namespace {

void add_choice(const std::string& key, const std::string& choice, Confidence confidence,
                const std::string& reason, Description& out) {
  const std::string why = reason.empty() ? std::string() : ": " + reason;
  out.add(key, fmt::format("{} ({}{})", choice, confidence_name(confidence), why));
  out.json[key] = {
      {"choice", choice}, {"confidence", confidence_name(confidence)}, {"reason", reason}};
}

}  // namespace

Result<Description> describe_bvh(const InputFile& file, ToolContext& context) {
  bvh::ReadOptions options;
  options.jobs = context.jobs;
  options.progress = context.progress;
  const auto capture = bvh::read(file.text(), file.path(), options);
  if (!capture) return capture.error();
  context.tell(capture->diagnostics);
  const Clip& clip = capture->clip;
  const Conventions& conventions = capture->conventions;
  Description out;
  out.what = "a capture (BVH), as krok-import takes it";
  out.json["kind"] = "bvh";
  add_timing(clip.frame_count(), clip.rate, out);
  out.json["frames_announced"] = capture->frames_announced;
  out.json["frame_time"] = capture->frame_time;
  add_skeleton(clip.skeleton, context.verbose, out);
  std::vector<Vec3> positions;
  for (const Transform& joint : clip.skeleton.reference) positions.push_back(joint.position);
  add_size<Vec3>(positions, "joints with all rotations 0", out);

  const Unit& unit = conventions.unit;
  add_choice(
      "unit",
      unit.name == "m" ? unit.name : fmt::format("{}, {} m", unit.name, readable(unit.metres)),
      conventions.unit_confidence, conventions.unit_reason, out);
  out.json["unit"]["metres"] = unit.metres;
  add_choice("up", std::string(direction_name(conventions.up)), conventions.up_confidence,
             conventions.up_reason, out);
  add_choice("forward", std::string(direction_name(conventions.forward)),
             conventions.forward_confidence, conventions.forward_reason, out);
  add_choice("positions", capture->positions.choice, capture->positions.confidence,
             capture->positions.reason, out);
  out.json["rest_frame"] = capture->rest_frame_found;
  if (capture->rest_frame_found) out.add("rest pose", "frame 0, no part of the motion");
  return out;
}

}  // namespace krok::info
