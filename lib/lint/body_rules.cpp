#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "capture/rest_frame.h"
#include "contacts/legs.h"
#include "core/index.h"
#include "core/numbers.h"
#include "lint/series_internal.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "roles/body_frame.h"
#include "roles/roles.h"

// Rules about the body: its size, bones, limits, reference pose and the ends of a loop.

namespace krok::lint {

namespace {

constexpr double kUsualStature = 1.72;  // metres
constexpr double kMinChange = 0.0025;   // metres, of a bone
constexpr double kShortestBone = 0.02;  // metres
constexpr double kConstant = 0.0005;    // metres, of a distance that only rounding changes
constexpr double kLongEnough = 0.1;     // seconds beyond a limit
constexpr double kForwards = 0.7;       // cosine to where the toes point
constexpr double kPointed = 0.5;        // of a foot's length, ahead of the shin
constexpr double kTurnedOut = 0.7;      // cosine from the line of the hips to where the toes point
constexpr double kLookAt = 30;          // poses a second that limits are checked in

void find_unit(const Series& series, MotionFaults& out) {
  const auto stature = stature_of(series.clip.skeleton, series.roles);
  if (!stature) return;
  const double ratio = stature->metres / kUsualStature, limit = series.threshold(Rule::unit);
  if (ratio < limit && ratio > 1 / limit) return;
  Finding finding = finding_of(Rule::unit, series, ratio, series.whole());
  finding.detail = fmt::format("the body is {} m tall", readable(stature->metres, 3));
  out.findings.push_back(finding);
}

bool is_of_body(Role role) {
  return role != Role::none && role != Role::helper && role != Role::end && role != Role::root;
}

// Whether a joint keeps its distance from its parent's parent, as the thighs of a Biped do, whose
// parent is the spine and whose place the pelvis gives.
bool is_carried_past(const Series& series, int joint) {
  const auto& parents = series.clip.skeleton.parents;
  const int carrier = parents[at(parents[at(joint)])];
  if (carrier < 0) return false;
  float low = INFINITY, high = 0;
  for (int f = 0; f < series.frames; ++f) {
    const auto places = series.clip.frame_positions(f);
    const float length = (places[at(joint)] - places[at(carrier)]).norm();
    low = std::min(low, length), high = std::max(high, length);
  }
  return high - low < kConstant * series.scale;
}

void find_bones(const Series& series, MotionFaults& out) {
  const Skeleton& skeleton = series.clip.skeleton;
  const auto below = subtree(skeleton, series.carrier);
  const bool roles = series.roles.humanoid;
  std::vector<Finding> found;
  struct Bone {
    int joint, parent;
    float low = INFINITY, high = 0;  // square metres
  };
  std::vector<Bone> bones;
  // Of what is no person: what moves most of the body against its root is no bone.
  std::vector<int> carried(at(series.joints), 1);  // the joint itself and those below it
  for (int j = series.joints - 1; j > 0; --j) {
    const int parent = skeleton.parents[at(j)];
    if (parent >= 0) carried[at(parent)] += carried[at(j)];
  }
  const auto moves_the_body = [&](int joint) {
    return !roles && skeleton.parents[at(joint)] == 0 && 2 * carried[at(joint)] > series.joints;
  };
  for (int j = 0; j < series.joints; ++j) {
    const int parent = skeleton.parents[at(j)];
    if (parent < 0 || j == series.carrier || below[at(j)] == 0 || skeleton.end_sites[at(j)] != 0 ||
        (roles &&
         !(is_of_body(series.roles.roles[at(j)]) && is_of_body(series.roles.roles[at(parent)])))) {
      continue;
    }
    if (moves_the_body(j)) continue;
    bones.push_back({j, parent});
  }
  for (int f = 0; f < series.frames; ++f) {
    const auto places = series.clip.frame_positions(f);
    for (Bone& bone : bones) {
      const float square = (places[at(bone.joint)] - places[at(bone.parent)]).squaredNorm();
      bone.low = std::min(bone.low, square), bone.high = std::max(bone.high, square);
    }
  }
  std::vector<float> lengths(at(series.frames));
  for (const auto& [j, parent, low_square, high_square] : bones) {
    const float low = std::sqrt(low_square), high = std::sqrt(high_square);
    const double range = high - low;
    if (range < kMinChange * series.scale) continue;
    double sum = 0;
    for (int f = 0; f < series.frames; ++f) {
      const auto places = series.clip.frame_positions(f);
      lengths[at(f)] = (places[at(j)] - places[at(parent)]).norm();
      sum += lengths[at(f)];
    }
    const double mean = sum / series.frames;
    if (mean < kShortestBone * series.scale) continue;
    Finding finding = finding_of(Rule::bone_length, series, 100 * range / mean, series.whole());
    if (finding.value <= finding.threshold) continue;
    finding.joint = j;
    double farthest = 0, largest = 0;
    for (int f = 0; f < series.frames; ++f) {
      const double off = std::abs(lengths[at(f)] - mean);
      if (off > farthest) farthest = off, finding.worst = f;
      if (f > 0) largest = std::max(largest, std::abs(1.0 * lengths[at(f)] - lengths[at(f - 1)]));
    }
    const bool jumps = largest > range / 2;
    const Role role = series.roles.roles[at(j)];
    // Shoulder blades glide on the ribs, and creatures are made to stretch.
    const bool glides = !roles || role == Role::left_collar || role == Role::right_collar;
    if ((!jumps && glides) || is_carried_past(series, j)) continue;
    finding.detail = fmt::format("{} to {} m{}", readable(low, 3), readable(high, 3),
                                 jumps ? ", in one frame" : "");
    found.push_back(finding);
  }
  merge_joints(found, 0);
  out.findings.insert(out.findings.end(), found.begin(), found.end());
}

// Degrees by which a knee is bent forwards: the shin out of the thigh's direction to where the toes
// point. From places alone, so that reference poses and axes of joints do not matter.
double knee_bent_forwards(std::span<const Vec3f> places, const LegJoints& leg, int other_hip) {
  const auto place = [&](int joint) -> Vec3 { return places[at(joint)].cast<double>(); };
  Vec3 thigh = place(leg.lower) - place(leg.upper), shin = place(leg.foot) - place(leg.lower);
  const Vec3 foot = place(leg.toes) - place(leg.foot);
  // Nearly all bend backwards: bend.dot(forwards) below, but for its size.
  if (foot.dot(shin) * thigh.dot(shin) < foot.dot(thigh) * shin.squaredNorm()) return 0;
  thigh.normalize(), shin.normalize();
  const Vec3 ahead = foot - foot.dot(shin) * shin;
  if (ahead.norm() < kPointed * foot.norm()) return 0;  // toes point along the shin
  const Vec3 forwards = ahead.normalized();
  // Turned out or held beside the other knee, as in a dance, toes do not show where knees point.
  const Vec3 across = place(other_hip) - place(leg.upper);
  if (std::abs(forwards.dot(across)) > kTurnedOut * across.norm()) return 0;
  const Vec3 bend = shin.dot(thigh) * shin - thigh;  // at a right angle to the shin, too
  if (!(bend.norm() > 1e-6) || bend.normalized().dot(forwards) < kForwards) return 0;
  return std::atan2(bend.norm(), shin.dot(thigh)) / kRadiansPerDegree;
}

void find_limits(const Series& series, MotionFaults& out) {
  const int stride = std::max(1, static_cast<int>(std::lround(series.rate / kLookAt)));
  const double limit = series.threshold(Rule::joint_limit);
  std::vector<Finding> found;
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    const LegJoints leg = leg_joints(series.roles, side);
    const auto other = side == FootSide::left ? FootSide::right : FootSide::left;
    const int other_hip = leg_joints(series.roles, other).upper;
    if (std::min({leg.upper, leg.lower, leg.foot, leg.toes, other_hip}) < 0) continue;
    Finding finding = finding_of(Rule::joint_limit, series, 0, series.whole());
    finding.kind = "knee";
    finding.joint = leg.lower, finding.detail = "bent forwards";
    std::vector<double> bent;  // of every `stride`th frame
    for (int f = 0; f < series.frames; f += stride) {
      bent.push_back(knee_bent_forwards(series.clip.frame_positions(f), leg, other_hip));
    }
    const auto is_over = [&](int i) { return bent[at(i)] > limit; };
    for (const auto& [first, end] : runs_of(static_cast<int>(bent.size()), is_over)) {
      if ((end - first) * stride <= kLongEnough * series.rate) continue;
      const auto worst = std::max_element(&bent[at(first)], &bent[at(end - 1)] + 1);
      finding.value = *worst, finding.worst = static_cast<int>(worst - bent.data()) * stride;
      finding.first = first * stride, finding.last = std::min(end * stride, series.frames) - 1;
      found.push_back(finding);
    }
  }
  merge_joints(found, 0);
  out.findings.insert(out.findings.end(), found.begin(), found.end());
}

void find_asymmetry(const Series& series, MotionFaults& out) {
  const auto length = [&](Role upper, Role lower) {
    const int a = series.roles.joint(upper), b = series.roles.joint(lower);
    if (a < 0 || b < 0) return 0.0;
    const auto& reference = series.clip.skeleton.reference;
    return (reference[at(a)].position - reference[at(b)].position).norm();
  };
  Finding worst = finding_of(Rule::asymmetric_rest_pose, series, 0, series.whole());
  const auto compare = [&](std::array<Role, 2> upper, std::array<Role, 2> lower) {
    const double left = length(upper[0], lower[0]), right = length(upper[1], lower[1]);
    if (std::min(left, right) < kShortestBone * series.scale ||
        std::abs(left - right) < kMinChange * series.scale) {
      return;
    }
    const double percent = 100 * std::abs(left - right) / std::max(left, right);
    if (percent <= worst.threshold) return;
    const int joints = worst.value > 0 ? worst.joints + 1 : 1;
    if (percent > worst.value) {
      worst.value = percent, worst.joint = series.roles.joint(lower[0]);
      worst.detail = fmt::format("{} m left, {} m right", readable(left, 3), readable(right, 3));
    }
    worst.joints = joints;
  };
  compare({kLegRoles[0].upper, kLegRoles[1].upper}, {kLegRoles[0].lower, kLegRoles[1].lower});
  compare({kLegRoles[0].lower, kLegRoles[1].lower}, {kLegRoles[0].foot, kLegRoles[1].foot});
  compare({kArmRoles[0].upper, kArmRoles[1].upper}, {kArmRoles[0].lower, kArmRoles[1].lower});
  compare({kArmRoles[0].lower, kArmRoles[1].lower}, {kArmRoles[0].hand, kArmRoles[1].hand});
  if (worst.value > worst.threshold) out.findings.push_back(worst);
}

void find_seam(const Series& series, MotionFaults& out) {
  Finding worst = finding_of(Rule::loop_seam, series, 0, series.whole());
  const int last = series.frames - 1;
  const auto local = [&](int joint, int frame) {
    const auto pose = series.clip.frame_orientations(frame);
    const int parent = series.clip.skeleton.parents[at(joint)];
    return Quat((pose[at(parent)].conjugate() * pose[at(joint)]).cast<double>());
  };
  for (int j = 0; j < series.joints; ++j) {
    if (series.clip.skeleton.parents[at(j)] < 0 || series.clip.skeleton.end_sites[at(j)] != 0)
      continue;
    // The last pose is the first one, or the one before it.
    const auto turns = series.turns_of(j);
    const double step = std::max(turns[at(last)].norm(), turns[1].norm());
    const double off = angle_between(local(j, last), local(j, 0)) - step;
    if (off / kRadiansPerDegree > worst.value)
      worst.value = off / kRadiansPerDegree, worst.joint = j;
    worst.joints += off / kRadiansPerDegree > worst.threshold ? 1 : 0;
  }
  worst.joints = std::max(1, worst.joints - 1);
  worst.worst = last;
  if (worst.value > worst.threshold) out.findings.push_back(worst);
}

}  // namespace

void find_body_faults(const Series& series, MotionFaults& out) {
  if (series.has(Rule::unit)) find_unit(series, out);
  if (series.has(Rule::asymmetric_rest_pose)) find_asymmetry(series, out);
  if (series.frames > 0 && series.has(Rule::bone_length)) find_bones(series, out);
  if (series.has(Rule::joint_limit)) find_limits(series, out);
  if (series.frames < 3) return;
  const RestPose rest = find_rest_pose(series.clip, series.roles);
  if (rest.frames > 0) {
    Finding finding = finding_of(Rule::rest_frame, series, 1, series.whole());
    finding.last = rest.frames - 1;
    finding.detail = rest.reason;
    out.findings.push_back(finding);
  }
  if (series.options.is_loop && series.has(Rule::loop_seam)) find_seam(series, out);
}

}  // namespace krok::lint
