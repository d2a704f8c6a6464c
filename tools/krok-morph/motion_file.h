#pragma once

#include <span>
#include <string>

#include "core/result.h"
#include "scene/mesh_motion.h"
#include "scene/model.h"
#include "scene/morph_set.h"
#include "tools/cli/output_set.h"
#include "tools/cli/report.h"
#include "tools/cli/tool.h"
#include "tools/krok-morph/shape_file.h"

namespace krok::cli::morph {

// Output format of an animated mesh, by extension.
enum class MotionFormat { glb, gltf, pc2, exr };

// An Error (code morph-format) for other extensions; `exr`: whether .exr is allowed.
Result<MotionFormat> motion_format(const std::string& path, bool exr);

// Adds the motion of a mesh as baked shapes to the outputs: glTF or a PC2 point cache. An Error
// (code morph-clip-too-long) for glTF beyond the limits of viewers.
Status add_baked(const ShapeFile& shape, const MeshMotion& motion, MotionFormat format,
                 OutputSet& outputs, ToolContext& context);

// Adds glTF with morph targets and weight keys, one per frame.
Status add_targets(const ShapeFile& shape, const MorphSet& morphs, const MorphWeights& weights,
                   MotionFormat format, OutputSet& outputs, ToolContext& context);

// How far a target displaces a mesh, in metres.
struct Movement {
  int moved = 0;       // vertices displaced by more than 1e-6 m
  double largest = 0;  // of all vertices
  int vertex = -1;     // with the largest displacement; -1 if none moves
  double mean = 0;     // over moved vertices
};

Movement movement_of(std::span<const Vec3f> base, std::span<const Vec3f> target);

// For reports: "vertices_moved", "largest_distance", "vertex", "mean_distance".
Json to_json(const Movement& movement);

// "moves 312 vertices, max 12.3 mm (vertex 88), mean 3.1 mm".
std::string describe(const Movement& movement);

}  // namespace krok::cli::morph
