#include "retarget/frame_transfer_internal.h"

#include <algorithm>
#include <cstddef>
#include <span>

#include "core/index.h"
#include "core/parallel.h"
#include "ik/soft_reach.h"
#include "math/quaternion.h"
#include "math/window.h"
#include "retarget/actor_view_internal.h"

namespace krok::retarget {

namespace {

constexpr std::size_t kFramesATime = 64;
constexpr int kShiftRounds = 2;
constexpr double kSeat = 0.12;  // leg lengths, of the hips over the ground that one sits or lies on

class FrameTransfer {
 public:
  FrameTransfer(const FrameRun& run, const Skeleton& target, const TransferPlan& plan, int jobs,
                const TouchKeeping* touches)
      : run_(run), source_(run.clip), target_(target), plan_(plan), jobs_(jobs), touches_(touches) {
    find_below_anchor();
  }

  void note(TouchKeeping& touches, bool again) const {
    in_parallel([&](std::size_t begin, std::size_t end) {
      std::vector<Transform> poses(joints());
      for (int f = static_cast<int>(begin); f < static_cast<int>(end); ++f) {
        if (!touches.needs(f, again)) continue;
        make_poses(f, poses);
        touches.note(f, std::span(poses).subspan(source_.skeleton.names.size()));
      }
    });
  }

  Clip run(std::vector<Transform>& poses, Report& report) {
    poses.resize(at(source_.frame_count()) * joints());
    poses_ = poses;
    in_parallel([&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) make_poses(static_cast<int>(f), poses_of(f));
    });
    Clip clip;
    clip.skeleton = target_;
    clip.rate = source_.rate;
    const auto frames = at(source_.frame_count());
    clip.resize(source_.frame_count());
    const bool touches = touches_ != nullptr && !touches_->empty();
    bends_ = find_bends();
    if (touches || !plan_.legs.empty()) shifts_ = find_shifts(report);
    std::vector<std::vector<double>> softness(plan_.legs.size());
    const std::vector<double> drops =
        plan_.legs.empty() ? std::vector<double>() : find_drops(softness);
    std::vector<std::array<LegPlacement::Outcome, 2>> outcomes(frames);
    std::vector<std::array<LegPlacement::Sunk, 2>> sunk(frames);
    std::vector<LegPlacement::Sunk> sunk_above(frames);
    for_frames([&](std::size_t f, std::span<const Transform> from, std::span<Transform> pose) {
      const int frame = static_cast<int>(f);
      if (!shifts_.empty()) shift_body(shifts_[f], pose);
      if (!drops.empty()) move_body(-drops[f] * kUp, pose);
      bend_feet(f, pose);
      if (touches) touches_->place_knees(frame, plan_.local, pose);
      for (std::size_t i = 0; i < plan_.legs.size(); ++i) {
        const PlacedLeg& leg = plan_.legs[i];
        const double kneels = touches ? touches_->kneels(frame, leg.is_left) : 0;
        outcomes[f][i] = leg.placement.place(from, plan_.local, stance_of(i, f), 1 - kneels,
                                             softness[i].empty() ? 0 : softness[i][f], pose);
      }
      if (touches) {
        touches_->place_feet(frame, plan_.local, pose);
        touches_->place_arms(frame, from, plan_.local, pose);
      }
      for (std::size_t i = 0; i < plan_.legs.size(); ++i) {
        sunk[f][i] = plan_.legs[i].placement.sunk(from, pose);
      }
      sunk_above[f] = sunk_of_hands_and_head(from, pose);
      clip.set_pose(frame, pose);
    });
    for (std::size_t i = 0; i < plan_.legs.size(); ++i) {
      add(outcomes, sunk, i, *(plan_.legs[i].is_left ? report.left_foot : report.right_foot));
    }
    for (int f = run_.kept_begin; f < run_.kept_end; ++f) {
      if (sunk_above[at(f)].depth <= report.largest_depth) continue;
      report.largest_depth = sunk_above[at(f)].depth;
      report.largest_depth_time = (run_.first + f) / source_.rate;
      report.largest_depth_joint = sunk_above[at(f)].joint;
    }
    for (const double drop : kept(drops)) report.largest_drop = std::max(report.largest_drop, drop);
    if (touches_ != nullptr) {
      add_contacts(touches_->report(run_, plan_.kept, clip, {}), report.contacts);
    }
    return clip;
  }

 private:
  std::size_t in_take(std::size_t frame) const { return at(run_.first) + frame; }

  template <typename Value>
  std::span<const Value> kept(const std::vector<Value>& values) const {
    if (values.empty()) return {};
    return std::span(values).subspan(at(run_.kept_begin), at(run_.kept_end - run_.kept_begin));
  }

  // The rotation of a source joint since the reference pose.
  Quat turn_of(std::span<const Transform> pose, int joint) const {
    return pose[at(joint)].orientation * plan_.rest_back[at(joint)];
  }

  // Of a turn what twists the target's joint k in that of its parent: about its bone.
  Quat twist_of(int k, std::span<const Transform> source_pose, const Quat& turn) const {
    const int above = plan_.mapping[at(target_.parents[at(k)])].first;
    const auto child = std::ranges::find(target_.parents, k);
    if (above < 0 || child == target_.parents.end()) return turn;
    const Vec3 bone = plan_.local[at(static_cast<int>(child - target_.parents.begin()))].position;
    const Vec3 axis = plan_.aligned[at(k)] * bone.stableNormalized();
    const Quat carried = turn_of(source_pose, above);
    const Quat since = carried.conjugate() * turn;
    const Vec3 about = axis * axis.dot(since.vec());
    const Quat twist(since.w(), about.x(), about.y(), about.z());
    return twist.norm() > 1e-6 ? carried * twist.normalized() : carried;
  }

  // joint_to_world of the target, with its anchor at its reference position.
  void pose_of(std::span<const Transform> source_pose, std::span<Transform> pose) const {
    for (int k = 0; k < target_.joint_count(); ++k) {
      const JointSource& from = plan_.mapping[at(k)];
      const int parent = target_.parents[at(k)];
      if (parent < 0) {
        pose[at(k)] = target_.reference[at(k)];
      } else if (from.first < 0) {
        pose[at(k)] = pose[at(parent)] * plan_.local[at(k)];
      } else {
        pose[at(k)].position = pose[at(parent)] * plan_.local[at(k)].position;
      }
      if (from.first < 0) continue;
      Quat turn = turn_of(source_pose, from.first);
      if (from.second >= 0) turn = slerp(turn, turn_of(source_pose, from.second), from.share);
      if (from.twists) turn = twist_of(k, source_pose, turn);
      pose[at(k)].orientation = (turn * plan_.aligned[at(k)]).normalized();
    }
  }

  Vec3 middle(std::span<const Transform> pose, const std::array<int, 2>& sides) const {
    return 0.5 * (pose[at(sides[0])].position + pose[at(sides[1])].position);
  }

  // Moves the anchor and its descendants, and takes along what hangs beside them.
  void place(std::span<const Transform> source_pose, std::span<Transform> pose) const {
    const Vec3 goal = plan_.scale * middle(source_pose, plan_.source_sides);
    // Who lies or sits on the ground is no higher for the height of his ankles.
    const double upright =
        plan_.leg_length > 0
            ? smooth_step(0.25 * plan_.leg_length, 0.6 * plan_.leg_length, goal.y() - plan_.floor)
            : 0;
    const Vec3 shift = goal + upright * plan_.rise * kUp - middle(pose, plan_.target_sides);
    for (std::size_t k = 0; k < pose.size(); ++k) {
      if (below_anchor_[k] != 0) pose[k].position += shift;
    }
    const Transform carried =
        pose[at(plan_.anchor)] * target_.reference[at(plan_.anchor)].inverse();
    for (std::size_t k = 0; k < pose.size(); ++k) {
      if (beside_anchor_[k] == 0) continue;
      const std::size_t parent = at(target_.parents[k]);
      const Quat own = pose[k].orientation;
      pose[k] = beside_anchor_[parent] != 0 ? pose[parent] * plan_.local[k]
                                            : carried * target_.reference[k];
      if (plan_.mapping[k].first >= 0) pose[k].orientation = own;
    }
  }

  // Joints beside the anchor, neither above nor below it: some rigs hang parts of a body, such as a
  // belly, on the root. They keep their place by the anchor.
  void find_below_anchor() {
    below_anchor_.assign(target_.names.size(), 0);
    below_anchor_[at(plan_.anchor)] = 1;
    for (int k = plan_.anchor + 1; k < target_.joint_count(); ++k) {
      below_anchor_[at(k)] = below_anchor_[at(target_.parents[at(k)])];
    }
    beside_anchor_.assign(target_.names.size(), 1);
    for (int k = plan_.anchor; k >= 0; k = target_.parents[at(k)]) beside_anchor_[at(k)] = 0;
    for (std::size_t k = 0; k < below_anchor_.size(); ++k) {
      if (below_anchor_[k] != 0 || target_.parents[k] < 0) beside_anchor_[k] = 0;
    }
  }

  std::size_t joints() const { return source_.skeleton.names.size() + target_.names.size(); }

  // The source's pose, and behind it the target's, as given by rotations and hips.
  void make_poses(int frame, std::span<Transform> poses) const {
    const auto source_pose = poses.first(source_.skeleton.names.size());
    const auto pose = poses.subspan(source_pose.size());
    source_.get_pose(frame, source_pose);
    pose_of(source_pose, pose);
    place(source_pose, pose);
  }

  std::span<Transform> poses_of(std::size_t frame) const {
    return poses_.subspan(frame * joints(), joints());
  }

  template <typename Body>
  void in_parallel(const Body& body) const {
    parallel_for(at(source_.frame_count()), kFramesATime, jobs_, body);
  }

  // Calls body(frame, source_pose, pose) for all frames, with a copy of the target's pose.
  template <typename Body>
  void for_frames(const Body& body) const {
    in_parallel([&](std::size_t begin, std::size_t end) {
      std::vector<Transform> pose(target_.names.size());
      for (std::size_t f = begin; f < end; ++f) {
        std::ranges::copy(poses_of(f).last(pose.size()), pose.begin());
        body(f, poses_of(f).first(source_.skeleton.names.size()), pose);
      }
    });
  }

  void move_body(const Vec3& by, std::span<Transform> pose) const {
    for (std::size_t k = 0; k < pose.size(); ++k) {
      if (below_anchor_[k] != 0 || beside_anchor_[k] != 0) pose[k].position += by;
    }
  }

  void shift_body(const BodyShift& shift, std::span<Transform> pose) const {
    move_body(shift.hips, pose);
    if (touches_ != nullptr) touches_->turn_trunk(shift.turn, plan_.local, pose);
  }

  // The angles by which toes and feet are bent so that they do not go into the floor, without a
  // jerk, [legs][frames]; empty for feet that need none.
  std::vector<std::vector<double>> find_bends() const {
    std::vector<std::vector<double>> bends(plan_.legs.size(),
                                           std::vector<double>(at(source_.frame_count())));
    for_frames([&](std::size_t f, std::span<const Transform> from, std::span<Transform> pose) {
      for (std::size_t i = 0; i < bends.size(); ++i) {
        const PlacedLeg& leg = plan_.legs[i];
        bends[i][f] = leg.placement.needed_bend(from, pose, {leg.stances.feet[in_take(f)]});
      }
    });
    for (std::vector<double>& angles : bends) {
      angles = softened_if_any(std::move(angles), softening_reach(source_.rate) / 2);
    }
    return bends;
  }

  // As LegPlacement::sunk(). No limb is moved for a hand that passes by, so longer arms go deep.
  LegPlacement::Sunk sunk_of_hands_and_head(std::span<const Transform> source_pose,
                                            std::span<const Transform> pose) const {
    LegPlacement::Sunk sunk;
    for (const AboveFloor& part : plan_.above_floor) {
      double allowed = 0;
      for (const int joint : part.source) {
        const double height = source_pose[at(joint)].position.y() - plan_.source_floor;
        allowed = std::min(allowed, plan_.scale * height);
      }
      for (const int joint : part.target) {
        const double depth = allowed - (pose[at(joint)].position.y() - plan_.floor);
        if (depth > sunk.depth) sunk = {depth, joint};
      }
    }
    return sunk;
  }

  FootStance stance_of(std::size_t leg, std::size_t frame) const {
    const LegPlacement::Stances& stances = plan_.legs[leg].stances;
    FootStance stance{stances.feet[in_take(frame)]};
    if (leg < bends_.size() && !bends_[leg].empty()) {
      stance.bend = bend_angles(bends_[leg][frame], 1 - stances.touching[in_take(frame)]);
    }
    return stance;
  }

  void bend_feet(std::size_t frame, std::span<Transform> pose) const {
    for (std::size_t i = 0; i < plan_.legs.size(); ++i) {
      plan_.legs[i].placement.bend_foot(stance_of(i, frame), pose);
    }
  }

  // How hips and trunk move in each frame so that limbs that touch something are bent as the
  // source's.
  std::vector<BodyShift> find_shifts(Report& report) const {
    std::vector<BodyShift> shifts(at(source_.frame_count()));
    // What limbs lack is linear in the shift for small ones; the second round finds the rest.
    for (int round = 0; round < kShiftRounds; ++round) {
      std::vector<BodyShift> more(shifts.size());
      for_frames([&](std::size_t f, std::span<const Transform> from, std::span<Transform> pose) {
        shift_body(shifts[f], pose);
        bend_feet(f, pose);
        ShiftSolver solver(plan_.leg_length);
        for (std::size_t i = 0; i < plan_.legs.size(); ++i) {
          const PlacedLeg& leg = plan_.legs[i];
          leg.placement.add_lack(from, pose, stance_of(i, f), leg.stances.bearing[in_take(f)],
                                 solver);
        }
        if (touches_ != nullptr) touches_->add_lacks(static_cast<int>(f), pose, solver);
        more[f] = solver.solve();
      });
      more = smoothed(more, softening_reach(source_.rate));
      for (std::size_t f = 0; f < shifts.size(); ++f) {
        shifts[f].hips += more[f].hips;
        shifts[f].turn += more[f].turn;
      }
      keep_seat_above_ground(shifts);
    }
    for (const BodyShift& shift : kept(shifts)) {
      report.largest_shift = std::max(report.largest_shift, shift.hips.norm());
      report.largest_turn = std::max(report.largest_turn, shift.turn.norm());
    }
    return shifts;
  }

  // Hands that lack the ground bring the hips down to where one sits, and no deeper.
  void keep_seat_above_ground(std::vector<BodyShift>& shifts) const {
    std::vector<double> sunk(shifts.size());
    for (std::size_t f = 0; f < shifts.size(); ++f) {
      const double height =
          middle(poses_of(f).last(target_.names.size()), plan_.target_sides).y() - plan_.floor;
      const double lowest = std::min(height, kSeat * plan_.leg_length);
      sunk[f] = std::max(0.0, lowest - (height + shifts[f].hips.y()));
    }
    sunk = softened(sunk, softening_reach(source_.rate) / 2);
    for (std::size_t f = 0; f < shifts.size(); ++f) shifts[f].hips.y() += sunk[f];
  }

  // How far the hips are lowered in each frame so that planted feet reach the floor. Knees of legs
  // that are too short even then do not snap: before and after, too, they straighten with a
  // softness, [legs][frames]; empty for legs that reach.
  std::vector<double> find_drops(std::vector<std::vector<double>>& softness) const {
    std::vector<double> drops(at(source_.frame_count()), 0.0);
    std::vector<std::vector<LegPlacement::Way>> ways(plan_.legs.size(),
                                                     std::vector<LegPlacement::Way>(drops.size()));
    for_frames([&](std::size_t f, std::span<const Transform> from, std::span<Transform> pose) {
      if (!shifts_.empty()) shift_body(shifts_[f], pose);
      bend_feet(f, pose);
      for (std::size_t i = 0; i < plan_.legs.size(); ++i) {
        ways[i][f] = plan_.legs[i].placement.way(from, pose, stance_of(i, f));
        drops[f] = std::max(drops[f], ways[i][f].lack());
      }
    });
    const double most = 0.06 * plan_.leg_length;
    for (double& drop : drops) drop = std::min(drop, most);
    drops = softened_if_any(std::move(drops), softening_reach(source_.rate));
    for (std::size_t i = 0; i < ways.size(); ++i) {
      for (std::size_t f = 0; f < ways[i].size(); ++f) {
        softness[i].push_back(ways[i][f].short_by(drops.empty() ? 0 : drops[f]));
      }
      softness[i] = softness_of(std::move(softness[i]), plan_.leg_length, source_.rate);
    }
    return drops;
  }

  void add(const std::vector<std::array<LegPlacement::Outcome, 2>>& outcomes,
           const std::vector<std::array<LegPlacement::Sunk, 2>>& sunk, std::size_t side,
           FootReport& foot) const {
    for (int f = run_.kept_begin; f < run_.kept_end; ++f) {
      const LegPlacement::Outcome& outcome = outcomes[at(f)][side];
      if (outcome.correction > foot.largest_correction) {
        foot.largest_correction = outcome.correction;
        foot.largest_correction_frame = run_.first + f;
      }
      if (outcome.miss > foot.largest_miss) {
        foot.largest_miss = outcome.miss;
        foot.largest_miss_frame = run_.first + f;
      }
      if (std::abs(outcome.bend) > std::abs(foot.largest_bend)) {
        foot.largest_bend = outcome.bend;
        foot.largest_bend_frame = run_.first + f;
      }
      if (sunk[at(f)][side].depth > foot.largest_depth) {
        foot.largest_depth = sunk[at(f)][side].depth;
        foot.largest_depth_time = (run_.first + f) / source_.rate;
        foot.largest_depth_joint = sunk[at(f)][side].joint;
      }
    }
  }

  const FrameRun& run_;
  const Clip& source_;
  const Skeleton& target_;
  const TransferPlan& plan_;
  int jobs_;
  const TouchKeeping* touches_;                     // of the run
  std::span<Transform> poses_;                      // [frames x joints()]
  std::vector<std::vector<double>> bends_;          // of find_bends()
  std::vector<BodyShift> shifts_;                   // [frames] or empty
  std::vector<char> below_anchor_, beside_anchor_;  // [target joints]
};

}  // namespace

void add_contacts(std::vector<ContactReport> found, std::vector<ContactReport>& all) {
  for (ContactReport& contact : found) {
    const auto before = std::find_if(all.rbegin(), all.rend(), [&](const ContactReport& other) {
      return other.part == contact.part && other.on == contact.on;
    });
    if (before == all.rend() || before->end != contact.start) {
      all.push_back(std::move(contact));
      continue;
    }
    const double part = contact.end - contact.start, seconds = contact.end - before->start;
    if (seconds > 0) {
      before->slide += part / seconds * (contact.slide - before->slide);
      before->source_slide += part / seconds * (contact.source_slide - before->source_slide);
    }
    before->end = contact.end;
    before->height = std::max(before->height, contact.height);
    before->apart = std::max(before->apart, contact.apart);
  }
}

void note_touches(const FrameRun& run, const Skeleton& target, const TransferPlan& plan, int jobs,
                  bool again, TouchKeeping& touches) {
  FrameTransfer(run, target, plan, jobs, nullptr).note(touches, again);
}

Clip transfer_frames(const FrameRun& run, const Skeleton& target, const TransferPlan& plan,
                     int jobs, const TouchKeeping* touches, std::vector<Transform>& poses,
                     Report& report) {
  return FrameTransfer(run, target, plan, jobs, touches).run(poses, report);
}

}  // namespace krok::retarget
