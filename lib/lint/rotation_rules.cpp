#include <algorithm>
#include <array>
#include <cmath>

#include "core/index.h"
#include "lint/series_internal.h"

// pop and flip: what happens between two frames.

namespace krok::lint {

namespace {

constexpr float kTimesUsual = 8;       // of the median acceleration of a second, of kinks
constexpr float kTimesNeighbours = 4;  // of the largest acceleration just before and after
constexpr float kDoubt = 1.5F;         // times as clear where only one side of a jump is known
constexpr int kNeighbours = 4;         // frames looked at on either side
constexpr double kSeamJoints = 0.3;    // of the joints that move
constexpr double kFlipRate = 20;       // frames per second; joints turn farther in longer frames
constexpr double kMinPath = 0.03;      // metres, of a jump of the hips

enum class PopKind : std::uint8_t { spike, step, kink };

struct Pop {
  PopKind kind = PopKind::spike;
  int first = 0, last = 0, worst = 0;
  double value = 0;
};

// Medians of the accelerations' sizes over blocks of a second; a frame's usual acceleration is the
// largest of its own block and those beside it, so that a gesture's beginning counts.
class UsualSize {
 public:
  UsualSize(std::span<const float> sizes, int block)
      : sizes_(sizes), block_(block), medians_((sizes.size() + at(block) - 1) / at(block), -1.0F) {}
  float at_frame(int frame) {
    const int own = frame / block_, last = static_cast<int>(medians_.size()) - 1;
    float most = 0;
    for (int b = std::max(0, own - 1); b <= std::min(last, own + 1); ++b) {
      if (medians_[at(b)] < 0) medians_[at(b)] = median_of(at(b * block_));
      most = std::max(most, medians_[at(b)]);
    }
    return most;
  }

 private:
  float median_of(std::size_t begin) {
    const auto part = sizes_.subspan(begin, std::min(at(block_), sizes_.size() - begin));
    some_.assign(part.begin(), part.end());
    const auto middle = some_.begin() + static_cast<std::ptrdiff_t>(some_.size() / 2);
    std::ranges::nth_element(some_, middle);
    return *middle;
  }

  std::span<const float> sizes_;
  int block_;
  std::vector<float> medians_, some_;  // medians: -1 before they are asked for
};

// What a jump of size 1 does to the accelerations of successive frames, and how the jump must stand
// out: `over_rest` times the largest acceleration around it that is left without the jump, and
// `over_usual` times the median of the second. Where it is `unlike` times as large as what else
// fits the template in the seconds around, less is enough: gestures and impacts come again.
struct Clearness {
  float over_rest, over_usual;
};
struct Template {
  PopKind kind;
  int length;
  std::array<float, 4> weights;
  Clearness alone, unlike_others;
  float unlike;
};
constexpr std::array<Template, 3> kTemplates = {
    {{PopKind::spike, 3, {1, -2, 1, 0}, {2.2F, 3}, {1, 2}, 1.5F},
     {PopKind::spike, 4, {1, -1, -1, 1}, {2.4F, 4}, {1.2F, 3}, 1.5F},
     {PopKind::step, 2, {1, -1, 0, 0}, {3.5F, 5}, {2.0F, 3}, 1.7F}}};
// Toes spring back within a frame or two when they leave the ground, and feet slap on it.
constexpr Clearness kOfToes = {3, 4};
constexpr auto kSlap = static_cast<float>(35 * kRadiansPerDegree);  // at most, of a foot
constexpr float kMinOverUsual = 2, kMinOverRest = 1;                // of all of them
constexpr double kSpringRate = 35;                                  // frames per second
constexpr double kBent = 0.4;                                       // seconds
constexpr float kBack = 0.25F;                                      // of the jump
constexpr double kFingers = 1e4 * kRadiansPerDegree;  // per second squared, of fingers that tap
constexpr double kAround = 10;  // seconds before and after in which a jump is unlike others

// A place where a template was tried.
struct Match {
  Pop pop;
  float score = 0;  // size over the largest acceleration around it, relative to what it must be
};

class PopFinder {
 public:
  // `around`: frames before and after that a jump is compared with.
  // `springs`: changes of speed up to which the joint is judged as toes are.
  PopFinder(std::span<const Vec3f> turns, float threshold, int block, int around, float springs,
            std::vector<float>& sizes)
      : turns_(turns),
        threshold_(threshold),
        block_(block),
        around_(around),
        springs_(springs),
        sizes_(sizes) {}

  std::vector<Pop> find() {
    const int frames = static_cast<int>(turns_.size());
    sizes_.assign(at(frames), 0.0F);
    float most = 0;
    for (int f = 1; f + 1 < frames; ++f) {
      sizes_[at(f)] = acceleration(f).squaredNorm();
      most = std::max(most, sizes_[at(f)]);
    }
    std::vector<Pop> pops;
    if (most < threshold_ * threshold_) return pops;
    for (float& size : sizes_) size = std::sqrt(size);
    UsualSize usual(sizes_, block_);
    int last = -kNeighbours;
    float last_score = 0;
    for (int f = 1; f + 1 < frames; ++f) {
      if (sizes_[at(f)] < threshold_) continue;
      const Match match = best_at(f, usual.at_frame(f));
      if (match.score < 1) continue;
      // Templates also match beside the jump, less well.
      if (f - last > 3) {
        pops.push_back(match.pop);
      } else if (match.score > last_score) {
        pops.back() = match.pop;
      } else {
        continue;
      }
      last = f, last_score = match.score;
    }
    return pops;
  }

 private:
  Vec3f acceleration(int frame) const { return turns_[at(frame + 1)] - turns_[at(frame)]; }

  float largest_beside(int first, int last) const {
    float most = 0;
    for (int n = 1; n <= kNeighbours; ++n) {
      if (first - n >= 1) most = std::max(most, sizes_[at(first - n)]);
      if (last + n + 1 < static_cast<int>(turns_.size())) {
        most = std::max(most, sizes_[at(last + n)]);
      }
    }
    return most;
  }

  // The jump by which a template fits best, over the frames of it that are there.
  Vec3f jump(const Template& shape, int first) const {
    const int begin = std::max(first, 1);
    const int end = std::min(first + shape.length, static_cast<int>(turns_.size()) - 1);
    Vec3f size = Vec3f::Zero();
    float norm = 0;
    for (int f = begin; f < end; ++f) {
      const float weight = shape.weights[at(f - first)];
      size += weight * acceleration(f);
      norm += weight * weight;
    }
    return size / norm;
  }

  // Of accelerations [begin, end); a jump is at most as large.
  float largest_of(int begin, int end) const {
    return 1.001F * *std::max_element(&sizes_[at(begin)], &sizes_[at(end - 1)] + 1);
  }

  // The largest jump that fits elsewhere; any that is over `enough`, if there is one.
  float largest_elsewhere(const Template& shape, int first, float enough) const {
    const int frames = static_cast<int>(turns_.size());
    float most = 0;
    for (int f = std::max(1, first - around_); f < std::min(frames - 4, first + around_); ++f) {
      if (std::abs(f - first) <= kNeighbours || largest_of(f, f + shape.length) < most) continue;
      most = std::max(most, jump(shape, f).norm());
      if (most > enough) break;
    }
    return most;
  }

  // How well a template fits that begins at a frame; of one that is cut off by an end of the
  // motion, what is there.
  Match fit(const Template& shape, int first, float usual) const {
    const int frames = static_cast<int>(turns_.size());
    const int last = first + shape.length - 1;
    const int begin = std::max(first, 1), end = std::min(last, frames - 2);
    const float least = std::max(threshold_, kMinOverUsual * usual);
    if (largest_of(begin, end + 1) < least) return {};  // as at most frames
    const Vec3f size = jump(shape, first);
    const float value = size.norm();
    if (value < least) return {};
    float rest = largest_beside(begin, end);
    if (value < kMinOverRest * rest) return {};
    for (int f = begin; f <= end; ++f) {
      rest = std::max(rest, (acceleration(f) - shape.weights[at(f - first)] * size).norm());
    }
    const bool cut = end - begin < shape.length - 1;
    const float doubt = begin < 3 || end + 3 >= frames ? kDoubt : 1.0F;
    const auto clear_by = [&](const Clearness& limits) {
      return std::min(value / (doubt * limits.over_rest * std::max(rest, 1e-6F)),
                      value / (doubt * limits.over_usual * std::max(usual, 1e-6F)));
    };
    float score = 0;
    if (cut) {
      score = std::min(value / (kTimesNeighbours * std::max(rest, 1e-6F)),
                       value / (kTimesUsual * std::max(usual, 1e-6F)));
    } else {
      const bool toes = value < springs_;
      if (!toes) score = clear_by(shape.alone);
      float other = score >= 1 ? 0 : clear_by(toes ? kOfToes : shape.unlike_others);
      if (other >= 1) {
        const float elsewhere = largest_elsewhere(shape, first, value / shape.unlike);
        other = std::min(other, value / (shape.unlike * elsewhere + 1e-6F));
      }
      score = std::max(score, other);
    }
    return {{shape.kind, std::max(first, 0), std::min(last, frames - 1), first + 1, value}, score};
  }

  // The template that begins at a frame and fits best.
  Match best_at(int first, float usual) const {
    Match best;
    const int frames = static_cast<int>(turns_.size());
    const auto try_at = [&](const Template& shape, int begin) {
      const Match match = fit(shape, begin, usual);
      if (match.score > best.score) best = match;
    };
    const Template& spike = kTemplates[0];
    for (const Template& shape : kTemplates) {
      if (first + shape.length < frames) try_at(shape, first);
    }
    // A first or a last frame that is off, and those beside them.
    if (frames <= 2 * kNeighbours) return best;
    for (int begin = -1; begin < 1 && first == 1; ++begin) try_at(spike, begin);
    if (first + spike.length >= frames) try_at(spike, first);
    // A change of speed alone.
    if (sizes_[at(first)] >= springs_ && best.score < 1 && first >= 3 && first + 3 < frames &&
        sizes_[at(first)] > kTimesUsual * usual &&
        sizes_[at(first)] > kTimesNeighbours * largest_beside(first, first)) {
      best = {{PopKind::kink, first, first, first, sizes_[at(first)]}, 1};
    }
    return best;
  }

  std::span<const Vec3f> turns_;
  float threshold_;
  int block_, around_;
  float springs_;
  std::vector<float>& sizes_;
};

// Whether toes that were bent by the ground for a while spring back to where they were before, at
// a frame: within 0.03 s or more, as a frame lasts at low rates.
bool springs_back(const Series& series, std::span<const Vec3f> turns, const Pop& pop) {
  if (series.rate > kSpringRate) return false;
  const int from = std::max(1, pop.worst - series.frames_in(kBent, 4));
  Vec3f way = turns[at(pop.worst)];
  const float back = kBack * way.norm();
  for (int f = pop.worst - 1; f >= from; --f) {
    way += turns[at(f)];
    if (f < pop.worst - 1 && way.norm() < back) return true;
  }
  return false;
}

// Joints that turn anywhere, and are more than the mark of a bone's end.
std::vector<int> moving(const Series& series) {
  std::vector<int> joints;
  for (int j = 0; j < series.joints; ++j) {
    if (series.clip.skeleton.end_sites[at(j)] != 0) continue;
    if (series.largest[at(j)] > 1e-6F) joints.push_back(j);
  }
  return joints;
}

// The angle between a rotation's axis and the bone, 0 to 90 degrees: small for a turn about it.
bool about_own_bone(const Series& series, int joint, const Vec3f& turn) {
  const auto& parents = series.clip.skeleton.parents;
  const auto child = std::ranges::find(parents, joint);
  const int parent = parents[at(joint)];
  if (child == parents.end() || parent < 0) return false;
  const Transform bone =
      series.clip.skeleton.reference_local(static_cast<int>(child - parents.begin()));
  const Quat joint_to_parent = series.clip.skeleton.reference_local(joint).orientation;
  const Vec3 along = joint_to_parent * bone.position;
  if (along.norm() < 1e-6) return false;
  return std::abs(along.normalized().dot(turn.normalized().cast<double>())) > 0.87;
}

void find_flips(const Series& series, int joint, std::span<const Vec3f> turns,
                std::vector<Finding>& flips) {
  // Turns are twice the sine of half the angle.
  const double longer = std::max(1.0, kFlipRate / series.rate);
  const double degrees = std::min(179.0, longer * series.threshold(Rule::flip));
  const auto limit = static_cast<float>(2 * std::sin(degrees * kRadiansPerDegree / 2));
  if (std::sqrt(series.largest[at(joint)]) < limit) return;
  for (int f = 1; f < series.frames; ++f) {
    const float size = turns[at(f)].norm();
    if (size < limit) continue;
    const double turned = 2 * std::asin(std::min(1.0F, size / 2)) / kRadiansPerDegree;
    Finding& flip = flips.emplace_back(finding_of(Rule::flip, series, turned, {f - 1, f, f}));
    flip.kind = about_own_bone(series, joint, turns[at(f)]) ? "twist" : "limb";
    flip.joint = joint, flip.threshold = degrees;
  }
}

}  // namespace

void find_rotation_faults(const Series& series, MotionFaults& out) {
  const int block = series.frames_in(1, 21), around = series.frames_in(kAround, 1);
  const double degrees = series.threshold(Rule::pop);
  std::vector<Finding> flips, pops, kinks, found;
  std::vector<float> sizes;
  const std::vector<int> joints = moving(series);
  const auto limit = static_cast<float>(degrees * kRadiansPerDegree);
  const auto fingers_start = static_cast<float>(kFingers / (series.rate * series.rate));
  const auto add = [&](const Pop& pop, int joint, bool path, float least) {
    Finding& finding = (pop.kind == PopKind::kink ? kinks : pops)
                           .emplace_back(finding_of(Rule::pop, series, pop.value,
                                                    {pop.first, pop.last, pop.worst}));
    finding.kind = pop.kind == PopKind::spike ? "spike" : "step";
    finding.joint = joint;
    if (path) {
      finding.threshold = least, finding.unit = "m";
      finding.detail = "path of the hips";
    } else {
      if (least > limit) finding.threshold = least / kRadiansPerDegree;
      finding.value /= kRadiansPerDegree;
    }
  };
  for (const int j : joints) {
    const auto turns = series.turns_of(j);
    if (series.has(Rule::flip)) find_flips(series, j, turns, flips);
    if (!series.has(Rule::pop)) continue;
    const Role role = series.roles.roles[at(j)];
    const bool toes = role == Role::left_toes || role == Role::right_toes;
    const bool feet = role == Role::left_foot || role == Role::right_foot;
    const bool fingers = role == Role::left_fingers || role == Role::right_fingers;
    const float least = fingers ? std::max(limit, fingers_start) : limit;
    // A change of speed is at most twice the largest speed.
    if (4.001F * series.largest[at(j)] < least * least) continue;
    PopFinder finder(turns, least, block, around, toes ? INFINITY : feet ? kSlap : 0.0F, sizes);
    for (const Pop& pop : finder.find()) {
      if (!toes || pop.kind == PopKind::spike || !springs_back(series, turns, pop)) {
        add(pop, j, false, least);
      }
    }
  }
  if (series.has(Rule::pop)) {
    const auto least = static_cast<float>(kMinPath * series.scale);
    PopFinder finder(series.steps, least, block, around, 0, sizes);
    for (const Pop& pop : finder.find()) {
      if (pop.kind != PopKind::kink) add(pop, series.carrier, true, least);
    }
  }
  // A flip is a pop, too, and what belongs to one rest frame is neither.
  const bool rest = std::ranges::any_of(
      out.findings, [](const Finding& finding) { return finding.rule == Rule::rest_frame; });
  std::erase_if(flips, [&](const Finding& flip) { return rest && flip.first == 0; });
  std::erase_if(pops, [&](const Finding& pop) {
    return (rest && pop.first <= 2) || std::ranges::any_of(flips, [&](const Finding& flip) {
             return flip.joint == pop.joint && flip.last >= pop.first && flip.first <= pop.last;
           });
  });
  merge_joints(flips, 0);
  // Where a third of the body jumps or changes its speed at once, two takes were joined.
  std::vector<int> at_once(at(series.frames), 0);
  for (const auto* list : {&pops, &kinks}) {
    for (const Finding& pop : *list) {
      if (pop.kind == "step") ++at_once[at(pop.worst)];
    }
  }
  const double enough = std::max(4.0, kSeamJoints * static_cast<double>(joints.size()));
  for (auto* list : {&pops, &kinks}) {
    for (Finding& pop : *list) {
      if (pop.kind != "step") continue;
      int joints_here = 0;
      for (int f = pop.worst - 1; f <= pop.worst + 1; ++f) {
        if (f >= 0 && f < series.frames) joints_here += at_once[at(f)];
      }
      if (joints_here >= enough) pop.kind = "seam";
    }
  }
  std::erase_if(kinks, [](const Finding& kink) { return kink.kind != "seam"; });
  pops.insert(pops.end(), kinks.begin(), kinks.end());
  merge_joints(pops, 0);
  out.findings.insert(out.findings.end(), flips.begin(), flips.end());
  out.findings.insert(out.findings.end(), pops.begin(), pops.end());
}

}  // namespace krok::lint
