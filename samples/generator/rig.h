#pragma once

#include <cstdint>

#include "scene/clip.h"

// The same motion on the rigs that captures come with.

namespace krok::samples {

enum class Rig : std::uint8_t {
  hips,         // the hips are the root
  static_root,  // the hips carry the motion below a root that stands at the origin
  ground_root,  // the root slides along on the ground below the hips and turns with them
  lying         // the hips are the root, and the reference pose lies on its back
};

// `clip` has the hips as its root and an upright reference pose facing +Z. Joints keep their names,
// order and world transforms; a root is put in front of them, called "Reference". The reference
// pose of Rig::lying is for a file whose reader stands it up.
Clip with_rig(const Clip& clip, Rig rig);

}  // namespace krok::samples
