#include "body/human_actor.h"

#include <algorithm>
#include <cmath>

#include "math/quaternion.h"
#include "math/window.h"
#include "roles/joint_names.h"

namespace krok::body {

namespace {

double distance(std::span<const Transform> pose, int a, int b) {
  return (pose[static_cast<std::size_t>(a)].position - pose[static_cast<std::size_t>(b)].position)
      .norm();
}

// Follows from `joint` the child with the deepest chain to the tip.
std::vector<int> longest_chain(const Skeleton& skeleton,
                               const std::vector<std::vector<int>>& children, int joint) {
  // Children come after their parents, so one backward pass finds the longest paths.
  std::vector<double> reach(skeleton.names.size(), 0);
  std::vector<int> next(skeleton.names.size(), -1);
  for (int j = skeleton.joint_count() - 1; j >= joint; --j) {
    const auto i = static_cast<std::size_t>(j);
    for (const int child : children[i]) {
      const double through =
          reach[static_cast<std::size_t>(child)] + distance(skeleton.reference, j, child) + 1e-9;
      if (through > reach[i]) reach[i] = through, next[i] = child;
    }
  }
  std::vector<int> chain;
  for (int j = joint; j >= 0; j = next[static_cast<std::size_t>(j)]) chain.push_back(j);
  return chain;
}

// All finger chains below the wrist. Skips a joint between wrist and knuckles that several fingers
// share (a palm), and joints of props.
void find_fingers(const Skeleton& skeleton, const std::vector<std::vector<int>>& children,
                  int joint, int depth, std::vector<std::vector<int>>& fingers) {
  for (const int child : children[static_cast<std::size_t>(joint)]) {
    if (names_no_shape(skeleton.names[static_cast<std::size_t>(child)])) continue;
    std::size_t deep = 0;
    for (const int grandchild : children[static_cast<std::size_t>(child)]) {
      if (!skeleton.end_sites[static_cast<std::size_t>(grandchild)]) ++deep;
    }
    if (deep >= 2 && depth < 3) {
      find_fingers(skeleton, children, child, depth + 1, fingers);
    } else {
      fingers.push_back(longest_chain(skeleton, children, child));
    }
  }
}

// Some skeletons have a joint at the sole below the ankle, with the tip of the foot as its child;
// that joint is not the ball of the foot.
void tell_sole_from_toes(const Skeleton& skeleton, double stature, HumanActor::Leg& leg) {
  if (leg.toes < 0 || leg.tip < 0 || leg.tip == leg.toes) return;
  const auto& pose = skeleton.reference;
  const double down = distance(pose, leg.ankle, leg.toes);
  if (down > 0.035 * stature || distance(pose, leg.toes, leg.tip) < 2 * down) return;
  leg.sole = leg.toes;
  leg.toes = -1;
}

// Lengths of segments over stature: Drillis and Contini 1966, in Winter, Biomechanics and Motor
// Control of Human Movement, figure 4.1.
std::vector<double> stature_estimates(std::span<const Transform> pose, const HumanActor& actor) {
  std::vector<double> statures;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto& arm = actor.arms[side];
    const auto& leg = actor.legs[side];
    const double thigh = distance(pose, leg.hip, leg.knee) / 0.245;
    const double shank = distance(pose, leg.knee, leg.ankle) / 0.246;
    const double upper_arm = distance(pose, arm.shoulder, arm.elbow) / 0.186;
    const double forearm = distance(pose, arm.elbow, arm.wrist) / 0.146;
    for (const double estimate : {thigh, shank, upper_arm, forearm}) statures.push_back(estimate);
    statures.push_back(distance(pose, leg.hip, leg.ankle) / 0.491);
  }
  return statures;
}

// Whether legs and arms all point one way across the trunk, as an animal's whose joints have a
// person's names. Whichever way the pose lies: readers stand such animals up.
bool is_on_four_legs(std::span<const Transform> pose, const HumanActor& actor, const Vec3& trunk) {
  std::array<Vec3, 4> limbs;
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    const auto& arm = actor.arms[i / 2];
    const auto& leg = actor.legs[i / 2];
    const auto from = static_cast<std::size_t>(i % 2 == 0 ? arm.shoulder : leg.hip);
    const auto to = static_cast<std::size_t>(i % 2 == 0 ? arm.wrist : leg.ankle);
    limbs[i] = (pose[to].position - pose[from].position).stableNormalized();
    sum += limbs[i];
  }
  const Vec3 down = sum.stableNormalized(), along = trunk.stableNormalized();
  return std::ranges::all_of(limbs, [&](const Vec3& limb) {
    return limb.dot(down) > 0.8 && std::abs(limb.dot(along)) < 0.5;
  });
}

}  // namespace

std::vector<int> joint_path(const Skeleton& skeleton, int ancestor, int joint) {
  std::vector<int> path;
  for (int j = joint; j >= 0; j = skeleton.parents[static_cast<std::size_t>(j)]) {
    path.push_back(j);
    if (j == ancestor) {
      std::reverse(path.begin(), path.end());
      return path;
    }
  }
  return {joint};
}

std::optional<HumanActor> find_human(const Skeleton& skeleton, const RoleMap& roles) {
  if (!roles.humanoid) return std::nullopt;
  HumanActor actor;
  actor.hips = roles.joint(Role::hips);
  actor.neck = roles.joint(Role::neck);
  actor.head = roles.joint(Role::head);
  const auto children = skeleton.children();
  for (std::size_t side = 0; side < 2; ++side) {
    auto& arm = actor.arms[side];
    arm.collar = roles.joint(kArmRoles[side].collar);
    arm.shoulder = roles.joint(kArmRoles[side].upper);
    arm.elbow = roles.joint(kArmRoles[side].lower);
    arm.wrist = roles.joint(kArmRoles[side].hand);
    auto& leg = actor.legs[side];
    leg.hip = roles.joint(kLegRoles[side].upper);
    leg.knee = roles.joint(kLegRoles[side].lower);
    leg.ankle = roles.joint(kLegRoles[side].foot);
    leg.toes = roles.joint(kLegRoles[side].toes);
    if (arm.shoulder < 0 || arm.elbow < 0 || arm.wrist < 0) return std::nullopt;
    if (leg.hip < 0 || leg.knee < 0 || leg.ankle < 0) return std::nullopt;
    find_fingers(skeleton, children, arm.wrist, 0, arm.fingers);
    const auto chain = longest_chain(skeleton, children, leg.toes >= 0 ? leg.toes : leg.ankle);
    if (chain.size() > 1) leg.tip = chain.back();
  }
  if (actor.hips < 0 || (actor.neck < 0 && actor.head < 0)) return std::nullopt;

  const auto& pose = skeleton.reference;
  const auto statures = stature_estimates(pose, actor);
  actor.stature = median(statures);
  if (!(actor.stature > 0)) return std::nullopt;
  for (const double estimate : statures) {
    if (estimate < 0.3 * actor.stature || estimate > 2.5 * actor.stature) return std::nullopt;
  }
  for (auto& leg : actor.legs) tell_sole_from_toes(skeleton, actor.stature, leg);
  const Vec3 hip_middle = 0.5 * (pose[static_cast<std::size_t>(actor.legs[0].hip)].position +
                                 pose[static_cast<std::size_t>(actor.legs[1].hip)].position);
  const Vec3 shoulder_middle =
      0.5 * (pose[static_cast<std::size_t>(actor.arms[0].shoulder)].position +
             pose[static_cast<std::size_t>(actor.arms[1].shoulder)].position);
  if (is_on_four_legs(pose, actor, shoulder_middle - hip_middle)) return std::nullopt;
  const double trunk = (shoulder_middle - hip_middle).norm();
  if (trunk < 0.1 * actor.stature || trunk > 0.7 * actor.stature) return std::nullopt;

  if (actor.head >= 0) {
    double best = 0.03 * actor.stature;
    const Vec3 up = (shoulder_middle - hip_middle).normalized();
    for (const int child : children[static_cast<std::size_t>(actor.head)]) {
      const double height = (pose[static_cast<std::size_t>(child)].position -
                             pose[static_cast<std::size_t>(actor.head)].position)
                                .dot(up);
      if (height > best) best = height, actor.head_top = child;
    }
  }
  return actor;
}

HumanAxes human_axes(const HumanActor& actor, std::span<const Transform> pose) {
  const auto at = [&pose](int joint) { return pose[static_cast<std::size_t>(joint)].position; };
  const Vec3 hips = 0.5 * (at(actor.legs[0].hip) + at(actor.legs[1].hip));
  const Vec3 shoulders = 0.5 * (at(actor.arms[0].shoulder) + at(actor.arms[1].shoulder));
  HumanAxes axes;
  const Vec3 trunk = shoulders - hips;
  if (trunk.norm() > 1e-9 * actor.stature) axes.up = trunk.normalized();
  Vec3 left = (at(actor.legs[0].hip) - at(actor.legs[1].hip)) +
              (at(actor.arms[0].shoulder) - at(actor.arms[1].shoulder));
  left -= axes.up * axes.up.dot(left);
  if (left.norm() > 1e-6 * actor.stature) {
    axes.left = left.normalized();
  } else {
    const Vec3 other = std::abs(axes.up.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitZ();
    axes.left = (other - axes.up * axes.up.dot(other)).normalized();
  }
  axes.forward = axes.left.cross(axes.up);
  return axes;
}

void turn_joint(const Skeleton& skeleton, int joint, const Quat& rotation,
                std::span<Transform> joint_to_world) {
  const auto first = static_cast<std::size_t>(joint);
  const Vec3 pivot = joint_to_world[first].position;
  std::vector<char> below(joint_to_world.size(), 0);
  for (std::size_t j = first; j < joint_to_world.size(); ++j) {
    const int parent = skeleton.parents[j];
    below[j] = j == first || (parent >= 0 && below[static_cast<std::size_t>(parent)]) ? 1 : 0;
    if (!below[j]) continue;
    Transform& transform = joint_to_world[j];
    transform.position = pivot + rotation * (transform.position - pivot);
    transform.orientation = normalized_or_identity(rotation * transform.orientation);
  }
}

double turn_angle(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace krok::body
