#pragma once

#include <string>
#include <vector>

#include "compare/matching.h"
#include "compare/measure.h"
#include "core/result.h"
#include "scene/camera_track.h"
#include "scene/model.h"
#include "scene/morph_set.h"

namespace krok::compare {

// Difference of two models. Vertices are matched by index, triangles in any order, joints as in
// ClipDifference; provenance is ignored.
struct ModelDifference {
  // Differences that no tolerance covers: another skeleton, other vertex counts, triangles or
  // parts, attributes such as normals that only one has. Readable sentences. Whatever can still be
  // measured is.
  std::vector<std::string> structure;

  Measure reference_positions, reference_orientations;  // of joints
  Measure positions;                                    // metres
  Measure normals;                                      // radians
  Measure texture_coordinates;                          // max of u and v, of all sets
  Measure colours;                                      // max of red, green, blue, alpha
  Measure tangents;                                     // radians, of their directions
  Measure tangent_sides;  // 1 if the handedness differs, else 0; tolerance 0
  Measure weights;        // max per vertex; the location includes the joint
  std::vector<JointDifference> joints;

  bool same() const;
};

// An Error if a model fails its check(). Locations have vertices and joints of `first`.
Result<ModelDifference> difference(const Model& first, const Model& second,
                                   const Tolerance& tolerance,
                                   Matching matching = Matching::automatic);

// Difference of two cameras; frames are matched as in ClipDifference.
struct CameraDifference {
  std::vector<std::string> structure;
  int compared_frames = 0;
  Measure positions;       // metres
  Measure orientations;    // radians
  Measure fields_of_view;  // radians

  bool same() const {
    return structure.empty() && positions.within() && orientations.within() &&
           fields_of_view.within();
  }
};

// An Error if a camera fails its check().
Result<CameraDifference> difference(const CameraTrack& first, const CameraTrack& second,
                                    const Tolerance& tolerance);

// Difference of two sets of morph targets. Vertices are matched by index; provenance is ignored.
struct MorphDifference {
  // Differences that no tolerance covers: other vertex counts (then nothing is measured), targets
  // or normals that only one has. Readable sentences.
  std::vector<std::string> structure;

  int compared_targets = 0;
  Measure positions;  // metres
  Measure normals;    // radians

  bool same() const { return structure.empty() && positions.within() && normals.within(); }
};

// Targets are matched by index for Matching::order, else by name. An Error if a set fails its
// check(). Locations have targets and vertices of `first`.
Result<MorphDifference> difference(const MorphSet& first, const MorphSet& second,
                                   const Tolerance& tolerance,
                                   Matching matching = Matching::automatic);

}  // namespace krok::compare
