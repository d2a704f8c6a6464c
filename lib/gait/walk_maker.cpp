#include "gait/walk_maker_internal.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "math/quaternion.h"

namespace krok::gait {

namespace {

constexpr double kFlat = 2 * kRadiansPerDegree;  // turns of a flat foot less than this
constexpr double kSpacing = 0.01;                // seconds, of derivatives at the ends of a swing
constexpr double kLoweringReach = 0.1;           // seconds over which the pelvis is lowered
constexpr double kMiddle = 0.4;                  // of the single support: the foot is flat

// When `pitch` comes to kFlat between two frames.
double crossing(double from, double to, double pitch_from, double pitch_to) {
  const double a = std::abs(pitch_from), b = std::abs(pitch_to);
  if (a == b) return to;
  return from + (to - from) * std::clamp((a - kFlat) / (a - b), 0.0, 1.0);
}

}  // namespace

WalkMaker::WalkMaker(const Walker& walker, const PlannedWalk& plan, const BodyMotion& body,
                     const Terrain& ground, const WalkOptions& options, double rate)
    : walker_(walker),
      plan_(plan),
      body_(body),
      ground_(ground),
      options_(options),
      rate_(rate),
      sampled_(plan.steps.size()),
      stances_(plan.grounded.size()),
      clearances_(plan.steps.size(), 0) {
  frames_ = static_cast<int>(std::ceil(body.steps().back().finish * rate - 1e-9)) + 1;
  needs_.assign(at(frames_), 0);
}

SampledStep WalkMaker::sample(std::size_t step) const {
  const std::vector<BodyStep>& steps = body_.steps();
  const auto first_after = [&](double time) {
    return static_cast<int>(std::ceil(time * rate_ - 1e-9));
  };
  SampledStep result;
  result.first = first_after(steps[step].start);
  const int end = step + 1 < steps.size() ? first_after(steps[step].strike) : frames_;
  auto scratch = steps[step].motion.make_scratch();
  std::vector<Transform> world(walker_.skeleton->names.size());
  for (int f = result.first; f < end; ++f) {
    PoseVector& pose = result.poses.emplace_back();
    body_.pose(step, time_of(f), pose, scratch);
    walker_.to_world(pose, world);
    result.blend.push_back({foot_of(walker_.legs[0], world), foot_of(walker_.legs[1], world)});
  }
  return result;
}

FootPose WalkMaker::blend_foot(std::size_t step, double time, FootSide side,
                               const Quat& signs) const {
  auto scratch = body_.steps()[step].motion.make_scratch();
  PoseVector pose;
  body_.pose(step, time, pose, scratch);
  std::vector<Transform> world(walker_.skeleton->names.size());
  walker_.to_world(pose, world);
  return in_signs_of(walker_.leg(side), signs, foot_of(walker_.leg(side), world));
}

const FootPose& WalkMaker::nearest(const SampledStep& step, double time, FootSide side) const {
  const int last = static_cast<int>(step.blend.size()) - 1;
  const int f = std::clamp(static_cast<int>(std::lround(time * rate_)) - step.first, 0, last);
  return step.blend[at(f)][index_of(side)];
}

// When the foot that strikes print `print` comes to lie flat. The step over it has been sampled.
void WalkMaker::begin_stance(std::size_t print) {
  const std::vector<BodyStep>& steps = body_.steps();
  const std::size_t over = print == 0 ? 0 : std::min(print - 1, steps.size() - 1);
  const BodyStep& step = steps[over];
  const SampledStep& frames = sampled_[over];
  const FootSide side = side_of(print);
  const bool is_first = print < 2, is_last = print + 1 == stances_.size();
  double middle = step.off + kMiddle * (step.strike - step.off);
  if (is_first) middle = 0;
  if (is_last) middle = step.finish;
  Stance stance(walker_.leg(side), plan_.grounded[print], nearest(frames, middle, side));
  stance.strike = is_first ? 0 : is_last ? step.strike : step.start;
  stance.flat_from = stance.strike;
  stance.flat_to = stance.off = body_.steps().back().finish + 1;
  double before = 0, time_before = 0;
  for (std::size_t i = 0; i < frames.blend.size() && !is_first; ++i) {
    const double time = time_of(frames.first + static_cast<int>(i));
    if (time < stance.strike) continue;
    const double pitch = stance.pitch(frames.blend[i][index_of(side)]);
    if (std::abs(pitch) < kFlat || time >= middle) {
      if (time_before > 0) stance.flat_from = crossing(time_before, time, before, pitch);
      break;
    }
    before = pitch;
    time_before = time;
  }
  stances_[print] = stance;
}

// When its heel comes up and its toes leave the ground, in the next step, which has been sampled.
void WalkMaker::finish_stance(std::size_t print) {
  const std::vector<BodyStep>& steps = body_.steps();
  if (print >= steps.size()) return;  // the walk ends on it
  Stance& stance = stances_[print];
  const FootSide side = side_of(print);
  stance.off = steps[print].off;
  stance.flat_to = stance.off;
  double after = 0, time_after = 0;
  // Backwards from the off to the frame that is flat.
  for (std::size_t s = print + 1; s-- > (print == 0 ? 0 : print - 1);) {
    const SampledStep& frames = sampled_[s];
    for (std::size_t i = frames.blend.size(); i-- > 0;) {
      const double time = time_of(frames.first + static_cast<int>(i));
      if (time > stance.off) continue;
      const double pitch = stance.pitch(frames.blend[i][index_of(side)]);
      if (std::abs(pitch) < kFlat || time <= stance.flat_from) {
        stance.flat_to = time_after > 0 ? crossing(time_after, time, after, pitch) : time;
        stance.flat_to = std::max(stance.flat_to, stance.flat_from);
        return;
      }
      after = pitch;
      time_after = time;
    }
  }
}

Swing WalkMaker::make_swing(std::size_t step) {
  const BodyStep& now = body_.steps()[step];
  const Stance& from = stances_[step];
  const Stance& to = stances_[step + 2];
  const FootSide side = side_of(step);
  const Quat signs = flat_foot(leg_of(step), plan_.grounded[step]).orientation;
  Swing swing(leg_of(step), now.off, now.strike);
  Swing::Ends off, strike;
  const bool is_last = step + 1 == body_.steps().size();
  off.spacing = std::min(kSpacing, (now.off - now.start) / 3);
  strike.spacing = kSpacing;
  for (std::size_t i = 0; i < 3; ++i) {
    const double time = now.off - off.spacing * static_cast<double>(i);
    off.blend[i] = blend_foot(step, time, side, signs);
    off.wanted[i] = from.at(time, off.blend[i]);
    const double later = now.strike + strike.spacing * static_cast<double>(i);
    strike.blend[i] = blend_foot(is_last ? step : step + 1, later, side, signs);
    strike.wanted[i] = to.at(later, strike.blend[i]);
  }
  swing.set_ends(off, strike);
  const SampledStep& frames = sampled_[step];
  std::vector<double> times;
  std::vector<FootPose> blend;
  for (std::size_t i = 0; i < frames.blend.size(); ++i) {
    times.push_back(time_of(frames.first + static_cast<int>(i)));
    blend.push_back(in_signs_of(leg_of(step), signs, frames.blend[i][index_of(side)]));
  }
  const double height = std::max(plan_.grounded[step].heel.y(), plan_.grounded[step + 2].heel.y());
  swing.clear(ground_, times, blend, options_.clearance, height);
  return swing;
}

void WalkMaker::place_feet(std::size_t step) {
  const BodyStep& now = body_.steps()[step];
  SampledStep& frames = sampled_[step];
  const Swing swing = make_swing(step);
  const FootSide moving = side_of(step), standing = side_of(step + 1);
  const Quat signs = flat_foot(leg_of(step), plan_.grounded[step]).orientation;
  std::vector<Transform> world(walker_.skeleton->names.size());
  double clearance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < frames.poses.size(); ++i) {
    const double time = time_of(frames.first + static_cast<int>(i));
    auto& target = frames.target.emplace_back();
    target[index_of(standing)] = stances_[step + 1].at(time, frames.blend[i][index_of(standing)]);
    const FootPose blend = in_signs_of(leg_of(step), signs, frames.blend[i][index_of(moving)]);
    FootPose& foot = target[index_of(moving)];
    if (time <= now.off) {
      foot = stances_[step].at(time, blend);
    } else if (time >= now.strike) {
      foot = stances_[step + 2].at(time, blend);
    } else {
      foot = swing.at(time, blend);
      const double part = (time - now.off) / (now.strike - now.off);
      for (const Vec3& point : sole_points(leg_of(step), foot)) {
        if (part < 0.25 || part > 0.75) break;
        const auto found = ground_near(ground_, point.x(), point.z(), point.y(), 0.3);
        if (found) clearance = std::min(clearance, point.y() - found->height);
      }
    }
    walker_.to_world(frames.poses[i], world);
    needs_[at(frames.first) + i] = lowering_for(walker_, world, target);
  }
  clearances_[step] = std::isfinite(clearance) ? clearance : 0;
}

void WalkMaker::emit(std::size_t step, Walk& walk) {
  SampledStep& frames = sampled_[step];
  const int count = static_cast<int>(frames.poses.size());
  const int reach = std::max(2, static_cast<int>(std::lround(kLoweringReach * rate_)));
  const int from = std::max(0, frames.first - 2 * reach - 2);
  const int to = std::min(frames_, frames.first + count + 2 * reach + 2);
  const auto lowered = smooth_above(std::span(needs_).subspan(at(from), at(to - from)), reach);
  StepReport& report = walk.steps[step];
  std::vector<Transform> world(walker_.skeleton->names.size());
  for (int i = 0; i < count; ++i) {
    PoseVector& pose = frames.poses[at(i)];
    const double down = lowered[at(frames.first + i - from)];
    position_of(pose, 0).y() -= down;
    walker_.to_world(pose, world);
    const SolvedLegs legs =
        solve_legs(walker_, frames.target[at(i)], options_.stretch, pose, world);
    walker_.to_world(pose, world);
    walk.clip.set_pose(frames.first + i, world);
    report.pelvis_lowered = std::max(report.pelvis_lowered, down);
    report.leg_extension = std::max(report.leg_extension, legs.extension);
    report.missed = std::max(report.missed, legs.missed);
  }
  report.clearance = clearances_[step];
  frames = {};
}

void WalkMaker::make(Walk& walk, Progress* progress) {
  const std::size_t count = sampled_.size();
  walk.clip.skeleton = *walker_.skeleton;
  walk.clip.rate = rate_;
  walk.clip.resize(frames_);
  if (progress != nullptr) progress->begin("walking", count);
  sampled_[0] = sample(0);
  begin_stance(0);
  begin_stance(1);
  finish_stance(0);
  for (std::size_t step = 0; step < count; ++step) {
    if (step + 1 < count) sampled_[step + 1] = sample(step + 1);
    begin_stance(step + 2);
    finish_stance(step + 1);
    place_feet(step);
    if (step > 0) emit(step - 1, walk);
    if (progress != nullptr) progress->advance(1);
  }
  emit(count - 1, walk);
  if (progress != nullptr) progress->end();
  add_keys(walk);
}

void WalkMaker::add_keys(Walk& walk) const {
  const double end = walk.clip.duration();
  for (std::size_t print = 0; print < stances_.size(); ++print) {
    const Stance& stance = stances_[print];
    const Leg& leg = leg_of(print);
    GroundedPrint& grounded = walk.prints[print];
    grounded.strike = stance.strike;
    grounded.off = std::min(stance.off, end);
    const Transform flat = flat_foot(leg, grounded);
    const std::string side = name_of(grounded.side);
    if (print >= 2) walk.keys.keytimes.push_back({stance.strike, side + "_strike"});
    if (stance.off < end) walk.keys.keytimes.push_back({stance.off, side + "_off"});
    walk.keys.contacts.push_back(
        {leg.foot, stance.flat_from, std::min(stance.flat_to, end), flat.position});
    if (leg.toes < 0) continue;
    const Transform toes = walker_.skeleton->reference_local(leg.toes);
    walk.keys.contacts.push_back({leg.toes, stance.flat_from, grounded.off, flat * toes.position});
  }
  std::ranges::stable_sort(walk.keys.contacts, [](const Contact& a, const Contact& b) {
    return a.start != b.start ? a.start < b.start : a.joint < b.joint;
  });
  std::ranges::stable_sort(walk.keys.keytimes, {}, &Keytime::time);
}

}  // namespace krok::gait
