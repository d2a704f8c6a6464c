#include "motion/ground_frame.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "math/euler.h"

namespace krok {

Transform GroundFrame::to_world() const {
  return {Vec3(x, 0, z), axis_rotation(Axis::y, heading)};
}

int carrying_joint(const RoleMap& roles) {
  return std::max(0, roles.joint(Role::hips));
}

GroundFrame ground_frame(const Skeleton& skeleton, int carrier, const Transform& carrier_to_world) {
  const Quat& reference = skeleton.reference[static_cast<std::size_t>(carrier)].orientation;
  const Quat turn = carrier_to_world.orientation * reference.conjugate();
  // Swing-twist decomposition: the twist about an axis is the quaternion's part along it. It is
  // undefined upside down by exactly half a turn.
  const double heading =
      turn.y() == 0 && turn.w() == 0 ? 0 : wrapped(2 * std::atan2(turn.y(), turn.w()));
  return {carrier_to_world.position.x(), carrier_to_world.position.z(), heading};
}

GroundFrame ground_frame(const Clip& clip, int carrier, int frame) {
  const auto c = static_cast<std::size_t>(carrier);
  return ground_frame(clip.skeleton, carrier,
                      {clip.frame_positions(frame)[c].cast<double>(),
                       clip.frame_orientations(frame)[c].cast<double>().normalized()});
}

double wrapped(double angle) {
  return std::remainder(angle, 2 * kPi);
}

std::vector<int> foot_joints(const Skeleton& skeleton, const RoleMap& roles) {
  std::vector<int> feet;
  std::vector<std::uint8_t> of_foot(skeleton.names.size(), 0);
  for (std::size_t j = 0; j < of_foot.size(); ++j) {
    const Role role = roles.roles[j];
    const int parent = skeleton.parents[j];
    of_foot[j] = role == Role::left_foot || role == Role::right_foot || role == Role::left_toes ||
                 role == Role::right_toes ||
                 (role == Role::end && parent >= 0 && of_foot[static_cast<std::size_t>(parent)]);
    if (of_foot[j]) feet.push_back(static_cast<int>(j));
  }
  if (feet.empty()) {
    feet.resize(of_foot.size());
    std::iota(feet.begin(), feet.end(), 0);
  }
  return feet;
}

std::vector<std::uint8_t> subtree(const Skeleton& skeleton, int joint) {
  std::vector<std::uint8_t> within(skeleton.names.size(), 0);
  within[static_cast<std::size_t>(joint)] = 1;
  for (std::size_t j = static_cast<std::size_t>(joint) + 1; j < within.size(); ++j) {
    const int parent = skeleton.parents[j];
    if (parent >= 0) within[j] = within[static_cast<std::size_t>(parent)];
  }
  return within;
}

}  // namespace krok
