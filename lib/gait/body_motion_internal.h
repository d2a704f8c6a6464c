#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "gait/ground_prints_internal.h"
#include "gait/slope_gait_internal.h"
#include "gait/walk.h"
#include "parametric/blended_motion.h"

// Which step of which library goes from print to print.

namespace krok::gait {

// The step over print `stance`, from print stance - 1 to print stance + 1.
struct PlannedStep {
  int stance = 0;
  int library = 0;
  std::vector<double> asked;  // parameters by the prints, the others as usual
  std::vector<std::uint8_t> is_asked;
  std::vector<double> nearest;  // the nearest inside the examples' range
  double far = 0;               // metres from `asked` to `nearest`
  std::vector<double> weights;
  std::vector<double> made;  // parameters of the blend
  // The example whose style it has, -1 if none, and how much of it, see choose_styles().
  int example = -1;
  double example_share = 0;
};

struct PlannedWalk {
  std::vector<Print> prints;  // moved where `adapt` asked for it
  std::vector<GroundedPrint> grounded;
  std::vector<PlannedStep> steps;
  std::vector<double> moved;  // metres, [prints]
  std::vector<std::string> why_moved;
  Diagnostics warnings;
};

// Sets the parameters that are not asked for: to those of the examples of the style, weighted by
// how near these are in the parameters that are. All are [parameters].
void take_usual(const StepLibrary& steps, FootSide swing, std::span<const std::uint8_t> is_asked,
                std::span<double> parameters);

Result<PlannedWalk> plan_steps(std::span<const StepLibrary> libraries, const Walker& walker,
                               std::span<const Print> prints, const Terrain& ground,
                               const WalkOptions& options);

// The quintic that is 1, with slope or with acceleration 1, at s = 0, its two other derivatives
// zero, and zero with two derivatives at s = 1.
struct Fading {
  double value, slope, acceleration;
};
inline Fading fading(double s) {
  if (s >= 1) return {0, 0, 0};
  const double s2 = s * s, s3 = s2 * s;
  return {1 - s3 * (10 - s * (15 - 6 * s)), s - s3 * (6 - s * (8 - 3 * s)),
          0.5 * s2 - s3 * (1.5 - s * (1.5 - 0.5 * s))};
}

// The motion of the whole body over all steps, joined, before the feet are set on their prints.
//

// The blend of a step, placed in the world and in the time of the walk. The first step starts from
// standing: a captured start is used from its first frame; any other step starts slowly from the
// standing pose, with the swing foot beside the stance foot. The last step ends likewise. A walk of
// one step goes from standing to standing.
struct BodyStep {
  enum class Kind : unsigned char { middle, captured_start, captured_stop, first, last, only };

  BodyStep(parametric::BlendedMotion blend, const Walker& whose)
      : motion(std::move(blend)),
        bones(&whose.bones),
        joints(whose.skeleton->joint_count()),
        walker(&whose) {}

  parametric::BlendedMotion motion;
  const std::vector<FixedJoint>* bones;
  int joints = 0;
  Kind kind = Kind::middle;
  int stance = 0;  // print
  Transform stance_to_world;
  double start = 0, strike = 0;  // seconds: of the step, and of the swing foot
  // Seconds, when the ball of the swing foot leaves the ground, and its toes; and the same of the
  // stance foot in a run, else infinite.
  double off = 0, toes_off = 0, stance_off = 0, stance_toes_off = 0;
  double finish = 0;            // seconds, strike but for the last step
  double scale = 1;             // seconds of the walk for a second of the blend
  double rest = 0;              // seconds of the blend where it rests beside the stance foot
  double blend_strike = 0;      // seconds of the blend
  double blend_stance_off = 0;  // the same, of a run; else 0
  double lead = 0;              // seconds from the start to where the blend begins to move
  PoseVector stand;             // in the world, before the first step or after the last
  double standing = 0;          // share of standing in a step that no example is near
  PoseVector stand_after;       // after an only step, and where standing > 0
  // What the ground rises more than the blend does, metres: from the print before to the stance
  // foot's, and on to the next one; and how fast the pelvis rises where the steps meet, m/s.
  double rise_before = 0, rise_after = 0, speed_before = 0, speed_after = 0;
  SlopeGait gait;           // for that rise
  Vec3 way = Vec3::Zero();  // level, from print to print, unit vector
  const Walker* walker = nullptr;

  bool runs() const { return blend_stance_off > 0; }
  // When the stance foot is flat.
  double flat_time() const {
    return std::isfinite(stance_off) ? std::lerp(start, stance_off, kFlatInRun)
                                     : std::lerp(off, strike, kFlatPart);
  }

  // Before joining, clamped to the step.
  void pose(double time, PoseVector& pose, parametric::BlendedMotion::Scratch& scratch) const;

 private:
  void follow_slope(double time, PoseVector& pose) const;
};

// The difference between two steps where they meet, the later minus the earlier one, and its time
// derivatives; quaternions are in the hemisphere of the earlier step.
struct Gap {
  PoseVector value, velocity, acceleration;
  PoseVector sign;               // of quaternions after, by value
  double before = 0, after = 0;  // seconds that the correction takes on either side
  double share = 0.5;            // of the correction that the step before takes
  // The same for the root. The hips are far apart where steps of very different length meet: the
  // earlier step ends with both feet on their prints, the later one begins with its own stride.
  double root_share = 0.5;
};

class BodyMotion {
 public:
  static Result<BodyMotion> create(std::span<const StepLibrary> libraries, const Walker& walker,
                                   const PlannedWalk& plan, const WalkOptions& options);

  const std::vector<BodyStep>& steps() const { return steps_; }
  double rate() const { return rate_; }  // frames per second of the examples
  // Seconds, when the foot's ball leaves that print: before the other foot strikes in a run, and as
  // it does where a run begins; after the walk for the last two prints.
  double off_of(std::size_t print) const {
    return leaves(print, &BodyStep::off, &BodyStep::stance_off);
  }
  // The same of the toes, which leave it last.
  double toes_off_of(std::size_t print) const {
    return leaves(print, &BodyStep::toes_off, &BodyStep::stance_toes_off);
  }
  // The gap after a step that is not the last.
  Gap gap_after(std::size_t step) const;

 private:
  BodyMotion() = default;
  void sum_examples(std::span<const StepLibrary> libraries, const PlannedWalk& plan);
  Status add_step(std::span<const StepLibrary> libraries, const Walker& walker,
                  const PlannedWalk& plan, std::size_t index, const WalkOptions& options);
  double leaves(std::size_t print, double BodyStep::*swing, double BodyStep::*stance) const;
  // `off` and `toes_off` in seconds of the blend.
  Status set_times(const PlannedWalk& plan, double off, double toes_off, double speed,
                   BodyStep& step) const;

  std::vector<BodyStep> steps_;
  std::vector<std::unique_ptr<const parametric::ExampleSums>> sums_;  // that the steps use
  double rate_ = 30;                                                  // of the examples
  // 1 for values whose accelerations are matched between steps: not those of legs, which heel
  // strikes disturb and which are solved again for the feet, and not bone lengths.
  PoseVector is_accelerated_;
};

// The pose of a step joined to those beside it; gaps are null at the ends of the walk.
void joined_pose(const BodyStep& step, double time, const Gap* before, const Gap* after,
                 PoseVector& pose, parametric::BlendedMotion::Scratch& scratch);

// The standing pose on two prints, in the world.
PoseVector standing_on(const Walker& walker, const GroundedPrint& one, const GroundedPrint& two);

// The foot's transform when flat on a print.
Transform flat_foot(const Leg& leg, const GroundedPrint& print);

// The style of steps. What weights make of hundreds of examples is their average: nobody's walk. So
// each step of a walk takes what one real step differs by from the blend at that step's own
// parameters: w = w(p) + v (e_i - w(p_i)), with the weights w(p) at the step's parameters, those
// at the parameters of the example i, its own row e_i and the variation v. At p = p_i and v = 1 the
// step is the example; keytimes are the example's as well. Where the weights interpolate the
// examples nothing changes. In a style that was asked for, 1 - v of what its examples near the
// step's parameters differ by in the mean is added: v = 0 is the style's average.

// Chooses the example of each step and sets its weights. Consecutive steps take examples that go
// on in each other (motion matching on places and velocities where the steps meet: Clavet, "Motion
// Matching and The Road to Next-Gen Animation", GDC 2016) and whose parameters are near those of
// the step, so that a walk follows real walks and keeps to one person's style. The same seed gives
// the same walk.
void choose_styles(std::span<const StepLibrary> libraries, const WalkOptions& options,
                   PlannedWalk& plan);

}  // namespace krok::gait
