#include "timeline/actor_pose.h"

#include "math/euler.h"

namespace krok::timeline {

ActorPose actor_pose(const Skeleton& skeleton, int carrier,
                     std::span<const Transform> joint_to_world) {
  ActorPose pose;
  pose.place = ground_frame(skeleton, carrier, joint_to_world[static_cast<std::size_t>(carrier)]);
  pose.local.resize(joint_to_world.size());
  world_to_local(skeleton.parents, joint_to_world, pose.local);
  pose.local[0] = pose.place.to_world().inverse() * pose.local[0];
  return pose;
}

void to_world(const Skeleton& skeleton, const ActorPose& pose,
              std::span<Transform> joint_to_world) {
  std::copy(pose.local.begin(), pose.local.end(), joint_to_world.begin());
  joint_to_world[0] = pose.place.to_world() * pose.local[0];
  local_to_world(skeleton.parents, joint_to_world, joint_to_world);
}

GroundFrame combined(const GroundFrame& first, const GroundFrame& second) {
  const Vec3 there = first.to_world() * Vec3(second.x, 0, second.z);
  return {there.x(), there.z(), first.heading + second.heading};
}

GroundFrame inverse(const GroundFrame& place) {
  const Vec3 back = axis_rotation(Axis::y, -place.heading) * Vec3(-place.x, 0, -place.z);
  return {back.x(), back.z(), -place.heading};
}

Vec3 as_vector(const GroundFrame& place) {
  return {place.x, place.z, place.heading};
}

Vec3 difference(const GroundFrame& from, const GroundFrame& to) {
  return {to.x - from.x, to.z - from.z, wrapped(to.heading - from.heading)};
}

GroundFrame moved(const GroundFrame& place, const Vec3& by) {
  return {place.x + by.x(), place.z + by.y(), place.heading + by.z()};
}

}  // namespace krok::timeline
