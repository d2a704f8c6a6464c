#pragma once

#include <string>
#include <vector>

#include "compare/matching.h"
#include "compare/measure.h"
#include "compare/scene.h"
#include "core/progress.h"
#include "core/result.h"

// Comparing two animated scenes by what a viewer shows: both are evaluated at the same moments, and
// vertices and joints compared in world space. So a rig can be held against the same motion baked
// into morph targets.

namespace krok::compare {

struct SceneOptions {
  Tolerance tolerance;
  Matching matching = Matching::automatic;  // of meshes, joints and morph targets
  bool keep_vertices = false;               // whether vertex_largest is wanted
  bool materials = false;                   // whether other materials are a fault
};

// One quantity at one moment. Floats, since there may be a million moments.
struct MomentValue {
  float largest = 0;
  float rms = 0;
  int mesh = -1;  // where the largest is; -1 for joints
  int item = -1;  // vertex or joint
  bool in_second = false;
};

struct MomentDifference {
  int animation = -1;  // of the first; -1 for the pose without any
  int frame = -1;      // counted from 0 in each animation; -1 for the pose without any
  double time = 0;     // seconds
  MomentValue positions, normals, tangents, joint_positions, joint_orientations;
};

// A mesh over all moments.
struct PartDifference {
  int mesh = -1;
  bool in_second = false;  // one of the second's, against the first (Matching::nearest)
  Measure positions, normals, tangents, tangent_sides;
};

struct SceneDifference {
  // What keeps the two from being the same whatever the tolerance: meshes, vertices, triangles,
  // joints or animations that do not correspond. Sentences for people. What can be measured all the
  // same, is.
  std::vector<std::string> structure;
  // What differs but is no fault: joints that only one has where the other is baked, key times,
  // and materials unless SceneOptions::materials makes them one.
  std::vector<std::string> notes;

  int compared_times = 0;  // moments at which both were evaluated, of all animations together
  Measure positions;       // metres, world space
  Measure normals;         // radians, world space
  Measure tangents;        // the same of their directions, where both have them
  Measure tangent_sides;   // 1 where the handedness is the other one, else 0; tolerance 0
  Measure joint_positions, joint_orientations;
  Measure target_positions;     // metres: displacements by morph targets, where both have them
  Measure target_normals;       // length of the difference of normals' displacements, no unit
  Measure target_tangents;      // the same of tangents
  Measure texture_coordinates;  // the larger of u and v
  Measure weights;              // of skins, where both have one
  Measure times;                // seconds: key times that are one moment

  std::vector<MomentDifference> moments;  // in the order in which they were compared
  std::vector<PartDifference> parts;      // of the meshes that were compared
  std::vector<JointDifference> joints;    // of the joints that were compared

  // [meshes of the first][their vertices]: the largest distance over all moments, metres. Empty for
  // a mesh that was not compared; empty altogether unless asked for.
  std::vector<std::vector<float>> vertex_largest;

  bool same() const;
};

// Each pair of animations (by name where all names of both are unique and the same, otherwise by
// place) is compared at the key times of both, times within the tolerance being one, as far as both
// last; without animations the pose without any is compared. A scene whose meshes are skinned may
// be held against one without joints: joints are then not compared. Normals or texture coordinates
// that only one mesh has are a difference of structure; so are tangents where the materials of both
// have a normal texture, which shows them, and otherwise a note. An Error (code compare-value) if a
// scene gives values that are not finite, (code compare-too-long) for more than a million moments.
// Deterministic for any number of jobs.
//
// With Matching::nearest, all meshes of each are one surface where they cannot be matched by name.
// The nearest points are found at the first moment that is compared and kept: each moves with its
// triangle. Where several surfaces touch there, the one that stays closest is taken. A mesh without
// triangles is the points of its vertices. Shapes and weights themselves are not compared, only
// what they make.
Result<SceneDifference> difference(const Scene& first, const Scene& second,
                                   const SceneOptions& options, int jobs, Progress& progress);

}  // namespace krok::compare
