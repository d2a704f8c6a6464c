#pragma once

#include "formats/gltf/joint_tracks.h"
#include "scene/model.h"
#include "skin/mesh_error.h"

namespace krok::gltf {

// Fewer keys whose error is measured on the mesh that the tracks move: its vertices, at all frames
// and half-way between them.
struct MeshReduction {
  MeshError error;  // moment 2 f is frame f, 2 f + 1 half a frame later
  std::size_t keys_before = 0, keys_after = 0;
};

// Removes keys of tracks of all frames while no vertex of `model` moves by more than `tolerance`
// metres; rotations are of 16 bits after that if `short_rotations`. choose_keys() bounds the error
// of a sphere around each joint, with the radius of its vertices here, which is more than what a
// vertex between several joints moves by, or less for vertices far off. So its tolerance is
// searched for. Codes: reduce-tolerance, reduce-stretch (joints that change scale).
Result<MeshReduction> reduce_for_mesh(const Model& model, double tolerance, bool short_rotations,
                                      int jobs, JointTracks& tracks);

// The largest distance between the vertices of two models of one mesh, moved by tracks of the same
// frames, at the moments of MeshReduction.
MeshError mesh_error(const Model& a, const JointTracks& a_tracks, const Model& b,
                     const JointTracks& b_tracks, int jobs);

// Rotations rounded to the 16 bits a component that glTF may store, normalised as a viewer does.
void round_rotations(JointTracks& tracks);

}  // namespace krok::gltf
