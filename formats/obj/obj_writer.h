#pragma once

#include <cstddef>
#include <string>

#include "core/file.h"
#include "core/result.h"
#include "scene/mesh_motion.h"
#include "scene/model.h"
#include "scene/provenance.h"

// Wavefront OBJ files of a model's mesh. A motion is a file a frame.
//
// Codes: obj-empty-mesh, obj-shape and those of check(Model).

namespace krok::obj {

struct WriteOptions {
  Provenance provenance;      // tool and version go into a comment
  std::string name = "krok";  // of the object
};

// Writes files of one model in any number of shapes. What all of them share is made once; the
// model need not live on.
//
// Positions, normals and texture coordinates are lists of as many as the model has vertices, in its
// order, so that a point cache of the model fits the mesh; in metres, +Y up, facing +Z. Every
// number has the digits that give the same float when read. Parts are groups with their materials'
// names; no file of materials is named. Characters that would end a name become '_'.
class Writer {
 public:
  // Codes: obj-empty-mesh (no triangles) and those of check(Model).
  static Result<Writer> create(const Model& model, const WriteOptions& options);

  // Appends one whole file to `file`. May be called from several threads at once, for different
  // files. The shape needs normals where the model has them, and has none where it has none;
  // tangents are left out. Code obj-shape: other numbers of them than the model's, or one that is
  // not finite.
  Status write(const MeshShape& shape, OutputFile& file) const;

 private:
  Writer() = default;
  std::size_t vertices_ = 0;
  bool normals_ = false;
  std::string head_, texture_coordinates_, faces_;
};

// One file: create() and write().
Status write(const Model& model, const MeshShape& shape, const WriteOptions& options,
             OutputFile& file);

}  // namespace krok::obj
