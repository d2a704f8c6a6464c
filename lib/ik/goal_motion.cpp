#include "ik/goal_motion.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "core/index.h"
#include "core/parallel.h"
#include "ik/frame_solver_internal.h"
#include "ik/keyed_goal_internal.h"
#include "math/quaternion.h"
#include "scene/frame_source.h"

namespace krok::ik {

namespace {

// Frames in a row in which goals are active, both included.
struct Stretch {
  int first = 0, last = 0;
};

// Of a joint relative to its parent, over the frames so far.
struct JointTurns {
  double largest = 0, before = 0;  // radians a frame, of the result and of the input
  int frame = -1;
  bool changed = false;
  Quat last = Quat::Identity(), last_before = Quat::Identity();  // in the last frame
};

// Solves a take block by block.
class BlockSolver {
 public:
  BlockSolver(const FrameSource& source, std::span<const KeyedGoal> goals,
              std::vector<CarriedFrom> carried, Limits limits, GoalMotionOptions options,
              int block_frames)
      : parents_(source.skeleton.parents),
        rate_(source.rate),
        duration_(source.duration()),
        goals_(goals),
        carried_(std::move(carried)),
        limits_(std::move(limits)),
        options_(std::move(options)),
        block_frames_(block_frames),
        joints_(parents_.size()) {
    motion_->goals.resize(goals.size());
    motion_->shifts.resize(parents_.size());
    motion_->excesses.resize(options_.ranges.size());
  }

  const std::shared_ptr<GoalMotion>& motion() const { return motion_; }

  // Blocks have no overlap; each comes first after those before it.
  Status change(FrameRun& run) {
    const int first = run.first, end = run.first + run.clip.frame_count();
    const auto number = at(first / block_frames_);
    before_.resize(std::max(before_.size(), number + 2));
    const std::vector<Stretch> stretches = stretches_of(first, end);
    const std::size_t count = goals_.size();
    std::vector<GoalFrame> report(at(end - first) * count);
    std::vector<Status> failed(stretches.size());
    std::vector<double> excesses(stretches.size(), 0.0);
    Clip made = run.clip;
    parallel_for(stretches.size(), 1, options_.jobs, [&](std::size_t from, std::size_t to) {
      for (std::size_t s = from; s < to; ++s) {
        const Stretch& stretch = stretches[s];
        FrameSolver solver(run, duration_, goals_, carried_, options_,
                           *Solver::create(parents_, limits_, options_.solver),
                           stretch.first == first ? before_[number] : TurnsBefore());
        for (int f = stretch.first; f <= stretch.last && failed[s].ok(); ++f) {
          failed[s] = solver.solve(f, std::span(report).subspan(at(f - first) * count, count), made,
                                   excesses[s]);
        }
        if (stretch.last + 1 == end) before_[number + 1] = std::move(solver).before();
      }
    });
    for (Status& status : failed) {
      if (!status) return std::move(status);
    }
    if (end > reported_) {
      reported_ = end;
      for (const double excess : excesses) {
        motion_->largest_excess = std::max(motion_->largest_excess, excess);
      }
      for (const Stretch& stretch : stretches)
        motion_->changed_frames += stretch.last + 1 - stretch.first;
      for (std::size_t i = 0; i < report.size(); ++i) {
        if (report[i].strength > 0) motion_->goals[i % count].push_back(report[i]);
      }
      measure_turns(run, made);
    }
    run.clip = std::move(made);
    return {};
  }

 private:
  std::vector<Stretch> stretches_of(int first, int end) const {
    std::vector<Stretch> stretches;
    for (int f = first; f < end; ++f) {
      const bool active = std::ranges::any_of(goals_, [&](const KeyedGoal& goal) {
        return strength_at(goal, f / rate_, duration_, rate_) > 0;
      });
      if (!active) continue;
      if (stretches.empty() || stretches.back().last + 1 < f) stretches.push_back({f, f});
      stretches.back().last = f;
    }
    return stretches;
  }

  void measure_turns(const FrameRun& given, const Clip& made) {
    parallel_for(parents_.size(), 1, options_.jobs, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j) measure_turns(given, made, j);
    });
    GoalMotion& motion = *motion_;
    motion.largest_turn = motion.input_turn = 0;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      if (!joints_[j].changed) continue;
      motion.input_turn = std::max(motion.input_turn, joints_[j].before);
      if (joints_[j].largest <= motion.largest_turn) continue;
      motion.largest_turn = joints_[j].largest;
      motion.turning_joint = static_cast<int>(j);
      motion.turning_frame = joints_[j].frame;
    }
  }

  void measure_turns(const FrameRun& given, const Clip& made, std::size_t j) {
    JointTurns& joint = joints_[j];
    GoalMotion::Shift& shift = motion_->shifts[j];
    const auto relative = [&](const Clip& of, int f) -> Quat {
      const Quat own = of.frame_orientations(f)[j].cast<double>();
      if (parents_[j] < 0) return own;
      return of.frame_orientations(f)[at(parents_[j])].cast<double>().conjugate() * own;
    };
    for (int f = 0; f < made.frame_count(); ++f) {
      const double moved = (made.frame_positions(f)[j] - given.clip.frame_positions(f)[j]).norm();
      if (moved > shift.distance) shift = {moved, given.first + f};
      const Quat was = relative(given.clip, f), now = relative(made, f);
      if (!options_.ranges.empty() && now.coeffs() != was.coeffs()) {
        const JointLimit& range = options_.ranges[j];
        const double further = excess(range, now) - excess(range, was);
        GoalMotion::Excess& largest = motion_->excesses[j];
        if (further > largest.angle) largest = {further, given.first + f};
      }
      const Quat before = std::exchange(joint.last_before, was);
      const Quat made_before = std::exchange(joint.last, now);
      if (given.first + f == 0) continue;
      const bool is_given = now.coeffs() == was.coeffs();
      const double turn_before = angle_between(before, was);
      const double turn = is_given && made_before.coeffs() == before.coeffs()
                              ? turn_before
                              : angle_between(made_before, now);
      joint.changed = joint.changed || (!is_given && angle_between(now, was) > 1e-6);
      joint.before = std::max(joint.before, turn_before);
      if (turn > joint.largest) joint.largest = turn, joint.frame = given.first + f;
    }
  }

  const std::vector<int> parents_;
  double rate_, duration_;
  std::span<const KeyedGoal> goals_;
  const std::vector<CarriedFrom> carried_;  // [goals]
  const Limits limits_;
  const GoalMotionOptions options_;
  int block_frames_;
  std::vector<TurnsBefore> before_;  // at the beginning of each block
  std::vector<JointTurns> joints_;
  int reported_ = 0;  // frames that motion_ is of
  std::shared_ptr<GoalMotion> motion_ = std::make_shared<GoalMotion>();
};

// Read now, as a frame that is solved may be blocks away from these.
Result<CarriedFrom> carried_from(const FrameSource& source, const KeyedGoal& goal, int joint) {
  const bool in_world = goal.relative_to < 0 || goal.motion != nullptr;
  const bool has_place =
      goal.goal.kind == Goal::Kind::position || goal.goal.kind == Goal::Kind::pose;
  if (!in_world || !has_place || source.frame_count == 0) return CarriedFrom();
  const FullStrength full = full_strength(goal, source.duration(), source.rate);
  std::array<Transform, 2> places;
  for (const bool last : {false, true}) {
    const double frame = (last ? full.to : full.from) * source.rate;
    const int nearest =
        static_cast<int>(std::min(std::max(0.0, frame), source.frame_count - 1.0) + 0.5);
    const auto clip = load(part_of(source, nearest, 1), 1);
    if (!clip) return clip.error();
    places[last ? 1 : 0] = {clip->frame_positions(0)[at(joint)].cast<double>(),
                            clip->frame_orientations(0)[at(joint)].cast<double>().normalized()};
  }
  return CarriedFrom(places);
}

}  // namespace

Result<GoalFrames> apply_goals(const FrameSource& source, std::span<const KeyedGoal> goals,
                               const Limits& limits, const GoalMotionOptions& options,
                               int block_frames) {
  const BlockSize size{std::max(block_frames, 1)};
  for (const KeyedGoal& goal : goals) {
    if (Status status = check_goal(goal, source.skeleton); !status) return status.error();
  }
  // Says now what is wrong with limits and options.
  if (auto made = Solver::create(source.skeleton.parents, limits, options.solver); !made) {
    return made.error();
  }
  std::vector<CarriedFrom> carried;
  for (const KeyedGoal& goal : goals) {
    auto one = carried_from(source, goal, options.solver.moving_joint);
    if (!one) return one.error();
    carried.push_back(*std::move(one));
  }
  const auto solver = std::make_shared<BlockSolver>(source, goals, std::move(carried), limits,
                                                    options, size.frames);
  return GoalFrames{changed_in_blocks(source, size, options.jobs,
                                      [solver](FrameRun& run) { return solver->change(run); }),
                    solver->motion()};
}

Result<GoalMotion> apply_goals(const Clip& motion, std::span<const KeyedGoal> goals,
                               const Limits& limits, const GoalMotionOptions& options) {
  const auto made = apply_goals(frames_of(motion), goals, limits, options);
  if (!made) return made.error();
  auto clip = load(made->frames, options.jobs);
  if (!clip) return clip.error();
  GoalMotion result = std::move(*made->motion);
  result.clip = *std::move(clip);
  result.clip.provenance = motion.provenance;
  return result;
}

}  // namespace krok::ik
