#include "capture/rest_frame.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "math/quaternion.h"

namespace krok {

namespace {

enum class PoseKind { t_pose, a_pose, other, unknown };

double degrees_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kRadiansPerDegree;
}

// Classifies a pose in Krok's frame with legs down and trunk up: arms out (T) or lowered (A).
PoseKind kind_of_pose(const RoleMap& roles, std::span<const Transform> pose) {
  if (!roles.humanoid) return PoseKind::unknown;
  const auto place = [&](Role role) {
    return pose[static_cast<std::size_t>(roles.joint(role))].position;
  };
  const Role trunk_top = roles.joint(Role::head) >= 0 ? Role::head : Role::neck;
  const Vec3 trunk = place(trunk_top) - place(Role::hips);
  const Vec3 left_leg = place(Role::left_foot) - place(Role::left_upper_leg);
  const Vec3 right_leg = place(Role::right_foot) - place(Role::right_upper_leg);
  if (degrees_between(trunk, Vec3::UnitY()) > 25 ||
      degrees_between(left_leg, -Vec3::UnitY()) > 25 ||
      degrees_between(right_leg, -Vec3::UnitY()) > 25) {
    return PoseKind::other;
  }
  const Vec3 left = place(Role::left_hand) - place(Role::left_upper_arm);
  const Vec3 right = place(Role::right_hand) - place(Role::right_upper_arm);
  const double left_drop = degrees_between(left, -Vec3::UnitY());
  const double right_drop = degrees_between(right, -Vec3::UnitY());
  const bool apart = degrees_between(left, right) > 50;
  if (std::abs(left_drop - 90) < 20 && std::abs(right_drop - 90) < 20 && apart) {
    return PoseKind::t_pose;
  }
  return left_drop < 70 && right_drop < 70 ? PoseKind::a_pose : PoseKind::other;
}

// Rotation of joints relative to their parents from one frame to another.
struct Step {
  double largest = 0;    // degrees
  int many_degrees = 0;  // joints that rotate by at least 5 degrees
};

// Steps between successive frames, from the first frame on.
class Steps {
 public:
  explicit Steps(const Clip& clip)
      : clip_(clip),
        world_(static_cast<std::size_t>(clip.joint_count())),
        before_(world_.size()),
        now_(world_.size()) {
    read_next();
  }

  Step next() {
    std::swap(before_, now_);
    read_next();
    Step step;
    for (std::size_t j = 0; j < world_.size(); ++j) {
      const double turn =
          angle_between(before_[j].orientation, now_[j].orientation) / kRadiansPerDegree;
      step.largest = std::max(step.largest, turn);
      if (turn >= 5.0) ++step.many_degrees;
    }
    return step;
  }

 private:
  void read_next() {
    clip_.get_pose(frame_++, world_);
    world_to_local(clip_.skeleton.parents, world_, now_);
  }

  const Clip& clip_;
  int frame_ = 0;
  std::vector<Transform> world_, before_, now_;  // before_, now_: local
};

// Of each joint in its parent.
std::vector<Transform> local_pose(const Clip& clip, int frame) {
  std::vector<Transform> world(static_cast<std::size_t>(clip.joint_count())), local(world.size());
  clip.get_pose(frame, world);
  world_to_local(clip.skeleton.parents, world, local);
  return local;
}

// Fraction of joints, without root and end sites, that are not rotated relative to their parents.
double unturned_share(const Clip& clip, int frame) {
  const std::vector<Transform> local = local_pose(clip, frame);
  const std::size_t joints = local.size();
  int asked = 0;
  int unturned = 0;
  for (std::size_t j = 1; j < joints; ++j) {
    if (clip.skeleton.end_sites[j] != 0) continue;
    ++asked;
    if (angle_between(local[j].orientation, Quat::Identity()) < 1e-3) ++unturned;
  }
  return asked == 0 ? 0.0 : static_cast<double>(unturned) / asked;
}

const char* name_of(PoseKind kind) {
  switch (kind) {
    case PoseKind::t_pose:
      return "a T-pose";
    case PoseKind::a_pose:
      return "upright with the arms down";
    case PoseKind::other:
      return "not a T-pose";
    case PoseKind::unknown:
      break;
  }
  return "of unknown kind, as no humanoid was recognised";
}

// The frames of a T-pose that is held at the start and of the way from it: 0 where none is, or
// where the motion goes on as fast.
int frames_of_held_pose(const Clip& clip, int fewest_joints) {
  constexpr int kMaxHeld = 5, kMaxSteps = 15;
  constexpr double kHeld = 1, kMinStep = 15;  // degrees
  constexpr double kFactor = 1.8;
  Steps steps(clip);
  std::vector<Step> all;
  while (static_cast<int>(all.size()) < std::min(clip.frame_count() - 1, kMaxSteps)) {
    all.push_back(steps.next());
  }
  const auto away =
      std::ranges::find_if(all, [](const Step& step) { return step.largest >= kHeld; });
  if (away == all.end() || away - all.begin() >= kMaxHeld || away->largest < kMinStep ||
      away->many_degrees < fewest_joints) {
    return 0;
  }
  auto end = away + 1;
  if (end != all.end() && end->largest >= away->largest / 2) ++end;
  double later = 0;
  for (auto step = end; step != all.end(); ++step) later = std::max(later, step->largest);
  return end != all.end() && away->largest >= kFactor * later ? static_cast<int>(end - all.begin())
                                                              : 0;
}

}  // namespace

RestPose find_rest_pose(const Clip& clip, const RoleMap& roles) {
  RestPose result;
  result.reference = name_of(kind_of_pose(roles, clip.skeleton.reference));
  constexpr int kMinFrames = 4;
  if (clip.frame_count() < kMinFrames) return result;
  Steps steps(clip);
  const Step first_step = steps.next();
  constexpr double kMinStep = 15.0;  // degrees
  double later_step = 0;
  const int last = first_step.largest < kMinStep ? 0 : std::min(clip.frame_count() - 1, 11);
  for (int frame = 1; frame < last; ++frame) {
    later_step = std::max(later_step, steps.next().largest);
  }
  std::vector<Transform> pose(static_cast<std::size_t>(clip.joint_count()));
  clip.get_pose(0, pose);
  const bool t_pose = kind_of_pose(roles, pose) == PoseKind::t_pose;
  // A T-pose is evidence too, so a smaller step suffices.
  const double factor = t_pose ? 2.5 : 4.0;
  // One or two joints that jump are a tracking error.
  const int fewest_joints = std::min(4, clip.joint_count() / 2);
  const bool apart = first_step.largest >= kMinStep && first_step.largest >= factor * later_step &&
                     first_step.many_degrees >= fewest_joints;
  if (!apart || (!t_pose && unturned_share(clip, 0) < 0.6)) {
    if (!t_pose) return result;
    result.reference += "; the motion starts in a T-pose";
    const int frames = frames_of_held_pose(clip, fewest_joints);
    if (frames < 2) return result;
    result.frames = frames;
    const std::vector<Transform> held = local_pose(clip, 0), moving = local_pose(clip, frames);
    double turn = 0;
    for (std::size_t j = 0; j < held.size(); ++j) {
      turn = std::max(turn, angle_between(held[j].orientation, moving[j].orientation));
    }
    result.reason = fmt::format("frames 0 to {} are a T-pose, {:.0f} degrees away from frame {}",
                                frames - 1, turn / kRadiansPerDegree, frames);
    return result;
  }
  result.first_frame_is_rest = true;
  result.frames = 1;
  result.reason = fmt::format("frame 0 is a {}, {:.0f} degrees away from frame 1",
                              t_pose ? "T-pose" : "rest pose", first_step.largest);
  return result;
}

bool settle_rest_frame(const RestPose& rest, RestFrame wish, const std::string& prefix,
                       const std::string& file_name, Capture& capture) {
  Clip& clip = capture.clip;
  const bool drop =
      clip.frame_count() > 0 &&
      (wish == RestFrame::drop || (wish == RestFrame::automatic && rest.first_frame_is_rest));
  if (drop) {
    const auto joints = static_cast<std::ptrdiff_t>(clip.joint_count());
    clip.positions.erase(clip.positions.begin(), clip.positions.begin() + joints);
    clip.orientations.erase(clip.orientations.begin(), clip.orientations.begin() + joints);
    clip.provenance.conversions.emplace_back("the first frame, a rest pose, was dropped");
  }
  if (!drop && rest.frames == 0) return drop;
  Diagnostic diagnostic;
  diagnostic.severity = drop ? Severity::note : Severity::warning;
  diagnostic.code = prefix + "-rest-frame";
  diagnostic.where.file = file_name;
  if (rest.frames > 1) {
    diagnostic.message = rest.reason + (drop ? "; the first was dropped" : "; they were kept");
    diagnostic.hint =
        fmt::format("drop them with krok-edit --from {}f", rest.frames - (drop ? 1 : 0));
    diagnostic.severity = Severity::warning;
  } else if (rest.first_frame_is_rest) {
    diagnostic.message = fmt::format("{}; it {}", rest.reason, drop ? "was dropped" : "was kept");
    if (!drop) diagnostic.hint = "drop it with --skip-rest-frame auto";
  } else {
    diagnostic.message = "the first frame was dropped as requested";
  }
  capture.diagnostics.push_back(std::move(diagnostic));
  return drop;
}

Result<RoleMap> roles_of(const Skeleton& skeleton, const CaptureOptions& options) {
  return options.roles ? options.roles(skeleton) : find_roles(skeleton);
}

Status check_rate(const std::optional<double>& rate, const std::string& code) {
  return rate ? check_frame_rate(*rate, code) : Status();
}

}  // namespace krok
