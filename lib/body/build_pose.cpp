#include "body/shapes.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "body/human_actor.h"
#include "math/quaternion.h"
#include "retarget/stance.h"
#include "scene/frame_source.h"

namespace krok::body {

namespace {

// A pose suitable for human_shape, derived from an arbitrary pose.
struct StandingPose {
  std::vector<Transform> joint_to_world;
  double turned = 0;   // radians, sum of all bone rotations; 0: the pose is unchanged
  double heading = 0;  // radians, rotation of the whole body to stand upright facing +Z
};

constexpr double kDegree = kRadiansPerDegree;

class Straightener {
 public:
  Straightener(const Skeleton& skeleton, const HumanActor& actor, std::span<const Transform> pose)
      : skeleton_(skeleton), actor_(actor), pose_(pose.begin(), pose.end()) {}

  StandingPose run() {
    face_forward();
    straighten_trunk();
    // Corrections apply to both sides.
    const bool legs = leg_in_the_way(0) || leg_in_the_way(1);
    const bool arms = arm_in_the_way(0) || arm_in_the_way(1);
    for (std::size_t side = 0; side < 2; ++side) {
      place_leg(side, legs);
      place_arm(side, arms);
    }
    return {std::move(pose_), turned_, heading_};
  }

 private:
  Vec3 position(int joint) const { return pose_[static_cast<std::size_t>(joint)].position; }
  Vec3 bone(int from, int to) const { return position(to) - position(from); }

  void rotate(int joint, const Quat& rotation) { turn_joint(skeleton_, joint, rotation, pose_); }

  // Rotates `joint` so that the bone to `child` points along `wanted`, if it deviates by more than
  // `tolerance`.
  void point(int joint, int child, const Vec3& wanted, double tolerance) {
    const Vec3 now = bone(joint, child);
    if (now.norm() < 1e-3 * actor_.stature) return;
    const double off = turn_angle(now, wanted);
    if (off <= tolerance) return;
    rotate(joint, shortest_arc(now, wanted));
    turned_ += off;
  }

  void face_forward() {
    const HumanAxes axes = human_axes(actor_, pose_);
    const double tilt = turn_angle(axes.up, Vec3::UnitY());
    Vec3 forward = axes.forward;
    Quat rotation = Quat::Identity();
    if (tilt > 25 * kDegree) {
      Mat3 from;
      from << axes.left, axes.up, axes.forward;
      rotation = Quat(Mat3(from.transpose()));
      heading_ = tilt;
    } else {  // a slight lean is kept
      forward.y() = 0;
      const double turn = std::atan2(forward.x(), forward.z());
      if (std::abs(turn) < 10 * kDegree) return;
      rotation = Quat(Eigen::AngleAxisd(-turn, Vec3::UnitY()));
      heading_ = std::abs(turn);
    }
    rotate(0, normalized_or_identity(rotation));
  }

  // Rotates the bones from one joint to another upwards, one by one, if they are folded or their
  // overall direction is more than 40 degrees from up. Otherwise single bones may deviate.
  void straighten(int from, int to) {
    const auto path = joint_path(skeleton_, from, to);
    double length = 0;
    for (std::size_t i = 1; i < path.size(); ++i) length += bone(path[i - 1], path[i]).norm();
    const Vec3 whole = bone(path.front(), path.back());
    if (whole.norm() > 0.75 * length && turn_angle(whole, Vec3::UnitY()) < 40 * kDegree) return;
    for (std::size_t i = 1; i < path.size(); ++i) {
      point(path[i - 1], path[i], Vec3::UnitY(), 30 * kDegree);
    }
  }

  void straighten_trunk() {
    const int top = actor_.head >= 0 ? actor_.head : actor_.neck;
    const Quat before = pose_[static_cast<std::size_t>(top)].orientation;
    const int chest =
        skeleton_.parents[static_cast<std::size_t>(actor_.neck >= 0 ? actor_.neck : actor_.head)];
    straighten(actor_.hips, chest);
    straighten(chest, top);
    // Keeps the direction of the face. (The end site of the head is not reliable: some exporters
    // put it anywhere.)
    rotate(top, normalized_or_identity(
                    before * pose_[static_cast<std::size_t>(top)].orientation.conjugate()));
  }

  // Whether a thigh crosses to the other side, is spread wide or raised.
  bool leg_in_the_way(std::size_t side) const {
    const auto& leg = actor_.legs[side];
    const Vec3 thigh = bone(leg.hip, leg.knee).normalized();
    const double apart = (side == 0 ? 1.0 : -1.0) * thigh.x();
    return apart < -0.06 || apart > 0.28 || std::abs(thigh.z()) > 0.30 || thigh.y() > 0;
  }

  // Whether an upper arm is beside the trunk, raised, or far in front of or behind it.
  bool arm_in_the_way(std::size_t side) const {
    const auto& arm = actor_.arms[side];
    const Vec3 upper = bone(arm.shoulder, arm.elbow).normalized();
    const double out = (side == 0 ? 1.0 : -1.0) * upper.x();
    return out < 0.45 || upper.y() > 0.21 || std::abs(upper.z()) > 0.4;
  }

  void place_leg(std::size_t side, bool turn) {
    const auto& leg = actor_.legs[side];
    const double out = side == 0 ? 1.0 : -1.0;
    if (turn) point(leg.hip, leg.knee, Vec3(0.06 * out, -1, 0), 0);
    const Vec3 upper = bone(leg.hip, leg.knee).normalized();
    point(leg.knee, leg.ankle, Vec3(upper.x(), upper.y(), std::min(0.0, upper.z())), 20 * kDegree);
    const int far = leg.toes >= 0 ? leg.toes : leg.tip;
    if (far < 0) return;
    const Vec3 foot = bone(leg.ankle, far);
    const double level = std::hypot(foot.x(), foot.z());
    const double pitch = std::atan2(-foot.y(), level);
    const double yaw = std::atan2(out * foot.x(), foot.z());
    const bool fits =
        pitch > -12 * kDegree && pitch < 60 * kDegree && yaw > -20 * kDegree && yaw < 40 * kDegree;
    if (!fits) {
      const Vec3 wanted(0.1 * out, -std::tan(leg.toes >= 0 ? 25 * kDegree : 10 * kDegree), 1);
      point(leg.ankle, far, wanted, 0);
    }
    if (leg.toes >= 0 && leg.tip >= 0 && leg.tip != leg.toes) {
      Vec3 ahead = bone(leg.ankle, leg.toes);
      ahead.y() = 0;
      if (ahead.norm() > 1e-6 * actor_.stature) point(leg.toes, leg.tip, ahead, 35 * kDegree);
    }
  }

  void place_arm(std::size_t side, bool turn) {
    const auto& arm = actor_.arms[side];
    const double out = side == 0 ? 1.0 : -1.0;
    if (arm.collar >= 0) {
      const Vec3 collar = bone(arm.collar, arm.shoulder);
      if (out * collar.x() < 0.3 * collar.norm()) {
        point(arm.collar, arm.shoulder, Vec3(out, 0.1, 0), 30 * kDegree);
      }
    }
    const Vec3 upper = bone(arm.shoulder, arm.elbow).normalized();
    if (turn) {
      const double hanging = turn_angle(upper, -Vec3::UnitY());
      // A raised or horizontal arm goes to a T-pose, a hanging one to an A-pose.
      const double aim = hanging > 75 * kDegree ? 90 * kDegree : 45 * kDegree;
      point(arm.shoulder, arm.elbow, Vec3(out * std::sin(aim), -std::cos(aim), 0), 0);
    }
    point(arm.elbow, arm.wrist, bone(arm.shoulder, arm.elbow), 28 * kDegree);
    Vec3 knuckles = Vec3::Zero();
    int count = 0;
    for (const auto& chain : arm.fingers) {
      for (const int joint : chain) {
        const Vec3 offset = bone(arm.wrist, joint);
        if (offset.norm() < 0.02 * actor_.stature) continue;
        knuckles += offset.normalized();
        ++count;
        break;
      }
    }
    if (count == 0 || knuckles.norm() < 0.3 * count) return;
    const Vec3 forearm = bone(arm.elbow, arm.wrist);
    const double off = turn_angle(knuckles, forearm);
    if (off > 30 * kDegree) {
      rotate(arm.wrist, shortest_arc(knuckles, forearm));
      turned_ += off;
    }
  }

  const Skeleton& skeleton_;
  const HumanActor& actor_;
  std::vector<Transform> pose_;
  double turned_ = 0, heading_ = 0;
};

// Rotates only what prevents building a body: the whole body upright and facing +Z, arms away from
// the trunk (about 30 to 100 degrees from hanging straight down), elbows, wrists, knees and toes
// bent by more than about 25 degrees straight, legs side by side under the hips, feet level and
// forward, a folded trunk or neck up. Corrections apply to both sides. Bone lengths are kept. Limbs
// are rotated by the shortest arc, so that they keep their twist.
StandingPose stand_upright(const Skeleton& skeleton, const HumanActor& actor,
                           std::span<const Transform> pose) {
  return Straightener(skeleton, actor, pose).run();
}

// Moves a pose of a clip, which is at the captured position, to the origin.
void bring_home(std::vector<Transform>& pose) {
  Vec3 middle = pose.front().position;
  double low = middle.y();
  for (const Transform& transform : pose) low = std::min(low, transform.position.y());
  for (Transform& transform : pose) transform.position -= Vec3(middle.x(), low, middle.z());
}

constexpr int kSamples = 60;  // candidate frames

// Total bone rotation (radians) above which a frame may be better than the reference pose.
constexpr double kTooMuch = 4.0;

// The spread of a pose's bones: the mean distance from a bone's midpoint to that of the nearest
// bone that it is not connected to, over the total bone length.
double spread(const Skeleton& skeleton, std::span<const Transform> pose) {
  std::vector<Vec3> middles;
  std::vector<std::pair<int, int>> ends;
  double total = 0;
  for (std::size_t j = 1; j < pose.size(); ++j) {
    const int parent = skeleton.parents[j];
    const Vec3& from = pose[static_cast<std::size_t>(parent)].position;
    const double length = (pose[j].position - from).norm();
    if (!(length > 0)) continue;
    total += length;
    middles.push_back(0.5 * (from + pose[j].position));
    ends.emplace_back(parent, static_cast<int>(j));
  }
  double sum = 0;
  std::size_t pairs = 0;
  const std::size_t stride = std::max<std::size_t>(1, middles.size() / 100);
  for (std::size_t a = 0; a < middles.size(); a += stride) {
    double nearest = total;
    for (std::size_t b = 0; b < middles.size(); b += stride) {
      const bool meet = ends[a].first == ends[b].first || ends[a].first == ends[b].second ||
                        ends[a].second == ends[b].first || ends[a].second == ends[b].second;
      if (!meet) nearest = std::min(nearest, (middles[a] - middles[b]).norm());
    }
    if (nearest < total) sum += nearest, ++pairs;
  }
  return pairs > 0 && total > 0 ? sum / (static_cast<double>(pairs) * total) : 1.0;
}

}  // namespace

Result<std::vector<Transform>> pose_of(const FrameSource& source, int frame) {
  const auto clip = load(part_of(source, frame, 1), 1);
  if (!clip) return clip.error();
  std::vector<Transform> pose(source.skeleton.names.size());
  clip->get_pose(0, pose);
  return pose;
}

Status untwist(const FrameSource& source, std::vector<Transform>& pose) {
  constexpr double kNoPosture = 120 * kDegree;
  const auto usual = usual_pose(source);
  if (!usual) return usual.error();
  if (usual->empty()) return {};
  const auto children = source.skeleton.children();
  for (std::size_t j = 1; j < pose.size(); ++j) {
    if (children[j].size() != 1) continue;
    const Transform& parent = pose[static_cast<std::size_t>(source.skeleton.parents[j])];
    const Transform& usual_parent = (*usual)[static_cast<std::size_t>(source.skeleton.parents[j])];
    const Transform& child = pose[static_cast<std::size_t>(children[j].front())];
    const Vec3 bone = (pose[j].inverse() * child.position).normalized();
    const Quat in_motion = usual_parent.orientation.conjugate() * (*usual)[j].orientation;
    const Quat turn =
        (parent.orientation.conjugate() * pose[j].orientation).conjugate() * in_motion;
    const double along = turn.vec().dot(bone);
    const double twist = 2 * std::atan2(turn.w() < 0 ? -along : along, std::abs(turn.w()));
    if (!(std::abs(twist) > kNoPosture)) continue;
    pose[j].orientation = pose[j].orientation * Quat(Eigen::AngleAxisd(twist, bone));
  }
  return {};
}

Status drop_tips_below_ankles(const FrameSource& source, HumanActor& actor) {
  constexpr double kInLine = 25 * kDegree;  // feet of dancers who point them are at 35 and more
  const auto usual = usual_pose(source);
  if (!usual) return usual.error();
  if (usual->empty()) return {};
  const auto place = [&](int joint) { return (*usual)[static_cast<std::size_t>(joint)].position; };
  for (HumanActor::Leg& leg : actor.legs) {
    if (leg.toes >= 0 || leg.tip < 0) continue;
    const Vec3 shank = place(leg.ankle) - place(leg.knee), foot = place(leg.tip) - place(leg.ankle);
    if (turn_angle(shank, foot) < kInLine) leg.tip = -1;
  }
  return {};
}

Result<BuildPose> human_build_pose(const FrameSource& source, const RoleMap& roles,
                                   const HumanActor& actor) {
  const Skeleton& skeleton = source.skeleton;
  StandingPose best = stand_upright(skeleton, actor, skeleton.reference);
  std::string name = best.turned > 0    ? "reference, limbs turned aside"
                     : best.heading > 0 ? "reference, turned upright"
                                        : "reference";
  if (best.turned > kTooMuch) {
    const auto neutral = retarget::neutral_skeleton(source, roles);
    if (!neutral) return neutral.error();
    StandingPose built = stand_upright(skeleton, actor, neutral->reference);
    if (built.turned < 0.6 * best.turned) {
      best = std::move(built);
      bring_home(best.joint_to_world);
      name = "T-pose built from the skeleton";
    }
  }
  return BuildPose{std::move(best.joint_to_world), std::move(name)};
}

Result<BuildPose> general_build_pose(const FrameSource& source) {
  const Skeleton& skeleton = source.skeleton;
  BuildPose best{skeleton.reference, "reference"};
  double most = 1.5 * spread(skeleton, skeleton.reference);
  const int frames = source.frame_count;
  const int step = std::max(1, frames / kSamples);
  for (int frame = 0; frame < frames; frame += step) {
    auto pose = pose_of(source, frame);
    if (!pose) return pose.error();
    const double candidate = spread(skeleton, *pose);
    if (candidate <= most) continue;
    most = candidate;
    bring_home(*pose);
    best = {*std::move(pose), fmt::format("frame {}", frame)};
  }
  return best;
}

}  // namespace krok::body
