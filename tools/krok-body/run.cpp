#include "tools/krok-body/options.h"

#include <fmt/format.h>

#include "core/numbers.h"
#include "formats/anim/anim.h"
#include "formats/io/open_motion.h"
#include "formats/model/model_format.h"
#include "formats/registry/registry.h"
#include "tools/cli/output_set.h"

namespace krok::cli::body {

namespace {

// A clip with the file's skeleton, and its motion if any.
Result<Clip> read_skeleton(const InputFile& input, ToolContext& context) {
  switch (registry::kind_of_content(input.bytes())) {
    case registry::Kind::anim: {
      Stretches stretches;  // a body is made for the reference pose
      auto clip = anim::read(input.bytes(), &stretches);
      if (!clip) return std::move(clip).error().in_file(input.path());
      return clip;
    }
    case registry::Kind::model: {
      auto model = model::read(input.bytes());
      if (!model) return std::move(model).error().in_file(input.path());
      Clip clip;
      clip.skeleton = std::move(model->skeleton);
      return clip;
    }
    default:
      break;
  }
  const registry::Kind kind = registry::identify(input.path(), input.bytes());
  if (kind == registry::Kind::bvh || kind == registry::Kind::amc) {
    return io::open_motion(input, context);
  }
  return Error("body-input",
               fmt::format("expected a motion (.anim, .bvh, .amc) or a .model file, but this is {}",
                           registry::describe_content(input.bytes())),
               registry::advice(kind, registry::Kind::anim))
      .in_file(input.path());
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
  auto clip = read_skeleton(*input, context);
  if (!clip) return clip.error();
  auto body = make_body(*clip, how);
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

}  // namespace krok::cli::body
