#pragma once

#include <span>
#include <string>
#include <vector>

#include "compare/matching.h"
#include "compare/measure.h"
#include "core/result.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "scene/stretch.h"

namespace krok::compare {

// Difference of two clips, joint by joint in world space. Provenance is ignored.
struct ClipDifference {
  // Differences that no tolerance covers: another skeleton (then nothing is measured), other frame
  // counts or rates. Readable sentences.
  std::vector<std::string> structure;
  std::vector<std::string> notes;  // what differences may come of

  // Number of frames compared: all if the rates are equal (see match_frames); frame by frame if
  // only the rates differ; otherwise frames whose times agree within a thousandth of a frame.
  int compared_frames = 0;

  Measure reference_positions, reference_orientations;  // metres, radians
  Measure positions, orientations;
  // Of joints that are stretched in one of the clips: the Frobenius norm of what Stretch::matrix()
  // differs by, 0.1 where one axis is 10 % longer; tolerance `ratio`.
  Measure stretches;
  std::vector<JointDifference> joints;  // over the frames that were compared

  bool same() const {
    return structure.empty() && reference_positions.within() && reference_orientations.within() &&
           positions.within() && orientations.within() && stretches.within();
  }
};

// An Error if a clip fails its check() (for example, a value that is not finite); its file is
// empty, its message says "the first" or "the second". Locations have joints and frames of `first`.
//
// Joints are matched by name, or by index if names repeat. Matching::order always matches by index;
// Matching::name compares the joints that both have even if others are missing; Matching::nearest
// is the same as Matching::automatic.
//
// Stretches are [frames x joints] of their clip, or none for rigid joints.
Result<ClipDifference> difference(const Clip& first, const Clip& second, const Tolerance& tolerance,
                                  Matching matching = Matching::automatic,
                                  std::span<const Stretch> first_stretches = {},
                                  std::span<const Stretch> second_stretches = {});

// The same for frames that are made on demand, on `jobs` threads, which do not affect the result;
// memory does not grow with their number. The errors of the sources are passed on.
Result<ClipDifference> difference(const FrameSource& first, const FrameSource& second,
                                  const Tolerance& tolerance,
                                  Matching matching = Matching::automatic,
                                  std::span<const Stretch> first_stretches = {},
                                  std::span<const Stretch> second_stretches = {}, int jobs = 1);

}  // namespace krok::compare
