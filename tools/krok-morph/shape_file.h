#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "scene/material.h"
#include "scene/mesh_motion.h"
#include "scene/model.h"
#include "scene/morph_set.h"
#include "tools/cli/output_set.h"
#include "tools/cli/report.h"
#include "tools/cli/tool.h"
#include "tools/krok-morph/options.h"

namespace krok::cli::morph {

enum class Source { obj, gltf, model };

// A mesh shape from a file of any supported kind.
struct ShapeFile {
  std::string path;
  Source source = Source::model;
  Model model;
  std::vector<Material> materials;  // of the model's parts, of a glTF file
  bool has_normals = false;  // from the file; otherwise the model's are computed from triangles
  MorphSet morphs;           // of a glTF file; otherwise none
};

// Reads OBJ according to the options, glTF (all meshes of its character, as krok-import
// --save-model does) and .model. Codes: morph-input (another kind of file), morph-empty (no
// triangles), and those of the readers.
Result<ShapeFile> read_shape(const std::string& path, const Options& options, ToolContext& context,
                             bool with_morphs = false);

// Checks that `shape` is a shape of the base's mesh: the same number of vertices and, without
// options.by_order, the same triangles in any order. Codes: morph-vertices, morph-triangles.
Status check_same_mesh(const ShapeFile& base, const ShapeFile& shape, const Options& options);

// Checks that targets match this base. Code morph-vertices.
Status check_vertices(const ShapeFile& base, const MorphSet& morphs, const std::string& path);

// Normals of a shape: its own, or else the base's, transformed with the surface.
std::vector<Vec3f> normals_for(const ShapeFile& base, const ShapeFile& shape);

// An .exr of morph targets and the file it came from.
struct TargetFile {
  InputFile file;
  MorphSet morphs;
};
Result<TargetFile> read_targets(const std::string& path, ToolContext& context);

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
