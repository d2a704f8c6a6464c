#include <algorithm>
#include <cmath>

#include "timeline/transitions_internal.h"

namespace krok::timeline {

namespace {

// Frame spacing for measuring velocities: that of the result, or of the motion if it is coarser.
double step_of(const ItemPlayer& player, double rate) {
  const double source_rate = player.source().clip->rate * std::abs(player.range().speed);
  return 1 / std::min(rate, source_rate);
}

// Pose and derivatives where a motion is left or entered, from the frames before or after.
ActorState state_at(const ItemPlayer& player, double play_time, double room, double step) {
  const int known =
      static_cast<int>(std::clamp(std::floor(room / std::abs(step) + 1e-6), 0.0, 2.0));
  return actor_state([&](int k) { return player.actor(play_time + k * step); }, step, known);
}

}  // namespace

const Skeleton& skeleton_of(const TransitionSides& sides) {
  return sides.previous.source().clip->skeleton;
}

std::vector<Vec3> places_of_joints(const Skeleton& skeleton, const ActorPose& pose) {
  std::vector<Transform> joint_to_world(skeleton.names.size());
  to_world(skeleton, pose, joint_to_world);
  std::vector<Vec3> places;
  places.reserve(joint_to_world.size());
  for (const Transform& joint : joint_to_world) places.push_back(joint.position);
  return places;
}

std::set<int> contact_joints(const TransitionSides& sides) {
  std::set<int> joints;
  for (const ItemPlayer* player : {&sides.previous, static_cast<const ItemPlayer*>(&sides.next)}) {
    if (player->source().keys == nullptr) continue;
    for (const Contact& contact : player->source().keys->contacts) joints.insert(contact.joint);
  }
  return joints;
}

bool stand_on_feet(const TransitionSides& sides, const ActorPose& previous, const ActorPose& next,
                   GroundFrame& place) {
  const double left = sides.previous_times.play_time(sides.next_times.begin);
  const Skeleton& skeleton = skeleton_of(sides);
  const auto before = places_of_joints(skeleton, previous);
  const auto after = places_of_joints(skeleton, {place, next.local});
  Vec3 way = Vec3::Zero();
  int count = 0;
  for (const int joint : contact_joints(sides)) {
    if (!sides.previous.stands(joint, left) || !sides.next.stands(joint, 0)) {
      continue;
    }
    const auto j = static_cast<std::size_t>(joint);
    way += before[j] - after[j];
    ++count;
  }
  if (count == 0) return false;
  place.x += way.x() / count;
  place.z += way.z() / count;
  return true;
}

void put_next(const TransitionSides& sides, const ActorPose& left, bool& on_feet) {
  GroundFrame place = left.place;
  if (sides.place) {
    place = *sides.place;
  } else if (sides.change.align == Align::stance) {
    on_feet = stand_on_feet(sides, left, sides.next.actor(0), place);
  }
  sides.next.put(0, place);
}

ActorState state_before(const TransitionSides& sides) {
  const double step = step_of(sides.previous, sides.rate);
  return state_at(sides.previous, sides.previous_times.play_time(sides.next_times.begin),
                  sides.next_times.begin - sides.previous_times.settled, -step);
}

ActorState state_after(const TransitionSides& sides) {
  const double step = step_of(sides.next, sides.rate);
  return state_at(sides.next, 0, sides.next.range().duration(), step);
}

std::unique_ptr<Transition> make_transition(const TransitionSides& sides, bool& on_feet) {
  switch (sides.change.kind) {
    case ChangeKind::crossfade:
      return make_crossfade(sides, on_feet);
    case ChangeKind::smooth:
      return make_smooth(sides, on_feet);
    case ChangeKind::inertial:
      return make_inertial(sides, on_feet);
    case ChangeKind::cut:
      break;
  }
  put_next(sides, sides.previous.actor(sides.previous_times.play_time(sides.next_times.begin)),
           on_feet);
  return nullptr;
}

}  // namespace krok::timeline
