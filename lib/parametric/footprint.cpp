#include "parametric/footprint.h"

#include <algorithm>
#include <cmath>

#include "contacts/legs.h"
#include "math/quaternion.h"
#include "math/window.h"
#include "motion/hips_root.h"

namespace krok::parametric {

namespace {

constexpr double kUpright = 1e-3;  // of the horizontal part of a unit vector
constexpr double kClimb = 0.15;    // of the leg length, between the heights of contacts

// The up direction in the foot's frame, for frames with both heel and ball in contact.
void add_flat_frames(const ClipContacts& given, FootSide side, int joint, std::vector<Vec3>& ups) {
  if (given.contacts == nullptr) return;
  const Clip& clip = *given.clip;
  std::vector<std::uint8_t> heel(static_cast<std::size_t>(clip.frame_count()), 0), front = heel;
  for (const Stay& stay : given.contacts->stays) {
    const SolePoint& point = given.contacts->tracks[static_cast<std::size_t>(stay.track)].point;
    if (point.side != side) continue;
    auto& marks = point.part == FootPart::heel ? heel : front;
    const int first = std::max(0, static_cast<int>(std::ceil(stay.start * clip.rate)));
    const int last =
        std::min(clip.frame_count() - 1, static_cast<int>(std::floor(stay.end * clip.rate)));
    for (int f = first; f <= last; ++f) marks[static_cast<std::size_t>(f)] = 1;
  }
  for (int f = 0; f < clip.frame_count(); ++f) {
    if (heel[static_cast<std::size_t>(f)] && front[static_cast<std::size_t>(f)]) {
      ups.emplace_back(joint_at(clip, f, joint).orientation.conjugate() * Vec3::UnitY());
    }
  }
}

// Whether contacts are at different heights, as on a slope, where a flat foot is tilted.
bool climbs(const ClipContacts& given) {
  if (given.contacts == nullptr || given.contacts->stays.empty()) return false;
  const auto [low, high] = std::ranges::minmax_element(
      given.contacts->stays, {}, [](const Stay& stay) { return stay.place.y(); });
  return high->place.y() - low->place.y() > kClimb * given.contacts->leg_length;
}

Vec3 level(const Vec3& v, const Vec3& up) {
  return v - up * up.dot(v);
}

// From the foot joint to the front of the foot, in the foot's frame.
Vec3 front_of(const Skeleton& skeleton, const SolePoint& front, int foot) {
  if (front.joint == foot) return front.offset;
  const Transform& from = skeleton.reference[static_cast<std::size_t>(foot)];
  return from.inverse() * skeleton.reference[static_cast<std::size_t>(front.joint)].position;
}

}  // namespace

Transform Footprint::to_world() const {
  return {place, axis_rotation(Axis::y, heading)};
}

Vec3 ball_of(const FootShape& foot) {
  return foot.heel + foot.length * foot.forward;
}

Footprint footprint(const FootShape& foot, const Transform& foot_to_world) {
  const Vec3 forward = foot_to_world.orientation * foot.forward;
  Footprint print;
  print.place = foot_to_world * foot.heel;
  if (std::hypot(forward.x(), forward.z()) < kUpright) return print;
  print.heading = std::atan2(forward.x(), forward.z());
  if (forward.y() < 0) {
    print.place += foot.length * (forward - axis_rotation(Axis::y, print.heading) * Vec3::UnitZ());
  }
  return print;
}

Result<std::array<FootShape, 2>> find_foot_shapes(std::span<const ClipContacts> clips,
                                                  const RoleMap& roles) {
  std::array<FootShape, 2> shapes;
  const bool has_level = !std::ranges::all_of(clips, climbs);
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    FootShape& shape = shapes[static_cast<std::size_t>(side)];
    std::vector<Vec3> heels, fronts, ups;
    for (const ClipContacts& given : clips) {
      if (has_level && climbs(given)) continue;
      const Feet feet = find_feet(*given.clip, roles);
      const auto& points = feet.points[static_cast<std::size_t>(side)];
      if (points.empty()) continue;
      shape.joint = points.front().joint;
      heels.push_back(points.front().offset);
      if (points.size() > 1) {
        fronts.push_back(front_of(given.clip->skeleton, points[1], shape.joint));
      }
      add_flat_frames(given, side, shape.joint, ups);
    }
    if (shape.joint < 0) {
      return Error("parametric-feet", "the skeleton has no known feet",
                   "assign its feet with --map");
    }
    const Skeleton& skeleton = clips.front().clip->skeleton;
    const Quat world_to_foot =
        skeleton.reference[static_cast<std::size_t>(shape.joint)].orientation.conjugate();
    const Vec3 at_reference = world_to_foot * Vec3::UnitY();
    const Vec3 above = ups.empty() ? at_reference : median_point(ups);
    const Vec3 upward = above.norm() > 0.1 ? Vec3(above.normalized()) : at_reference;
    shape.heel = median_point(heels);
    Vec3 forward = fronts.empty() ? Vec3::Zero() : level(median_point(fronts) - shape.heel, upward);
    if (forward.norm() > 1e-3) {
      shape.length = forward.norm();
    } else {
      forward = level(world_to_foot * Vec3::UnitZ(), upward);
    }
    shape.forward =
        forward.norm() > 1e-6 ? Vec3(forward.normalized()) : Vec3(upward.unitOrthogonal());
  }
  return shapes;
}

namespace {

constexpr double kShortestWay = 0.2;  // metres, of two steps
constexpr std::size_t kFewestPrints = 3;

}  // namespace

std::array<double, 2> toe_out_of(std::span<const std::vector<WalkPrint>> walks) {
  std::array<std::vector<double>, 2> angles;
  for (const auto& prints : walks) {
    for (std::size_t i = 1; i + 1 < prints.size(); ++i) {
      const WalkPrint &before = prints[i - 1], &here = prints[i], &after = prints[i + 1];
      if (before.side == here.side || after.side == here.side) continue;
      const Vec3 way = after.print.place - before.print.place;
      if (std::hypot(way.x(), way.z()) < kShortestWay) continue;
      const double angle = wrapped(here.print.heading - std::atan2(way.x(), way.z()));
      // Not of steps to the side or backwards.
      if (std::abs(angle) > kPi / 3) continue;
      angles[static_cast<std::size_t>(here.side)].push_back(angle);
    }
  }
  std::array<double, 2> result{};
  for (std::size_t s = 0; s < 2; ++s) {
    if (angles[s].size() < kFewestPrints) return {};
    const auto middle = angles[s].begin() + static_cast<std::ptrdiff_t>(angles[s].size() / 2);
    std::ranges::nth_element(angles[s], middle);
    result[s] = *middle;
  }
  return result;
}

}  // namespace krok::parametric
