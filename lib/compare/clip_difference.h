#pragma once

#include <string>
#include <vector>

#include "compare/matching.h"
#include "compare/measure.h"
#include "core/result.h"
#include "scene/clip.h"

namespace krok::compare {

// How far two clips are apart, joint by joint in world space. Provenance does not matter.
struct ClipDifference {
  // What keeps the two from being the same whatever the tolerance: another skeleton (then nothing
  // was measured), other numbers of frames or rates. Sentences for people.
  std::vector<std::string> structure;

  // Frames that stand at the same time in both: all, where the rates are the same (see
  // match_frames); frame by frame, where only the rates differ; otherwise those whose times agree
  // within a thousandth of a frame.
  int compared_frames = 0;

  Measure reference_positions, reference_orientations;  // metres, radians
  Measure positions, orientations;
  std::vector<JointDifference> joints;  // over all frames, those that were compared

  bool same() const {
    return structure.empty() && reference_positions.within() && reference_orientations.within() &&
           positions.within() && orientations.within();
  }
};

// An Error if one of the clips fails its check() (a value that is not finite, say); the error's
// file is empty, its message says "the first" or "the second". Places carry joints and frames of
// `first`.
//
// Joints are matched by name, so their order does not matter, or by place where names repeat;
// Matching::order takes their place whatever the names; Matching::name compares those that both
// have where others are missing. Matching::nearest is Matching::automatic.
Result<ClipDifference> difference(const Clip& first, const Clip& second, const Tolerance& tolerance,
                                  Matching matching = Matching::automatic);

}  // namespace krok::compare
