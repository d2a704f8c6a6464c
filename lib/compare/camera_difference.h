#pragma once

#include <string>
#include <vector>

#include "compare/measure.h"
#include "core/result.h"
#include "scene/camera_track.h"

namespace krok::compare {

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

}  // namespace krok::compare
