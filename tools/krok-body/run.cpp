#include "tools/krok-body/options.h"

#include <fmt/format.h>

#include <memory>
#include <optional>

#include "body/body.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/io/formats.h"
#include "formats/io/open_character.h"
#include "formats/io/open_motion.h"
#include "formats/model/model_format.h"
#include "tools/cli/output_set.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::body {

namespace {

// Around the file's skeleton, and the motion that the pose may be taken from.
Result<Body> make_body_for(const InputFile& input, const BodyOptions& how, ToolContext& context) {
  const io::Format& format = io::format_of(input);
  const bool is_capture = format.open_capture != nullptr && !format.companion;
  if (is_capture || format.kind == registry::Kind::anim) {
    std::optional<Body> body;
    Stretches stretches;  // do not matter here
    const auto read =
        io::stream_motion(input, context,
                          [&](const FrameSource& frames) -> Status {
                            if (Status status = read_through(frames, context.jobs); !status)
                              return status;
                            auto made = make_body(frames, how);
                            if (!made) return made.error();
                            body = *std::move(made);
                            return {};
                          },
                          {.stretches = &stretches});
    if (!read) return read.error();
    return *std::move(body);
  }
  auto actor = io::open_actor(
      input, context, {.every_clip = true, .with_materials = false, .with_stretches = true});
  if (!actor) return actor.error();
  if (actor->has_mesh()) {
    context.warn("body-mesh",
                 fmt::format("{} has a mesh, and the body is made around its joints instead",
                             shown(input.path())),
                 format.kind == registry::Kind::model || format.kind == registry::Kind::character
                     ? "krok-skin takes the file as it is"
                     : "krok-import --save-model OUT.model keeps its mesh, krok-skin takes it as "
                       "it is");
  }
  if (!actor->motions.empty()) return make_body(actor->motions[0].clip, how);
  return make_body(actor->skeleton(), how);
}

Json result_of(const Body& body) {
  Json result;
  result["vertices"] = body.model.vertex_count();
  result["triangles"] = body.model.triangles.size();
  result["joints"] = body.model.skeleton.joint_count();
  result["bones"] = body.model.skeleton.joint_count() - 1;
  result["volume"] = body.volume;
  result["human"] = body.human;
  result["stature"] = body.human ? Json(body.stature) : Json();
  result["pose"] = body.pose;
  return result;
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  BodyOptions how;
  how.detail = options.detail;
  how.pose = options.pose.kind;
  how.frame = options.pose.frame;
  how.jobs = context.jobs;
  how.progress = context.progress;

  auto input = context.open_input(options.input);
  if (!input) return input.error();
  auto body = make_body_for(*input, how, context);
  if (!body) return std::move(body).error().in_file(input->path());
  context.diagnose(body->diagnostics);

  Model& model = body->model;
  if (Status status = add_twist_joints(options.twist, model); !status) {
    return std::move(status.error()).in_file(input->path());
  }
  model.provenance = context.provenance();
  model.provenance.conversions.push_back(fmt::format("body built in pose: {}", body->pose));
  const Status status = write_output(context, context.output, [&](OutputFile& file) {
    return model::write(model, {.orientation = options.orientation}, file);
  });
  if (!status) return status.error();

  context.report.result = result_of(*body);
  context.log(fmt::format("body: {}, {}, {}, {} m3 -> {}",
                          counted(model.vertex_count(), "vertex", "vertices"),
                          counted(model.triangles.size(), "triangle"),
                          counted(model.skeleton.joint_count() - 1, "bone"),
                          readable(body->volume, 2), context.output));
  return kExitDone;
}

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
