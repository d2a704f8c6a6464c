#include "lint/lint.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "contacts/sole_points.h"
#include "core/index.h"
#include "lint/series_internal.h"
#include "motion/ground_frame.h"

namespace krok::lint {

namespace {

constexpr double kUsualLeg = 0.86;  // metres

// q and -q are one rotation; the one with w >= 0 turns less.
Vec3f turn_between(const Quatf& before, const Quatf& after) {
  const Quatf turn = after * before.conjugate();
  return (turn.w() < 0 ? -2.0F : 2.0F) * turn.vec();
}

Quatf in_parent(const Clip& clip, int joint, int parent, int frame) {
  const Quatf* pose = &clip.orientations[at(frame) * clip.skeleton.names.size()];
  return parent < 0 ? pose[joint] : pose[parent].conjugate() * pose[joint];
}

}  // namespace

double legs_scale(const Skeleton& skeleton, const RoleMap& roles) {
  double sum = 0;
  int legs = 0;
  for (const auto& [upper, lower, foot] :
       {std::tuple(Role::left_upper_leg, Role::left_lower_leg, Role::left_foot),
        std::tuple(Role::right_upper_leg, Role::right_lower_leg, Role::right_foot)}) {
    const int a = roles.joint(upper), b = roles.joint(lower), c = roles.joint(foot);
    if (a < 0 || b < 0 || c < 0) continue;
    const auto place = [&](int joint) { return skeleton.reference[at(joint)].position; };
    sum += (place(a) - place(b)).norm() + (place(b) - place(c)).norm();
    ++legs;
  }
  return sum > 0 ? sum / legs / kUsualLeg : 1;
}

double Finding::excess() const {
  if (threshold <= 0) return value > 0 ? value : 1;
  const bool both_ways = rule == Rule::frame_rate || rule == Rule::unit;
  if (both_ways && value > 0 && value < 1) return 1 / (value * threshold);
  return value / threshold;
}

Series::Series(const Clip& motion, const RoleMap& role_map, const MotionOptions& how)
    : clip(motion), roles(role_map), options(how) {
  joints = clip.joint_count();
  frames = clip.frame_count();
  rate = clip.rate;
  scale = legs_scale(clip.skeleton, roles);
  carrier = std::max(0, carrying_joint(roles));
  largest.assign(at(joints), 0.0F);
  steps.assign(at(frames), Vec3f::Zero());
  moved.assign(at(frames), 0.0F);
  constexpr int kBlock = 64;  // frames that the caches hold
  std::vector<Quatf> before(at(joints));
  for (int begin = 0; begin < frames; begin += kBlock) {
    const int end = std::min(frames, begin + kBlock);
    for (int j = 0; j < joints; ++j) {
      const int parent = clip.skeleton.parents[at(j)];
      Quatf last = before[at(j)];
      float most = largest[at(j)];
      for (int f = begin; f < end; ++f) {
        const Quatf now = in_parent(clip, j, parent, f);
        if (f > 0) {
          const Vec3f turn = turn_between(last, now);
          most = std::max(most, turn.squaredNorm());
          moved[at(f)] = std::max(moved[at(f)], turn.squaredNorm());
        }
        last = now;
      }
      before[at(j)] = last, largest[at(j)] = most;
    }
  }
  for (int f = 1; f < frames; ++f) {
    steps[at(f)] = clip.frame_positions(f)[at(carrier)] - clip.frame_positions(f - 1)[at(carrier)];
    moved[at(f)] = std::sqrt(std::max(moved[at(f)], steps[at(f)].squaredNorm()));
  }
}

std::vector<Vec3f> Series::turns_of(int joint) const {
  std::vector<Vec3f> turns(at(frames), Vec3f::Zero());
  const int parent = clip.skeleton.parents[at(joint)];
  Quatf last = Quatf::Identity();
  for (int f = 0; f < frames; ++f) {
    const Quatf now = in_parent(clip, joint, parent, f);
    if (f > 0) turns[at(f)] = turn_between(last, now);
    last = now;
  }
  return turns;
}

int Series::frames_in(double seconds, int at_least) const {
  return std::max(at_least, static_cast<int>(std::lround(seconds * rate)));
}

double Series::fall(int first, int last, bool all) const {
  const auto height = [&](int f) {
    const auto places = clip.frame_positions(f);
    if (!all) return static_cast<double>(places[at(carrier)].y());
    double sum = 0;
    for (const Vec3f& place : places) sum += place.y();
    return sum / joints;
  };
  const int middle = (first + last) / 2, reach = std::min(middle - first, last - middle);
  const double seconds = reach / rate;
  if (reach < 1) return 9.81;
  const double sag = height(middle) - 0.5 * (height(middle - reach) + height(middle + reach));
  return 2 * sag / (seconds * seconds) / scale;
}

Finding finding_of(Rule rule, const Series& series, double value, const Span& span) {
  Finding finding;
  finding.rule = rule;
  finding.first = span.first, finding.last = span.last, finding.worst = span.worst;
  finding.value = value;
  finding.unit = facts_of(rule).unit;
  finding.threshold = series.threshold(rule) * (finding.unit == "m" ? series.scale : 1);
  return finding;
}

void merge_joints(std::vector<Finding>& findings, int near) {
  std::ranges::stable_sort(findings, {}, [](const Finding& f) {
    return std::tuple(static_cast<int>(f.rule), f.kind, f.first);
  });
  std::vector<Finding> merged;
  for (Finding& finding : findings) {
    Finding* last = merged.empty() ? nullptr : &merged.back();
    if (last == nullptr || last->rule != finding.rule || last->kind != finding.kind ||
        finding.first > last->last + near) {
      merged.push_back(std::move(finding));
      continue;
    }
    const int joints = last->joint == finding.joint ? last->joints : last->joints + finding.joints;
    const int first = std::min(last->first, finding.first),
              end = std::max(last->last, finding.last);
    if (finding.excess() > last->excess()) *last = std::move(finding);
    last->joints = joints, last->first = first, last->last = end;
  }
  findings = std::move(merged);
}

MotionFaults lint_motion(const Clip& clip, const RoleMap& roles, const MotionOptions& options) {
  MotionFaults out;
  const Series series(clip, roles, options);
  find_body_faults(series, out);
  if (series.frames >= 3) {
    find_rate_faults(series, out);
    find_rotation_faults(series, out);
    find_noise_faults(series, out);
    find_foot_faults(series, out);
  }
  std::erase_if(out.findings, [&](const Finding& finding) { return !series.has(finding.rule); });
  std::ranges::stable_sort(out.findings, {}, [](const Finding& f) {
    return std::tuple(static_cast<int>(f.rule), f.first);
  });
  return out;
}

}  // namespace krok::lint
