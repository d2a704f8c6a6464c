#include <algorithm>
#include <bit>
#include <cmath>

#include "core/text.h"
#include "draw/pack_motion_internal.h"

namespace krok::draw {

namespace {

static_assert(std::endian::native == std::endian::little, "typed arrays of browsers are so");

// Changes below these are rounding errors, not motion.
constexpr double kStillLength = 2e-5;  // metres
constexpr double kStillAngle = 2e-5;   // radians, half of what packing rounds to

constexpr double kComponentLimit = 0.70710678118654752;
constexpr double kPackedSteps = 32767.0;

constexpr std::size_t kNarrowCorners = 65536;  // vertices; the page has the same limit

// joint_to_parent of all frames, and which joints move.
struct Locals {
  std::vector<Transform> first;     // [joints]: the reference pose's, or the first frame's
  std::vector<std::uint8_t> turns;  // [joints]
  std::vector<std::uint8_t> moves;
};

void local_frame(const Clip& clip, int frame, std::vector<Transform>& world,
                 std::vector<Transform>& local) {
  clip.get_pose(frame, world);
  world_to_local(clip.skeleton.parents, world, local);
}

Locals find_changes(const Clip& clip) {
  const auto joints = static_cast<std::size_t>(clip.joint_count());
  Locals result;
  result.turns.assign(joints, 0);
  result.moves.assign(joints, 0);
  if (clip.frame_count() == 0) {
    for (int joint = 0; joint < clip.joint_count(); ++joint) {
      result.first.push_back(clip.skeleton.reference_local(joint));
    }
    return result;
  }
  std::vector<Transform> world(joints), local(joints);
  local_frame(clip, 0, world, local);
  result.first = local;
  for (int frame = 1; frame < clip.frame_count(); ++frame) {
    local_frame(clip, frame, world, local);
    for (std::size_t joint = 0; joint < joints; ++joint) {
      const Transform& first = result.first[joint];
      if ((local[joint].position - first.position).norm() > kStillLength) result.moves[joint] = 1;
      if (local[joint].orientation.angularDistance(first.orientation) > kStillAngle) {
        result.turns[joint] = 1;
      }
    }
  }
  return result;
}

std::vector<int> places_of(const std::vector<std::uint8_t>& marks) {
  std::vector<int> places;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (marks[i] != 0) places.push_back(static_cast<int>(i));
  }
  return places;
}

void push(std::vector<float>& values, const Vec3& vector) {
  for (int axis = 0; axis < 3; ++axis) values.push_back(static_cast<float>(vector[axis]));
}

void push(std::vector<float>& values, const Quat& rotation) {
  for (int i = 0; i < 4; ++i) values.push_back(static_cast<float>(rotation.coeffs()[i]));
}

}  // namespace

std::string Blob::base64() const {
  return to_base64(bytes_);
}

std::array<std::uint16_t, 3> pack_rotation(const Quat& rotation) {
  const auto& value = rotation.coeffs();
  int largest = 0;
  for (int i = 1; i < 4; ++i) {
    if (std::abs(value[i]) > std::abs(value[largest])) largest = i;
  }
  const double sign = value[largest] < 0 ? -1.0 : 1.0;
  std::array<std::uint16_t, 3> words{};
  std::size_t at = 0;
  for (int i = 0; i < 4; ++i) {
    if (i == largest) continue;
    const double share = (sign * value[i] / kComponentLimit + 1.0) / 2.0;
    words[at++] =
        static_cast<std::uint16_t>(std::lround(std::clamp(share, 0.0, 1.0) * kPackedSteps));
  }
  const auto left_out = static_cast<unsigned>(largest);
  words[0] = static_cast<std::uint16_t>(words[0] | (left_out & 1U) << 15);
  words[1] = static_cast<std::uint16_t>(words[1] | (left_out >> 1) << 15);
  return words;
}

Quat unpack_rotation(const std::array<std::uint16_t, 3>& words) {
  const int left_out = words[0] >> 15 | (words[1] >> 15) << 1;
  Quat rotation;
  double rest = 1.0;
  std::size_t at = 0;
  for (int i = 0; i < 4; ++i) {
    if (i == left_out) continue;
    const double value = ((words[at++] & 0x7fff) / kPackedSteps * 2.0 - 1.0) * kComponentLimit;
    rotation.coeffs()[i] = value;
    rest -= value * value;
  }
  rotation.coeffs()[left_out] = std::sqrt(std::max(rest, 0.0));
  return rotation;
}

void pack_motion(const Clip& clip, Json& item, Blob& blob) {
  const Skeleton& skeleton = clip.skeleton;
  const Locals changes = find_changes(clip);
  const std::vector<int> turning = places_of(changes.turns);
  const std::vector<int> moving = places_of(changes.moves);

  item["rate"] = clip.rate;
  item["frames"] = clip.frame_count();
  item["joints"] = skeleton.names;
  item["parents"] = skeleton.parents;
  item["endSites"] = places_of(skeleton.end_sites);
  pack_drawn_bones(find_drawn_bones(clip, changes.moves), item);
  std::vector<float> offsets, orientations;
  for (const Transform& local : changes.first) {
    push(offsets, local.position);
    push(orientations, local.orientation);
  }
  std::vector<float> rest;
  for (int joint = 0; joint < clip.joint_count(); ++joint) {
    push(rest, skeleton.reference_local(joint).orientation);
  }
  item["rest"] = blob.add<float>(rest);
  item["offsets"] = blob.add<float>(offsets);
  item["referenceRotations"] = blob.add<float>(orientations);

  const auto joints = static_cast<std::size_t>(clip.joint_count());
  const auto frames = static_cast<std::size_t>(clip.frame_count());
  std::vector<Transform> world(joints), local(joints);
  std::vector<std::uint16_t> rotations;
  std::vector<float> translations;
  rotations.reserve(frames * turning.size() * 3);
  translations.reserve(frames * moving.size() * 3);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    local_frame(clip, frame, world, local);
    for (const int joint : turning) {
      const auto words = pack_rotation(local[static_cast<std::size_t>(joint)].orientation);
      rotations.insert(rotations.end(), words.begin(), words.end());
    }
    for (const int joint : moving) {
      push(translations, local[static_cast<std::size_t>(joint)].position);
    }
  }
  item["turning"] = turning;
  item["rotations"] = blob.add<std::uint16_t>(rotations);
  item["moving"] = moving;
  item["translations"] = blob.add<float>(translations);
}

Json pack_body(const Model& body, Blob& blob) {
  const auto vertices = static_cast<std::size_t>(body.vertex_count());
  std::vector<float> positions;
  std::vector<std::int8_t> normals(vertices * 4, 0);
  std::vector<std::uint16_t> joints(vertices * 4, 0);
  std::vector<std::uint8_t> weights(vertices * 4, 0);
  positions.reserve(vertices * 3);
  const auto influences = static_cast<std::size_t>(body.influences_per_vertex);
  const std::size_t kept = std::min<std::size_t>(4, influences);
  for (std::size_t v = 0; v < vertices; ++v) {
    push(positions, body.positions[v].cast<double>());
    for (int axis = 0; axis < 3 && !body.normals.empty(); ++axis) {
      normals[v * 4 + static_cast<std::size_t>(axis)] =
          static_cast<std::int8_t>(std::lround(body.normals[v][axis] * 127.0F));
    }
    // Weights are in descending order, so the first four are the largest; the first takes the
    // rounding remainder.
    int left = 255;
    float sum = 0.0F;
    for (std::size_t k = 0; k < kept; ++k) sum += body.influence_weights[v * influences + k];
    for (std::size_t k = 0; k < kept; ++k) {
      const float share = body.influence_weights[v * influences + k] / std::max(sum, 1e-9F);
      const int weight = std::min(left, static_cast<int>(std::lround(share * 255.0F)));
      weights[v * 4 + k] = static_cast<std::uint8_t>(weight);
      joints[v * 4 + k] = body.influence_joints[v * influences + k];
      left -= weight;
    }
    weights[v * 4] = static_cast<std::uint8_t>(weights[v * 4] + left);
  }
  std::vector<float> reference;
  for (const Transform& joint : body.skeleton.reference) {
    push(reference, joint.position);
    push(reference, joint.orientation);
  }
  const std::span<const std::uint32_t> corners(
      body.triangles.empty() ? nullptr : body.triangles.front().data(), body.triangles.size() * 3);
  const bool narrow = vertices <= kNarrowCorners;
  const std::vector<std::uint16_t> narrow_corners =
      narrow ? std::vector<std::uint16_t>(corners.begin(), corners.end())
             : std::vector<std::uint16_t>();
  Json result;
  result["positions"] = blob.add<float>(positions);
  result["normals"] = blob.add<std::int8_t>(normals);
  result["joints"] = blob.add<std::uint16_t>(joints);
  result["weights"] = blob.add<std::uint8_t>(weights);
  result["triangles"] =
      narrow ? blob.add<std::uint16_t>(narrow_corners) : blob.add<std::uint32_t>(corners);
  result["reference"] = blob.add<float>(reference);
  return result;
}

void pack_camera(const CameraTrack& camera, Json& item, Blob& blob) {
  std::vector<float> positions, orientations;
  for (int frame = 0; frame < camera.frame_count(); ++frame) {
    const auto at = static_cast<std::size_t>(frame);
    push(positions, camera.positions[at].cast<double>());
    push(orientations, camera.orientations[at].cast<double>());
  }
  item["rate"] = camera.rate;
  item["frames"] = camera.frame_count();
  item["cuts"] = camera.cuts;
  item["positions"] = blob.add<float>(positions);
  item["orientations"] = blob.add<float>(orientations);
  item["fieldsOfView"] = blob.add<float>(camera.fields_of_view);
}

}  // namespace krok::draw
