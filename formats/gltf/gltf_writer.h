#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "core/file.h"
#include "core/progress.h"
#include "core/result.h"
#include "formats/gltf/joint_tracks.h"
#include "scene/clip.h"
#include "scene/model.h"

// glTF 2.0 files, binary (GLB) or text with the data inside. Krok's frame is glTF's, so nothing is
// converted. Each function appends one whole file to an OutputFile to which nothing was written
// before; the caller commits. The same input gives the same bytes.
//
// Codes: gltf-empty-mesh, gltf-times, gltf-too-large, gltf-name, gltf-structure and those of
// check().

namespace krok::gltf {

struct WriteOptions {
  bool binary = true;  // GLB; otherwise text with a data URI
  // Recorded in asset.extras; its version goes into asset.generator.
  Provenance provenance;
  std::string name = "krok";  // of the mesh's node and of the animation
};

// A skeleton and its motion: a node a joint, in the reference pose; a skin that tells viewers that
// they are joints; an animation with a key at the time of each frame (none for a clip without
// frames). Shows nothing in a viewer that draws meshes only.
Status write_skeleton(const Clip& clip, const WriteOptions& options, OutputFile& file);

// A mesh for a viewer's own skinning: write_skeleton's content, the nodes in the model's reference
// pose, and the mesh with joints and weights at the root of the scene. The model's skeleton must
// have the clip's structure (code gltf-structure); bind_to of lib/skin makes it so.
Status write_rig(const Model& model, const Clip& clip, const WriteOptions& options,
                 OutputFile& file);

// The same of tracks that joint_tracks() has made of the motion, for `skeleton` and for the
// model's.
Status write_skeleton(const Skeleton& skeleton, const JointTracks& tracks,
                      const WriteOptions& options, OutputFile& file);
Status write_rig(const Model& model, const JointTracks& tracks, const WriteOptions& options,
                 OutputFile& file);

// The vertices of a model in some pose; lengths as Model has them.
struct MeshShape {
  std::span<const Vec3f> positions;
  std::span<const Vec3f> normals;   // or empty
  std::span<const Vec4f> tangents;  // or empty
};

// A mesh without a skeleton: the triangles, texture coordinates and parts of `model` with the
// vertices of `shape`.
Status write_mesh(const Model& model, const MeshShape& shape, const WriteOptions& options,
                  OutputFile& file);

// A motion as whole meshes. `shape_at` fills in the vertices of a frame (normals are empty where
// the model has none); it is called once for each frame, in order.
struct BakedMotion {
  int frames = 0;
  double rate = 30.0;
  std::function<void(int frame, std::span<Vec3f> positions, std::span<Vec3f> normals)> shape_at;
};

// A mesh whose morph targets are the frames after the first (the mesh itself is the first), with
// weights keyed so that at the time of a frame exactly that frame shows, and between two frames the
// linear blend of both.
Status write_baked(const Model& model, const BakedMotion& motion, const WriteOptions& options,
                   OutputFile& file, Progress* progress = nullptr);

// What a baked motion takes, to be judged before it is made: bytes of vertices and weights.
std::uint64_t baked_bytes(const Model& model, std::int64_t frames);

// Browsers (WebGL 2) hold morph targets in the layers of one texture; common hardware has this
// many.
inline constexpr int kMaxMorphTargets = 2048;

}  // namespace krok::gltf
