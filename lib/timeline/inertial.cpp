#include "math/quaternion.h"
#include "timeline/transitions_internal.h"

namespace krok::timeline {

namespace {

class Inertial : public Transition {
 public:
  Inertial(const TransitionSides& sides, bool& on_feet)
      : next_(sides.next), next_times_(sides.next_times) {
    const ActorState from = state_before(sides);
    put_next(sides, from.pose, on_feet);
    const ActorState to = state_after(sides);
    const auto decay = [&](const Vec3& value, const Rates& a, const Rates& b) {
      return Decay(value, {a.velocity - b.velocity, a.acceleration - b.acceleration},
                   sides.change.duration, sides.change.guard);
    };
    place_ = decay(difference(to.pose.place, from.pose.place), from.place, to.place);
    for (std::size_t j = 0; j < from.rotations.size(); ++j) {
      const Transform& a = from.pose.local[j];
      const Transform& b = to.pose.local[j];
      positions_.push_back(decay(a.position - b.position, from.positions[j], to.positions[j]));
      const RotationOffset offset =
          rotation_offset(a.orientation, from.rotations[j], b.orientation, to.rotations[j]);
      rotations_.emplace_back(offset.value, offset.rates, sides.change.duration,
                              sides.change.guard);
    }
  }

  ActorPose at(double time) const override {
    const double t = time - next_times_.begin;
    ActorPose pose = next_.actor(next_times_.play_time(time));
    pose.place = moved(pose.place, place_.at(t));
    for (std::size_t j = 0; j < pose.local.size(); ++j) {
      pose.local[j].position += positions_[j].at(t);
      pose.local[j].orientation =
          from_rotation_vector(rotations_[j].at(t)) * pose.local[j].orientation;
    }
    return pose;
  }

 private:
  const ItemPlayer& next_;
  const ScheduledItem& next_times_;
  Decay place_;
  std::vector<Decay> positions_, rotations_;
};

}  // namespace

std::unique_ptr<Transition> make_inertial(const TransitionSides& sides, bool& on_feet) {
  return std::make_unique<Inertial>(sides, on_feet);
}

}  // namespace krok::timeline
