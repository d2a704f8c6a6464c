#include "motion/loop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/index.h"
#include "math/quaternion.h"
#include "math/transform.h"
#include "motion/hips_root.h"
#include "motion/local_motion.h"

namespace krok {

namespace {

// The gap at the seam between two motions, and the correction curves that close it. Rates are per
// frame.

// One joint's transforms on both sides, from the seam outwards: before[0] and after[0] are at the
// same time, the others one and two frames away.
struct SeamSides {
  std::array<Transform, 3> before, after;
};

struct SeamGap {
  Vec3 value = Vec3::Zero();  // from end to start; a rotation vector in the end's frame
  // Velocities at the seam, for rotations each in the frame of its own side. From parabolas of
  // equal curvature through the frames of both sides, so that curvature does not count as a
  // velocity jump.
  Vec3 rate_before = Vec3::Zero(), rate_after = Vec3::Zero();

  double jump() const { return (rate_after - rate_before).norm(); }

  // Reduces the velocity jump by `usual`, at most to zero.
  void forgive(double usual);
};

// The correction on each side, a quintic Hermite curve per coordinate: half the gap at the seam,
// zero with two derivatives `width` frames away.
class SeamCurve {
 public:
  SeamCurve(const Vec3& value_before, const Vec3& slope_before, const Vec3& value_after,
            const Vec3& slope_after, int width);

  // `from_seam` >= 0: frames from the seam. For rotations a rotation vector to be applied from the
  // right.
  Vec3 at(bool before, int from_seam) const;

 private:
  Vec3 value_[2], slope_[2];  // after, before; slopes per frame
  int width_;
};

// With right(s) = v s + a s^2 / 2 after the seam and left(s) = -u s + a s^2 / 2 before it, their
// sum gives v - u and their difference v + u (the latter by least squares).
void find_rates(const std::array<Vec3, 2>& left, const std::array<Vec3, 2>& right, SeamGap& gap) {
  const Vec3 jump = 2 * (left[0] + right[0]) - 0.5 * (left[1] + right[1]);
  const Vec3 mean = ((right[0] - left[0]) + 2 * (right[1] - left[1])) / 10;
  gap.rate_before = mean - 0.5 * jump;
  gap.rate_after = mean + 0.5 * jump;
}

// The inverse right Jacobian of SO(3)'s exponential map at `v`: the derivative of v for which
// exp(v) turns at `body_rate` (Chirikjian, Stochastic Models, Information Theory, and Lie Groups,
// vol. 2, sec. 10.7).
Vec3 vector_rate(const Vec3& v, const Vec3& body_rate) {
  const double angle = v.norm();
  const double factor =
      angle < 1e-4 ? 1.0 / 12 : 1 / (angle * angle) - 0.5 / (angle * std::tan(0.5 * angle));
  return body_rate + 0.5 * v.cross(body_rate) + factor * v.cross(v.cross(body_rate));
}

void SeamGap::forgive(double usual) {
  const Vec3 whole = rate_after - rate_before;
  if (jump() <= 0) return;
  const Vec3 forgiven = std::min(1.0, usual / jump()) * whole;
  rate_before += 0.5 * forgiven;
  rate_after -= 0.5 * forgiven;
}

SeamGap rotation_gap(const SeamSides& sides) {
  SeamGap gap;
  const Quat& end = sides.before[0].orientation;
  const Quat& begin = sides.after[0].orientation;
  gap.value = rotation_vector(end.conjugate() * begin);
  std::array<Vec3, 2> left, right;
  // Steps before the seam are converted to the start's frame, because the fit adds both sides.
  const Quat end_to_begin = begin.conjugate() * end;
  for (std::size_t k = 0; k < 2; ++k) {
    left[k] = end_to_begin * rotation_vector(end.conjugate() * sides.before[k + 1].orientation);
    right[k] = rotation_vector(begin.conjugate() * sides.after[k + 1].orientation);
  }
  find_rates(left, right, gap);
  gap.rate_before = end_to_begin.conjugate() * gap.rate_before;
  return gap;
}

SeamGap position_gap(const SeamSides& sides) {
  SeamGap gap;
  gap.value = sides.after[0].position - sides.before[0].position;
  std::array<Vec3, 2> left, right;
  for (std::size_t k = 0; k < 2; ++k) {
    left[k] = sides.before[k + 1].position - sides.before[0].position;
    right[k] = sides.after[k + 1].position - sides.after[0].position;
  }
  find_rates(left, right, gap);
  return gap;
}

SeamCurve::SeamCurve(const Vec3& value_before, const Vec3& slope_before, const Vec3& value_after,
                     const Vec3& slope_after, int width)
    : value_{value_after, value_before}, slope_{slope_after, slope_before}, width_(width) {}

Vec3 SeamCurve::at(bool before, int from_seam) const {
  if (from_seam >= width_) return Vec3::Zero();
  // u is 1 at the seam and 0 at the far end.
  const double u = 1 - static_cast<double>(from_seam) / width_;
  const double u3 = u * u * u;
  const double value = u3 * (10 + u * (-15 + 6 * u));
  const double slope = u3 * (-4 + u * (7 - 3 * u)) * width_;  // its derivative at u = 1 is `width_`
  const int side = before ? 1 : 0;
  return value * value_[side] + (before ? slope : -slope) * slope_[side];
}

SeamCurve position_curve(const SeamGap& gap, int width) {
  const Vec3 half = 0.5 * gap.value;
  const Vec3 slope = 0.5 * (gap.rate_after - gap.rate_before);
  return {half, slope, -half, -slope, width};
}

SeamCurve rotation_curve(const SeamGap& gap, int width) {
  // Both sides meet half-way, and so do their velocities in that frame: exp(-c) w exp(c) plus the
  // curve's rate.
  const Vec3 half = 0.5 * gap.value;
  const Vec3 before = from_rotation_vector(-half) * gap.rate_before;
  const Vec3 after = from_rotation_vector(half) * gap.rate_after;
  const Vec3 change = 0.5 * (after - before);
  return {half, vector_rate(half, change), -half, vector_rate(-half, -change), width};
}

constexpr double kLevel = 0.05;     // of the character's extent
constexpr double kNoTravel = 1e-3;  // metres

Quat turn_about_vertical(double angle) {
  return axis_rotation(Axis::y, angle);
}

// A fraction of a displacement on the ground, along the circular arc to its end.
Transform share_of(const Transform& displacement, double turn, double share) {
  Transform part{share * displacement.position, turn_about_vertical(share * turn)};
  if (std::abs(turn) < 1e-9) return part;
  // The arc's centre: the fixed point c of x -> R x + d in the plane.
  const double half_cotangent = 0.5 / std::tan(turn / 2);
  const Vec3 d(displacement.position.x(), 0, displacement.position.z());
  const Vec3 centre = 0.5 * d + half_cotangent * Vec3(d.z(), 0, -d.x());
  part.position = centre - part.orientation * centre;
  part.position.y() = share * displacement.position.y();
  return part;
}

// The displacement on the ground that takes one place to another, which differs by `turn`.
Transform ground_displacement(const GroundFrame& from, const GroundFrame& to, double turn) {
  const Quat rotation = turn_about_vertical(turn);
  return {Vec3(to.x, 0, to.z) - rotation * Vec3(from.x, 0, from.z), rotation};
}

// Takes the motion along the arc from the first place to the last out and puts one straight on, at
// the arc's first velocity, in.
class Straightening {
 public:
  Straightening(const GroundFrame& first, const GroundFrame& last)
      : turn_(wrapped(last.heading - first.heading)),
        displacement_(ground_displacement(first, last, turn_)) {
    const Vec3 start(first.x, 0, first.z);
    const Vec3 chord = Vec3(last.x, 0, last.z) - start;
    // The chord is at the mean heading, and shorter than the arc.
    const double half = turn_ / 2;
    const double length = std::abs(half) < 1e-9 ? 1 : half / std::sin(half);
    way_ = length * (turn_about_vertical(-half) * chord);
  }

  // World to world, at a share of the time from the first frame to the last.
  Transform at(double share) const {
    Transform back = share_of(displacement_, turn_, share).inverse();
    back.position += share * way_;
    return back;
  }

 private:
  double turn_;
  Transform displacement_;
  Vec3 way_;
};

class Looper {
 public:
  Looper(const Clip& clip, int carrier, const LoopOptions& options)
      : clip_(clip), carrier_(carrier), options_(options), motion_(local_motion(clip)) {}

  Looped loop() {
    if (needs_closing_frame()) add_closing_frame();
    straighten();
    choose_displacement();
    result_.blended_frames =
        std::clamp(static_cast<int>(std::min(1e6, std::round(options_.blend * clip_.rate))), 1,
                   std::max(1, last() / 2));
    moving_ = moving_joints(motion_);
    measure_usual();
    result_.before = seam();
    close();
    // Where frames near the seam jumped, the usual jump is smaller now.
    constexpr int kRounds = 10;
    for (int round = 1; round < kRounds; ++round) {
      measure_usual();
      if (!jumps_unusually()) break;
      close();
    }
    result_.after = seam();
    result_.clip = Clip{clip_.skeleton, clip_.rate, {}, {}, clip_.provenance};
    set_local_motion(motion_, result_.clip);
    return std::move(result_);
  }

 private:
  int last() const { return motion_.frames - 1; }

  Transform carrier_to_world(int frame) const {
    Transform sum;
    for (int j = carrier_; j >= 0; j = clip_.skeleton.parents[at(j)]) {
      sum = motion_.at(j, frame) * sum;
    }
    return sum;
  }
  GroundFrame place(int frame) const {
    return ground_frame(clip_.skeleton, carrier_, carrier_to_world(frame));
  }
  Transform way(int from, int to) const {
    return place(to).to_world() * place(from).to_world().inverse();
  }

  // Root sum of squares of the angles between the joints' rotations in the first frame and in the
  // last, the latter continued by `steps` (0 or 1) repeats of the last step. Ignores the root's
  // heading.
  double distance_to_first(int steps) const {
    double sum = 0;
    const Quat root_turn = way(last(), 0).orientation;
    for (int j = 0; j < motion_.joints; ++j) {
      const auto q = motion_.joint_orientations(j);
      Quat end = q.back();
      if (steps > 0) end = end * (q[q.size() - 2].conjugate() * end);
      if (j == 0) end = root_turn * end;
      const double angle = angle_between(end, q.front());
      sum += angle * angle;
    }
    return std::sqrt(sum);
  }

  bool needs_closing_frame() const {
    if (options_.end != LoopEnd::automatic) return options_.end == LoopEnd::open;
    return distance_to_first(1) < 0.5 * distance_to_first(0);
  }

  void add_closing_frame() {
    // The missing step is the mean of the steps before and after it.
    const Transform before = place(last() - 1).to_world().inverse() * place(last()).to_world();
    const Transform after = place(0).to_world().inverse() * place(1).to_world();
    const Transform step{0.5 * (before.position + after.position),
                         slerp(before.orientation, after.orientation, 0.5)};
    const Transform move = place(last()).to_world() * step * place(0).to_world().inverse();
    const double climb = motion_.at(0, last()).position.y() - motion_.at(0, 0).position.y();
    LocalMotion longer = motion_;
    longer.frames += 1;
    longer.orientations.clear();
    longer.positions.clear();
    for (int j = 0; j < motion_.joints; ++j) {
      Transform closing = motion_.at(j, 0);
      if (j == 0) {
        closing = move * closing;
        if (std::abs(climb) > kLevel * reference_extent(clip_.skeleton))
          closing.position.y() += climb;
      }
      const auto q = motion_.joint_orientations(j);
      const auto p = motion_.joint_positions(j);
      longer.orientations.insert(longer.orientations.end(), q.begin(), q.end());
      longer.orientations.push_back(closing.orientation);
      longer.positions.insert(longer.positions.end(), p.begin(), p.end());
      longer.positions.push_back(closing.position);
    }
    motion_ = std::move(longer);
    result_.added_frames = 1;
  }

  void straighten() {
    const double drift = wrapped(place(last()).heading - place(0).heading);
    const bool take_out = options_.turn == LoopTurn::straighten ||
                          (options_.turn == LoopTurn::automatic && std::abs(drift) <= kLoopDrift);
    if (!take_out || drift == 0) return;
    result_.straightened = drift;
    const Straightening change(place(0), place(last()));
    for (int f = 0; f <= last(); ++f) {
      motion_.set(0, f, change.at(static_cast<double>(f) / last()) * motion_.at(0, f));
    }
  }

  void choose_displacement() {
    result_.turn = wrapped(place(last()).heading - place(0).heading);
    if (result_.straightened != 0) result_.turn = 0;
    const GroundFrame from = place(0), to = place(last());
    Transform& displacement = result_.displacement;
    displacement = ground_displacement(from, to, result_.turn);
    const double climb = carrier_to_world(last()).position.y() - carrier_to_world(0).position.y();
    const bool keep = options_.climb == LoopClimb::keep ||
                      (options_.climb == LoopClimb::automatic &&
                       std::abs(climb) > kLevel * reference_extent(clip_.skeleton));
    if (keep) {
      displacement.position.y() = climb;
    } else {
      result_.levelled = climb;
    }
  }

  // A joint's local transform near the end, with the displacement removed.
  Transform brought_back(int joint, int frame) const {
    const Transform local = motion_.at(joint, frame);
    return joint == 0 ? result_.displacement.inverse() * local : local;
  }

  // The frames around the seam, with the displacement removed at the end.
  SeamSides sides(int joint) const {
    SeamSides about;
    for (int k = 0; k < 3; ++k) {
      about.before[static_cast<std::size_t>(k)] = brought_back(joint, last() - k);
      about.after[static_cast<std::size_t>(k)] = motion_.at(joint, k);
    }
    return about;
  }

  // The same around an inner frame, where there is no gap.
  SeamSides sides_within(int joint, int frame) const {
    SeamSides about;
    for (int k = 0; k < 3; ++k) {
      about.before[static_cast<std::size_t>(k)] = motion_.at(joint, frame - k);
      about.after[static_cast<std::size_t>(k)] = motion_.at(joint, frame + k);
    }
    return about;
  }

  // 95th percentile of the velocity jumps at inner frames, per frame.
  double usual_jump(int joint, SeamGap (*gap)(const SeamSides&)) const {
    std::vector<double> jumps;
    for (int f = 2; f + 2 <= last(); ++f) jumps.push_back(gap(sides_within(joint, f)).jump());
    if (jumps.empty()) return 0;
    const auto place = jumps.begin() + static_cast<std::ptrdiff_t>((jumps.size() - 1) * 19 / 20);
    std::ranges::nth_element(jumps, place);
    return *place;
  }

  // Whether closing the seam once more would move joints by more than about 0.01 mm or 0.001
  // degrees.
  bool jumps_unusually() const {
    constexpr double kTurn = 1e-5, kShift = 1e-5;
    constexpr double kPeak = 0.06;  // of the curve of a jump, of its width
    const double reach = kPeak * result_.blended_frames;
    for (int j = 0; j < motion_.joints; ++j) {
      const SeamSides about = sides(j);
      if (reach * (rotation_gap(about).jump() - usual_turn_[at(j)]) > kTurn) return true;
      if (moving_[at(j)] == 0) continue;
      if (reach * (position_gap(about).jump() - usual_shift_[at(j)]) > kShift) return true;
    }
    return false;
  }

  void measure_usual() {
    usual_turn_.clear();
    usual_shift_.clear();
    for (int j = 0; j < motion_.joints; ++j) {
      usual_turn_.push_back(usual_jump(j, rotation_gap));
      usual_shift_.push_back(moving_[at(j)] != 0 ? usual_jump(j, position_gap) : 0);
    }
  }

  Seam seam() const {
    Seam worst;
    for (int j = 0; j < motion_.joints; ++j) {
      const SeamSides about = sides(j);
      const SeamGap rotation = rotation_gap(about);
      if (rotation.value.norm() > worst.angle) {
        worst.angle = rotation.value.norm();
        worst.angle_joint = j;
      }
      const double spin = rotation.jump() * clip_.rate;
      if (spin > worst.angular_velocity) {
        worst.angular_velocity = spin;
        worst.angular_velocity_joint = j;
        worst.usual_angular_velocity = usual_turn_[at(j)] * clip_.rate;
      }
      if (moving_[at(j)] == 0) continue;
      const SeamGap position = position_gap(about);
      worst.distance = std::max(worst.distance, position.value.norm());
      worst.velocity = std::max(worst.velocity, position.jump() * clip_.rate);
    }
    return worst;
  }

  void close() {
    const int width = result_.blended_frames;
    for (int j = 0; j < motion_.joints; ++j) {
      const SeamSides about = sides(j);
      SeamGap turn_gap = rotation_gap(about);
      turn_gap.forgive(usual_turn_[at(j)]);
      const SeamCurve turn = rotation_curve(turn_gap, width);
      std::optional<SeamCurve> shift;
      if (moving_[at(j)] != 0) {
        SeamGap shift_gap = position_gap(about);
        shift_gap.forgive(usual_shift_[at(j)]);
        shift = position_curve(shift_gap, width);
      }
      const auto corrected = [&](Transform local, bool before, int from_seam) {
        local.orientation = local.orientation * from_rotation_vector(turn.at(before, from_seam));
        if (shift) local.position += shift->at(before, from_seam);
        return local;
      };
      for (int k = 0; k < width; ++k) {
        const Transform end = corrected(brought_back(j, last() - k), true, k);
        const Transform begin = corrected(motion_.at(j, k), false, k);
        motion_.set(j, k, begin);
        motion_.set(j, last() - k, j == 0 ? result_.displacement * end : end);
      }
      // Already equal up to rounding; makes them exactly equal.
      const Transform first = motion_.at(j, 0);
      motion_.set(j, last(), j == 0 ? result_.displacement * first : first);
    }
  }

  const Clip& clip_;
  int carrier_;
  const LoopOptions& options_;
  LocalMotion motion_;
  std::vector<std::uint8_t> moving_;
  std::vector<double> usual_turn_, usual_shift_;  // [joints], per frame
  Looped result_;
};

}  // namespace

Result<Looped> loop(const Clip& clip, int carrier, const LoopOptions& options) {
  if (clip.frame_count() < 4) {
    return Error("motion-loop", "a motion needs at least four frames to be looped");
  }
  if (!(options.blend >= 0) || !std::isfinite(options.blend)) {
    return Error("motion-blend", "the blend time must be finite and not negative");
  }
  const HipsRoot hips_root(clip, carrier);
  if (!hips_root.changes()) return Looper(clip, carrier, options).loop();
  const Clip rooted = hips_root.rooted(clip);
  Looped looped = Looper(rooted, carrier, options).loop();
  const Transform& displacement = looped.displacement;
  const Vec3 hips = clip.frame_positions(0)[at(carrier)].cast<double>();
  const Vec3 way = displacement * hips - hips;
  // A character is moved on by moving all of it, so a root that stands must go along.
  looped.carried = hips_root.stands() && Vec2(way.x(), way.z()).norm() > kNoTravel;
  HipsRoot::Carried carried;
  if (looped.carried) {
    const int last = looped.clip.frame_count() - 1;
    carried = [&displacement, turn = looped.turn, last](int frame) {
      return share_of(displacement, turn, static_cast<double>(frame) / last);
    };
  }
  looped.clip = hips_root.restored(looped.clip, clip.skeleton, carried);
  for (Seam* seam : {&looped.before, &looped.after}) {
    seam->angle_joint = hips_root.original(seam->angle_joint);
    seam->angular_velocity_joint = hips_root.original(seam->angular_velocity_joint);
  }
  return looped;
}

void straighten(int carrier, Looped& looped) {
  Clip& clip = looped.clip;
  const int last = clip.frame_count() - 1;
  const GroundFrame first = ground_frame(clip, carrier, 0);
  const Straightening change(first, ground_frame(clip, carrier, last));
  std::vector<Transform> pose(clip.skeleton.names.size());
  for (int f = 1; f <= last; ++f) {
    const Transform move = change.at(static_cast<double>(f) / last);
    clip.get_pose(f, pose);
    for (Transform& joint : pose) joint = move * joint;
    clip.set_pose(f, pose);
  }
  const double climb = looped.displacement.position.y();
  looped.displacement = ground_displacement(first, ground_frame(clip, carrier, last), 0);
  looped.displacement.position.y() = climb;
  looped.straightened += std::exchange(looped.turn, 0.0);
}

Result<Clip> repeated(const Clip& looped, const Transform& displacement, int rounds) {
  const int period = looped.frame_count() - 1;
  if (period < 1 || rounds <= 1) return looped;
  if (static_cast<double>(period) * rounds * looped.joint_count() > 1e8) {
    return Error("clip-too-long", "the repeated motion would exceed 100 million joint transforms");
  }
  Clip result{looped.skeleton, looped.rate, {}, {}, looped.provenance};
  result.resize(period * rounds + 1);
  std::vector<Transform> pose(looped.skeleton.names.size());
  Transform moved;
  for (int f = 0; f < result.frame_count(); ++f) {
    if (f > 0 && f % period == 0) moved = displacement * moved;
    looped.get_pose(f % period, pose);
    for (Transform& joint : pose) joint = moved * joint;
    result.set_pose(f, pose);
  }
  return result;
}

}  // namespace krok
