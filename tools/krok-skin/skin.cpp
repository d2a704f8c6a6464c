#include "tools/krok-skin/skin.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "core/quantity.h"
#include "formats/anim/anim.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/model/model_format.h"
#include "motion/cut.h"
#include "motion/sample.h"
#include "skin/bind.h"
#include "skin/skin.h"
#include "tools/common/output_set.h"

namespace krok {

namespace {

// A model and the motion that moves it, on one skeleton.
struct Scene {
  Model model;
  Clip clip;
  int first_frame = 0, every = 1;  // of the motion as read, for names of files
};

// A baked file above this is refused; --as rig has no such limit.
constexpr std::uint64_t kMaxBakedBytes = std::uint64_t{1} << 30;
// More morph targets than this fit in no browser on common hardware, or only just.
constexpr int kManyMorphTargets = 1000;

Error at_option(const char* option, Error error) {
  error.message = fmt::format("{}: {}", option, error.message);
  return error;
}

// The frame nearest to a moment given on the command line.
Result<int> frame_at(const char* option, const std::string& text, const Clip& clip, int fallback) {
  if (text.empty()) return fallback;
  const auto time = parse_clip_time(text);
  if (!time) return at_option(option, time.error());
  const double frame = std::round(time->in_frames ? time->value : time->value * clip.rate);
  if (!(frame >= 0 && frame < clip.frame_count())) {
    return Error("skin-time",
                 fmt::format("{} {} lies outside the motion, which has frames 0 to {} ({} s)",
                             option, text, clip.frame_count() - 1, readable(clip.duration())));
  }
  return static_cast<int>(frame);
}

Status cut_to_range(const SkinOptions& options, Scene& scene) {
  const int frames = scene.clip.frame_count();
  if (options.from.empty() && options.to.empty() && options.every == 1) return {};
  if (frames == 0) {
    return Error("skin-no-frames",
                 "the motion has no frames to choose from by --from, --to, --every");
  }
  const auto first = frame_at("--from", options.from, scene.clip, 0);
  if (!first) return first.error();
  const auto last = frame_at("--to", options.to, scene.clip, frames - 1);
  if (!last) return last.error();
  if (*last < *first) {
    return Error("skin-time",
                 fmt::format("--from {} lies after --to {}", options.from, options.to));
  }
  scene.clip = cut(scene.clip, *first, *last, options.every);
  scene.first_frame = *first;
  scene.every = options.every;
  return {};
}

Result<Scene> load(const SkinOptions& options, ToolContext& context) {
  Scene scene;
  const auto model_file = context.open_input(options.model);
  if (!model_file) return model_file.error();
  auto model = model::read(model_file->bytes());
  if (!model) return std::move(model.error()).in_file(options.model);
  const auto motion_file = context.open_input(options.motion);
  if (!motion_file) return motion_file.error();
  auto clip = anim::read(motion_file->bytes());
  if (!clip) return std::move(clip.error()).in_file(options.motion);
  scene.clip = std::move(*clip);

  auto bound = bind_to(std::move(*model), scene.clip.skeleton);
  if (!bound) return std::move(bound.error()).in_file(options.motion);
  scene.model = std::move(*bound);
  if (scene.model.triangles.empty()) {
    return Error("skin-empty-model", "the model has no triangles",
                 "krok-body makes a model with a mesh")
        .in_file(options.model);
  }
  for (Diagnostic difference : reference_differences(scene.model.skeleton, scene.clip)) {
    difference.where.file = options.motion;
    context.tell(std::move(difference));
  }
  if (Status done = cut_to_range(options, scene); !done) {
    return std::move(done.error()).in_file(options.motion);
  }
  return scene;
}

// The moment of --as pose in seconds.
Result<double> pose_time(const SkinOptions& options, const Clip& clip) {
  if (options.time.empty()) return 0.0;
  const auto time = parse_clip_time(options.time);
  if (!time) return at_option("--time", time.error());
  const double seconds = time->seconds(clip.rate);
  if (seconds < 0 || seconds > clip.duration() * (1 + 1e-9)) {
    return Error("skin-time", fmt::format("--time {} lies outside the motion, which lasts {} s",
                                          options.time, readable(clip.duration())))
        .in_file(options.motion);
  }
  return seconds;
}

// Skins the model in poses one after the other; owns the working memory.
class Skinner {
 public:
  Skinner(const Model& model, const SkinBinding& binding, int jobs)
      : model_(model), binding_(binding), pose_(binding), jobs_(jobs) {}

  void skin(std::span<const Transform> joint_to_world, const SkinnedSurface& out) {
    pose_.set(joint_to_world);
    SkinSurface in = skin_surface(model_);
    if (out.tangents.empty()) in.tangents = {};
    krok::skin(binding_, pose_, in, out, jobs_);
  }

 private:
  const Model& model_;
  const SkinBinding& binding_;
  SkinPose pose_;
  int jobs_;
};

gltf::WriteOptions write_options(const ToolContext& context, const std::string& output) {
  gltf::WriteOptions options;
  options.binary = extension(output) != ".gltf";
  options.provenance = context.provenance();
  options.name = "body";
  return options;
}

Status write_pose(const Scene& scene, const SkinBinding& binding,
                  std::span<const Transform> joint_to_world, int jobs,
                  const gltf::WriteOptions& options, OutputFile& file) {
  std::vector<Vec3f> positions(scene.model.positions.size());
  std::vector<Vec3f> normals(scene.model.normals.size());
  std::vector<Vec4f> tangents(scene.model.tangents.size());
  Skinner(scene.model, binding, jobs).skin(joint_to_world, {positions, normals, tangents});
  return gltf::write_mesh(scene.model, {positions, normals, tangents}, options, file);
}

Status write_pose_at(const Scene& scene, const SkinBinding& binding, double seconds,
                     const ToolContext& context, OutputFile& file) {
  const std::size_t joints = scene.clip.skeleton.names.size();
  std::vector<Transform> pose(joints), scratch(3 * joints);
  sample(scene.clip, seconds, pose, scratch);
  return write_pose(scene, binding, pose, context.jobs, write_options(context, context.output),
                    file);
}

// The smallest --every that brings a motion within the limits; 0 if none does.
int fitting_step(const Model& model, int frames) {
  for (int step = 2; step < frames; ++step) {
    const int kept = (frames - 1) / step + 1;
    if (kept <= gltf::kMaxMorphTargets && gltf::baked_bytes(model, kept) <= kMaxBakedBytes) {
      return step;
    }
  }
  return 0;
}

Status check_bakeable(const Scene& scene, ToolContext& context) {
  const int frames = scene.clip.frame_count();
  const std::uint64_t bytes = gltf::baked_bytes(scene.model, frames);
  const auto megabytes = (bytes >> 20) + 1;
  if (frames - 1 > gltf::kMaxMorphTargets || bytes > kMaxBakedBytes) {
    const int step = fitting_step(scene.model, frames);
    return Error(
        "skin-clip-too-long",
        fmt::format("{} frames of {} vertices make {} morph targets and {} MB; viewers hold at "
                    "most {} targets, and {} MB is the limit here",
                    frames, scene.model.vertex_count(), frames - 1, megabytes,
                    gltf::kMaxMorphTargets, kMaxBakedBytes >> 20),
        step > 0 ? fmt::format("--as rig holds any length; or --every {}, or a part by --from and "
                               "--to",
                               step * scene.every)
                 : "--as rig holds any number of vertices and frames");
  }
  if (frames - 1 > kManyMorphTargets) {
    context.warn("skin-many-targets",
                 fmt::format("{} morph targets are more than some viewers show", frames - 1),
                 "--as rig, or --every 2");
  }
  return {};
}

Status write_clip(const Scene& scene, const SkinBinding& binding, const ToolContext& context,
                  OutputFile& file) {
  Skinner skinner(scene.model, binding, context.jobs);
  std::vector<Transform> pose(scene.clip.skeleton.names.size());
  gltf::BakedMotion motion;
  motion.frames = scene.clip.frame_count();
  motion.rate = scene.clip.rate;
  motion.shape_at = [&](int frame, std::span<Vec3f> positions, std::span<Vec3f> normals) {
    scene.clip.get_pose(frame, pose);
    skinner.skin(pose, {positions, normals, {}});
  };
  return gltf::write_baked(scene.model, motion, write_options(context, context.output), file,
                           context.progress);
}

// "walk.glb" and frame 7 of 1500 give "walk_0007.glb".
std::string frame_path(const std::string& output, int frame, int last_frame) {
  const std::size_t digits = std::max<std::size_t>(4, fmt::format("{}", last_frame).size());
  const std::string end = extension(output);
  const std::string stem = output.substr(0, output.size() - end.size());
  return fmt::format("{}_{:0{}}{}", stem, frame, digits, output.substr(stem.size()));
}

// One file a frame, several at a time; all of them appear or none.
Result<int> write_frames(const Scene& scene, const SkinBinding& binding, ToolContext& context) {
  const int frames = scene.clip.frame_count();
  const int last_frame = scene.first_frame + (frames - 1) * scene.every;
  std::vector<std::string> paths;
  for (int i = 0; i < frames; ++i) {
    paths.push_back(frame_path(context.output, scene.first_frame + i * scene.every, last_frame));
  }
  const gltf::WriteOptions writing = write_options(context, context.output);
  OutputSet outputs(context);
  context.progress->begin("writing frames", static_cast<std::uint64_t>(frames));
  const auto write = [&](std::size_t i, OutputFile& file) {
    std::vector<Transform> pose(scene.clip.skeleton.names.size());
    scene.clip.get_pose(static_cast<int>(i), pose);
    context.progress->advance(1);
    return write_pose(scene, binding, pose, 1, writing, file);
  };
  if (Status added = outputs.add_all(paths, context.jobs, write); !added) return added.error();
  if (Status done = outputs.finish(); !done) return done.error();
  context.say(fmt::format("{} to {}: {}", paths.front(), paths.back(), counted(frames, "file")));
  return kExitDone;
}

Status write_one(SkinAs as, const Scene& scene, const SkinBinding& binding, double seconds,
                 ToolContext& context, OutputFile& file) {
  switch (as) {
    case SkinAs::pose:
      return write_pose_at(scene, binding, seconds, context, file);
    case SkinAs::rig:
      return gltf::write_rig(scene.model, scene.clip, write_options(context, context.output), file);
    default:
      return write_clip(scene, binding, context, file);
  }
}

// An option that the rest of the command line makes void is a mistake to be told of.
Status check_time(const char* option, const std::string& text) {
  if (text.empty()) return {};
  const auto time = parse_clip_time(text);
  if (!time) return at_option(option, time.error());
  if (time->value >= 0) return {};
  return Error("skin-time", fmt::format("{} {} is less than 0", option, text));
}

Status check_options(const SkinOptions& options) {
  for (const auto& [option, text] :
       {std::pair{"--time", &options.time}, {"--from", &options.from}, {"--to", &options.to}}) {
    if (Status fits = check_time(option, *text); !fits) return fits;
  }
  const bool pose = options.as == SkinAs::pose;
  if (!pose && !options.time.empty()) {
    return Error("usage", "--time is for --as pose", "--from and --to choose a part of the motion");
  }
  if (options.as == SkinAs::rig && options.method != SkinMethod::linear) {
    return Error("usage", "--method is not for --as rig, which leaves skinning to the viewer",
                 "--as clip writes the mesh as the method moves it");
  }
  if (pose && !(options.from.empty() && options.to.empty() && options.every == 1)) {
    return Error("usage", "--from, --to and --every are not for --as pose", "--time says when");
  }
  return {};
}

Json result_of(const Scene& scene, int frames) {
  Json result;
  result["vertices"] = scene.model.vertex_count();
  result["triangles"] = scene.model.triangles.size();
  result["joints"] = scene.model.skeleton.joint_count();
  result["frames"] = frames;
  result["rate"] = scene.clip.rate;
  return result;
}

Status check_output(const SkinOptions& options, const std::string& output) {
  const std::string end = extension(output);
  if (options.as == SkinAs::frames && output == "-") {
    return Error("skin-output", "--as frames writes many files, which standard output cannot take",
                 "give -o OUT.glb for OUT_0000.glb, OUT_0001.glb, ...");
  }
  if (output == "-" || end == ".glb" || end == ".gltf") return {};
  return Error("skin-format",
               end.empty() ? fmt::format("{} has no extension to tell the format by", output)
                           : fmt::format("no format of this tool has the extension {}", end),
               "known are .glb and .gltf")
      .in_file(output);
}

}  // namespace

Status check(const SkinOptions& options) {
  return check_options(options);
}

Result<int> run_skin(const SkinOptions& options, ToolContext& context) {
  if (Status fits = check_options(options); !fits) return fits.error();
  if (Status fits = check_output(options, context.output); !fits) return fits.error();
  auto scene = load(options, context);
  if (!scene) return scene.error();
  if (scene->clip.frame_count() == 0 &&
      (options.as == SkinAs::clip || options.as == SkinAs::frames)) {
    return Error("skin-no-frames", "the motion has no frames", "--as pose gives the reference pose")
        .in_file(options.motion);
  }
  const int frames = options.as == SkinAs::pose ? 1 : scene->clip.frame_count();
  context.report.result = result_of(*scene, frames);
  const SkinBinding binding(scene->model, options.method);
  if (options.as == SkinAs::frames) return write_frames(*scene, binding, context);
  if (options.as == SkinAs::clip) {
    Status fits = check_bakeable(*scene, context);
    if (!fits) return std::move(fits.error()).in_file(options.motion);
  }
  const auto seconds = pose_time(options, scene->clip);
  if (!seconds) return seconds.error();
  if (options.as == SkinAs::rig && frames == 0) {
    context.warn("skin-no-frames", "the motion has no frames, so the rig does not move");
  }

  const Status written = write_output(context, context.output, [&](OutputFile& file) {
    return write_one(options.as, *scene, binding, *seconds, context, file);
  });
  if (!written) return written.error();
  context.say(fmt::format("{}: {}, {}", context.output,
                          counted(scene->model.vertex_count(), "vertex", "vertices"),
                          counted(frames, "frame")));
  return kExitDone;
}

}  // namespace krok
