#pragma once

#include <string>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "scene/material.h"
#include "scene/model.h"
#include "scene/morph_set.h"
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

}  // namespace krok::cli::morph
