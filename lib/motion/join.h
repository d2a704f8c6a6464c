#pragma once

#include "core/result.h"
#include "scene/clip.h"
#include "scene/frame_source.h"

namespace krok {

struct JoinOptions {
  // Seconds of overlap between the end of the first motion and the start of the second, cross-faded
  // with a smoothstep weight (3u^2 - 2u^3). 0: a hard cut; the first's last frame replaces the
  // second's first.
  double blend = 0.2;
  // Matches the second's height to the first's where they meet, as climbing needs. Otherwise both
  // keep their own floor.
  bool match_height = false;
  // The joint of the chest, which turns against the hips as people walk; -1: there is none.
  int chest = -1;
};

// `largest_angle` is the largest angle, in radians, between the two motions' rotations of a joint
// relative to its parent at `joint_frame`, before blending.
struct JoinSeam {
  int joint_frame = 0;  // the middle frame of the overlap
  int shared_frames = 1;
  double largest_angle = 0;
  int largest_joint = 0;
};

struct Joined : JoinSeam {
  Clip clip;
};

struct JoinedFrames : JoinSeam {
  FrameSource frames;
};

// The first motion and then the second, which is moved and turned on the ground so that the
// character stands and faces as the first does in the middle of what they share. People who walk
// straight on turn their hips with each step: how they face is a mean over 1.2 s, unless they turn
// there, or the two poses are alike, as those of one motion that was cut in two. The second is
// resampled to the first's rate. Without the shared time the durations add up: n and m frames give
// n + m - 1, less the shared steps. `carrier` is what carrying_joint() gives. Skeleton and
// provenance are the first's. A motion without frames adds nothing. A root above the hips does what
// it does in the motions, relative to the hips, or goes on standing where it stands in the first
// (HipsRoot).
//
// Codes: motion-skeleton where names, order or parents differ, or the reference poses' offsets of
// joints below the hips by more than a hundredth of the character's extent; motion-blend for a
// shared time that is negative or longer than one of the two; those of resample().
Result<Joined> join(const Clip& first, const Clip& second, int carrier, const JoinOptions& options);
// The same of frames that are produced on demand; they are read once or twice beforehand, and again
// when the result is read.
Result<JoinedFrames> join(const FrameSource& first, const FrameSource& second, int carrier,
                          const JoinOptions& options, int jobs);

}  // namespace krok
