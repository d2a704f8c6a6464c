#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "core/bytes.h"
#include "core/text.h"
#include "formats/assimp/collada_text_internal.h"
#include "formats/assimp/conversion_internal.h"
#include "math/quaternion.h"
#include "math/transform.h"

namespace krok::assimp {

namespace {

// Reads what Assimp 5.2 reads incorrectly from 3DS files. Sources: lib3ds; M. van Velsen, "3D
// Studio File Format (3ds)".

struct Max3dsCamera {
  Vec3 position = Vec3::Zero();  // Z-up
  Vec3 target = Vec3::Zero();
  double roll = 0;   // radians, about the view direction
  double lens = 50;  // millimetres

  // Radians, by 3D Studio's formula.
  double horizontal_field_of_view() const { return 2400.0 / lens * kRadiansPerDegree; }
};

constexpr std::uint16_t kMain = 0x4D4D;
constexpr std::uint16_t kEditor = 0x3D3D;
constexpr std::uint16_t kObject = 0x4000;
constexpr std::uint16_t kCamera = 0x4700;

struct Chunk {
  std::uint16_t id = 0;
  std::span<const std::byte> content;
};

// The next chunk, truncated to the available bytes; `in` is not ok() if there is none.
Chunk take_chunk(ByteReader& in) {
  constexpr std::uint32_t kHeader = 6;
  Chunk chunk;
  chunk.id = in.read<std::uint16_t>();
  const auto size = in.read<std::uint32_t>();
  if (!in.ok() || size < kHeader) {
    in.seek(in.position() + in.remaining() + 1);
    return {};
  }
  chunk.content = in.take(std::min<std::size_t>(size - kHeader, in.remaining()));
  return chunk;
}

template <typename Use>
void for_each_chunk(std::span<const std::byte> bytes, std::uint16_t id, Use use) {
  ByteReader in(bytes);
  while (in.remaining() > 0) {
    const Chunk chunk = take_chunk(in);
    if (!in.ok()) return;
    if (chunk.id == id) use(chunk.content);
  }
}

Vec3 take_vector(ByteReader& in) {
  Vec3 vector;
  for (int k = 0; k < 3; ++k) vector[k] = static_cast<double>(in.read<float>());
  return vector;
}

// By name; unreadable cameras are skipped.
std::map<std::string, Max3dsCamera> read_3ds_cameras(std::span<const std::byte> bytes) {
  std::map<std::string, Max3dsCamera> cameras;
  const auto read_camera = [&](const std::string& name, std::span<const std::byte> content) {
    ByteReader in(content);
    Max3dsCamera camera;
    camera.position = take_vector(in);
    camera.target = take_vector(in);
    camera.roll = static_cast<double>(in.read<float>()) * kRadiansPerDegree;
    camera.lens = static_cast<double>(in.read<float>());
    const bool finite = camera.position.allFinite() && camera.target.allFinite() &&
                        std::isfinite(camera.roll) && std::isfinite(camera.lens);
    if (in.ok() && finite && camera.lens > 0) cameras.emplace(name, camera);
  };
  const auto read_object = [&](std::span<const std::byte> content) {
    const auto end = std::find(content.begin(), content.end(), std::byte{0});
    if (end == content.end()) return;
    const auto size = static_cast<std::size_t>(end - content.begin());
    const std::string name = to_utf8({reinterpret_cast<const char*>(content.data()), size});
    for_each_chunk(content.subspan(size + 1), kCamera,
                   [&](std::span<const std::byte> camera) { read_camera(name, camera); });
  };
  for_each_chunk(bytes, kMain, [&](std::span<const std::byte> main) {
    for_each_chunk(main, kEditor, [&](std::span<const std::byte> editor) {
      for_each_chunk(editor, kObject, read_object);
    });
  });
  return cameras;
}

}  // namespace

using namespace nodes;
using registry::Kind;

namespace {

// The rotation that takes -Z to `forward` and +Y as close to `up` as possible.
Quat look_rotation(const Vec3& forward, const Vec3& up) {
  const Vec3 back = -forward.normalized();
  Vec3 right = up.cross(back);
  if (right.norm() < 1e-6) return shortest_arc(-Vec3::UnitZ(), forward);
  right.normalize();
  Mat3 axes;
  axes << right, back.cross(right), back;
  return normalized_or_identity(Quat(axes));
}

// The camera's position and orientation in its node's space.
struct View {
  Vec3 position = Vec3::Zero();
  Vec3 forward = -Vec3::UnitZ();
  Vec3 up = Vec3::UnitY();
};

// A 3DS camera is in world space, Z-up, and rolls about its view direction.
View view_of(const Max3dsCamera& camera) {
  View view;
  view.position = camera.position;
  const Vec3 forward = camera.target - camera.position;
  if (forward.norm() < 1e-9) return view;
  view.forward = forward.normalized();
  const Vec3 upright = Vec3::UnitZ() - view.forward * view.forward.z();
  view.up = upright.norm() < 1e-6 ? Vec3(Vec3::UnitY()) : Vec3(upright.normalized());
  view.up = Eigen::AngleAxisd(camera.roll, view.forward) * view.up;
  return view;
}

View view_of(const aiCamera& camera, Kind kind) {
  View view;
  // 3ds Max cameras look along -Z; for ASE, Assimp leaves its default, +Z.
  if (kind == Kind::ase) return view;
  view.position = to_vector(camera.mPosition);
  view.forward = to_vector(camera.mLookAt);
  view.up = to_vector(camera.mUp);
  if (!view.position.allFinite()) view.position.setZero();
  if (!view.forward.allFinite() || view.forward.norm() < 1e-9) view.forward = -Vec3::UnitZ();
  if (!view.up.allFinite() || view.up.norm() < 1e-9) view.up = Vec3::UnitY();
  return view;
}

// An angle; nullopt if it is not valid.
std::optional<double> sensible(double angle) {
  if (angle > 1e-3 && angle < kPi - 1e-3) return angle;
  return std::nullopt;
}

// For COLLADA cameras, Assimp 5.2 mostly gives a wrong value, pi / 4 interpreted as degrees.
bool is_collada_default(const Conversion& to, const aiCamera& camera) {
  const double wrong = kPi / 4 * kRadiansPerDegree;
  return to.kind == Kind::collada &&
         std::abs(static_cast<double>(camera.mHorizontalFOV) - wrong) < 1e-6;
}

// Vertical, radians.
std::optional<double> vertical_field_of_view(Conversion& to, const aiCamera& camera,
                                             const Max3dsCamera* lens,
                                             const std::map<std::string, double>& of_collada,
                                             const std::string& name) {
  constexpr double kUsualAspect = 4.0 / 3.0;
  if (is_collada_default(to, camera)) {
    const auto own = of_collada.find(to_text(camera.mName));
    if (own != of_collada.end()) return sensible(own->second * kRadiansPerDegree);
    return std::nullopt;
  }
  const auto across = lens != nullptr ? sensible(lens->horizontal_field_of_view())
                                      : sensible(static_cast<double>(camera.mHorizontalFOV));
  if (!across) return std::nullopt;
  auto aspect = static_cast<double>(camera.mAspect);
  if (!(aspect > 1e-3 && aspect < 1e3)) {
    aspect = kUsualAspect;
    to.note("assimp-camera-aspect",
            fmt::format("the file has no aspect ratio for camera '{}'; 4:3 is assumed, its "
                        "horizontal field of view is {:.4g} degrees",
                        name, *across / kRadiansPerDegree));
  }
  return 2 * std::atan(std::tan(*across / 2) / aspect);
}

bool is_moved(const aiScene& scene, const aiString& node) {
  for (unsigned a = 0; a < scene.mNumAnimations; ++a) {
    for (unsigned c = 0; c < scene.mAnimations[a]->mNumChannels; ++c) {
      if (scene.mAnimations[a]->mChannels[c]->mNodeName == node) return true;
    }
  }
  return false;
}

}  // namespace

// Lights, cameras that are left out or in the world, and the targets that 3ds Max aims cameras at.
void mark_fixtures(Conversion& to) {
  const auto mark = [&](const std::string& name) {
    const auto found = to.node_by_name.find(name);
    if (found != to.node_by_name.end()) {
      to.scene.nodes[static_cast<std::size_t>(found->second)].fixture = true;
    }
  };
  for (unsigned k = 0; k < to.source.mNumLights; ++k) mark(to_text(to.source.mLights[k]->mName));
  for (unsigned k = 0; k < to.source.mNumCameras; ++k) {
    const std::string name = to_text(to.source.mCameras[k]->mName);
    mark(name);
    mark(name + ".Target");
  }
}

void convert_cameras(Conversion& to) {
  // Assimp 5.2 interprets the lens of 3DS cameras as an angle and uses a wrong up vector for roll.
  std::map<std::string, Max3dsCamera> of_3ds;
  if (to.kind == Kind::max_3ds) of_3ds = read_3ds_cameras(std::as_bytes(std::span(to.text)));
  std::map<std::string, double> of_collada;
  if (to.kind == Kind::collada && to.source.mNumCameras > 0) {
    of_collada = collada_fields_of_view(to.text);
  }
  for (unsigned c = 0; c < to.source.mNumCameras; ++c) {
    const aiCamera& source = *to.source.mCameras[c];
    Camera camera;
    camera.name = to_text(source.mName);
    const auto found = to.node_by_name.find(camera.name);
    const auto own = of_3ds.find(camera.name);
    const bool in_world = own != of_3ds.end();  // regardless of its node
    if (!in_world && found == to.node_by_name.end()) {
      to.warn("assimp-camera", fmt::format("camera '{}' has no node and is left out", camera.name));
      continue;
    }
    if (to.kind == Kind::max_3ds && is_moved(to.source, source.mName)) {
      to.warn("assimp-camera",
              fmt::format("camera '{}' is animated and is left out: Assimp does not read the "
                          "orientation of such 3DS cameras",
                          camera.name));
      continue;
    }
    const auto angle = vertical_field_of_view(to, source, in_world ? &own->second : nullptr,
                                              of_collada, camera.name);
    if (!angle) {
      to.warn("assimp-camera",
              fmt::format("camera '{}' has an invalid field of view and is left out", camera.name));
      continue;
    }
    camera.field_of_view = *angle;
    const View view = in_world ? view_of(own->second) : view_of(source, to.kind);
    const Quat rotation = look_rotation(view.forward, view.up);
    int node = in_world ? 0 : found->second;
    const bool moved = view.position.norm() > 0 || angle_between(rotation, Quat::Identity()) > 1e-6;
    if (moved || to.scene.nodes[static_cast<std::size_t>(node)].camera != -1) {
      Node extra;
      extra.name = camera.name + "_camera";
      extra.parent = node;
      extra.translation = view.position;
      extra.rotation = rotation;
      node = static_cast<int>(to.scene.nodes.size());
      to.scene.nodes.push_back(std::move(extra));
    }
    to.scene.nodes[static_cast<std::size_t>(node)].camera =
        static_cast<int>(to.scene.cameras.size());
    to.scene.cameras.push_back(std::move(camera));
  }
}

}  // namespace krok::assimp
