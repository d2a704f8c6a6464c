#pragma once

#include <string>

#include "support/human_skeleton.h"

namespace krok::test {

// A toy soldier's proportions, on the same joints: 1.08 m tall, hips 0.34 m apart on legs of 0.38
// m, in long boots with ankles at 0.145 m.
inline Skeleton chibi_skeleton() {
  Skeleton skeleton = human_skeleton(1.2);
  const Vec3 lower(0, 0.52 - skeleton.reference[0].position.y() + 0.024, 0);
  for (Transform& joint : skeleton.reference) joint.position += lower;
  for (const double side : {1.0, -1.0}) {
    const auto put = [&](const char* joint, double y, double z) {
      const std::string name = (side > 0 ? "Left" : "Right") + std::string(joint);
      skeleton.reference[static_cast<std::size_t>(skeleton.find(name))].position =
          Vec3(0.17 * side, y, z);
    };
    put("UpLeg", 0.52, 0);
    put("Leg", 0.292, 0.008);
    put("Foot", 0.145, -0.019);
    put("ToeBase", 0.026, 0.096);
    put("ToeBase_end", 0.026, 0.17);
  }
  return skeleton;
}

}  // namespace krok::test
