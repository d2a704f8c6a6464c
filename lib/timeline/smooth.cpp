#include <algorithm>
#include <cmath>

#include "math/euler.h"
#include "math/hermite.h"
#include "math/quaternion.h"
#include "timeline/transitions_internal.h"

namespace krok::timeline {

namespace {

constexpr double kCarriedOn = 0.35;  // max seconds for which a velocity is carried on

class Smooth : public Transition {
 public:
  Smooth(const TransitionSides& sides, bool& on_feet)
      : easing_(sides.change.easing),
        begin_(sides.next_times.begin),
        duration_(sides.change.duration),
        from_(state_before(sides)) {
    to_ = state_after(sides);
    const Vec3 entered = heading_frame(to_);  // the motion is not positioned yet
    GroundFrame place = from_.pose.place;
    if (sides.place) {
      place = *sides.place;
    } else if (sides.change.align == Align::stance &&
               stand_on_feet(sides, from_.pose, to_.pose, place)) {
      on_feet = true;
    } else {
      const Vec3 left = heading_frame(from_);
      const Vec3 way = axis_rotation(Axis::y, place.heading) *
                       Vec3(0.5 * duration_ * (left.x() + entered.x()), 0,
                            0.5 * duration_ * (left.y() + entered.y()));
      place = moved(place, {way.x(), way.z(), 0});
    }
    sides.next.put(0, place);
    to_ = state_after(sides);
    for (std::size_t j = 0; j < from_.rotations.size(); ++j) {
      const Quat& a = from_.pose.local[j].orientation;
      const Vec3 gap = rotation_vector(to_.pose.local[j].orientation * a.conjugate());
      gaps_.push_back(gap);
      entering_.push_back(vector_velocity(gap, to_.rotations[j].velocity));
    }
  }

  ActorPose at(double time) const override {
    const double t = time - begin_;
    ActorPose pose;
    const Vec3 end = as_vector(from_.pose.place) + difference(from_.pose.place, to_.pose.place);
    const Vec3 place = hermite(as_vector(from_.pose.place), from_.place.velocity, end,
                               to_.place.velocity, duration_, t / duration_);
    pose.place = {place.x(), place.y(), place.z()};
    const double over = easing_.at(t / duration_);
    for (std::size_t j = 0; j < gaps_.size(); ++j) {
      const Transform& a = from_.pose.local[j];
      const Transform& b = to_.pose.local[j];
      const Vec3 turn = over * gaps_[j] + carried(t) * from_.rotations[j].velocity -
                        carried(duration_ - t) * entering_[j];
      const Vec3 position = a.position + over * (b.position - a.position) +
                            carried(t) * from_.positions[j].velocity -
                            carried(duration_ - t) * to_.positions[j].velocity;
      pose.local.push_back({position, from_rotation_vector(turn) * a.orientation});
    }
    return pose;
  }

 private:
  static Vec3 heading_frame(const ActorState& state) {
    const Vec3& v = state.place.velocity;
    const Vec3 seen = axis_rotation(Axis::y, -state.pose.place.heading) * Vec3(v.x(), 0, v.y());
    return {seen.x(), seen.z(), v.z()};
  }

  // Offset from carrying on a unit velocity: zero at both ends of a short window, whatever the
  // duration of the change.
  double carried(double t) const {
    const double window = std::min(duration_, kCarriedOn);
    if (!(t > 0) || t >= window) return 0;
    const double rest = 1 - t / window;
    return t * rest * rest;
  }

  Easing easing_;
  double begin_, duration_;
  ActorState from_, to_;
  std::vector<Vec3> gaps_, entering_;
};

}  // namespace

std::unique_ptr<Transition> make_smooth(const TransitionSides& sides, bool& on_feet) {
  return std::make_unique<Smooth>(sides, on_feet);
}

}  // namespace krok::timeline
