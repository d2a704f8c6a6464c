#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "blend/correspondence.h"
#include "blend/time_map.h"
#include "core/result.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "scene/motion_keys.h"

// Weighted blend of motions after time alignment: (1) the keytimes that the motions share define
// each motion's generic time; (2) the keytimes of the blend are the weighted sum of theirs;
// (3) each motion is sampled at the blend's generic time; (4) displacements are summed;
// (5) rotations are summed as quaternions, in one hemisphere, and normalised.

namespace krok::blend {

enum class Align : unsigned char {
  root,    // sums root motion per frame, relative to the character's heading, so that turns blend
  stance,  // as root, and joints in contact in all motions stay planted
  none     // sums poses in world space
};

struct BlendInput {
  std::string name;  // for messages
  const Clip* clip = nullptr;
  const MotionKeys* keys = nullptr;  // may be null; contacts serve Align::stance
  WeightCurve weight;
};

struct BlendOptions {
  Warp warp = Warp::pchip;
  Align align = Align::root;
  double rate = 0;       // frames per second; 0: that of the first motion
  bool any_sum = false;  // weights need not sum to 1 (a modifier)
  int jobs = 0;          // threads; 0: one per processor
};

struct Blended {
  Clip clip;        // skeleton of the first motion, without provenance
  MotionKeys keys;  // the shared keytimes without "begin" and "end", and the shared contacts
  std::vector<double> generic;             // [frames]
  std::vector<std::vector<double>> times;  // [motions x frames], seconds
  // The largest angle between the local rotations of a joint in two of the blended motions,
  // radians. Above 90 degrees the blend is not meaningful.
  double widest_spread = 0;
  int spread_joint = 0, spread_frame = 0;
};

// The blend starts at the weighted mean of the motions' start positions. All motions need the same
// skeleton: names, order and parents. Poses are summed from the hips down, whatever the root above
// them does (HipsRoot). Codes: blend-skeleton; blend-empty for no motions or a motion
// without frames; blend-sum if the weights do not sum to 1 within 1e-6 at some point and any_sum is
// not set; clip-rate, clip-too-long as resample(); those of check(Correspondence), of BlendTime,
// and of check(Clip) and check(MotionKeys).
Result<Blended> blend_clips(std::span<const BlendInput> inputs, const RoleMap& roles,
                            const Correspondence& correspondence, const BlendOptions& options);

// Blends of motions that do not fit in memory.

struct BlendSource {
  std::string name;  // for messages
  FrameSource frames;
  const MotionKeys* keys = nullptr;  // as in BlendInput; must outlive the result, if set
  WeightCurve weight;
};

struct BlendedFrames {
  FrameSource frames;  // to be read about in order
  // What blend_clips() gives besides, complete once the frames were read; of the clip the skeleton
  // and the rate alone.
  std::function<Blended()> done;
};

// As blend_clips() of the same motions. Each source is read once or twice beforehand, and where it
// is blended as the result is read. Kept are the times and the ground frames of all frames, about
// 100 bytes for each. Errors are those of blend_clips() and of the sources.
Result<BlendedFrames> blend_frames(std::span<const BlendSource> sources, const RoleMap& roles,
                                   const Correspondence& correspondence,
                                   const BlendOptions& options);

}  // namespace krok::blend
