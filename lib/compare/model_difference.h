#pragma once

#include <string>
#include <vector>

#include "compare/matching.h"
#include "compare/measure.h"
#include "core/result.h"
#include "scene/model.h"

namespace krok::compare {

// How far two models are apart. Vertices are matched by index, triangles in any order, joints as in
// ClipDifference; provenance does not matter.
struct ModelDifference {
  // What keeps the two from being the same whatever the tolerance: another skeleton, other numbers
  // of vertices, other triangles or parts, normals or the like that only one has. Sentences for
  // people. What can be measured all the same, is.
  std::vector<std::string> structure;

  Measure reference_positions, reference_orientations;  // of joints
  Measure positions;                                    // metres
  Measure normals;                                      // radians
  Measure texture_coordinates;                          // the larger of u and v
  Measure tangents;                                     // radians, of their directions
  Measure tangent_sides;  // 1 where the handedness is the other one, else 0; tolerance 0
  Measure weights;        // the largest of a vertex; place has the joint too
  std::vector<JointDifference> joints;

  bool same() const;
};

// An Error if one of the models fails its check(). Places carry vertices and joints of `first`.
Result<ModelDifference> difference(const Model& first, const Model& second,
                                   const Tolerance& tolerance,
                                   Matching matching = Matching::automatic);

}  // namespace krok::compare
