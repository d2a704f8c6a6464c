#include "ik/gaze.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "roles/body_frame.h"
#include "roles/roles.h"

namespace krok::ik {

namespace {

constexpr double kEyeOnly = 20, kTableEnd = 90, kEyesAtEnd = 35;  // degrees
constexpr double kMaxOfRange = 0.95;  // of the eyes' range that is used before the head helps
constexpr double kMaxHead = 70 * kRadiansPerDegree;
// Head movements of 10 to 60 degrees take about 0.3 to 0.6 s.
constexpr double kHeadTime = 0.3, kHeadTimePerRadian = 0.3;
constexpr double kOneMillimetre = 1e-3;

// Minimum jerk: 10 u^3 - 15 u^4 + 6 u^5.
double progress(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * u * (10 + u * (6 * u - 15));
}

double saccade_time(double amplitude) {
  return 0.021 + 0.0022 * amplitude / kRadiansPerDegree;
}

Vec3 turned(const Vec3& from, const Vec3& to, double share) {
  return slerp(Quat::Identity(), shortest_arc(from, to), share) * from;
}

// A direction within the range of an eye, in the frame of a head that faces +Z. `side` is 1 for the
// left eye, of which outwards is +X.
Vec3 within(const Vec3& direction, const Character::EyeRange& range, double side) {
  const double degree = kRadiansPerDegree;
  const double out = std::atan2(side * direction.x(), direction.z());
  const double up = std::asin(std::clamp(direction.y(), -1.0, 1.0));
  const double yaw = std::clamp(out, -range.in * degree, range.out * degree);
  const double pitch = std::clamp(up, -range.down * degree, range.up * degree);
  if (yaw == out && pitch == up) return direction;
  return {side * std::sin(yaw) * std::cos(pitch), std::sin(pitch), std::cos(yaw) * std::cos(pitch)};
}

class Gazer {
 public:
  Gazer(const Clip& clip, std::span<const GazeEye> eyes, std::span<const GazeTarget> targets,
        const RoleMap& roles)
      : clip_(clip), eyes_(eyes.begin(), eyes.end()), targets_(targets) {
    const Skeleton& skeleton = clip.skeleton;
    const int neck = roles.joint(Role::neck);
    head_ = roles.joint(Role::head);
    if (head_ < 0) head_ = neck;
    if (head_ < 0 && !eyes.empty()) {
      const GazeEye& eye = eyes.front();
      head_ = eye.joint < 0 ? eye.carrier : skeleton.parents[at(eye.joint)];
    }
    if (head_ < 0) return;
    head_joints_ = subtree(skeleton, head_);
    neck_joints_ = neck >= 0 ? subtree(skeleton, neck) : std::vector<std::uint8_t>();
    if (neck == head_ || neck < 0 || neck_joints_[at(head_)] == 0) neck_joints_.clear();
    neck_ = neck;
    const Quat faces = facing_skeleton(clip, roles).reference[at(head_)].orientation;
    from_head_ = faces.normalized().conjugate() * body_frame(skeleton, roles);
  }

  Status check() const {
    if (head_ < 0) {
      return Error("gaze-head", "the eyes are on no joint that could be a head",
                   "krok-info -v lists the joints and their roles; --map assigns roles");
    }
    for (std::size_t k = 1; k < targets_.size(); ++k) {
      if (targets_[k].time > targets_[k - 1].time) continue;
      return Error("gaze-time",
                   fmt::format("two gaze shifts begin at {} and {} s",
                               readable(targets_[k - 1].time, 9), readable(targets_[k].time, 9)));
    }
    return {};
  }

  GazeMotion run() {
    add_joints();
    result_.targets.resize(targets_.size());
    pose_.resize(result_.clip.skeleton.names.size());
    for (int frame = 0; frame < clip_.frame_count(); ++frame) turn(frame);
    return std::move(result_);
  }

 private:
  // The skeleton with the eyes that are to be added, of which +Z is ahead and +X left.
  void add_joints() {
    Clip& clip = result_.clip;
    clip.skeleton = clip_.skeleton;
    clip.rate = clip_.rate;
    clip.provenance = clip_.provenance;
    // Left, up and ahead of the head in the reference pose.
    const Quat axes = clip.skeleton.reference[at(head_)].orientation.normalized() * from_head_;
    for (GazeEye& eye : eyes_) {
      if (eye.joint < 0) {
        const Vec3 place = clip.skeleton.reference[at(eye.carrier)] * eye.place;
        eye.joint = clip.skeleton.add(eye.name, eye.carrier, {place, axes});
      }
      const Vec3 in_head = axes.conjugate() * Vec3(clip.skeleton.reference[at(eye.joint)].position -
                                                   clip.skeleton.reference[at(head_)].position);
      sides_.push_back(in_head.x() < 0 ? -1 : 1);
      locals_.push_back(clip.skeleton.reference_local(eye.joint));
      axes_.push_back(clip.skeleton.reference[at(eye.joint)].orientation.conjugate() *
                      (axes * Vec3::UnitZ()));
    }
    clip.resize(clip_.frame_count());
    for (int frame = 0; frame < clip_.frame_count(); ++frame) {
      std::ranges::copy(clip_.frame_positions(frame), clip.frame_positions(frame).begin());
      std::ranges::copy(clip_.frame_orientations(frame), clip.frame_orientations(frame).begin());
    }
  }

  bool is_added(const GazeEye& eye) const { return eye.joint >= clip_.joint_count(); }

  void place_added() {
    for (std::size_t e = 0; e < eyes_.size(); ++e) {
      if (is_added(eyes_[e])) pose_[at(eyes_[e].joint)] = pose_[at(eyes_[e].carrier)] * locals_[e];
    }
  }

  Vec3 direction(const GazeTarget& target, const Vec3& from, const Vec3& ahead) const {
    if (!target.point) return ahead;
    const Vec3 way = *target.point - from;
    return way.norm() < kOneMillimetre ? ahead : way.normalized();
  }

  // The rotation vector of the head, in the world, while it looks at a target.
  Vec3 head_turn(const GazeTarget& target) const {
    const Vec3 way = rotation_vector(shortest_arc(ahead_, direction(target, between_, ahead_)));
    const double amplitude = way.norm();
    if (amplitude < 1e-9) return Vec3::Zero();
    // The range along the direction in which the eyes go.
    const Vec3 to = head_frame_.conjugate() * (from_rotation_vector(way) * ahead_);
    double side = 90, up = 90, down = 90;
    for (const GazeEye& eye : eyes_) {
      side = std::min<double>({side, eye.range.in, eye.range.out});
      up = std::min<double>(up, eye.range.up);
      down = std::min<double>(down, eye.range.down);
    }
    const double across = std::hypot(to.x(), to.y());
    const double height = std::max(1e-3, to.y() > 0 ? up : down);
    const double range =
        across < 1e-9 ? side : across / std::hypot(to.x() / std::max(1e-3, side), to.y() / height);
    const double needed = amplitude - kMaxOfRange * range * kRadiansPerDegree;
    const double angle = std::max(needed, head_share(amplitude));
    return way * (std::min({angle, kMaxHead, amplitude}) / amplitude);
  }

  void turn(int frame) {
    const double time = frame / clip_.rate;
    clip_.get_pose(frame, std::span(pose_).first(at(clip_.joint_count())));
    place_added();
    const Quat head = pose_[at(head_)].orientation;
    head_frame_ = head * from_head_;
    ahead_ = head_frame_ * Vec3::UnitZ();
    between_.setZero();
    for (const GazeEye& eye : eyes_) between_ += pose_[at(eye.joint)].position;
    between_ /= static_cast<double>(eyes_.size());

    const GazeTarget none;
    const auto next = std::ranges::upper_bound(targets_, time, {}, &GazeTarget::time);
    const auto k = next - targets_.begin() - 1;  // the current one, or -1
    const GazeTarget& now = k >= 0 ? targets_[static_cast<std::size_t>(k)] : none;
    const GazeTarget& before = k >= 1 ? targets_[static_cast<std::size_t>(k - 1)] : none;
    const double since = time - now.time;
    const double shift = std::acos(std::clamp(
        direction(before, between_, ahead_).dot(direction(now, between_, ahead_)), -1.0, 1.0));
    if (k != current_) {
      current_ = k;
      amplitude_ = shift;
      head_time_ = kHeadTime + kHeadTimePerRadian * shift;
    }
    const double moved = k < 0 ? 1 : progress((since - kHeadLag) / head_time_);
    const Vec3 turn = (1 - moved) * head_turn(before) + moved * head_turn(now);
    if (turn.norm() > 1e-12) turn_head(frame, turn);

    const Quat frame_now = pose_[at(head_)].orientation * from_head_;
    const double jump = k < 0 ? 1 : progress(since / saccade_time(amplitude_));
    double missed = 0;
    for (std::size_t e = 0; e < eyes_.size(); ++e) {
      const int joint = eyes_[e].joint;
      Transform& eye = pose_[at(joint)];
      if (k < 0 && !is_added(eyes_[e])) continue;
      // Without a target as the motion has it.
      const Vec3 straight = eye.orientation * axes_[e];
      const Vec3 wanted = direction(now, eye.position, straight);
      const Vec3 gaze = turned(direction(before, eye.position, straight), wanted, jump);
      const Vec3 looks = within(frame_now.conjugate() * gaze, eyes_[e].range, sides_[e]);
      const Quat turned_by = shortest_arc(Vec3::UnitZ(), looks);
      // At rest as the reference pose has it in its parent.
      const int parent = result_.clip.skeleton.parents[at(joint)];
      const Quat rest = is_added(eyes_[e]) || parent < 0
                            ? eye.orientation
                            : pose_[at(parent)].orientation * locals_[e].orientation;
      eye.orientation = frame_now * turned_by * frame_now.conjugate() * rest;
      missed = std::max(missed,
                        angle_between(Quat::Identity(), shortest_arc(frame_now * looks, wanted)));
      result_.clip.frame_positions(frame)[at(joint)] = eye.position.cast<float>();
      result_.clip.frame_orientations(frame)[at(joint)] =
          eye.orientation.normalized().cast<float>();
    }
    if (k < 0) return;
    GazeFacts& facts = result_.targets[static_cast<std::size_t>(k)];
    facts = {amplitude_, turn.norm(), missed, missed < 2 * kRadiansPerDegree};
  }

  // Half of the turn in the neck, if there is one.
  void turn_head(int frame, const Vec3& turn) {
    const bool has_neck = !neck_joints_.empty();
    if (has_neck) rotate(frame, neck_, neck_joints_, from_rotation_vector(0.5 * turn));
    rotate(frame, head_, head_joints_, from_rotation_vector(has_neck ? Vec3(0.5 * turn) : turn));
    place_added();
  }

  void rotate(int frame, int joint, const std::vector<std::uint8_t>& below, const Quat& rotation) {
    const Vec3 about = pose_[at(joint)].position;
    for (std::size_t j = 0; j < below.size(); ++j) {
      if (below[j] == 0) continue;
      pose_[j].position = about + rotation * (pose_[j].position - about);
      pose_[j].orientation = (rotation * pose_[j].orientation).normalized();
      result_.clip.frame_positions(frame)[j] = pose_[j].position.cast<float>();
      result_.clip.frame_orientations(frame)[j] = pose_[j].orientation.cast<float>();
    }
  }

  const Clip& clip_;
  std::vector<GazeEye> eyes_;
  std::span<const GazeTarget> targets_;
  int head_ = -1, neck_ = -1;
  std::vector<std::uint8_t> head_joints_, neck_joints_;  // 1: moves with it
  Quat body_ = Quat::Identity();                         // body_frame()
  Quat from_head_ = Quat::Identity();  // from left, up and ahead of the head to its own frame
  std::vector<double> sides_;          // [eyes] 1: left
  std::vector<Transform> locals_;      // [eyes] in the parent, in the reference pose
  std::vector<Vec3> axes_;             // [eyes] that look ahead, in the eye's frame
  GazeMotion result_;
  // Of the frame: the pose, the head before it is turned, and the shift.
  std::vector<Transform> pose_;
  Quat head_frame_ = Quat::Identity();
  Vec3 ahead_ = Vec3::UnitZ(), between_ = Vec3::Zero();
  std::ptrdiff_t current_ = -1;
  double amplitude_ = 0, head_time_ = kHeadTime;
};

}  // namespace

double head_share(double amplitude) {
  const double degrees = amplitude / kRadiansPerDegree;
  const double slope = (kTableEnd - kEyesAtEnd) / (kTableEnd - kEyeOnly);
  return std::max(0.0, slope * (degrees - kEyeOnly)) * kRadiansPerDegree;
}

Result<std::vector<GazeEye>> gaze_eyes(std::span<const Character::Eye> eyes, const Skeleton& model,
                                       const Skeleton& motion) {
  std::vector<GazeEye> made;
  for (const Character::Eye& eye : eyes) {
    const int own = motion.find(eye_joint_name(eye));
    const int joint = motion.find(eye.joint);
    const int in_model = model.find(eye.joint);
    if (joint < 0 || in_model < 0) {
      return Error("gaze-eyes", fmt::format("eye '{}' moves with the joint '{}', which the motion "
                                            "does not have",
                                            shown(eye.name), shown(eye.joint)));
    }
    GazeEye& one =
        made.emplace_back(GazeEye{eye_joint_name(eye), own, joint, Vec3::Zero(), eye.range});
    one.place = model.reference[at(in_model)].inverse() * eye.position.cast<double>();
    // An eye at the joint that it moves with is that joint.
    const EyeJoints found = find_eyes(motion);
    const bool is_eye = joint == found.left || joint == found.right;
    if (own < 0 && is_eye && one.place.norm() < kOneMillimetre) one.joint = joint;
  }
  if (!made.empty()) return made;
  const EyeJoints found = find_eyes(motion);
  for (const int joint : {found.left, found.right}) {
    if (joint >= 0) made.push_back({motion.names[at(joint)], joint, joint, Vec3::Zero(), {}});
  }
  if (!made.empty()) return made;
  return Error("gaze-eyes", "there are no eyes to turn",
               "give a .character with \"eyes\", or a motion with joints such as LeftEye");
}

Result<GazeMotion> apply_gaze(const Clip& clip, std::span<const GazeEye> eyes,
                              std::span<const GazeTarget> targets, const RoleMap& roles) {
  if (eyes.empty()) return Error("gaze-eyes", "there are no eyes to turn");
  Gazer gazer(clip, eyes, targets, roles);
  if (Status status = gazer.check(); !status) return status.error();
  return gazer.run();
}

}  // namespace krok::ik
