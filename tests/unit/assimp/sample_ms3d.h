#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "unit/assimp/binary_text.h"
#include "unit/assimp/sample_rig.h"

// The rig as MilkShape MS3D, by the format's description and without any library.

namespace krok::test {

// The frames are at 0, 0.1, 0.4 and 0.6 s. A key is relative to the joint's rest: rest * key is the
// joint's transform.
inline std::string ms3d(const MovingRig& rig, bool weights = true, float rate = 25.0f) {
  BinaryText out;
  out.text("MS3D000000", 10).put<std::int32_t>(4);
  out.put<std::uint16_t>(4);
  for (std::size_t c = 0; c < 4; ++c) {
    out.put<std::uint8_t>(0).vector(corners()[c]);
    out.put(static_cast<std::int8_t>(corner_weights()[c][0].first)).put<std::uint8_t>(1);
  }
  out.put<std::uint16_t>(2);
  for (const auto& triangle : corner_triangles()) {
    out.put<std::uint16_t>(0);
    for (const int corner : triangle) out.put(static_cast<std::uint16_t>(corner));
    for (int k = 0; k < 3; ++k) out.vector({0, 0, 1});
    for (int k = 0; k < 3; ++k) out.put(0.25f);
    for (int k = 0; k < 3; ++k) out.put(0.75f);
    out.put<std::uint8_t>(1).put<std::uint8_t>(0);
  }
  out.put<std::uint16_t>(1).put<std::uint8_t>(0).text("body", 32);
  out.put<std::uint16_t>(2).put<std::uint16_t>(0).put<std::uint16_t>(1).put<std::int8_t>(0);
  out.put<std::uint16_t>(1).text("skin", 32);
  for (int k = 0; k < 18; ++k) out.put(0.5f);
  out.put<std::uint8_t>(0).text("", 256);
  out.put(rate).put(0.0f).put<std::int32_t>(16);
  out.put(static_cast<std::uint16_t>(rig.names.size()));
  const float times[] = {0.0f, 0.1f, 0.4f, 0.6f};
  for (std::size_t j = 0; j < rig.names.size(); ++j) {
    const Transform rest = rig.rest[j].transform();
    out.put<std::uint8_t>(0).text(rig.names[j], 32);
    out.text(j == 0 ? "" : rig.names[static_cast<std::size_t>(rig.parents[j])], 32);
    out.vector(rig.rest[j].angles).vector(rig.rest[j].translation);
    out.put(static_cast<std::uint16_t>(rig.frames.size()));
    out.put(static_cast<std::uint16_t>(rig.frames.size()));
    std::string positions;
    for (std::size_t f = 0; f < rig.frames.size(); ++f) {
      const Transform key = rest.inverse() * rig.frames[f][j].transform();
      const Vec3 zyx = key.orientation.toRotationMatrix().eulerAngles(2, 1, 0);
      out.put(times[f]).vector({zyx[2], zyx[1], zyx[0]});
      positions += BinaryText().put(times[f]).vector(key.position).take();
    }
    out.append(positions);
  }
  if (!weights) return out.take();
  // No groups', materials' and joints' comments but one of the model.
  out.put<std::uint32_t>(1).put<std::uint32_t>(0).put<std::uint32_t>(0).put<std::uint32_t>(0);
  out.put<std::uint32_t>(1).put<std::uint32_t>(5).text("hello", 5);
  out.put<std::uint32_t>(2);
  for (const auto& list : corner_weights()) {
    for (std::size_t k = 1; k < 4; ++k) {
      out.put(static_cast<std::int8_t>(k < list.size() ? list[k].first : -1));
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const double weight = k < list.size() ? list[k].second : 0.0;
      out.put(static_cast<std::uint8_t>(std::lround(weight * 100)));
    }
    out.put<std::uint32_t>(0);
  }
  return out.take();
}

}  // namespace krok::test
