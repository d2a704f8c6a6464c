#include <cmath>

#include "ik/two_bone.h"
#include "math/quaternion.h"
#include "methods.h"
#include "motion/hips_root.h"
#include "support/foot_skate.h"

namespace krok::bench {

namespace {

using test::joint_of;

constexpr double kWindow = 0.25;                    // seconds, over which changes are blended
constexpr double kDamped = 20 * kRadiansPerDegree;  // of bend, below which knees are damped

// 1 at 0, 0 from 1 on: the paper's blending function.
double blend(double u) {
  return u >= 1 ? 0 : 2 * u * u * u - 3 * u * u + 1;
}

struct Change {
  Vec3 turn = Vec3::Zero(), shift = Vec3::Zero();
  bool turned = false, shifted = false;  // by a constraint
};

struct Fixed {
  const FixedStay* heel = nullptr;
  const FixedStay* ball = nullptr;
  Vec3 heel_place, ball_place;
};

// Changes of frames that no constraint sets, from the nearest before and after that one sets.
void blend_between(std::vector<Change>& changes, double rate, bool Change::*set,
                   Vec3 Change::*value) {
  const int frames = static_cast<int>(changes.size()),
            window = std::max(1, static_cast<int>(std::lround(kWindow * rate)));
  const auto at = [&](int f) -> Change& { return changes[static_cast<std::size_t>(f)]; };
  for (int f = 0; f < frames; ++f) {
    if (at(f).*set) continue;
    int before = f, after = f;
    while (before >= 0 && !(at(before).*set) && f - before <= window) --before;
    while (after < frames && !(at(after).*set) && after - f <= window) ++after;
    const bool left = before >= 0 && at(before).*set, right = after < frames && at(after).*set;
    const double u = static_cast<double>(f - before), v = static_cast<double>(after - f);
    if (left && right) {
      const double part = blend(u / (u + v));
      at(f).*value = part * (at(before).*value) + (1 - part) * (at(after).*value);
    } else if (left) {
      at(f).*value = blend(u / window) * (at(before).*value);
    } else if (right) {
      at(f).*value = blend(v / window) * (at(after).*value);
    }
  }
}

class Cleanup {
 public:
  Cleanup(const Clip& clip, const RoleMap& roles, const std::vector<FixedStay>& stays)
      : clip_(clip), legs_(test::legs_of(roles)), pelvis_(carrying_joint(roles)) {
    for (const std::size_t side : {0U, 1U}) place_ankles(side, stays);
    place_root();
  }

  Clip result() const {
    Clip result = clip_;
    const auto carried = subtree(clip_.skeleton, pelvis_);
    for (int f = 0; f < clip_.frame_count(); ++f) {
      const Vec3& root = root_[static_cast<std::size_t>(f)];
      for (std::size_t j = 0; j < carried.size(); ++j) {
        if (carried[j]) result.frame_positions(f)[j] += root.cast<float>();
      }
      for (const std::size_t side : {0U, 1U}) set_leg(f, side, result);
    }
    return result;
  }

 private:
  Change& change(std::size_t side, int f) { return changes_[side][static_cast<std::size_t>(f)]; }
  const Change& change(std::size_t side, int f) const {
    return changes_[side][static_cast<std::size_t>(f)];
  }
  Vec3 ankle_goal(std::size_t side, int f) const {
    return joint_of(clip_, f, legs_[side].foot).position + change(side, f).shift;
  }

  void place_ankles(std::size_t side, const std::vector<FixedStay>& stays) {
    std::vector<Fixed> fixed(static_cast<std::size_t>(clip_.frame_count()));
    for (const FixedStay& stay : stays) {
      if (static_cast<std::size_t>(stay.point.side) != side || stay.point.part == FootPart::tip) {
        continue;
      }
      for (int f = stay.first; f <= stay.last; ++f) {
        Fixed& now = fixed[static_cast<std::size_t>(f)];
        const bool heel = stay.point.part == FootPart::heel;
        (heel ? now.heel : now.ball) = &stay;
        (heel ? now.heel_place : now.ball_place) = stay.place;
      }
    }
    changes_[side].resize(fixed.size());
    const auto now = [&](int f, const FixedStay& stay) {
      return Vec3(joint_of(clip_, f, stay.point.joint) * stay.point.offset);
    };
    for (int f = 0; f < clip_.frame_count(); ++f) {
      const Fixed& at = fixed[static_cast<std::size_t>(f)];
      if (!at.heel || !at.ball) continue;
      change(side, f).turned = true;
      change(side, f).turn = rotation_vector(
          shortest_arc(now(f, *at.ball) - now(f, *at.heel), at.ball_place - at.heel_place));
    }
    blend_between(changes_[side], clip_.rate, &Change::turned, &Change::turn);
    for (int f = 0; f < clip_.frame_count(); ++f) {
      const Fixed& at = fixed[static_cast<std::size_t>(f)];
      const FixedStay* stay = at.heel ? at.heel : at.ball;
      if (!stay) continue;
      Change& here = change(side, f);
      const Vec3 ankle = joint_of(clip_, f, legs_[side].foot).position;
      here.shifted = true;
      here.shift = (at.heel ? at.heel_place : at.ball_place) - ankle -
                   from_rotation_vector(here.turn) * Vec3(now(f, *stay) - ankle);
    }
    blend_between(changes_[side], clip_.rate, &Change::shifted, &Change::shift);
  }

  // The nearest place of the root from which both ankles can be reached.
  Vec3 projected(int f) const {
    Vec3 root = Vec3::Zero();
    for (int round = 0; round < 50; ++round) {
      bool within = true;
      for (const std::size_t side : {0U, 1U}) {
        const Vec3 hip = joint_of(clip_, f, legs_[side].upper).position + root;
        const Vec3 knee = joint_of(clip_, f, legs_[side].lower).position,
                   ankle = joint_of(clip_, f, legs_[side].foot).position;
        const double longest = (knee + root - hip).norm() + (ankle - knee).norm();
        const Vec3 line = ankle_goal(side, f) - hip;
        if (line.norm() <= longest + 1e-9) continue;
        within = false;
        root += line * (1 - longest / line.norm());
      }
      if (within) break;
    }
    return root;
  }

  void place_root() {
    const int frames = clip_.frame_count(),
              window = std::max(1, static_cast<int>(std::lround(kWindow * clip_.rate)));
    std::vector<Vec3> wanted;
    for (int f = 0; f < frames; ++f) wanted.push_back(projected(f));
    for (int f = 0; f < frames; ++f) {
      Vec3 most = wanted[static_cast<std::size_t>(f)];
      for (int g = std::max(0, f - window); g <= std::min(frames - 1, f + window); ++g) {
        const Vec3 faded = blend(std::abs(g - f) / static_cast<double>(window)) *
                           wanted[static_cast<std::size_t>(g)];
        if (faded.norm() > most.norm()) most = faded;
      }
      root_.push_back(most);
    }
  }

  // The bend after damping: what the captured bend is to change by counts less the straighter the
  // knee is.
  static double damped(double captured, double wanted) {
    const auto integral = [](double bend) {  // of 1 - blend(bend / kDamped)
      if (bend >= kDamped) return bend - kDamped + 0.5 * kDamped;
      const double u = bend / kDamped;
      return kDamped * (u * u * u - 0.5 * u * u * u * u);
    };
    const double goal = wanted;
    double bend = captured;
    const int steps = 64;
    for (int i = 0; i < steps; ++i) {
      const double step = (goal - captured) / steps;
      bend += integral(bend + step) - integral(bend);
      bend = std::max(0.0, bend);
    }
    return bend;
  }

  void set_leg(int f, std::size_t side, Clip& result) const {
    const test::LegRoles& leg = legs_[side];
    const Transform upper = joint_of(result, f, leg.upper), lower = joint_of(result, f, leg.lower),
                    foot = joint_of(result, f, leg.foot);
    const Vec3 goal = ankle_goal(side, f), line = goal - upper.position;
    const double thigh = (lower.position - upper.position).norm(),
                 shank = (foot.position - lower.position).norm();
    const double bend = damped(two_bone_bend(thigh, shank, (foot.position - upper.position).norm()),
                               two_bone_bend(thigh, shank, line.norm()));
    const double reach = two_bone_reach(thigh, shank, bend);
    const TwoBoneSolution solution =
        solve_two_bone({upper.position, lower.position, foot.position, Vec3::Zero()},
                       {Vec3(upper.position + line.normalized() * reach)});
    const double stretch = line.norm() / reach;
    const Vec3 knee = upper.position + stretch * (solution.middle - upper.position);
    const Quat of_foot = from_rotation_vector(change(side, f).turn);
    std::vector<int> part(clip_.skeleton.names.size(), 0);
    for (std::size_t j = 0; j < part.size(); ++j) {
      const int parent = clip_.skeleton.parents[j], joint = static_cast<int>(j);
      if (parent >= 0) part[j] = part[static_cast<std::size_t>(parent)];
      part[j] = joint == leg.upper ? 1 : joint == leg.lower ? 2 : joint == leg.foot ? 3 : part[j];
      if (part[j] == 0) continue;
      const Quat turn = part[j] == 1   ? solution.root_rotation
                        : part[j] == 2 ? solution.middle_rotation
                                       : of_foot;
      const Transform& from = part[j] == 1 ? upper : part[j] == 2 ? lower : foot;
      const Vec3 to = part[j] == 1 ? upper.position : part[j] == 2 ? knee : goal;
      const Transform now = joint_of(result, f, joint);
      result.frame_positions(f)[j] = (to + turn * Vec3(now.position - from.position)).cast<float>();
      result.frame_orientations(f)[j] = (turn * now.orientation).cast<float>();
    }
  }

  const Clip& clip_;
  std::array<test::LegRoles, 2> legs_;
  int pelvis_;
  std::array<std::vector<Change>, 2> changes_;
  std::vector<Vec3> root_;
};

}  // namespace

Clip kovar_2002(const Clip& clip, const RoleMap& roles, const std::vector<FixedStay>& stays) {
  return Cleanup(clip, roles, stays).result();
}

}  // namespace krok::bench
