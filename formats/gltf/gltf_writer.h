#pragma once

#include <span>
#include <string>

#include "core/file.h"
#include "core/result.h"
#include "formats/gltf/joint_tracks.h"
#include "scene/character.h"
#include "scene/clip.h"
#include "scene/material.h"
#include "scene/mesh_motion.h"
#include "scene/model.h"
#include "scene/morph_set.h"

// glTF 2.0 files, binary (GLB) or text with the data inside. Krok's frame is glTF's, so nothing is
// converted. Each function appends one whole file to an OutputFile to which nothing was written
// before; the caller commits. The same input gives the same bytes.
//
// Codes: gltf-empty-mesh, gltf-morphs, gltf-times, gltf-too-large, gltf-name, gltf-structure and
// those of check().

namespace krok::gltf {

struct WriteOptions {
  bool binary = true;  // GLB; otherwise text with a data URI
  // Recorded in asset.extras; its version goes into asset.generator.
  Provenance provenance;
  std::string name = "krok";  // of the mesh's node and of the animation
  // Of the model's parts, by name, with the pictures' bytes; parts of other materials are light
  // grey. They and what they hold must live until the file is written. Textures need texture
  // coordinates, normal textures tangents too, which are made where the model has none; in baked
  // clips where the motion has none, normal textures are left out.
  std::span<const Material> materials{};
  // Become nodes under their joints, named as "left_eye"; by write_rig alone.
  std::span<const Character::Eye> eyes{};
  // For write_rig and write_mesh: morph targets of the model's vertices, and how much of each shows
  // over time (of one frame: always), in the same animation as the joints. Codes: gltf-morphs.
  const MorphSet* morphs = nullptr;
  const MorphWeights* weights = nullptr;  // of `morphs`, in its order
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

// A mesh without a skeleton: the triangles, texture coordinates and parts of `model` with the
// vertices of `shape`, which is the model's own where there are morph targets.
Status write_mesh(const Model& model, const MeshShape& shape, const WriteOptions& options,
                  OutputFile& file);

}  // namespace krok::gltf
