#pragma once

#include <string>
#include <vector>

#include "compare/matching.h"
#include "compare/material_difference.h"
#include "compare/measure.h"
#include "core/progress.h"
#include "core/result.h"
#include "scene/scene.h"

// Compares two animated scenes by what a viewer shows: both are evaluated at the same times, and
// vertices and joints are compared in world space. A rig can thus be compared with the same motion
// baked into morph targets.

namespace krok::compare {

struct SceneOptions {
  Tolerance tolerance;
  Matching matching = Matching::automatic;  // of meshes, joints and morph targets
  bool keep_vertices = false;               // fill vertex_largest
  bool materials = false;                   // count different materials as a difference
  ImageDistance images{};                   // without it textures are compared by their bytes
};

// One quantity at one time. Floats, because there can be a million moments.
struct MomentValue {
  float largest = 0;
  float rms = 0;
  int mesh = -1;  // location of the largest; -1 for joints
  int item = -1;  // vertex or joint
  bool in_second = false;
};

struct MomentDifference {
  int animation = -1;  // in the first; -1 for the pose without animation
  int frame = -1;      // the first's last key time up to here; -1 without animation
  double time = 0;     // seconds
  MomentValue positions, normals, tangents, joint_positions, joint_orientations;
};

// A mesh over all times.
struct PartDifference {
  int mesh = -1;
  bool in_second = false;  // a mesh of the second, compared with the first (Matching::nearest)
  Measure positions, normals, tangents, tangent_sides;
};

struct SceneDifference {
  // Differences that no tolerance covers: meshes, vertices, triangles, joints or animations that do
  // not correspond. Readable sentences. Whatever can still be measured is.
  std::vector<std::string> structure;
  // Differences that do not count: joints that only one has if the other is baked, key times, and
  // materials unless SceneOptions::materials is set.
  std::vector<std::string> notes;

  int compared_times = 0;  // times at which both were evaluated, over all animations
  Measure positions;       // metres, world space
  Measure normals;         // radians, world space
  Measure tangents;        // radians, of directions, where both have tangents
  Measure tangent_sides;   // 1 if the handedness differs, else 0; tolerance 0
  Measure joint_positions, joint_orientations;
  Measure target_positions;     // metres: morph target displacements, where both have them
  Measure target_normals;       // the same, in lengths of the normals, no unit
  Measure target_tangents;      // the same of tangents
  Measure texture_coordinates;  // max of u and v, of all sets that both have
  Measure colours;  // max of the channels of vertex colours; within any tolerance unless
                    // SceneOptions::materials is set
  Measure weights;  // skin weights, where both have a skin
  Measure times;    // seconds: key times matched to each other
  // With nearest points, differences of vertices are lower bounds: a vertex may have moved along
  // the other surface.
  bool at_least = false;

  std::vector<MomentDifference> moments;  // in order of comparison
  std::vector<PartDifference> parts;      // of the meshes compared
  std::vector<JointDifference> joints;    // of the joints compared

  // [meshes of the first][vertices]: max distance over all times, metres. Empty for meshes that
  // were not compared; empty altogether unless requested.
  std::vector<std::vector<float>> vertex_largest;

  bool same() const;
};

// Compares each pair of animations (by name, those without a namesake in their order; by index if
// one has no name or with Matching::order) at the key times of both, for as long as both last;
// times within the tolerance are merged. Between key times, also at the ends of the parts of
// KeyGap, and just before steps. Without animations, compares the static pose. A skinned scene can
// be compared with one without joints; joints are then skipped. Nodes without a mesh, cameras and
// lights are compared by their places and properties, by name where all have one, as are extras.
// Normals or texture coordinates that only one mesh has are a difference of structure; so are
// tangents if both materials have a normal texture, and further texture coordinates if a texture
// uses them, otherwise they are a note. Different numbers of morph targets are a note if one mesh
// is a bake of the other's motion. Two meshes with the same triangles differ if one shows their
// backs. Deterministic for any number of jobs. Another name of an animation (not of a bake) or
// (with `materials`) a material is a difference except with Matching::order (an animation's also
// with Matching::nearest); of a mesh it is a note, a difference by Matching::name. Codes:
// compare-value if a scene has values that are not finite, compare-too-long for more than a million
// moments.
//
// The pose without animation is compared where both have animations and joints: another one is a
// difference of structure.
//
// With Matching::nearest, all meshes of a scene are one surface if they cannot be matched by name.
// Nearest points are found at the first time compared; after that each moves with its triangle. If
// several surfaces touch there, or come within the tolerance (or four times the median distance, in
// a mesh that is coarser overall), the one that stays closest is used, of those the one with the
// closest normal, the same side and material, and the closest tangents and texture coordinates. A
// mesh without triangles is a point cloud. Of parts that touch, a vertex is held against the one on
// its own joints. Triangles are sampled inside, too, in both directions: what has no counterpart
// there, a hole, is a difference of structure. Vertices that lie on the back of the other's
// triangles, or on another material, are reported with their count. Morph targets and weights
// themselves are not compared, only their effect.
Result<SceneDifference> difference(const Scene& first, const Scene& second,
                                   const SceneOptions& options, int jobs, Progress& progress);

}  // namespace krok::compare
