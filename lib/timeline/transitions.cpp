#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <vector>

#include "math/hermite.h"
#include "math/quaternion.h"
#include "timeline/base_motion.h"
#include "timeline/join_state.h"

namespace krok::timeline {

namespace {

constexpr double kMaxNodes = 100'000;

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

const Skeleton& skeleton_of(const TransitionSides& sides) {
  return sides.previous.source().clip->skeleton;
}

// World positions of the joints.
std::vector<Vec3> places_of_joints(const Skeleton& skeleton, const ActorPose& pose) {
  std::vector<Transform> joint_to_world(skeleton.names.size());
  to_world(skeleton, pose, joint_to_world);
  std::vector<Vec3> places;
  places.reserve(joint_to_world.size());
  for (const Transform& joint : joint_to_world) places.push_back(joint.position);
  return places;
}

// Joints with contacts in either motion.
std::set<int> contact_joints(const TransitionSides& sides) {
  std::set<int> joints;
  for (const ItemPlayer* player : {&sides.previous, static_cast<const ItemPlayer*>(&sides.next)}) {
    if (player->source().keys == nullptr) continue;
    for (const Contact& contact : player->source().keys->contacts) joints.insert(contact.joint);
  }
  return joints;
}

// Moves `place`, the ground frame of the next motion, so that joints in contact in both poses (the
// previous motion's last and the next motion's first) stay planted. False if there are none.
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

// Positions the next motion where the previous one leaves the character.
void put_next(const TransitionSides& sides, const ActorPose& left, bool& on_feet) {
  GroundFrame place = left.place;
  if (sides.place) {
    place = *sides.place;
  } else if (sides.change.align == Align::stance) {
    on_feet = stand_on_feet(sides, left, sides.next.actor(0), place);
  }
  sides.next.put(0, place);
}

// Pose and derivatives at the end of the previous motion (from earlier frames) and at the start of
// the next one (from later frames).
ActorState state_before(const TransitionSides& sides) {
  const double step = step_of(sides.previous, sides.rate);
  return state_at(sides.previous, sides.previous_times.play_time(sides.next_times.begin),
                  sides.next_times.begin - sides.previous_times.settled, -step);
}

ActorState state_after(const TransitionSides& sides) {
  const double step = step_of(sides.next, sides.rate);
  return state_at(sides.next, 0, sides.next.range().duration(), step);
}

class Crossfade : public Transition {
 public:
  Crossfade(const TransitionSides& sides, bool& on_feet)
      : sides_(sides), begin_(sides.next_times.begin), end_(sides.next_times.settled) {
    walk(on_feet);
    const GroundFrame reached = places_.back();
    const double play = sides.next_times.play_time(end_);
    if (sides.place) {
      sides.next.put(sides.next_times.skipped, *sides.place);
      const Vec3 off = difference(reached, sides.next.actor(play).place);
      for (std::size_t n = 0; n < places_.size(); ++n) {
        places_[n] = moved(places_[n], weight(n) * off);
      }
    } else {
      sides.next.put(play, reached);
    }
  }

  ActorPose at(double time) const override {
    ActorPose pose = mixed(time, sides_.change.easing.at((time - begin_) / (end_ - begin_)));
    const double last = static_cast<double>(places_.size() - 1);
    const double node = std::clamp((time - begin_) / (end_ - begin_) * last, 0.0, last);
    const auto n = std::min(static_cast<std::size_t>(node), places_.size() - 2);
    const double part = node - static_cast<double>(n);
    pose.place = moved(places_[n], part * (as_vector(places_[n + 1]) - as_vector(places_[n])));
    return pose;
  }

 private:
  double weight(std::size_t node) const {
    return sides_.change.easing.at(static_cast<double>(node) /
                                   static_cast<double>(places_.size() - 1));
  }
  double time_of(std::size_t node, std::size_t last) const {
    return begin_ + (end_ - begin_) * static_cast<double>(node) / static_cast<double>(last);
  }

  // The blended pose relative to the ground frame; `place` is not set.
  ActorPose mixed(double time, double weight_of_next) const {
    const ActorPose a = sides_.previous.actor(sides_.previous_times.play_time(time));
    const ActorPose b = sides_.next.actor(sides_.next_times.play_time(time));
    return mixed(a, b, weight_of_next);
  }
  static ActorPose mixed(const ActorPose& a, const ActorPose& b, double weight_of_next) {
    ActorPose pose;
    pose.local.resize(a.local.size());
    for (std::size_t j = 0; j < a.local.size(); ++j) {
      pose.local[j] = {
          a.local[j].position + weight_of_next * (b.local[j].position - a.local[j].position),
          slerp(a.local[j].orientation, b.local[j].orientation, weight_of_next)};
    }
    return pose;
  }

  // Integrates root motion: the weighted sum of both motions' displacements relative to the
  // character's heading, or the displacement that keeps feet planted.
  void walk(bool& on_feet) {
    const double wanted = std::ceil((end_ - begin_) * sides_.rate * 2);
    const auto last = static_cast<std::size_t>(std::clamp(wanted, 8.0, kMaxNodes));
    const bool stance = sides_.change.align == Align::stance;
    const std::set<int> joints = stance ? contact_joints(sides_) : std::set<int>();
    std::vector<Vec3> feet_before;
    ActorPose a_before, b_before;
    for (std::size_t n = 0; n <= last; ++n) {
      const double time = time_of(n, last);
      const double part = static_cast<double>(n) / static_cast<double>(last);
      const ActorPose a = sides_.previous.actor(sides_.previous_times.play_time(time));
      const ActorPose b = sides_.next.actor(sides_.next_times.play_time(time));
      std::vector<Vec3> feet;
      if (stance) {
        feet = places_of_joints(skeleton_of(sides_), mixed(a, b, sides_.change.easing.at(part)));
      }
      if (n == 0) {
        places_.push_back(a.place);
      } else {
        const double middle = sides_.change.easing.at(part - 0.5 / static_cast<double>(last));
        Vec3 step =
            (1 - middle) * way(a_before.place, a.place) + middle * way(b_before.place, b.place);
        if (stance) {
          const double at = time - 0.5 * (end_ - begin_) / static_cast<double>(last);
          if (keep_feet(joints, at, middle, feet_before, feet, step)) on_feet = true;
        }
        const Vec3 moves =
            axis_rotation(Axis::y, places_.back().heading) * Vec3(step.x(), 0, step.y());
        places_.push_back(moved(places_.back(), {moves.x(), moves.z(), step.z()}));
      }
      feet_before = std::move(feet);
      a_before = a;
      b_before = b;
    }
  }

  // x, z and rotation, relative to the previous heading.
  static Vec3 way(const GroundFrame& from, const GroundFrame& to) {
    const Vec3 went = difference(from, to);
    const Vec3 seen = axis_rotation(Axis::y, -from.heading) * Vec3(went.x(), 0, went.y());
    return {seen.x(), seen.z(), went.z()};
  }

  // Replaces the displacement by the one that keeps feet planted, weighted by their contacts.
  bool keep_feet(const std::set<int>& joints, double time, double weight_of_next,
                 const std::vector<Vec3>& before, const std::vector<Vec3>& now, Vec3& step) const {
    const double previous = sides_.previous_times.play_time(time);
    const double next = sides_.next_times.play_time(time);
    const double share = std::clamp(weight_of_next, 0.0, 1.0);
    const Quat turned = axis_rotation(Axis::y, step.z());
    double all = 0;
    Vec3 sum = Vec3::Zero();
    for (const int joint : joints) {
      const double stands = (1 - share) * sides_.previous.contact_weight(joint, previous) +
                            share * sides_.next.contact_weight(joint, next);
      const auto j = static_cast<std::size_t>(joint);
      all += stands;
      sum += stands * (before[j] - turned * now[j]);
    }
    if (all == 0) return false;
    const Vec3 kept =
        all >= 1 ? Vec3(sum / all) : Vec3(sum + (1 - all) * Vec3(step.x(), 0, step.y()));
    step.x() = kept.x();
    step.y() = kept.z();
    return true;
  }

  TransitionSides sides_;
  double begin_, end_;
  std::vector<GroundFrame> places_;  // evenly spaced in time
};

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

std::unique_ptr<Transition> make_transition(const TransitionSides& sides, bool& on_feet) {
  switch (sides.change.kind) {
    case ChangeKind::crossfade:
      return std::make_unique<Crossfade>(sides, on_feet);
    case ChangeKind::smooth:
      return std::make_unique<Smooth>(sides, on_feet);
    case ChangeKind::inertial:
      return std::make_unique<Inertial>(sides, on_feet);
    case ChangeKind::cut:
      break;
  }
  put_next(sides, sides.previous.actor(sides.previous_times.play_time(sides.next_times.begin)),
           on_feet);
  return nullptr;
}

}  // namespace krok::timeline
