#include "tools/krok-skin/outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>

#include "core/numbers.h"
#include "formats/obj/obj_writer.h"
#include "formats/pc2/pc2.h"
#include "motion/sample.h"
#include "skin/morph.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/output_set.h"

namespace krok::cli::skin {

namespace {

// The subject's mesh at times of its motion: morph targets first, then skinning. Owns working
// memory: use one per thread. Subject and binding must outlive it.
class PosedMesh {
 public:
  PosedMesh(const Subject& subject, const SkinBinding& binding, int jobs);

  // `out` has one element per vertex; normals and tangents if the model has them, or empty.
  void at_frame(int frame, const SkinnedSurface& out);
  void at_time(double seconds, const SkinnedSurface& out);

 private:
  void skin(double frame, std::span<const Stretch> stretches, const SkinnedSurface& out);
  // The surface before skinning: the model's or, with morph targets, that of `frame`.
  SkinSurface shape_at(double frame, const SkinnedSurface& out);

  const Subject& subject_;
  const SkinBinding& binding_;
  SkinPose pose_;
  int jobs_;
  std::vector<Transform> joints_, scratch_;
  std::vector<Stretch> stretches_;
  std::vector<float> weights_;
  std::vector<Vec3f> positions_, normals_;
};

PosedMesh::PosedMesh(const Subject& subject, const SkinBinding& binding, int jobs)
    : subject_(subject),
      binding_(binding),
      pose_(binding),
      jobs_(jobs),
      joints_(subject.clip.skeleton.names.size()),
      scratch_(3 * joints_.size()) {}

void PosedMesh::at_frame(int frame, const SkinnedSurface& out) {
  subject_.clip.get_pose(frame, joints_);
  std::span<const Stretch> stretches = subject_.stretches;
  if (!stretches.empty()) {
    stretches = stretches.subspan(static_cast<std::size_t>(frame) * joints_.size(), joints_.size());
  }
  skin(frame, stretches, out);
}

void PosedMesh::at_time(double seconds, const SkinnedSurface& out) {
  sample(subject_.clip, seconds, joints_, scratch_);
  const double frame = seconds * subject_.clip.rate;
  if (!subject_.stretches.empty()) {
    stretches_.resize(joints_.size());
    sample(subject_.stretches, frame, stretches_);
  }
  skin(frame, stretches_, out);
}

void PosedMesh::skin(double frame, std::span<const Stretch> stretches, const SkinnedSurface& out) {
  pose_.set(joints_, stretches);
  krok::skin(binding_, pose_, shape_at(frame, out), out, jobs_);
}

SkinSurface PosedMesh::shape_at(double frame, const SkinnedSurface& out) {
  SkinSurface surface = skin_surface(subject_.model);
  if (out.normals.empty()) surface.normals = {};
  if (out.tangents.empty()) surface.tangents = {};
  if (!subject_.changes_shape()) return surface;
  weights_at(subject_.weights, frame / subject_.weights.rate, weights_);
  positions_.resize(surface.positions.size());
  normals_.resize(surface.normals.size());
  apply_morphs(subject_.morphs, weights_, {surface.positions, surface.normals},
               {positions_, normals_}, jobs_);
  surface.positions = positions_;
  surface.normals = normals_;
  return surface;
}

// Browsers on common hardware fail at about this number of morph targets.
constexpr int kManyMorphTargets = 1000;
// Default mesh name, for object lists of viewers.
constexpr const char* kMeshName = "body";
// Sizes that are printed before a baked motion is written.
constexpr std::uint64_t kLargeBytes = 50'000'000;

gltf::WriteOptions write_options(const Subject& subject, const ToolContext& context) {
  gltf::WriteOptions options;
  options.binary = extension(context.output) != ".gltf";
  options.provenance = context.provenance();
  options.name = kMeshName;
  options.clip_name = subject.clip_name;
  options.materials = subject.materials;
  options.unnamed_is_none = subject.unnamed_is_none;
  return options;
}

obj::WriteOptions obj_options(const ToolContext& context) {
  return {.provenance = context.provenance(), .name = kMeshName};
}

// Vertex positions of a mesh in one pose.
struct Vertices {
  std::vector<Vec3f> positions, normals;
  std::vector<Vec4f> tangents;

  explicit Vertices(const Model& model)
      : positions(model.positions.size()),
        normals(model.normals.size()),
        tangents(model.tangents.size()) {}
  SkinnedSurface surface() { return {positions, normals, tangents}; }
  MeshShape shape() const { return {positions, normals, tangents}; }
};

// Writes meshes of one model, each to its own file. Thread-safe.
using WriteMesh = std::function<Status(const MeshShape& shape, OutputFile& file)>;

Result<WriteMesh> mesh_writer(const Subject& subject, const ToolContext& context) {
  if (extension(context.output) == ".obj") {
    auto writer = obj::Writer::create(subject.model, obj_options(context));
    if (!writer) return writer.error();
    return WriteMesh(
        [writer = std::make_shared<const obj::Writer>(std::move(*writer))](
            const MeshShape& shape, OutputFile& file) { return writer->write(shape, file); });
  }
  return WriteMesh([&model = subject.model, options = write_options(subject, context)](
                       const MeshShape& shape, OutputFile& file) {
    return gltf::write_mesh(model, shape, options, file);
  });
}

// The smallest --every that keeps a motion within the limits; 0 if none does.
int fitting_step(const Model& model, std::span<const Material> materials, int frames) {
  for (int step = 2; step < frames; ++step) {
    const int kept = (frames - 1) / step + 1;
    if (kept <= gltf::kMaxMorphTargets &&
        gltf::baked_bytes(model, kept, materials) <= gltf::kMaxDataBytes) {
      return step;
    }
  }
  return 0;
}

Status check_bakeable(const Subject& subject, ToolContext& context) {
  const int frames = subject.clip.frame_count();
  const std::uint64_t bytes = gltf::baked_bytes(subject.model, frames, subject.materials);
  const auto megabytes = (bytes >> 20) + 1;
  if (frames - 1 > gltf::kMaxMorphTargets || bytes > gltf::kMaxDataBytes) {
    const int step = fitting_step(subject.model, subject.materials, frames);
    return Error(
        "skin-clip-too-long",
        fmt::format("{} frames of {} vertices need {} morph targets and {} MB; viewers support at "
                    "most {} targets, and glTF at most {} MB",
                    frames, subject.model.vertex_count(), frames - 1, megabytes,
                    gltf::kMaxMorphTargets, gltf::kMaxDataBytes >> 20),
        step > 0 ? fmt::format(
                       "use --as rig for any length, --every {}, or a range with --from and --to",
                       step * subject.every)
                 : "use --as rig or -o OUT.pc2 for any number of vertices and frames");
  }
  if (bytes > kLargeBytes) {
    context.log(fmt::format("{}: {} of {} will take {} MB; a rig (--as rig) has the mesh once",
                            context.output, counted(frames, "frame"),
                            counted(subject.model.vertex_count(), "vertex", "vertices"),
                            readable(static_cast<double>(bytes) / 1e6, 3)));
  }
  if (frames - 1 > kManyMorphTargets) {
    context.warn("skin-many-targets",
                 fmt::format("{} morph targets are more than some viewers support", frames - 1),
                 "use --as rig or --every 2");
  }
  return {};
}

// "walk_0007.glb" for "walk.glb" and frame 7 of 1500.
std::string frame_path(const std::string& output, int frame, int last_frame) {
  const std::size_t digits = std::max<std::size_t>(4, fmt::format("{}", last_frame).size());
  const std::string end = extension(output);
  const std::string stem = output.substr(0, output.size() - end.size());
  return fmt::format("{}_{:0{}}{}", stem, frame, digits, output.substr(stem.size()));
}

}  // namespace

Status check_output(As as, const std::string& output) {
  const std::string end = extension(output);
  if (as == As::frames && output == "-") {
    return Error("skin-output", "--as frames writes many files, not standard output",
                 "use -o OUT.glb for OUT_0000.glb, OUT_0001.glb, ...");
  }
  if (output == "-" || end == ".glb" || end == ".gltf") return {};
  if (end == ".pc2") {
    if (as == As::baked) return {};
    return Error("skin-format", "a point cache (.pc2) can only hold the vertices of a whole motion",
                 "use --as baked; write the mesh with --as pose -o OUT.obj")
        .in_file(output);
  }
  if (end == ".obj") {
    if (as == As::pose || as == As::frames) return {};
    return Error("skin-format", "an OBJ file holds one static mesh",
                 "use --as frames for one file per frame, --as pose for one pose")
        .in_file(output);
  }
  const std::string maker = maker_of(end);
  return Error("skin-format",
               end.empty() ? fmt::format("{} has no extension; cannot determine the format", output)
                           : fmt::format("unsupported extension {}", end),
               "use .glb, .gltf, .pc2 or .obj" + (maker.empty() ? "" : "; " + maker))
      .in_file(output);
}

Status write_pose(const Subject& subject, const SkinBinding& binding, double seconds,
                  ToolContext& context) {
  Vertices vertices(subject.model);
  PosedMesh(subject, binding, context.jobs).at_time(seconds, vertices.surface());
  const auto write = mesh_writer(subject, context);
  if (!write) return write.error();
  return write_output(context, context.output,
                      [&](OutputFile& file) { return (*write)(vertices.shape(), file); });
}

Status write_baked(const Subject& subject, const SkinBinding& binding, pc2::Up up,
                   ToolContext& context) {
  const bool cache = extension(context.output) == ".pc2";
  if (!cache) {
    if (Status status = check_bakeable(subject, context); !status) return status;
  }
  MeshMotion motion;
  motion.frames = subject.clip.frame_count();
  motion.rate = subject.clip.rate;
  motion.tangents = !subject.model.tangents.empty();
  motion.source = [&]() -> ShapeSource {
    return [mesh = std::make_shared<PosedMesh>(subject, binding, 1)](int frame,
                                                                     const ShapeOutput& to) {
      mesh->at_frame(frame, {to.positions, to.normals, to.tangents});
    };
  };
  return write_output(context, context.output, [&](OutputFile& file) {
    if (cache) {
      return pc2::write(subject.model, motion, {.up = up}, file, context.progress, context.jobs);
    }
    return gltf::write_baked(subject.model, motion, write_options(subject, context), file,
                             context.progress, context.jobs);
  });
}

Status write_motion(const Subject& subject, ToolContext& context) {
  const auto clips = clips_of(subject, kMeshName, context);
  if (!clips) return clips.error();
  return write_output(context, context.output, [&](OutputFile& file) {
    return gltf::write_skeleton(subject.model.skeleton, clips->named(),
                                write_options(subject, context), file);
  });
}

Result<bool> write_rig(const Options& chosen, const Subject& subject, ToolContext& context) {
  auto rig = small_rig(chosen, subject, kMeshName, context);
  if (!rig) return rig.error();
  bool within = true;
  const Status all = write_output(context, context.output, [&](OutputFile& file) -> Status {
    gltf::WriteOptions options = write_options(subject, context);
    options.eyes = subject.eyes;
    options.sockets = subject.sockets;
    std::vector<gltf::Attached> attached;
    for (const Subject::Thing& thing : subject.things) {
      attached.push_back({thing.name, thing.joint, thing.socket, &thing.model});
    }
    options.attached = attached;
    if (rig->morphs.target_count() > 0) options.morphs = &rig->morphs;
    if (subject.changes_shape()) options.weights = &subject.weights;
    options.quantized = rig->quantization;
    options.compressed = chosen.compress;
    if (chosen.minify) options.provenance = {};
    const auto write = [&](OutputFile& to) {
      return gltf::write_rig(rig->model, rig->clips.named(), options, to);
    };
    if (!rig->facts.is_object()) return write(file);
    // A stream cannot be read again.
    std::optional<OutputFile> readable;
    if (!file.can_overwrite()) {
      auto made = OutputFile::create(std::filesystem::temp_directory_path() / "krok-skin.glb");
      if (!made) return made.error();
      readable = std::move(*made);
    }
    OutputFile& measured = readable ? *readable : file;
    if (Status status = write(measured); !status) return status;
    if (Status status = measured.seal(); !status) return status;
    const auto kept = report_loss(measured.written_at(), chosen, subject, *rig, context);
    if (!kept) return kept.error();
    within = *kept;
    if (!readable) return {};
    const auto again = InputFile::open(measured.written_at());
    return again ? file.write(again->bytes()) : Status(again.error());
  });
  if (!all) return all.error();
  return within;
}

Result<std::string> write_frames(const Subject& subject, const SkinBinding& binding,
                                 ToolContext& context) {
  const int frames = subject.clip.frame_count();
  const int last_frame = subject.first_frame + (frames - 1) * subject.every;
  std::vector<std::string> paths;
  for (int i = 0; i < frames; ++i) {
    paths.push_back(
        frame_path(context.output, subject.first_frame + i * subject.every, last_frame));
  }
  const auto write_mesh = mesh_writer(subject, context);
  if (!write_mesh) return write_mesh.error();
  OutputSet outputs(context);
  context.progress->begin("writing frames", static_cast<std::uint64_t>(frames));
  const auto write = [&](std::size_t i, OutputFile& file) {
    Vertices vertices(subject.model);
    PosedMesh(subject, binding, 1).at_frame(static_cast<int>(i), vertices.surface());
    context.progress->advance(1);
    return (*write_mesh)(vertices.shape(), file);
  };
  if (Status status = outputs.add_all(paths, context.jobs, write); !status) return status.error();
  if (Status status = outputs.finish(); !status) return status.error();
  return fmt::format("{} to {}", paths.front(), paths.back());
}

}  // namespace krok::cli::skin
