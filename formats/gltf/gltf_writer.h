#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/progress.h"
#include "core/result.h"
#include "formats/gltf/joint_tracks.h"
#include "formats/gltf/quantize.h"
#include "math/transform.h"
#include "scene/character.h"
#include "scene/clip.h"
#include "scene/material.h"
#include "scene/mesh_motion.h"
#include "scene/model.h"
#include "scene/morph_set.h"

// Writes glTF 2.0, as GLB or as JSON with embedded data. Krok's axes and units are glTF's, so
// nothing is converted. Each function writes one whole file to an empty OutputFile; the caller
// commits. Output is deterministic.
//
// Codes: gltf-empty-mesh, gltf-morphs, gltf-times, gltf-too-large, gltf-name, gltf-structure and
// those of check().

namespace krok::gltf {

// A mesh that a joint carries, in the frame of a socket or of the joint.
struct Attached {
  std::string name;  // of the node; made unique
  int joint = 0;     // of the skeleton
  std::string
      socket{};  // the node below which it is, one of WriteOptions::sockets; empty: the joint
  const Model* mesh = nullptr;  // in its reference pose; its skeleton is not written
};

struct WriteOptions {
  bool binary = true;  // GLB; otherwise text with a data URI
  // Stored in asset.extras; its version goes into asset.generator.
  Provenance provenance;
  // Of the skin, and of the mesh of parts that name none: "krok_mesh".
  std::string name = "krok";
  std::string clip_name = {};  // of the animation; empty: `name`
  // Materials of the model's parts, by name, with image bytes; parts with other materials are light
  // grey. Must outlive the call. Textures need texture coordinates. Tangents are written where the
  // model has some; without them loaders compute those of a normal texture (glTF 2.0, 3.7.2.1).
  std::span<const Material> materials{};
  // Whether parts that name no material have none, which loaders show as white metal: as a glTF
  // file has it that is written again.
  bool unnamed_is_none = false;
  // Eye nodes as children of their joints, named like "left_eye"; write_rig only.
  std::span<const Character::Eye> eyes{};
  // Sockets as nodes below their joints, and meshes below joints or sockets; write_rig only.
  std::span<const Character::Socket> sockets{};
  std::span<const Attached> attached{};
  // For write_rig: vertices as integers of 16 bits, directions of 8 (KHR_mesh_quantization).
  std::optional<Quantization> quantized{};
  // For a GLB: buffer views encoded by meshoptimizer (EXT_meshopt_compression), without loss but
  // for filters (Quantization, JointTrack). Best after order_for_compression().
  bool compressed = false;
  // For write_rig and write_mesh: morph targets of the model and their weights over time (constant
  // if one frame), in the first animation. Code: gltf-morphs.
  const MorphSet* morphs = nullptr;
  const MorphWeights* weights = nullptr;  // of `morphs`, in its order
};

// One of the animations of a file.
struct NamedTracks {
  std::string name;
  const JointTracks* tracks = nullptr;    // of the file's skeleton; none if it has no times
  const MorphWeights* weights = nullptr;  // of its frames, for WriteOptions::morphs; or null
};

// A skeleton and its motion: one node per joint, in the reference pose; a skin that marks them as
// joints; an animation with one key per frame (none for a clip without frames). Nothing is visible
// in viewers that draw only meshes.
Status write_skeleton(const Clip& clip, const WriteOptions& options, OutputFile& file);

// A skinned mesh: the content of write_skeleton, with the nodes in the model's reference pose, and
// the mesh with joints and weights at the scene root; parts in a row that name different meshes
// (Model::Part::mesh) become meshes of these names. The skeletons of
// model and clip must have the same structure (code gltf-structure); see bind_to in lib/skin.
Status write_rig(const Model& model, const Clip& clip, const WriteOptions& options,
                 OutputFile& file);

// As above, with the result of joint_tracks() for `skeleton` or for the model's skeleton.
Status write_skeleton(const Skeleton& skeleton, const JointTracks& tracks,
                      const WriteOptions& options, OutputFile& file);
Status write_rig(const Model& model, const JointTracks& tracks, const WriteOptions& options,
                 OutputFile& file);

// As above, with several animations.
Status write_skeleton(const Skeleton& skeleton, std::span<const NamedTracks> clips,
                      const WriteOptions& options, OutputFile& file);
Status write_rig(const Model& model, std::span<const NamedTracks> clips,
                 const WriteOptions& options, OutputFile& file);

// Makes one of the vertices of which the file would hold the same, and reorders them, and triangles
// within parts, so that compression finds neighbours near each other. `morphs` may have no targets.
// Returns the new place of each vertex.
std::vector<std::uint32_t> order_for_compression(Model& model, MorphSet& morphs,
                                                 const std::optional<Quantization>& quantization);

// A mesh without a skeleton: triangles, texture coordinates and parts of `model`, vertices of
// `shape`, which must be the model's own shape if there are morph targets.
Status write_mesh(const Model& model, const MeshShape& shape, const WriteOptions& options,
                  OutputFile& file);

// An animated mesh without a skeleton, in the shape of the first frame, with one morph target for
// each further frame. Weights are keyed so that each frame is shown exactly at its time, with
// linear blending in between.
//
// Vertices are streamed into the file: memory holds a few frames, plus some kilobytes of JSON per
// frame. With `jobs` other than 1 (as in parallel_for) frames are computed while others are
// written; the bytes are the same. A GLB to a stream (see OutputFile) computes all frames twice,
// because the bounds of all frames precede the vertices.
//
// Codes besides those above: gltf-structure for a motion without frames or a vertex that
// is not finite.
Status write_baked(const Model& model, const MeshMotion& motion, const WriteOptions& options,
                   OutputFile& file, Progress* progress = nullptr, int jobs = 1);

// Bytes of vertices and weights of a baked motion, for checking its size before writing. Includes
// tangents if `materials` need them.
std::uint64_t baked_bytes(const Model& model, std::int64_t frames,
                          std::span<const Material> materials = {});

// Max bytes of binary data that the writers put into a file (code gltf-too-large): GLB lengths have
// 32 bits, and some room is left for the JSON.
inline constexpr std::uint64_t kMaxDataBytes =
    (std::uint64_t{4} << 30) - (std::uint64_t{256} << 20);

// WebGL 2 viewers store morph targets in the layers of a texture array; this is a common limit.
inline constexpr int kMaxMorphTargets = 2048;

// A mesh with vertex colours, in scene coordinates (metres).
struct ColouredMesh {
  std::string name;  // of the node; made unique
  std::span<const Vec3f> positions;
  std::span<const Vec3f> normals;                           // [vertices] or empty
  std::span<const Vec3f> colours;                           // [vertices], linear RGB, 0 .. 1
  std::span<const std::array<std::uint32_t, 3>> triangles;  // empty: drawn as points
  std::string mesh_name{};                                  // if not that of the node
};

// Writes static meshes with vertex colours (COLOR_0) and a white, rough, lit material called
// `material`. Meshes without vertices are skipped. Codes: gltf-empty-mesh if none remains,
// gltf-too-large, gltf-name, gltf-value for values that are not finite.
Status write_coloured(std::span<const ColouredMesh> meshes, const std::string& material,
                      const WriteOptions& options, OutputFile& file);

}  // namespace krok::gltf
