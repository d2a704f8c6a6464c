#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>

#include "formats/assimp/collada_text_internal.h"
#include "formats/assimp/conversion_internal.h"
#include "formats/assimp/max_3ds_file_internal.h"
#include "math/quaternion.h"

namespace krok::assimp {

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
