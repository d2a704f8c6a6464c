#include "tools/krok-body/options.h"

#include <fmt/format.h>

#include <memory>

#include "core/numbers.h"
#include "tools/cli/option_kinds.h"
#include "tools/krok-body/run.h"
#include "tools/shared/orientation_option.h"

namespace krok::cli::body {

Result<BodyOptions> body_options(const Options& options) {
  BodyOptions result;
  result.detail = options.detail;
  if (options.pose == "auto") return result;
  if (options.pose == "reference") {
    result.pose = BodyPose::reference;
    return result;
  }
  const auto frame = parse_integer(options.pose);
  if (!frame || *frame < 0 || *frame > 2'000'000'000) {
    return Error("usage",
                 fmt::format("--pose {} is not auto, reference or a frame number", options.pose),
                 "frames are numbered from 0");
  }
  result.pose = BodyPose::frame;
  result.frame = static_cast<int>(*frame);
  return result;
}

namespace {

void declare(CommandOptions& command, Options& options) {
  command
      .add_option("input IN", options.input,
                  "Motion or model with the skeleton (- is standard input)")
      .required();
  command.group("Body");
  add_choice<BodyDetail>(
      command, "--detail", options.detail,
      {{"low", BodyDetail::low}, {"medium", BodyDetail::medium}, {"high", BodyDetail::high}},
      "Number of vertices: low (about 2,500), medium (10,000) or high (40,000)", "LEVEL", "medium");
  command
      .add_option("--pose POSE", options.pose,
                  "Bind pose of the body: reference (the skeleton's), a frame number, or auto (the "
                  "reference pose, with overlapping limbs turned aside)")
      .default_str("auto");
  add_orientation_option(command, options.orientation);
}

Status check(const Options& options) {
  const auto how = body_options(options);
  return how ? Status() : how.error();
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of("krok-body", options, declare, check, run);
  spec.summary = "Generates a smooth, closed, skinned body for any skeleton";
  spec.details = "It shows a capture as a character.";
  spec.inputs = "IN.anim|IN.bvh|IN.amc|IN.model";
  spec.examples = {{"krok-body walk.anim -o walker.model",
                    "a body for the actor of a capture, about 10,000 vertices"},
                   {"krok-body dog.anim --detail high -o dog.model",
                    "bodies of other skeletons follow the bone lengths"}};
  spec.batch = {{".anim", ".kanim"}, always(".model")};
  return spec;
}

}  // namespace krok::cli::body
