#include "formats/assimp/run_assimp_internal.h"

#include <algorithm>
#include <array>

#include "core/bytes.h"
#include "core/text.h"

namespace krok::assimp {

namespace {

constexpr int kNoJoint = -1;

struct Vertex {
  std::array<int, 4> joints = {kNoJoint, kNoJoint, kNoJoint, kNoJoint};
  std::array<int, 3> weights = {0, 0, 0};  // of the first three; the fourth has the rest
};

struct Parts {
  std::vector<Vertex> vertices;
  std::vector<std::array<std::uint16_t, 3>> triangles;
  std::vector<std::vector<std::uint16_t>> groups;
};

std::string fixed_text(ByteReader& in, std::size_t size) {
  const std::string_view text = in.take_text(size);
  return to_utf8(text.substr(0, text.find('\0')));
}

void read_geometry(ByteReader& in, Parts& parts) {
  parts.vertices.resize(in.read<std::uint16_t>());
  for (Vertex& vertex : parts.vertices) {
    in.take(13);  // flags, position
    vertex.joints[0] = static_cast<int>(in.read<std::int8_t>());
    in.take(1);
    if (!in.ok()) return;
  }
  parts.triangles.resize(in.read<std::uint16_t>());
  for (auto& triangle : parts.triangles) {
    in.take(2);
    for (std::uint16_t& corner : triangle) corner = in.read<std::uint16_t>();
    in.take(62);  // normals, texture coordinates, smoothing group, group
    if (!in.ok()) return;
  }
  parts.groups.resize(in.read<std::uint16_t>());
  for (auto& group : parts.groups) {
    in.take(33);  // flags, name
    const std::size_t count = in.read<std::uint16_t>();
    if (count > in.remaining() / 2) in.seek(in.position() + in.remaining() + 1);
    if (!in.ok()) return;
    group.resize(count);
    for (std::uint16_t& triangle : group) triangle = in.read<std::uint16_t>();
    in.take(1);
  }
}

void skip_materials(ByteReader& in) {
  const std::size_t materials = in.read<std::uint16_t>();
  constexpr std::size_t kMaterialSize = 361;
  in.take(materials * kMaterialSize);
}

void read_joints(ByteReader& in, Ms3dFile& file) {
  const std::size_t count = in.read<std::uint16_t>();
  for (std::size_t j = 0; j < count && in.ok(); ++j) {
    in.take(1);
    file.joints.push_back(fixed_text(in, 32));
    in.take(32 + 24);  // parent, rotation, position
    const std::size_t rotations = in.read<std::uint16_t>();
    const std::size_t positions = in.read<std::uint16_t>();
    in.take((rotations + positions) * 16);
  }
}

// The section added by later versions: three lists of comments, one comment, then more joints and
// weights per vertex. If it is missing or truncated, each vertex has a single joint.
void read_extra_joints(ByteReader in, std::vector<Vertex>& vertices) {
  if (in.read<std::uint32_t>() != 1) return;
  for (int list = 0; list < 3; ++list) {
    const auto comments = in.read<std::uint32_t>();
    for (std::uint32_t c = 0; c < comments && in.ok(); ++c) {
      in.take(4);
      in.take(in.read<std::uint32_t>());
    }
  }
  if (in.read<std::uint32_t>() != 0) in.take(in.read<std::uint32_t>());
  const auto version = in.read<std::uint32_t>();
  if (!in.ok() || version < 1 || version > 3) return;
  const std::size_t each = 6 + 4 * (version - 1);
  if (in.remaining() / each < vertices.size()) return;
  for (Vertex& vertex : vertices) {
    for (std::size_t k = 1; k < 4; ++k) vertex.joints[k] = static_cast<int>(in.read<std::int8_t>());
    for (int& weight : vertex.weights) weight = in.read<std::uint8_t>();
    in.take(each - 6);
  }
}

// Weights are from 0 to 100; some exporters use 0 to 255.
int scale_of(const std::vector<Vertex>& vertices) {
  int largest = 0;
  for (const Vertex& vertex : vertices) {
    largest = std::max(largest, vertex.weights[0] + vertex.weights[1] + vertex.weights[2]);
  }
  return largest > 100 ? 255 : 100;
}

std::vector<Ms3dInfluence> influences_of(const Vertex& vertex, int scale, std::size_t joints) {
  std::vector<Ms3dInfluence> influences;
  const auto add = [&](int joint, int weight) {
    if (joint >= 0 && static_cast<std::size_t>(joint) < joints && weight > 0) {
      influences.push_back({joint, static_cast<float>(weight)});
    }
  };
  const auto& w = vertex.weights;
  if (w[0] == 0 && w[1] == 0 && w[2] == 0) {
    add(vertex.joints[0], scale);
  } else {
    for (std::size_t k = 0; k < 3; ++k) add(vertex.joints[k], w[k]);
    add(vertex.joints[3], scale - w[0] - w[1] - w[2]);
  }
  return influences;
}

}  // namespace

std::optional<Ms3dFile> read_ms3d(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  if (in.take_text(10) != "MS3D000000" || in.read<std::int32_t>() != 4) return std::nullopt;
  Parts parts;
  read_geometry(in, parts);
  skip_materials(in);
  Ms3dFile file;
  file.place_of_rate = in.position();
  file.rate = in.read<float>();
  in.take(8);  // current time, frames
  read_joints(in, file);
  if (!in.ok()) return std::nullopt;
  file.end_of_joints = in.position();
  read_extra_joints(in, parts.vertices);
  const int scale = scale_of(parts.vertices);
  for (const auto& group : parts.groups) {
    auto& corners = file.influences.emplace_back();
    for (const std::uint16_t triangle : group) {
      if (triangle >= parts.triangles.size()) return std::nullopt;
      for (const std::uint16_t corner : parts.triangles[triangle]) {
        if (corner >= parts.vertices.size()) return std::nullopt;
        corners.push_back(influences_of(parts.vertices[corner], scale, file.joints.size()));
      }
    }
  }
  return file;
}

}  // namespace krok::assimp
