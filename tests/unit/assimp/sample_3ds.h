#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "unit/assimp/binary_text.h"
#include "unit/assimp/sample_rig.h"

// The rig's mesh as 3DS, by the format's description and without any library.

namespace krok::test {

inline std::string chunk(std::uint16_t id, const std::string& content) {
  return BinaryText()
      .put(id)
      .put(static_cast<std::uint32_t>(content.size() + 6))
      .append(content)
      .take();
}

// A mesh "body" that moves along x in three uneven keys (frames 0, 4 and 10), and a camera "eye" at
// (0, -5, 1) that looks at (0, 0, 1) through a lens of 50 mm, rolled by `roll` degrees. The mesh
// turns by `turns`, rotation vectors, each at the frame of its index and relative to the one
// before.
inline std::string max_3ds(float roll = 0.0f, const std::vector<Vec3>& turns = {Vec3::Zero()}) {
  BinaryText points, faces, matrix;
  points.put<std::uint16_t>(4);
  for (const Vec3& corner : corners()) points.vector(corner);
  faces.put<std::uint16_t>(2);
  for (const auto& triangle : corner_triangles()) {
    for (const int corner : triangle) faces.put(static_cast<std::uint16_t>(corner));
    faces.put<std::uint16_t>(7);
  }
  matrix.vector(Vec3::UnitX()).vector(Vec3::UnitY()).vector(Vec3::UnitZ()).vector({0, 0, 0});
  const std::string body =
      std::string("body\0", 5) +
      chunk(0x4100, chunk(0x4110, points.take()) + chunk(0x4120, faces.take()) +
                        chunk(0x4160, matrix.take()));
  const std::string eye =
      std::string("eye\0", 4) +
      chunk(0x4700, BinaryText().vector({0, -5, 1}).vector({0, 0, 1}).put(roll).put(50.0f).take());
  const std::string editor = chunk(0x3D3D, chunk(0x4000, body) + chunk(0x4000, eye));
  const auto track = [](const std::vector<std::pair<int, std::string>>& keys) {
    BinaryText out;
    out.put<std::uint16_t>(0).put<std::uint32_t>(0).put<std::uint32_t>(0);
    out.put(static_cast<std::uint32_t>(keys.size()));
    for (const auto& [frame, value] : keys) {
      out.put(static_cast<std::uint32_t>(frame)).put<std::uint16_t>(0).append(value);
    }
    return out.take();
  };
  const auto at = [](double x) { return BinaryText().vector({x, 0, 0}).take(); };
  std::vector<std::pair<int, std::string>> turned;
  for (const Vec3& turn : turns) {
    const Vec3 axis = turn.norm() > 0 ? Vec3(turn.normalized()) : Vec3::UnitZ();
    BinaryText key;
    key.put(static_cast<float>(turn.norm())).vector(axis);
    turned.emplace_back(static_cast<int>(turned.size()), key.take());
  }
  const std::string whole = BinaryText().vector({1, 1, 1}).take();
  const std::string node =
      chunk(0xB030, BinaryText().put<std::uint16_t>(0).take()) +
      chunk(0xB010, std::string("body\0", 5) +
                        BinaryText().put<std::uint32_t>(0).put<std::uint16_t>(0xFFFF).take()) +
      chunk(0xB013, BinaryText().vector({0, 0, 0}).take()) +
      chunk(0xB020, track({{0, at(0)}, {4, at(0.5)}, {10, at(2)}})) + chunk(0xB021, track(turned)) +
      chunk(0xB022, track({{0, whole}}));
  const std::string keyframer = chunk(0xB000, chunk(0xB002, node));
  return chunk(0x4D4D,
               chunk(0x0002, BinaryText().put<std::uint32_t>(3).take()) + editor + keyframer);
}

}  // namespace krok::test
