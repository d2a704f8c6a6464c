#include "gait/body_motion_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/index.h"
#include "core/numbers.h"
#include "math/hermite.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"

namespace krok::gait {

namespace {

constexpr std::size_t kLongWalk = 8;  // steps of one foot for which sums are worth their time
constexpr double kLead = 0.4;         // seconds of weight shift before the first foot leaves
constexpr double kTail = 0.4;         // seconds after the last strike
constexpr double kBeside = 0.5;       // of the swing: where the swing foot is beside the other
constexpr double kBesideInRun = 0.5;  // of the stance
constexpr double kLifted = 0.4;       // share of the blend in the middle of an only step
constexpr double kShortestStep = 0.2, kLongestStep = 10;  // seconds
// Distance of a step from the examples, metres, from which it is blended with standing, and from
// which only standing is left, as in steps on the spot or to the side.
constexpr double kNear = 0.12, kFar = 0.55;
constexpr double kShortest = 1.0 / 120;  // seconds between poses that a velocity is taken from
constexpr double kUsualGap = 0.06;       // metres between the hips of steps that are alike
constexpr double kVelocityWidth = 0.12;  // seconds in which a difference in velocity fades
constexpr double kShortStride = 0.25;    // metres: shorter ones have no grade
constexpr double kLongStride = 1.5;      // of the leg: in shorter ones the pelvis goes ahead less
constexpr double kRiseSpeed = 1.2;       // of the pelvis at a strike, of its mean over the steps

// From rest at 0 to slope 2 at 1, no acceleration at both ends.
double speed_up(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * s * (2 - s);
}

// The first number from 0 to 1 that is not before what is looked for.
template <typename IsBefore>
double bisected(const IsBefore& is_before) {
  double low = 0, high = 1;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (is_before(middle) ? low : high) = middle;
  }
  return high;
}

struct EndState {
  PoseVector value, velocity, acceleration;
};
// `inwards`: +1 at the start of the step, -1 at its end. Velocities are from the parabola through
// three poses, accelerations from the cubic through four: longer fits would include the shock of a
// heel strike.
EndState end_state(const BodyStep& step, double time, double inwards, double spacing) {
  auto scratch = step.motion.make_scratch();
  EndState end;
  PoseVector next, far, farthest;
  step.pose(time, end.value, scratch);
  step.pose(time + inwards * spacing, next, scratch);
  step.pose(time + inwards * 2 * spacing, far, scratch);
  step.pose(time + inwards * 3 * spacing, farthest, scratch);
  end.velocity = inwards / (2 * spacing) * (4 * next - far - 3 * end.value);
  end.acceleration = (2 * end.value - 5 * next + 4 * far - farthest) / (spacing * spacing);
  return end;
}

void match_signs(PoseVector& pose, const PoseVector& to) {
  for (int j = 0; j < pose.size() / kPoseValues; ++j) {
    if (rotation_of(pose, j).dot(rotation_of(to, j)) < 0) rotation_of(pose, j) *= -1;
  }
}

// Places the blend so that its flat stance foot is on the print. (The foot still moves at the
// strike that captures mark, so the footprint of that moment lies further back.)
Transform stance_frame(const Walker& walker, const GroundedPrint& print, const StepLibrary& library,
                       const BodyStep& step) {
  const BodyStep plain(step.motion, walker);
  auto scratch = step.motion.make_scratch();
  PoseVector pose;
  const std::vector<double>& times = step.motion.keytimes();
  const double strike = times[index_of_time(library.library(), "swing_strike")];
  double when = kFlatInRun * step.blend_stance_off;
  if (!step.runs()) {
    when = std::lerp(times[index_of_time(library.library(), "swing_off")], strike, kFlatPart);
  }
  plain.pose(when, pose, scratch);
  const Leg& leg = walker.leg(print.side);
  const Transform foot = joint_to_world(*walker.skeleton, pose, leg.foot);
  const Vec3 forward = foot.orientation * (leg.sole.sole * Vec3::UnitZ());
  const Transform flat{foot * leg.sole.heel,
                       axis_rotation(Axis::y, std::atan2(forward.x(), forward.z()))};
  const double toes = print.facing + (print.side == FootSide::left ? 1 : -1) * library.toe_out();
  return Transform{print.heel, axis_rotation(Axis::y, toes)} * flat.inverse();
}

}  // namespace

Transform flat_foot(const Leg& leg, const GroundedPrint& print) {
  Mat3 axes;
  axes << print.up.cross(print.forward), print.up, print.forward;
  const Quat orientation = Quat(axes) * leg.sole.sole.conjugate();
  return {print.heel - orientation * leg.sole.heel, orientation};
}

PoseVector standing_on(const Walker& walker, const GroundedPrint& one, const GroundedPrint& two) {
  const Vec3 a = flat_foot(walker.leg(one.side), one).position;
  const Vec3 b = flat_foot(walker.leg(two.side), two).position;
  const double heading = one.facing + 0.5 * wrapped(two.facing - one.facing);
  Vec3 middle = 0.5 * (a + b);
  middle.y() = 0.5 * (one.heel.y() + two.heel.y());
  const Transform place{middle, axis_rotation(Axis::y, heading)};
  PoseVector pose = walker.stand;
  const Transform root = place * joint_of(pose, 0);
  position_of(pose, 0) = root.position;
  rotation_of(pose, 0) = root.orientation.coeffs();
  return pose;
}

// The pelvis rises or falls as the ground does, is as high over the stance foot as on the level in
// the middle of the step and halfway between the prints at its ends; and the body leans.
void BodyStep::follow_slope(double time, PoseVector& pose) const {
  if (strike > start) {
    const double length = strike - start;
    const double u = std::clamp((time - start) / length, 0.0, 1.0);
    const Fading begin = fading(u), end = fading(1 - u);
    position_of(pose, 0).y() += 0.5 * (end.value * rise_after - begin.value * rise_before) +
                                length * (begin.slope * speed_before - end.slope * speed_after);
  }
  const double leg = walker->legs[0].length;
  position_of(pose, 0) += leg * (gait.ahead * way - gait.lower * Vec3::UnitY());
  if (gait.lean == 0) return;
  const Quat lean = from_rotation_vector(gait.lean * Vec3::UnitY().cross(way));
  const auto turn = [&](int joint, const Quat& by) {
    if (joint <= 0) return;
    const int parent = walker->skeleton->parents[at(joint)];
    const Quat above = joint_to_world(*walker->skeleton, pose, parent).orientation;
    Quat own;
    own.coeffs() = rotation_of(pose, joint);
    rotation_of(pose, joint) = (above.conjugate() * by * above * own).coeffs();
  };
  turn(walker->spine, lean);
  turn(walker->neck, lean.conjugate());
}

void BodyStep::pose(double time, PoseVector& pose,
                    parametric::BlendedMotion::Scratch& scratch) const {
  double inside = (time - start) / scale, part = 1;
  const double length = motion.duration();
  if (kind == Kind::first) {
    const double moves = 2 * (length - rest);
    inside = rest + (length - rest) * speed_up((time - start - lead) / scale / moves);
    part = smoother_step((time - start) / (lead + 0.9 * moves * scale));
  } else if (kind == Kind::last) {
    const double moves = 2 * rest;
    inside = rest * (1 - speed_up(1 - inside / moves));
    const double from = start + 0.2 * moves * scale;
    part = 1 - smoother_step((time - from) / (finish - from));
  } else if (kind == Kind::only) {
    inside = rest;
  }
  std::array<PoseBlock, 16> blocks_here;
  std::vector<PoseBlock> many;
  std::span<PoseBlock> blocks(blocks_here);
  if (scratch.reference.size() > blocks.size()) {
    many.resize(scratch.reference.size());
    blocks = many;
  }
  blocks = blocks.first(scratch.reference.size());
  motion.pose(inside, blocks, scratch);
  pose.resize(kPoseValues * joints);
  for (int j = 0; j < joints; ++j) {
    const PoseBlock& block = blocks[at(j / PoseBlock::kLanes)];
    const int lane = j % PoseBlock::kLanes;
    double* values = pose.data() + kPoseValues * j;
    for (int c = 0; c < 3; ++c) values[c] = block.position[c][lane];
    for (int c = 0; c < 4; ++c) values[3 + c] = block.rotation[c][lane];
  }
  for (const FixedJoint& bone : *bones) position_of(pose, bone.joint) = bone.place;
  position_of(pose, 0) = stance_to_world * Vec3(position_of(pose, 0));
  Quat turn;
  turn.coeffs() = rotation_of(pose, 0);
  rotation_of(pose, 0) = (stance_to_world.orientation * turn).coeffs();
  follow_slope(time, pose);
  if (kind == Kind::only) {
    const double u = smoother_step((time - start) / (finish - start));
    const double lifted = 4 * kLifted * u * (1 - u);
    pose = lifted * pose + (1 - lifted) * ((1 - u) * stand + u * stand_after);
    return;
  }
  if (part < 1) pose = part * pose + (1 - part) * stand;
  if (standing > 0) {
    const double u = smoother_step((time - start) / (finish - start));
    pose = (1 - standing) * pose + standing * ((1 - u) * stand + u * stand_after);
  }
}

double BodyMotion::leaves(std::size_t print, double BodyStep::*swing,
                          double BodyStep::*stance) const {
  if (print > 0 && print <= steps_.size() && std::isfinite(steps_[print - 1].*stance)) {
    return steps_[print - 1].*stance;
  }
  return print < steps_.size() ? steps_[print].*swing : steps_.back().finish + 1;
}

Gap BodyMotion::gap_after(std::size_t step) const {
  const BodyStep& before = steps_[step];
  const BodyStep& after = steps_[step + 1];
  const double spacing =
      std::clamp(1 / rate_, kShortest,
                 0.1 * std::min(before.strike - before.start, after.strike - after.start));
  const EndState a = end_state(before, before.strike, -1, spacing);
  const EndState b = end_state(after, after.start, 1, spacing);
  Gap gap;
  gap.sign = PoseVector::Ones(a.value.size());
  for (int j = 0; j < a.value.size() / kPoseValues; ++j) {
    if (rotation_of(a.value, j).dot(rotation_of(b.value, j)) < 0) {
      rotation_of(gap.sign, j).setConstant(-1);
    }
  }
  gap.value = gap.sign.cwiseProduct(b.value) - a.value;
  gap.velocity = gap.sign.cwiseProduct(b.velocity) - a.velocity;
  gap.acceleration =
      is_accelerated_.cwiseProduct(gap.sign.cwiseProduct(b.acceleration) - a.acceleration);
  gap.before = 0.5 * (before.strike - before.start);
  gap.after = 0.5 * (after.strike - after.start);
  // The first and the last step, which are not only blends, take the whole difference: they may be
  // short.
  if (before.kind == BodyStep::Kind::first && after.kind == BodyStep::Kind::middle) {
    gap.share = 1;
    gap.before = before.strike - before.start;
  } else if (after.kind == BodyStep::Kind::last && before.kind == BodyStep::Kind::middle) {
    gap.share = 0;
    gap.after = after.strike - after.start;
  }
  const double apart = position_of(gap.value, 0).norm();
  const double strange = smoother_step((apart - kUsualGap) / kUsualGap);
  gap.root_share = (1 - strange) * gap.share;
  gap.after += strange * (after.strike - after.start - gap.after);
  // At a strike, the hips are nearer to the striking foot in a run than in a walk: the correction
  // is spread over both steps, so that their speed changes gradually.
  if (before.runs() != after.runs() && gap.share == 0.5) {
    gap.before = before.strike - before.start;
    gap.after = after.strike - after.start;
    gap.root_share = gap.share;
  }
  return gap;
}

namespace {

// The correction that closes a gap, `since` seconds away from it on one side.
void add_correction(const Gap& gap, double since, double width, double inwards, double root_part,
                    double part, PoseVector& pose) {
  const Fading wide = fading(since / width);
  if (wide.value == 0) return;
  const double narrow = std::min(width, kVelocityWidth);
  const Fading close = fading(since / narrow);
  const auto rest = pose.size() - kPoseValues;
  // Differences of the body fade slowly, those of swinging limbs quickly.
  pose.head<kPoseValues>() +=
      root_part * (wide.value * gap.value.head<kPoseValues>() +
                   inwards * width * wide.slope * gap.velocity.head<kPoseValues>());
  pose.tail(rest) += part * wide.value * gap.value.tail(rest);
  if (since >= narrow) return;
  pose.tail(rest) += part * inwards * narrow * close.slope * gap.velocity.tail(rest);
  pose.tail(rest) += part * narrow * narrow * close.acceleration * gap.acceleration.tail(rest);
  pose.head<kPoseValues>() +=
      root_part * narrow * narrow * close.acceleration * gap.acceleration.head<kPoseValues>();
}

}  // namespace

void joined_pose(const BodyStep& step, double time, const Gap* before, const Gap* after,
                 PoseVector& pose, parametric::BlendedMotion::Scratch& scratch) {
  step.pose(time, pose, scratch);
  if (before != nullptr) {
    // In the signs of the step before.
    pose = before->sign.cwiseProduct(pose);
    add_correction(*before, time - step.start, before->after, 1, before->root_share - 1,
                   before->share - 1, pose);
    pose = before->sign.cwiseProduct(pose);
  }
  if (after != nullptr) {
    add_correction(*after, step.strike - time, after->before, -1, after->root_share, after->share,
                   pose);
  }
}

Status BodyMotion::set_times(const PlannedWalk& plan, double off, double toes_off, double speed,
                             BodyStep& step) const {
  using enum BodyStep::Kind;
  step.start = steps_.empty() ? 0 : steps_.back().strike;
  const double length = step.motion.duration();
  double moving = length, lead = 0, tail = 0;  // seconds at the blend's pace
  if (step.kind == captured_stop) {
    moving = step.blend_strike;
    tail = length - moving;
  }
  if (step.kind == first) moving = 2 * (length - step.rest);
  if (step.kind == last) moving = 2 * step.rest;
  if (step.kind == first || step.kind == only) lead = kLead;
  if (step.kind == last || step.kind == only) tail = kTail;
  step.scale = step.gait.duration / speed;
  const auto& time = plan.prints[at(step.stance) + 1].time;
  if (time) {
    const double wanted = *time - step.start;
    if (!(wanted >= kShortestStep && wanted <= kLongestStep)) {
      return Error("walk-time",
                   fmt::format("print {}: the step would last {} s, {} to {} s are possible",
                               step.stance + 2, readable(wanted, 3), kShortestStep, kLongestStep),
                   "times are of the strikes, in seconds from the first frame");
    }
    step.scale = wanted / (lead + moving);
  }
  step.lead = lead * step.scale;
  step.strike = step.start + (lead + moving) * step.scale;
  step.finish = step.strike + tail * step.scale;
  const auto swing_leaves = [&](double when) {
    if (lead > 0) return step.start + step.lead + 0.05 * moving * step.scale;
    if (step.kind != last || step.runs()) return step.start + when * step.scale;
    // When the slowing blend gets there.
    const double part =
        bisected([&](double u) { return step.rest * (1 - speed_up(1 - u)) < when; });
    return step.start + part * moving * step.scale;
  };
  const auto stance_leaves = [&](double when) {
    if (step.kind == middle && step.runs()) return step.start + when * step.scale;
    if (step.kind != first || !step.runs()) return std::numeric_limits<double>::infinity();
    const double part =
        bisected([&](double u) { return std::lerp(step.rest, length, speed_up(u)) < when; });
    return step.start + (lead + part * moving) * step.scale;
  };
  step.off = swing_leaves(off);
  step.toes_off = swing_leaves(step.runs() ? off : toes_off);
  step.stance_off = stance_leaves(step.blend_stance_off);
  step.stance_toes_off = stance_leaves(toes_off);
  return {};
}

namespace {

// How the ground goes on, beyond what the blend of the step does.
void take_slope(const PlannedWalk& plan, const PlannedStep& planned,
                const parametric::Library& library, BodyStep& step) {
  const std::size_t stance = at(planned.stance);
  const GroundedPrint& from = plan.grounded[stance - 1];
  const GroundedPrint& on = plan.grounded[stance];
  const GroundedPrint& to = plan.grounded[stance + 1];
  const Vec3 stride(to.heel.x() - from.heel.x(), 0, to.heel.z() - from.heel.z());
  double rises = 0;
  for (std::size_t d = 0; d < library.parameters.size(); ++d) {
    if (library.parameters[d].quantity == parametric::Quantity::step_height) {
      rises = planned.made[d];
    }
  }
  step.rise_before = on.heel.y() - from.heel.y() - rises;
  step.rise_after = to.heel.y() - on.heel.y() - rises;
  const double run = stride.norm();
  if (run < kShortStride) return;
  step.way = stride / run;
  const double share = smoother_step(run / kShortStride - 1);
  const double sole =
      std::asin(std::clamp(to.forward.y(), -1.0, 1.0)) * (step.way.dot(to.forward) < 0 ? -1 : 1);
  const double covered = std::atan2(2 * rises, run);
  const double grade = std::atan2(step.rise_before + step.rise_after, run);
  step.gait = slope_gait(share * grade, share * (sole - covered));
  step.gait.ahead *= std::min(1.0, run / (kLongStride * step.walker->legs[0].length));
}

}  // namespace

Status BodyMotion::add_step(std::span<const StepLibrary> libraries, const Walker& walker,
                            const PlannedWalk& plan, std::size_t index,
                            const WalkOptions& options) {
  const PlannedStep& planned = plan.steps[index];
  const std::size_t stance = at(planned.stance);
  const GroundedPrint& print = plan.grounded[stance];
  const parametric::Synthesiser& maker = libraries[at(planned.library)].steps(other(print.side));
  auto motion = maker.motion(planned.weights);
  if (!motion) return motion.error();
  BodyStep step(*std::move(motion), walker);
  step.start = steps_.empty() ? 0 : steps_.back().strike;
  const std::vector<double>& times = step.motion.keytimes();
  const StepKind made_of = libraries[at(planned.library)].kind();
  double off = 0, toes_off = 0;
  step.blend_strike = times[index_of_time(maker.library(), "swing_strike")];
  if (made_of == StepKind::run) {
    toes_off = times[index_of_time(maker.library(), "stance_off")];
    step.blend_stance_off = walker.run_off * toes_off;
    step.rest = kBesideInRun * step.blend_stance_off;
  } else {
    toes_off = times[index_of_time(maker.library(), "swing_off")];
    // At a start the ball leaves the ground as long before the toes as in a walk.
    off = made_of == StepKind::start
              ? toes_off - std::min((1 - walker.ball_off) * walker.usual_off, toes_off / 2)
              : walker.ball_off * toes_off;
    step.rest = off + kBeside * (step.blend_strike - off);
  }
  step.stance = planned.stance;
  const bool is_first = index == 0, is_last = index + 1 == plan.steps.size();
  if (!is_last && (!is_first || libraries[at(planned.library)].is_middle())) {
    step.standing = smoother_step((planned.far - kNear) / (kFar - kNear));
    if (step.standing > 0) {
      step.stand = standing_on(walker, plan.grounded[stance - 1], print);
      step.stand_after = standing_on(walker, print, plan.grounded[stance + 1]);
    }
  }
  if (is_first) step.stand = standing_on(walker, plan.grounded[stance - 1], print);
  if (is_last && !is_first) step.stand = standing_on(walker, print, plan.grounded[stance + 1]);
  if (is_last && is_first) step.stand_after = standing_on(walker, print, plan.grounded[stance + 1]);
  using enum BodyStep::Kind;
  step.kind = is_first && is_last ? only
              : is_first          ? made_of == StepKind::start ? captured_start : first
              : is_last           ? made_of == StepKind::stop ? captured_stop : last
                                  : middle;
  if (step.kind == captured_start || step.kind == captured_stop) step.stand.resize(0);
  take_slope(plan, planned, maker.library(), step);
  if (Status status = set_times(plan, off, toes_off, options.speed, step); !status) return status;
  step.stance_to_world = stance_frame(walker, print, libraries[at(planned.library)], step);
  if (step.stand.size() > 0) {
    PoseVector sample;
    auto scratch = step.motion.make_scratch();
    BodyStep plain(step.motion, walker);
    plain.stance_to_world = step.stance_to_world;
    plain.pose(step.rest, sample, scratch);
    match_signs(step.stand, sample);
    if (step.stand_after.size() > 0) match_signs(step.stand_after, sample);
  }
  steps_.push_back(std::move(step));
  return {};
}

// Long walks make their frames from a few sums of all examples.
void BodyMotion::sum_examples(std::span<const StepLibrary> libraries, const PlannedWalk& plan) {
  for (std::size_t library = 0; library < libraries.size(); ++library) {
    for (const FootSide swing : {FootSide::left, FootSide::right}) {
      std::vector<std::size_t> made_of_it;
      std::vector<std::vector<double>> rows;
      for (std::size_t i = 0; i < plan.steps.size(); ++i) {
        const PlannedStep& step = plan.steps[i];
        if (at(step.library) != library || plan.grounded[at(step.stance) + 1].side != swing)
          continue;
        made_of_it.push_back(i);
        rows.push_back(step.weights);
        if (step.example >= 0) rows.back()[at(step.example)] -= step.example_share;
      }
      if (made_of_it.size() < kLongWalk) continue;
      const std::vector<std::span<const double>> spans(rows.begin(), rows.end());
      auto sums = parametric::ExampleSums::create(libraries[library].steps(swing).packed(), spans);
      if (!sums) continue;
      sums_.push_back(std::make_unique<const parametric::ExampleSums>(*std::move(sums)));
      for (const std::size_t i : made_of_it) {
        const PlannedStep& step = plan.steps[i];
        steps_[i].motion.use(*sums_.back(), step.example, step.example_share);
      }
    }
  }
}

Result<BodyMotion> BodyMotion::create(std::span<const StepLibrary> libraries, const Walker& walker,
                                      const PlannedWalk& plan, const WalkOptions& options) {
  BodyMotion body;
  body.rate_ = main_library(libraries).library().rate;
  body.is_accelerated_ = PoseVector::Ones(kPoseValues * walker.skeleton->joint_count());
  for (int j = 1; j < walker.skeleton->joint_count(); ++j) {
    position_of(body.is_accelerated_, j).setZero();
  }
  for (const Leg& leg : walker.legs) {
    for (const int j : leg.path) rotation_of(body.is_accelerated_, j).setZero();
  }
  body.steps_.reserve(plan.steps.size());
  for (std::size_t i = 0; i < plan.steps.size(); ++i) {
    if (Status status = body.add_step(libraries, walker, plan, i, options); !status) {
      return status.error();
    }
  }
  body.sum_examples(libraries, plan);
  for (std::size_t i = 0; i + 1 < body.steps_.size(); ++i) {
    BodyStep& before = body.steps_[i];
    BodyStep& after = body.steps_[i + 1];
    const double lasts = 0.5 * (after.strike - before.start);
    before.speed_after = kRiseSpeed * before.rise_after / lasts;
    after.speed_before = kRiseSpeed * after.rise_before / lasts;
  }
  return body;
}

}  // namespace krok::gait
