#pragma once

#include "formats/gltf/joint_tracks.h"
#include "scene/model.h"
#include "scene/morph_set.h"
#include "skin/mesh_error.h"

namespace krok::gltf {

// Fewer keys whose error is measured on the mesh that the tracks move: its vertices, at all frames
// and half-way between them.
struct MeshReduction {
  MeshError error;  // moment 2 f is frame f, 2 f + 1 half a frame later
  std::size_t keys_before = 0, keys_after = 0;
};

// A mesh as tracks move it, and its morph targets with their weights in each frame of the tracks;
// null where shapes do not change.
struct TrackedMesh {
  const Model& model;
  const MorphSet* morphs = nullptr;
  const MorphWeights* weights = nullptr;
};

struct MeshReduceOptions {
  double tolerance = 1e-4;  // metres, > 0
  bool short_keys = false;  // may store keys with fewer bits, see JointTrack
  bool filtered = false;    // see rounded()
};

// Gives joints the rest values that they keep, nearly, in the largest number of clips of one
// skeleton, for the fewest tracks; all get tracks of all frames. `tolerance` in metres, on the
// mesh. Nothing if a joint changes scale.
void choose_rest(const Model& model, double tolerance, std::span<JointTracks> clips);

// Removes keys of tracks of all frames, and bits of those that stay, while no vertex of `kept`,
// what is left of `model`, is further than the tolerance from that of `model` with all keys.
// Joints without vertices keep their place and rotation within a few times the tolerance (about
// four at most) at 3 cm from them, for what is attached there. With `short_keys` and `filtered`,
// what keys leave of the tolerance goes into fewer bits. choose_keys() bounds the error of a sphere
// around each joint, with the radius of its vertices here, which is more than what a vertex between
// several joints moves by, or less for vertices far off. So its tolerance is searched for. All keys
// are kept where `kept` alone is further off. Codes: reduce-tolerance, reduce-stretch (joints that
// change scale).
Result<MeshReduction> reduce_for_mesh(const TrackedMesh& model, const TrackedMesh& kept,
                                      const MeshReduceOptions& options, int jobs,
                                      JointTracks& tracks);

// The largest distance between the vertices of two models of one mesh, moved by tracks of the same
// frames, at the moments of MeshReduction.
MeshError mesh_error(const TrackedMesh& a, const JointTracks& a_tracks, const TrackedMesh& b,
                     const JointTracks& b_tracks, int jobs);
MeshError mesh_error(const TrackedMesh& a, const JointTracks& a_tracks, const ShownMesh& b,
                     int jobs);

}  // namespace krok::gltf
