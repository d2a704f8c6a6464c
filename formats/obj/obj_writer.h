#pragma once

#include <cstddef>
#include <string>

#include "core/file.h"
#include "core/result.h"
#include "scene/mesh_motion.h"
#include "scene/model.h"
#include "scene/provenance.h"

// Writes a model's mesh as Wavefront OBJ; for a motion, one file per frame.
//
// Codes: obj-empty-mesh, obj-shape and those of check(Model).

namespace krok::obj {

struct WriteOptions {
  Provenance provenance;      // tool and version go into a comment
  std::string name = "krok";  // of the object
};

// Writes one model in any number of shapes. Shared text is prepared once; the model need not
// outlive the call of create().
//
// Positions, normals and texture coordinates are written per vertex, in the model's order, so that
// a point cache of the model fits the mesh; in metres, +Y up, facing +Z. Numbers have enough digits
// to read back as the same float. Parts are groups with material names; no material file (.mtl) is
// referenced. Characters that would end a name become '_'.
class Writer {
 public:
  // Codes: obj-empty-mesh (no triangles) and those of check(Model).
  static Result<Writer> create(const Model& model, const WriteOptions& options);

  // Appends one whole file to `file`. Thread-safe for different files. The shape must have normals
  // if and only if the model has; tangents are not written. Code: obj-shape if the counts differ
  // from the model's, or a value is not finite.
  Status write(const MeshShape& shape, OutputFile& file) const;

 private:
  Writer() = default;
  std::size_t vertices_ = 0;
  bool normals_ = false;
  std::string head_, texture_coordinates_, faces_;
};

// A single file: create() and write().
Status write(const Model& model, const MeshShape& shape, const WriteOptions& options,
             OutputFile& file);

}  // namespace krok::obj
