#include "tools/krok-body/options.h"

#include <fmt/format.h>

#include <memory>

#include "core/text.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::body {

namespace {

Result<Pose> parse_pose(const std::string& text) {
  if (text == "auto") return Pose{};
  if (text == "reference") return Pose{.kind = BodyPose::reference};
  const auto frame = whole(0, 2'000'000'000).read(text);
  if (frame) return Pose{BodyPose::frame, static_cast<int>(*frame)};
  return usage(fmt::format("'{}' is not auto, reference or a frame number", shown(text)),
               "frames are numbered from 0");
}

void declare(CommandOptions& command, Options& options) {
  command
      .add_option("input IN", options.input,
                  "Motion or model with the skeleton (- is standard input)")
      .required();
  command.group("Body");
  command.add(
      "--detail LEVEL", options.detail,
      choice<BodyDetail>(
          {{"low", BodyDetail::low}, {"medium", BodyDetail::medium}, {"high", BodyDetail::high}}),
      "Number of vertices: low (about 2,500), medium (10,000) or high (40,000)", "medium");
  command.add("--pose", options.pose, ValueKind<Pose>{"pose", "POSE", parse_pose, {}},
              "Bind pose of the body: reference (the skeleton's), a frame number, or auto (the "
              "reference pose, with overlapping limbs turned aside)",
              "auto");
  add_twist_joints_option(command, options.twist);
  add_orientation_option(command, options.orientation);
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of<Options>("krok-body", options, declare, nullptr, run);
  spec.summary = "Generates a smooth, closed, skinned body for any skeleton";
  spec.details = "It shows a capture as a character.";
  spec.writes = registry::Kind::model;
  spec.inputs = "IN.anim|IN.bvh|IN.fbx|IN.glb|IN.model";
  spec.examples = {{"krok-body walk.anim -o walker.model",
                    "a body for the actor of a capture, about 10,000 vertices"},
                   {"krok-body dog.anim --detail high -o dog.model",
                    "bodies of other skeletons follow the bone lengths"}};
  spec.batch = {{".anim", ".kanim"}, always(".model")};
  return spec;
}

}  // namespace krok::cli::body
