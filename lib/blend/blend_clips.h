#pragma once

#include <span>
#include <string>
#include <vector>

#include "blend/correspondence.h"
#include "blend/time_map.h"
#include "core/result.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"

// A weighted sum of motions. What is added are poses that correspond in structure, not in clock
// time: (1) the moments that the motions have in common make each motion's generic time; (2) the
// blend's own moments are the weighted sum of theirs; (3) each motion is evaluated at the blend's
// generic time; (4) displacements are summed; (5) rotations are summed as quaternions, in one
// hemisphere, and normalised.

namespace krok::blend {

enum class Align : unsigned char {
  root,    // ways are summed step by step in the figure's own heading, so that turns blend
  stance,  // the same, and what stands by all motions' contacts stays where it stands
  none     // poses are summed where they are in the world
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
  double rate = 0;       // frames a second; 0: the first motion's
  bool any_sum = false;  // weights need not sum to 1 (a modifier)
  int jobs = 0;          // threads; 0: as many as processors
};

struct Blended {
  Clip clip;        // skeleton of the first motion, without provenance
  MotionKeys keys;  // the moments but for "begin" and "end", and the contacts common to all
  std::vector<double> generic;             // [frames]
  std::vector<std::vector<double>> times;  // [motions x frames], seconds
  // The largest angle between the rotations to the parent of a joint in two motions that are
  // summed, radians. Over 90 degrees a sum means little.
  double widest_spread = 0;
  int spread_joint = 0, spread_frame = 0;
};

// The figure begins where the motions do, each counted by its weight. Motions of one skeleton:
// names, order and parents are the same. Codes: blend-skeleton; blend-empty for no motion or one
// without frames; blend-sum where weights do not sum to 1 within 1e-6 at some point and any_sum is
// not set; clip-rate, clip-too-long as resample(); those of check(Correspondence), of BlendTime,
// and of check(Clip) and check(MotionKeys).
Result<Blended> blend_clips(std::span<const BlendInput> inputs, const RoleMap& roles,
                            const Correspondence& correspondence, const BlendOptions& options);

}  // namespace krok::blend
