#pragma once

#include <string>

#include "core/result.h"
#include "scene/model.h"
#include "scene/morph_set.h"
#include "tools/common/tool.h"
#include "tools/krok-morph/options.h"

namespace krok::morph {

enum class Source { obj, gltf, model };

// A mesh in some shape, from a file of any kind that holds one.
struct ShapeFile {
  std::string path;
  Source source = Source::model;
  Model model;
  bool has_normals = false;  // of its own; otherwise the model's are made from its triangles
  MorphSet morphs;           // those within a glTF file; otherwise none
};

// Reads OBJ as the options say, glTF (all meshes of its character, as krok-import --model takes
// them) and .model. Codes: morph-input (another kind of file), morph-empty (no triangles), and
// those of the readers.
Result<ShapeFile> read_shape(const std::string& path, const Options& options, ToolContext& context,
                             bool with_morphs = false);

// Whether `shape` is another shape of the base's mesh: as many vertices and, without
// options.by_order, the same triangles, in any order. Codes: morph-vertices, morph-triangles.
Status check_same_mesh(const ShapeFile& base, const ShapeFile& shape, const Options& options);

// Whether targets are of this base. Code morph-vertices.
Status check_vertices(const ShapeFile& base, const MorphSet& morphs, const std::string& path);

// The normals of a shape of the base: its own, or else the base's moved as its surface is.
std::vector<Vec3f> normals_for(const ShapeFile& base, const ShapeFile& shape);

}  // namespace krok::morph
