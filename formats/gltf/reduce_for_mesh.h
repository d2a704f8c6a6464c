#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/gltf/gltf_writer.h"
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

// Morph weights with fewer keys: frames between which they are straight lines, off by at most
// `slack` [targets]; with `bits` of 8 or 16 rounded to what normalized whole numbers hold, if all
// are from -1 to 1. A writer finds these keys again. [frames] as before
MorphWeights on_keys(const MorphWeights& weights, std::span<const float> slack, int bits);
// The frames of these keys, the first and the last among them.
std::vector<std::size_t> weight_keys(const MorphWeights& weights, std::span<const float> slack);

// The largest distance between the vertices of two models of one mesh, moved by tracks of the same
// frames, at the moments of MeshReduction.
MeshError mesh_error(const TrackedMesh& a, const JointTracks& a_tracks, const TrackedMesh& b,
                     const JointTracks& b_tracks, int jobs);
MeshError mesh_error(const TrackedMesh& a, const JointTracks& a_tracks, const ShownMesh& b,
                     int jobs);

// A rig before anything was lost.
struct OriginalRig {
  const Model& model;
  const MorphSet& morphs;
  std::span<const NamedTracks> clips;  // of all frames
};

// What write_rig() was given for it, but for what is lost.
struct WrittenRig {
  const Model& model;                     // its triangles are read
  std::span<const std::uint32_t> places;  // see order_for_compression(); empty: unchanged
};

struct WrittenError {
  MeshError error;  // the vertex is the original's
  std::size_t clip = 0;
};

// The largest distance of a vertex of the original from where the file at `path` shows it, read and
// evaluated as a loader does: at all frames of all clips and half-way between them (between two
// moments both sides are nearly straight lines, whose distance is largest at an end). Vertices
// without a triangle are not compared. Codes: those of read_file(); gltf-mesh if the file does not
// have the rig's triangles.
Result<WrittenError> written_error(const std::string& path, const OriginalRig& original,
                                   const WrittenRig& written, int jobs);

}  // namespace krok::gltf
