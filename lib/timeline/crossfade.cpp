#include <algorithm>
#include <cmath>

#include "math/euler.h"
#include "math/quaternion.h"
#include "timeline/transitions_internal.h"

namespace krok::timeline {

namespace {

constexpr double kMaxNodes = 100'000;

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

}  // namespace

std::unique_ptr<Transition> make_crossfade(const TransitionSides& sides, bool& on_feet) {
  return std::make_unique<Crossfade>(sides, on_feet);
}

}  // namespace krok::timeline
