#include <fmt/format.h>

#include <cmath>

#include "core/numbers.h"
#include "formats/csv/csv_writer.h"
#include "formats/morph_exr/morph_exr.h"
#include "skin/key_frame_mesh.h"
#include "tools/krok-morph/actions.h"
#include "tools/krok-morph/key_shapes_input.h"
#include "tools/krok-morph/motion_file.h"

// Key-frame meshes: interpolates shapes over time.

namespace krok::cli::morph {

namespace {

constexpr double kMaxFrames = 10e6;
constexpr double kMaxWeights = 100e6;

Result<int> frame_count(const KeyShapes& keys) {
  const double frames = std::ceil(keys.times.back() * keys.rate - 1e-6) + 1;
  if (frames <= kMaxFrames &&
      frames * static_cast<double>(keys.shapes.names.size()) <= kMaxWeights) {
    return static_cast<int>(frames);
  }
  return Error("morph-too-large", fmt::format("{} s at {} fps are too many frames",
                                              readable(keys.times.back()), readable(keys.rate)));
}

// The weight of each shape in each frame; the weights of a frame sum to 1.
MorphWeights shares_of(const KeyShapes& keys, int frames) {
  MorphWeights weights;
  weights.rate = keys.rate;
  weights.names = keys.shapes.names;
  std::vector<double> row(weights.names.size());
  for (int frame = 0; frame < frames; ++frame) {
    std::ranges::fill(row, 0.0);
    const KeyShares shares = shares_at(keys.times, keys.join, keys.tension, frame / keys.rate);
    for (std::size_t i = 0; i < static_cast<std::size_t>(shares.count); ++i) {
      const auto key = static_cast<std::size_t>(shares.keys[i]);
      row[static_cast<std::size_t>(keys.shape_of[key])] += shares.shares[i];
    }
    for (const double share : row) weights.values.push_back(static_cast<float>(share));
  }
  return weights;
}

// The key-frame mesh with one shape per key.
KeyFrameMesh mesh_of(const KeyShapes& keys) {
  KeyFrameMesh mesh;
  mesh.times = keys.times;
  mesh.vertex_count = keys.shapes.vertex_count;
  for (const int shape : keys.shape_of) {
    const auto positions = keys.shapes.target_positions(shape);
    const auto normals = keys.shapes.target_normals(shape);
    mesh.positions.insert(mesh.positions.end(), positions.begin(), positions.end());
    mesh.normals.insert(mesh.normals.end(), normals.begin(), normals.end());
  }
  return mesh;
}

// Removes the first shape, which is the mesh itself, and its weights.
void leave_out_first(MorphSet& shapes, MorphWeights& weights) {
  const auto vertices = static_cast<std::ptrdiff_t>(shapes.vertex_count);
  const std::size_t targets = weights.names.size();
  shapes.positions.erase(shapes.positions.begin(), shapes.positions.begin() + vertices);
  shapes.normals.erase(shapes.normals.begin(), shapes.normals.begin() + vertices);
  shapes.names.erase(shapes.names.begin());
  std::vector<float> kept;
  for (std::size_t i = 0; i < weights.values.size(); ++i) {
    if (i % targets != 0) kept.push_back(weights.values[i]);
  }
  weights.values = std::move(kept);
  weights.names = shapes.names;
}

Status add_motion(KeyShapes& keys, int frames, MotionFormat format, As as, OutputSet& outputs,
                  ToolContext& context) {
  if (format == MotionFormat::exr) {
    keys.shapes.provenance = context.provenance();
    return outputs.add(context.output,
                       [&](OutputFile& file) { return morph_exr::write(keys.shapes, file); });
  }
  if (as == As::targets) {
    MorphWeights weights = shares_of(keys, frames);
    leave_out_first(keys.shapes, weights);
    return add_targets(keys.base.model, keys.shapes, weights, format, outputs, context);
  }
  const KeyFrameMesh mesh = mesh_of(keys);
  if (Status status = check(mesh); !status) return status;
  MeshMotion motion;
  motion.frames = frames;
  motion.rate = keys.rate;
  motion.source = copies_of([&](int frame, const ShapeOutput& to) {
    shape_at(mesh, keys.join, keys.tension, frame / keys.rate, {to.positions, to.normals}, 1);
  });
  return add_baked(keys.base.model, motion, format, outputs, context);
}

void report(const KeyShapes& keys, int frames, ToolContext& context) {
  Json result;
  result["vertices"] = keys.shapes.vertex_count;
  result["keys"] = keys.times.size();
  result["shapes"] = keys.shape_of.empty() ? 0 : *std::ranges::max_element(keys.shape_of) + 1;
  result["between"] = keys.join == ShapeJoin::linear ? "linear" : "hermite";
  result["tension"] = keys.tension;
  result["frames"] = frames;
  result["rate"] = keys.rate;
  context.report.result = std::move(result);
  context.log(fmt::format("{}: {}, {} at {} fps", context.output,
                          counted(static_cast<long long>(keys.times.size()), "key"),
                          counted(frames, "frame"), readable(keys.rate)));
}

}  // namespace

Result<int> frames(const Options& options, ToolContext& context) {
  const auto format = motion_format(context.output, true);
  if (!format) return format.error();
  const bool gltf = *format == MotionFormat::glb || *format == MotionFormat::gltf;
  if (options.as == As::targets && !gltf) {
    return Error("usage", "--as targets is for glTF");
  }
  auto keys = read_key_shapes(options, context);
  if (!keys) return keys.error();
  const auto count = frame_count(*keys);
  if (!count) return Error(count.error()).in_file(options.files[0]);

  OutputSet outputs(context);
  if (!options.save_weights.empty()) {
    const MorphWeights weights = shares_of(*keys, *count);
    const Status status = outputs.add(options.save_weights,
                                      [&](OutputFile& file) { return csv::write(weights, file); });
    if (!status) return status.error();
  }
  const Status status = add_motion(*keys, *count, *format, options.as, outputs, context);
  if (!status) return status.error();
  if (Status step = outputs.finish(); !step) return step.error();
  report(*keys, *count, context);
  return kExitDone;
}

}  // namespace krok::cli::morph
