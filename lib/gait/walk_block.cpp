#include "gait/walk_block_internal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "core/index.h"
#include "math/hermite.h"
#include "math/quaternion.h"

namespace krok::gait {

namespace {

constexpr double kSpacing = 0.01;       // seconds, of derivatives at the ends of a swing, at least
constexpr double kLoweringReach = 0.2;  // seconds over which the pelvis is lowered
// Steps that are computed on either side of a block: what the lowering of the pelvis takes from
// farther ones is below the rounding of floats, and they depend on their neighbours.
constexpr std::size_t kLookedAt = 3, kAround = kLookedAt + 2;
constexpr double kStaysFlat = 3;  // of the pitch at which a foot is flat
// The heel of the stance foot rises so long before the other foot's strike, as a share of single
// support: at 30 to 35 % of the cycle (Perry and Burnfield, "Gait Analysis", 2010).
constexpr double kHeelRise = 0.4;
constexpr double kMatching = 0.16, kMatchingInRun = 0.08;  // seconds, see Swing
constexpr double kDrawnUp = 0.12;                          // seconds, of a foot in flight
constexpr double kSoftReach = 0.05;                        // of the leg
constexpr double kHeelRiseInRun = 0.5;                     // of the stance
constexpr double kMoreRoll = 25 * kRadiansPerDegree;       // more than in the blend
constexpr double kMaxPitch = 75 * kRadiansPerDegree;       // of a foot on its ball
constexpr double kMinShare = 0.45;  // of the roll, below which the pelvis gives way
constexpr int kRollSteps = 16;
constexpr double kHeelDown = 0.5;  // of the time to the middle: after a forefoot strike

struct PitchAt {
  double time = 0, pitch = 0;
};

// When a rolling foot becomes flat: `series` goes from the strike to the middle of the stance, or
// back from toe-off to it. A foot that never becomes quite flat, as in captures, counts as flat
// when it nearly is.
double time_of_flat(std::span<const PitchAt> series) {
  struct Limit {
    double pitch, part;  // part of the series within which it is to be
  };
  constexpr Limit kLimits[] = {{0.5, 0.5}, {1, 0.6}, {2, 0.8}, {4, 0.95}};  // degrees
  const double from = series.front().time, to = series.back().time;
  for (const Limit& limit : kLimits) {
    const double flat = limit.pitch * kRadiansPerDegree;
    for (std::size_t i = 0; i < series.size(); ++i) {
      if (std::abs(series[i].pitch) >= flat) continue;
      if (std::abs(series[i].time - from) > limit.part * std::abs(to - from)) break;
      // A foot that is flat only in passing does not count.
      if (std::ranges::any_of(series.subspan(i), [&](const PitchAt& later) {
            return std::abs(later.pitch) > kStaysFlat * flat;
          })) {
        continue;
      }
      if (i == 0) return from;
      const double a = std::abs(series[i - 1].pitch), b = std::abs(series[i].pitch);
      return std::lerp(series[i - 1].time, series[i].time, (a - flat) / (a - b));
    }
  }
  return to;
}

// Metres, level, from the hips to the line between the ankles.
double off_support(const Walker& walker, std::span<const Transform> world) {
  const auto level = [&](int joint) {
    const Vec3& place = world[at(joint)].position;
    return Vec2(place.x(), place.z());
  };
  const Vec2 from = level(walker.legs[0].foot), way = level(walker.legs[1].foot) - from;
  const Vec2 hips = level(0) - from;
  const double part = std::clamp(hips.dot(way) / std::max(way.squaredNorm(), 1e-9), 0.0, 1.0);
  return (hips - part * way).norm();
}

}  // namespace

int WalkParts::first_frame(std::size_t step) const {
  const std::vector<BodyStep>& steps = body.steps();
  if (step >= steps.size()) return frames;
  return static_cast<int>(std::ceil(steps[step].start * rate - 1e-9));
}

WalkBlock::WalkBlock(const WalkParts& parts, std::size_t first_step, std::size_t end_step)
    : parts_(parts),
      first_(first_step),
      end_(end_step),
      low_(first_step - std::min<std::size_t>(first_step, kAround)),
      high_(std::min(end_step + kAround, parts.body.steps().size())) {
  for (std::size_t step = low_ == 0 ? 0 : low_ - 1; step < high_; ++step) {
    if (step + 1 < parts.body.steps().size()) gaps_.push_back(parts.body.gap_after(step));
  }
  sampled_.resize(high_ - low_);
  stances_.resize(high_ - low_ + 2);
  needs_.assign(at(parts.first_frame(high_) - parts.first_frame(low_)), 0);
}

const Gap* WalkBlock::gap_after(std::size_t step) const {
  const std::size_t index = step - (low_ == 0 ? 0 : low_ - 1);
  return step + 1 < parts_.body.steps().size() ? &gaps_[index] : nullptr;
}

SampledStep WalkBlock::sample(std::size_t step) const {
  const BodyStep& now = parts_.body.steps()[step];
  SampledStep result;
  result.first = parts_.first_frame(step);
  const int end = parts_.first_frame(step + 1);
  auto scratch = now.motion.make_scratch();
  std::vector<Transform> world(parts_.walker.skeleton->names.size());
  for (int f = result.first; f < end; ++f) {
    PoseVector& pose = result.poses.emplace_back();
    joined_pose(now, parts_.time_of(f), step > 0 ? gap_after(step - 1) : nullptr, gap_after(step),
                pose, scratch);
    parts_.walker.to_world(pose, world);
    result.blend.push_back(
        {foot_of(parts_.walker.legs[0], world), foot_of(parts_.walker.legs[1], world)});
    result.hips.push_back({world[at(parts_.walker.legs[0].upper)].position,
                           world[at(parts_.walker.legs[1].upper)].position});
  }
  return result;
}

FootPose WalkBlock::blend_foot(std::size_t step, double time, FootSide side,
                               const Quat& signs) const {
  const BodyStep& now = parts_.body.steps()[step];
  auto scratch = now.motion.make_scratch();
  PoseVector pose;
  joined_pose(now, time, step > 0 ? gap_after(step - 1) : nullptr, gap_after(step), pose, scratch);
  const Leg& leg = parts_.walker.leg(side);
  FootPose foot;
  foot.foot = joint_to_world(*parts_.walker.skeleton, pose, leg.foot);
  foot.toes = leg.toes < 0 ? foot.foot.orientation
                           : joint_to_world(*parts_.walker.skeleton, pose, leg.toes).orientation;
  return in_signs_of(leg, signs, foot);
}

const FootPose& WalkBlock::nearest(std::size_t step, double time, FootSide side) const {
  const SampledStep& frames = sampled(step);
  const int last = static_cast<int>(frames.blend.size()) - 1;
  const int f =
      std::clamp(static_cast<int>(std::lround(time * parts_.rate)) - frames.first, 0, last);
  return frames.blend[at(f)][index_of(side)];
}

// When the foot that strikes print `print` comes to lie flat. The step over it has been sampled.
void WalkBlock::begin_stance(std::size_t print) {
  const std::vector<BodyStep>& steps = parts_.body.steps();
  const std::size_t over = print == 0 ? 0 : std::min(print - 1, steps.size() - 1);
  const BodyStep& step = steps[over];
  const SampledStep& frames = sampled(over);
  const FootSide side = parts_.side_of(print);
  const bool is_first = print < 2, is_last = print + 1 == parts_.plan.grounded.size();
  double middle = step.flat_time();
  // The foot that leaves first stands flat before.
  if (print == 0) middle = 0;
  if (is_last) middle = step.finish;
  Stance stance(parts_.walker.leg(side), parts_.plan.grounded[print], nearest(over, middle, side));
  stance.strike = is_first ? 0 : is_last ? step.strike : step.start;
  stance.flat_from = stance.strike;
  stance.flat_to = stance.off = parts_.body.off_of(steps.size());
  std::vector<PitchAt> series;
  for (std::size_t i = 0; i < frames.blend.size() && !is_first; ++i) {
    const double time = parts_.time_of(frames.first + static_cast<int>(i));
    if (time < stance.strike || time > middle) continue;
    series.push_back({time, stance.pitch(frames.blend[i][index_of(side)])});
  }
  if (!series.empty()) {
    series.front().time = stance.strike;
    stance.be_flat(time_of_flat(series), middle);
    stance.land(steps[print - 2].gait, std::lerp(stance.strike, middle, kHeelDown));
  }
  changed_stance(print) = stance;
}

// When the foot's heel comes up and its toes leave the ground, in the next step, which has been
// sampled.
void WalkBlock::finish_stance(std::size_t print) {
  const std::vector<BodyStep>& steps = parts_.body.steps();
  if (print >= steps.size()) return;  // the walk ends on it
  Stance& stance = changed_stance(print);
  const FootSide side = parts_.side_of(print);
  stance.off = parts_.body.off_of(print);
  stance.flat_to = stance.off;
  std::vector<PitchAt> series;
  const double middle = print == 0 ? 0 : steps[print - 1].flat_time();
  for (std::size_t s = print + 1; s-- > (print == 0 ? 0 : print - 1);) {
    const SampledStep& frames = sampled(s);
    for (std::size_t i = frames.blend.size(); i-- > 0;) {
      const double time = parts_.time_of(frames.first + static_cast<int>(i));
      if (time > stance.off || time < std::max(middle, stance.flat_from)) continue;
      series.push_back({time, stance.pitch(frames.blend[i][index_of(side)])});
    }
  }
  if (series.empty()) return;
  series.front().time = stance.off;
  stance.leave(time_of_flat(series), middle);
}

// Where the leg that is left behind would be too long, its foot rolls over the ball, as people's
// do, before the pelvis has to give way.
void WalkBlock::roll_over_ball(std::size_t print) {
  const std::vector<BodyStep>& steps = parts_.body.steps();
  if (print == 0 || print >= steps.size()) return;
  Stance& stance = changed_stance(print);
  const Leg& leg = parts_.leg_of(print);
  const std::size_t side = index_of(parts_.side_of(print));
  const BodyStep& over = steps[print - 1];
  const double rises = stance.off < over.strike ? std::lerp(stance.off, over.start, kHeelRiseInRun)
                                                : std::lerp(over.strike, over.off, kHeelRise);
  const double from = std::max(stance.flat_from, rises);
  if (!(stance.off > from)) return;
  double roll = 0;
  for (std::size_t step = print - 1; step <= print; ++step) {
    const SampledStep& frames = sampled(step);
    for (std::size_t i = 0; i < frames.blend.size(); ++i) {
      const double time = parts_.time_of(frames.first + static_cast<int>(i));
      const double share = smoother_step((time - from) / (stance.off - from));
      if (share < kMinShare || time > stance.off) continue;
      const FootPose& blend = frames.blend[i][side];
      const Vec3& hip = frames.hips[i][side];
      const double longest = longest_reach(leg, (hip - blend.foot.position).norm());
      const FootPose foot = stance.at(time, blend);
      const auto is_too_long = [&](double angle) {
        return (hip - stance.rolled(foot, angle).foot.position).norm() > longest;
      };
      if (!is_too_long(0)) continue;
      double low = 0, high = std::min(kMoreRoll, kMaxPitch - stance.pitch(blend));
      if (high <= 0) continue;
      for (int k = 0; k < kRollSteps && !is_too_long(high); ++k) {
        const double middle = 0.5 * (low + high);
        (is_too_long(middle) ? low : high) = middle;
      }
      roll = std::max(roll, std::min(high / share, kMoreRoll));
    }
  }
  if (roll > 0) stance.roll_further(roll, from);
}

// The swing of the foot that strikes at the end of the step. In a run it begins in the step before.
Swing WalkBlock::make_swing(std::size_t step) const {
  const std::vector<BodyStep>& steps = parts_.body.steps();
  const BodyStep& now = steps[step];
  const double leaves = parts_.body.off_of(step);
  const std::size_t first = step > 0 && leaves <= now.start ? step - 1 : step;
  const Stance& from = stance(step);
  const Stance& to = stance(step + 2);
  const FootSide side = parts_.side_of(step);
  const Quat signs = flat_foot(parts_.leg_of(step), parts_.plan.grounded[step]).orientation;
  Swing swing(parts_.leg_of(step), leaves, now.strike,
              steps[first].runs() ? kMatchingInRun : kMatching);
  Swing::Ends off, strike;
  const bool is_last = step + 1 == steps.size();
  // Between their frames examples go straight on: over less time than that a foot would be as fast
  // as in one frame by chance, and have no acceleration or that of a corner.
  const double spacing = std::max(kSpacing, 1 / parts_.body.rate());
  off.spacing = std::min(spacing, (leaves - steps[first].start) / 3);
  strike.spacing = spacing;
  for (std::size_t i = 0; i < 3; ++i) {
    const double time = leaves - off.spacing * static_cast<double>(i);
    off.blend[i] = blend_foot(first, time, side, signs);
    off.wanted[i] = from.at(time, off.blend[i]);
    const double later = now.strike + strike.spacing * static_cast<double>(i);
    strike.blend[i] = blend_foot(is_last ? step : step + 1, later, side, signs);
    strike.wanted[i] = to.at(later, strike.blend[i]);
  }
  swing.set_ends(off, strike);
  std::vector<double> times;
  std::vector<FootPose> blend;
  for (std::size_t s = first; s <= step; ++s) {
    const SampledStep& frames = sampled(s);
    for (std::size_t i = 0; i < frames.blend.size(); ++i) {
      times.push_back(parts_.time_of(frames.first + static_cast<int>(i)));
      blend.push_back(in_signs_of(parts_.leg_of(step), signs, frames.blend[i][index_of(side)]));
    }
  }
  // In a run the toes leave with the ball.
  const double toes_off = parts_.body.toes_off_of(step);
  if (parts_.leg_of(step).toes >= 0 && first == step && toes_off < now.strike) {
    const double until = swing.tip_stays_until(toes_off, times, blend);
    if (until >= leaves + 2 * kSpacing) {
      const double apart = std::min(spacing, 0.5 * (until - leaves));
      std::array<FootPose, 3> before;
      for (std::size_t i = 0; i < 3; ++i) {
        before[i] = blend_foot(step, until - apart * static_cast<double>(i), side, signs);
      }
      swing.keep_tip(until, before, apart);
    }
  }
  const double height =
      std::max(parts_.plan.grounded[step].heel.y(), parts_.plan.grounded[step + 2].heel.y());
  swing.clear(parts_.ground, times, blend, parts_.options.clearance, height);
  return swing;
}

void WalkBlock::place_feet(std::size_t step, MadeStep& made) {
  const BodyStep& now = parts_.body.steps()[step];
  SampledStep& frames = sampled(step);
  const Swing swing = make_swing(step);
  if (!now.runs() && parts_.leg_of(step).toes >= 0) changed_stance(step).tip_off = swing.lifted();
  const FootSide moving = parts_.side_of(step), standing = parts_.side_of(step + 1);
  const double leaves = parts_.body.off_of(step), next_leaves = parts_.body.off_of(step + 1);
  std::optional<Swing> next;  // of the stance foot, in flight
  if (next_leaves < now.strike) next = make_swing(step + 1);
  const auto with_signs = [&](std::size_t print, const FootPose& foot) {
    const Leg& leg = parts_.leg_of(print);
    return in_signs_of(leg, flat_foot(leg, parts_.plan.grounded[print]).orientation, foot);
  };
  std::vector<Transform> world(parts_.walker.skeleton->names.size());
  double clearance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < frames.poses.size(); ++i) {
    const double time = parts_.time_of(frames.first + static_cast<int>(i));
    auto& target = frames.target.emplace_back();
    // A foot that left the ground at `off`, in flight, goes no further from the hip than the leg
    // reaches: the pelvis need not be lowered for it. It may have been for the foot as it stood.
    const auto within_reach = [&](FootPose foot, FootSide side, double off) {
      const Vec3& hip = frames.hips[i][index_of(side)];
      const Vec3 way = foot.foot.position - hip;
      const Vec3 usual = frames.blend[i][index_of(side)].foot.position - hip;
      const double longest = longest_reach(parts_.walker.leg(side), usual.norm());
      // Softly, as the knee turns far for little where the leg is nearly straight.
      const double soft = kSoftReach * parts_.walker.leg(side).length;
      const double beyond = way.norm() - (longest - soft);
      if (!(beyond > 0)) return foot;
      const double reach = longest - soft * std::exp(-beyond / soft);
      const double share = smoother_step((time - off) / kDrawnUp);
      foot.foot.position -= share * (1 - reach / way.norm()) * way;
      return foot;
    };
    const FootPose& stance_blend = frames.blend[i][index_of(standing)];
    target[index_of(standing)] =
        next && time > next_leaves
            ? within_reach(next->at(time, with_signs(step + 1, stance_blend)), standing,
                           next_leaves)
            : stance(step + 1).at(time, stance_blend);
    const FootPose blend = with_signs(step, frames.blend[i][index_of(moving)]);
    FootPose& foot = target[index_of(moving)];
    if (time <= leaves) {
      foot = stance(step).at(time, blend);
    } else if (time >= now.strike) {
      foot = stance(step + 2).at(time, blend);
    } else {
      foot = swing.at(time, blend);
      const bool was_in_flight = leaves <= now.start;
      if (was_in_flight && time < std::midpoint(leaves, now.strike)) {
        foot = within_reach(foot, moving, leaves);
      }
      const auto points = sole_points(parts_.leg_of(step), foot);
      // Heel and ball: the tip of the toes rolls over the ground as the foot leaves.
      for (const Vec3& point : std::span(points).first(2)) {
        if (!swing.is_to_be_clear(time, foot)) break;
        const auto found = ground_near(parts_.ground, point.x(), point.z(), point.y(), 0.3);
        if (found) clearance = std::min(clearance, point.y() - found->height);
      }
    }
    parts_.walker.to_world(frames.poses[i], world);
    need(frames.first + static_cast<int>(i)) = lowering_for(parts_.walker, world, target);
  }
  made.clearance = std::isfinite(clearance) ? clearance : 0;
}

void WalkBlock::emit(std::size_t step, Clip& clip, MadeStep& made) {
  SampledStep& frames = sampled(step);
  const int count = static_cast<int>(frames.poses.size());
  std::vector<Transform> world(parts_.walker.skeleton->names.size());
  for (int i = 0; i < count; ++i) {
    PoseVector& pose = frames.poses[at(i)];
    const double down = lowered_[at(frames.first + i - parts_.first_frame(low_))];
    position_of(pose, 0).y() -= down;
    parts_.walker.to_world(pose, world);
    const SolvedLegs legs =
        solve_legs(parts_.walker, frames.target[at(i)], parts_.options.stretch, pose, world);
    parts_.walker.to_world(pose, world);
    clip.set_pose(frames.first + i - parts_.first_frame(first_), world);
    made.lowered = std::max(made.lowered, down);
    made.extension = std::max(made.extension, legs.extension);
    made.missed = std::max(made.missed, legs.missed);
    const double time = parts_.time_of(frames.first + i);
    if (!parts_.body.steps()[step].runs()) {
      made.off_support = std::max(made.off_support, off_support(parts_.walker, world));
    }
    for (const std::size_t print : {step, step + 1}) {
      if (time > parts_.body.off_of(print)) continue;
      const Leg& leg = parts_.leg_of(print);
      made.ankle = std::max(made.ankle, leg.standing_ankle - ankle_angle(leg, world));
    }
  }
  frames = {};
}

void WalkBlock::make(Clip& clip, std::span<MadeStep> steps) {
  const std::size_t last = parts_.body.steps().size();
  MadeStep unused;
  for (std::size_t step = low_; step < high_; ++step) sampled(step) = sample(step);
  // The steps at the ends of the block are not completely known and are left out.
  for (std::size_t print = low_ == 0 ? 0 : low_ + 1; print < high_ + 2; ++print) {
    const bool is_known = print < high_ + 1 || high_ == last;
    if (is_known) begin_stance(print);
  }
  for (std::size_t print = low_ == 0 ? 0 : low_ + 1; print < high_ || print < 1; ++print) {
    finish_stance(print);
  }
  // Depends on both steps beside it, so that the outermost are left out.
  for (std::size_t print = low_ == 0 ? 0 : low_ + 2; print < high_; ++print) roll_over_ball(print);
  const std::size_t from = first_ - std::min(first_, kLookedAt);
  const std::size_t to = std::min(end_ + kLookedAt, last);
  for (std::size_t step = from; step < to; ++step) {
    place_feet(step, step >= first_ && step < end_ ? steps[step] : unused);
  }
  const int reach = std::max(2, static_cast<int>(std::lround(kLoweringReach * parts_.rate)));
  lowered_ = smooth_above(needs_, reach);
  for (std::size_t step = first_; step < end_; ++step) emit(step, clip, steps[step]);
}

MotionKeys keys_of(const WalkParts& parts, std::span<const Stance> stances, double duration,
                   std::span<GroundedPrint> prints) {
  MotionKeys keys;
  for (std::size_t print = 0; print < stances.size(); ++print) {
    const Stance& stance = stances[print];
    const Leg& leg = parts.leg_of(print);
    GroundedPrint& grounded = prints[print];
    grounded.strike = stance.strike;
    const double toes_off = std::min(parts.body.toes_off_of(print), stance.tip_off);
    grounded.off = std::min(toes_off, duration);
    const Transform flat = flat_foot(leg, grounded);
    const std::string side = name_of(grounded.side);
    if (print >= 2) keys.keytimes.push_back({stance.strike, side + "_strike"});
    if (toes_off < duration) keys.keytimes.push_back({toes_off, side + "_off"});
    keys.contacts.push_back(
        {leg.foot, stance.flat_from, std::min(stance.flat_to, duration), flat.position});
    if (leg.toes < 0) continue;
    const Transform toes = parts.walker.skeleton->reference_local(leg.toes);
    keys.contacts.push_back(
        {leg.toes, stance.ball_from(), std::min(stance.off, duration), flat * toes.position});
  }
  std::ranges::stable_sort(keys.contacts, [](const Contact& a, const Contact& b) {
    return a.start != b.start ? a.start < b.start : a.joint < b.joint;
  });
  std::ranges::stable_sort(keys.keytimes, {}, &Keytime::time);
  return keys;
}

}  // namespace krok::gait
