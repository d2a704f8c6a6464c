#include "lint/lint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "contacts/sole_points.h"
#include "core/index.h"
#include "lint/series_internal.h"
#include "motion/hips_root.h"

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

namespace {

constexpr double kInARow = 0.1;    // of the changes of pose, that another one follows at once
constexpr float kNextPose = 0.6F;  // rad, of three quarters of the changes

// Whether a clip holds one pose after the other and nothing moves from one to the next.
bool are_poses(const Series& series) {
  std::vector<float> turns;
  int in_a_row = 0;
  for (int f = 1; f < series.frames; ++f) {
    if (series.moved[at(f)] < kStill) continue;
    turns.push_back(series.moved[at(f)]);
    if (f > 1 && series.moved[at(f - 1)] >= kStill) ++in_a_row;
  }
  if (turns.size() < 3 || in_a_row > kInARow * static_cast<double>(turns.size())) return false;
  const auto quarter = turns.begin() + static_cast<std::ptrdiff_t>(turns.size() / 4);
  std::ranges::nth_element(turns, quarter);
  return *quarter > kNextPose;
}

}  // namespace

MotionFaults lint_motion(const Clip& clip, const RoleMap& roles, const MotionOptions& options) {
  MotionFaults out;
  const Series series(clip, roles, options);
  find_body_faults(series, out);
  if (are_poses(series)) {
    out.notes.emplace_back("a list of poses, each of some frames: no rule of motions applies");
  } else if (series.frames >= 3) {
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

namespace {

constexpr double kMargin = 10;  // seconds

// Adds a fault to the same that was found in the part before, if any: of the same joint, or, of one
// that was there in `all` frames, of any.
bool joined(const Finding& finding, bool all, std::vector<Finding>& before) {
  const auto same = std::find_if(before.rbegin(), before.rend(), [&](const Finding& one) {
    return one.rule == finding.rule && one.kind == finding.kind &&
           (all || one.joint == finding.joint) && one.first <= finding.last &&
           one.last + 1 >= finding.first;
  });
  if (same == before.rend()) return false;
  Finding both = finding.excess() > same->excess() ? finding : *same;
  both.first = std::min(finding.first, same->first), both.last = std::max(finding.last, same->last);
  both.joints = std::max(finding.joints, same->joints);
  *same = std::move(both);
  return true;
}

// The seam of a loop, from two frames at either end.
Status find_seam(const FrameSource& motion, const MotionOptions& options, const auto& judge,
                 MotionFaults& out) {
  Clip ends = *load(part_of(motion, 0, 0), 1);
  for (const int first : {0, motion.frame_count - 2}) {
    const auto end = load(part_of(motion, first, 2), 1);
    if (!end) return end.error();
    ends.positions.insert(ends.positions.end(), end->positions.begin(), end->positions.end());
    ends.orientations.insert(ends.orientations.end(), end->orientations.begin(),
                             end->orientations.end());
  }
  MotionOptions how = options;
  how.settings.enabled.fill(false);
  how.settings.enabled[static_cast<std::size_t>(Rule::loop_seam)] = true;
  for (Finding& seam : judge(ends, how).findings) {
    seam.last = seam.worst = motion.frame_count - 1;
    out.findings.push_back(std::move(seam));
  }
  return {};
}

}  // namespace

Result<MotionFaults> lint_long_take(
    const FrameSource& motion, const MotionOptions& options, int jobs,
    const std::function<MotionFaults(const Clip& part, const MotionOptions& how)>& judge,
    std::size_t part_bytes) {
  const std::size_t frame = (sizeof(Vec3f) + sizeof(Quatf)) * motion.skeleton.names.size();
  const int part = static_cast<int>(std::clamp<std::size_t>(
      part_bytes / std::max<std::size_t>(frame, 1), 16, at(std::max(16, motion.frame_count))));
  if (motion.frame_count <= part) {
    const auto clip = load(motion, jobs);
    if (!clip) return clip.error();
    return judge(*clip, options);
  }
  MotionOptions how = options;
  how.is_loop = false;
  MotionFaults out;
  const auto look = [&](const FrameRun& run) -> Status {
    MotionFaults found = judge(run.clip, how);
    for (Finding& finding : found.findings) {
      const bool is_here = finding.worst >= run.kept_begin && finding.worst < run.kept_end;
      const bool went_on = finding.first < run.kept_begin && finding.last >= run.kept_begin;
      const bool all = finding.first == 0 && finding.last == run.clip.frame_count() - 1;
      for (int* const place : {&finding.first, &finding.last, &finding.worst}) *place += run.first;
      if (went_on && joined(finding, all, out.findings)) continue;
      if (is_here || all) out.findings.push_back(std::move(finding));
    }
    for (std::string& note : found.notes) {
      const auto is_same = [&](const std::string& one) { return one.starts_with(note); };
      if (std::ranges::any_of(out.notes, is_same)) continue;
      out.notes.push_back(fmt::format("{} (in the part from {:.0f} s on)", note,
                                      (run.first + run.kept_begin) / motion.rate));
    }
    return {};
  };
  const int margin =
      static_cast<int>(std::min<double>(std::ceil(kMargin * motion.rate), motion.frame_count));
  Status status = for_each_run(motion, {part, margin}, jobs, look);
  if (status && options.is_loop && options.settings.has(Rule::loop_seam)) {
    status = find_seam(motion, options, judge, out);
  }
  if (!status) return status.error();
  std::ranges::stable_sort(out.findings, {}, [](const Finding& finding) {
    return std::tuple(static_cast<int>(finding.rule), finding.first);
  });
  return out;
}

namespace {

constexpr double kMoments = 16;  // at least, of a motion
constexpr double kSameDuration = 0.02;
constexpr float kHeld = 0.052F;  // 3 degrees, as a distance of unit vectors

}  // namespace

Signature signature_of(const FrameSource& motion, const RoleMap& roles) {
  std::vector<std::pair<int, int>> bones;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto add = [&](Role upper, Role lower) {
      bones.emplace_back(roles.joint(upper), roles.joint(lower));
    };
    add(kLegRoles[side].upper, kLegRoles[side].lower);
    add(kLegRoles[side].lower, kLegRoles[side].foot);
    add(kArmRoles[side].upper, kArmRoles[side].lower);
    add(kArmRoles[side].lower, kArmRoles[side].hand);
  }
  const int hips = roles.joint(Role::hips), frames = motion.frame_count;
  std::erase_if(bones, [](const auto& bone) { return bone.first < 0 || bone.second < 0; });
  Signature signature{motion.duration(), {}};
  if (hips < 0 || bones.size() < 4 || frames < 3) return signature;
  // The hips' frame differs between exporters of one capture; that of the reference pose does not.
  const Quatf reference = motion.skeleton.reference[at(hips)].orientation.cast<float>();
  // Times from the beginning, by a power of two of seconds: a frame more or less at the end, as
  // other rates have it, moves none of them.
  const double step = std::exp2(std::floor(std::log2(signature.duration / kMoments)));
  const std::size_t joints = motion.skeleton.names.size();
  std::vector<Vec3f> places(2 * joints);
  std::vector<Quatf> turns(2 * joints);
  for (int m = 0; m * step <= signature.duration; ++m) {
    const double place = std::min<double>(m * step * motion.rate, frames - 1);
    const int first = std::min(frames - 2, static_cast<int>(place));
    const auto share = static_cast<float>(place - first);
    if (!motion.read(first, 2, places, turns)) return {};
    const auto direction = [&](std::size_t frame, const std::pair<int, int>& bone) {
      const Vec3f* const at_frame = &places[frame * joints];
      const Quatf turn = turns[frame * joints + at(hips)] * reference.conjugate();
      return Vec3f(turn.conjugate() * (at_frame[bone.second] - at_frame[bone.first]));
    };
    for (const auto& bone : bones) {
      const Vec3f mixed = (1 - share) * direction(0, bone) + share * direction(1, bone);
      signature.directions.push_back(mixed.normalized());
    }
  }
  float moved = 0;
  for (std::size_t i = bones.size(); i < signature.directions.size(); ++i) {
    moved =
        std::max(moved, (signature.directions[i] - signature.directions[i % bones.size()]).norm());
  }
  if (moved < kHeld) signature.directions.clear();
  return signature;
}

std::vector<std::pair<int, int>> find_duplicates(std::span<const Signature> signatures,
                                                 double radians) {
  std::vector<int> order(signatures.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](int i) { return signatures[at(i)].duration; });
  const auto limit = static_cast<float>(2 * std::sin(radians / 2));
  std::vector<int> same(signatures.size(), -1);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Signature& a = signatures[at(order[i])];
    if (a.directions.empty()) continue;
    for (std::size_t k = i + 1; k < order.size(); ++k) {
      const Signature& b = signatures[at(order[k])];
      if (b.duration > a.duration * (1 + kSameDuration)) break;
      const std::size_t common = std::min(a.directions.size(), b.directions.size());
      if (4 * common < 3 * std::max(a.directions.size(), b.directions.size())) continue;
      const bool equal = std::ranges::equal(
          std::span(a.directions).first(common), std::span(b.directions).first(common),
          [&](const Vec3f& x, const Vec3f& y) { return (x - y).squaredNorm() <= limit * limit; });
      if (!equal) continue;
      const int first = std::min(order[i], order[k]), second = std::max(order[i], order[k]);
      int& found = same[at(second)];
      if (found < 0 || first < found) found = first;
    }
  }
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t i = 0; i < same.size(); ++i) {
    if (same[i] >= 0) pairs.emplace_back(same[i], static_cast<int>(i));
  }
  return pairs;
}

}  // namespace krok::lint
