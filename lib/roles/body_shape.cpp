#include <algorithm>
#include <cmath>
#include <utility>

#include "roles/role_finder_internal.h"

namespace krok {

namespace {

using Chain = std::vector<int>;  // joints, parents first

// Two limbs that mirror each other, from the joint that both hang on.
struct Pair {
  int joint = -1;
  std::array<Chain, 2> limbs;
  double reach = 0;
};

// The joints of a limb that move its parts: shoulder, elbow, wrist; hip, knee, ankle.
using LimbJoints = std::array<int, 3>;
using BothLimbs = std::array<LimbJoints, 2>;

// Shares of a limb's length; thigh and shank, upper arm and forearm are about as long.
constexpr double kSameBone = 0.15;      // of the longer of two bones
constexpr double kShortBone = 0.06;     // parts of a foot, collars
constexpr double kShortestPair = 0.25;  // of the longest limb
constexpr double kSteep = 0.8;          // cosine, of a leg's bones with its way down
constexpr double kUnequalBones = 3;     // what a difference of two bones costs, over its length

class ShapeFinder {
 public:
  explicit ShapeFinder(const Skeleton& skeleton)
      : skeleton_(skeleton), children_(skeleton.children()), reach_(skeleton.names.size(), 0.0) {
    for (std::size_t j = reach_.size(); j-- > 1;) {
      const auto parent = at(skeleton.parents[j]);
      reach_[parent] = std::max(reach_[parent], reach_[j] + bone(static_cast<int>(j)));
    }
    length_.resize(reach_.size());
    for (std::size_t j = reach_.size(); j-- > 0;) {
      if (skeleton.end_sites[j] != 0) continue;
      const int next = main_child(static_cast<int>(j));
      length_[j] = next < 0 ? 1 : length_[at(next)] + 1;
    }
  }

  std::optional<std::vector<JointName>> find() const {
    const std::vector<Pair> pairs = mirrored_pairs();
    std::optional<std::vector<JointName>> best;
    double highest = -HUGE_VAL;
    for (const Pair& legs : pairs) {
      for (const Pair& arms : pairs) {
        if (legs.joint == arms.joint || on_limb(legs.joint, arms) || on_limb(arms.joint, legs)) {
          continue;
        }
        // Arms reach to the sides from the trunk; tails of hair hang from a head.
        const double score = distance(arm_of(arms.limbs[0])[2], arm_of(arms.limbs[1])[2]) -
                             distance(legs.joint, arms.joint);
        if (score <= highest) continue;
        auto names = name_actor(legs, arms);
        if (!names) continue;
        highest = score;
        best = std::move(names);
      }
    }
    return best;
  }

 private:
  const Vec3& place(int joint) const { return skeleton_.reference[at(joint)].position; }
  bool is_end(int joint) const { return skeleton_.end_sites[at(joint)] != 0; }
  double distance(int a, int b) const { return (place(a) - place(b)).norm(); }
  double bone(int joint) const {
    const int parent = skeleton_.parents[at(joint)];
    return parent < 0 ? 0.0 : distance(joint, parent);
  }

  // The child with the longest branch, end sites included; -1 if there is none.
  int main_child(int joint) const {
    int best = -1;
    for (const int child : children_[at(joint)]) {
      if (best < 0 || bone(child) + reach_[at(child)] > bone(best) + reach_[at(best)]) best = child;
    }
    return best;
  }

  // A joint and its main descendants, without end sites.
  Chain chain_from(int joint) const {
    Chain chain;
    for (; joint >= 0 && !is_end(joint); joint = main_child(joint)) chain.push_back(joint);
    return chain;
  }

  bool mirrored(const Chain& a, const Chain& b) const {
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double longer = std::max(bone(a[i]), bone(b[i]));
      const double allowed = std::max(kSameBone * longer, 0.5 * kShortBone * reach_[at(a[0])]);
      if (std::abs(bone(a[i]) - bone(b[i])) > allowed) return false;
    }
    return distance(a.back(), b.back()) > 0;
  }

  // Of at least three joints, the longest pairs first.
  std::vector<Pair> mirrored_pairs() const {
    std::vector<Pair> pairs;
    for (int joint = 0; joint < skeleton_.joint_count(); ++joint) {
      const auto& below = children_[at(joint)];
      if (below.size() > kMaxChildren) continue;
      for (std::size_t i = 0; i < below.size(); ++i) {
        for (std::size_t k = i + 1; k < below.size(); ++k) {
          const int length = length_[at(below[i])];
          if (length < 3 || length > kMaxJoints || length != length_[at(below[k])]) continue;
          Chain a = chain_from(below[i]), b = chain_from(below[k]);
          if (!mirrored(a, b)) continue;
          pairs.push_back(
              {joint, {std::move(a), std::move(b)}, bone(below[i]) + reach_[at(below[i])]});
        }
      }
    }
    std::ranges::stable_sort(pairs, std::greater(), &Pair::reach);
    while (!pairs.empty() && pairs.back().reach < kShortestPair * pairs.front().reach) {
      pairs.pop_back();
    }
    if (pairs.size() > kMaxPairs) pairs.resize(kMaxPairs);
    return pairs;
  }

  bool on_limb(int joint, const Pair& pair) const {
    for (; joint >= 0; joint = skeleton_.parents[at(joint)]) {
      if (joint == pair.limbs[0].front() || joint == pair.limbs[1].front()) return true;
    }
    return false;
  }

  // Of `chain` up to `last`, the upper and the middle joint that share the way to it evenly.
  LimbJoints halves(const Chain& chain, std::size_t first, std::size_t last) const {
    LimbJoints best = {-1, -1, chain[last]};
    double highest = -HUGE_VAL;
    for (std::size_t u = first; u < last; ++u) {
      for (std::size_t m = u + 1; m < last; ++m) {
        const double upper = distance(chain[u], chain[m]), lower = distance(chain[m], chain[last]);
        const double score = upper + lower - kUnequalBones * std::abs(upper - lower);
        if (score <= highest) continue;
        highest = score;
        best = {chain[u], chain[m], chain[last]};
      }
    }
    return best;
  }

  // From the first to the last of the long bones that lead down.
  LimbJoints leg_of(const Chain& chain, const Vec3& down) const {
    const double length = reach_[at(chain.front())];
    std::size_t first = chain.size(), last = 0;
    for (std::size_t i = 1; i < chain.size(); ++i) {
      const Vec3 along = place(chain[i]) - place(chain[i - 1]);
      if (along.norm() < kShortBone * length || along.dot(down) < kSteep * along.norm()) continue;
      first = std::min(first, i - 1);
      last = i;
    }
    return last > 0 ? halves(chain, first, last) : LimbJoints{-1, -1, -1};
  }

  // To where fingers part, else to the end of the last long bone.
  LimbJoints arm_of(const Chain& chain) const {
    const double length = reach_[at(chain.front())];
    std::size_t last = 0;
    for (std::size_t i = 1; i < chain.size(); ++i) {
      if (bone(chain[i]) >= kShortBone * length) last = i;
      // Twist joints end before the next joint, fingers beyond it.
      const bool parts = std::ranges::any_of(children_[at(chain[i])], [&](int child) {
        return i + 1 < chain.size() && child != chain[i + 1] && !is_end(child) &&
               bone(child) + reach_[at(child)] > bone(chain[i + 1]);
      });
      if (parts && reach_[at(chain[i])] < 0.5 * length) {
        last = i;
        break;
      }
    }
    return halves(chain, 0, last);
  }

  std::optional<std::vector<JointName>> name_actor(const Pair& legs, const Pair& arms) const {
    const Vec3 trunk = place(arms.joint) - place(legs.joint);
    if (!(trunk.norm() > 0)) return std::nullopt;
    const Vec3 up = trunk.normalized();
    BothLimbs leg, arm;
    for (std::size_t side = 0; side < 2; ++side) {
      leg[side] = leg_of(legs.limbs[side], -up);
      arm[side] = arm_of(arms.limbs[side]);
      if (leg[side][1] < 0 || arm[side][1] < 0) return std::nullopt;
    }
    const auto forward = facing(legs, leg, arm, up);
    const int neck = leading_on(arms, up);
    if (!forward || neck < 0) return std::nullopt;
    const Vec3 left = up.cross(*forward);

    std::vector<JointName> names(skeleton_.names.size());
    int head = neck;  // follows the branch to its end or first fork (the face)
    while (children_[at(head)].size() == 1) {
      const int next = children_[at(head)].front();
      if (is_end(next) || bone(next) < 0.02 * trunk.norm()) break;
      names[at(head)] = {Part::neck, Side::middle};
      head = next;
    }
    names[at(head)] = {Part::head, Side::middle};
    constexpr LimbParts kLeg = {Part::upper_leg, Part::lower_leg, Part::foot};
    constexpr LimbParts kArm = {Part::upper_arm, Part::lower_arm, Part::hand};
    if (!name_pair(leg, kLeg, left, names) || !name_pair(arm, kArm, left, names)) return {};
    return names;
  }

  using LimbParts = std::array<Part, 3>;
  bool name_pair(const BothLimbs& limbs, const LimbParts& parts, const Vec3& left,
                 std::vector<JointName>& names) const {
    const double apart = (place(limbs[0][0]) - place(limbs[1][0])).dot(left);
    if (!(std::abs(apart) > 0)) return false;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      names[at(limbs[0][i])] = {parts[i], apart > 0 ? Side::left : Side::right};
      names[at(limbs[1][i])] = {parts[i], apart > 0 ? Side::right : Side::left};
    }
    return true;
  }

  // The child of the arms' joint that leads upwards, -1 if there is none.
  int leading_on(const Pair& arms, const Vec3& up) const {
    int best = -1;
    for (const int child : children_[at(arms.joint)]) {
      if (is_end(child) || on_limb(child, arms)) continue;
      const bool rises = std::ranges::any_of(chain_from(child), [&](int joint) {
        return (place(joint) - place(arms.joint)).dot(up) > 0;
      });
      if (!rises) continue;
      if (best < 0 || reach_[at(child)] > reach_[at(best)]) best = child;
    }
    return best;
  }

  // The way across `up` to the joint below `joint` that is farthest from it.
  Vec3 farthest_aside(int joint, const Vec3& up) const {
    Vec3 best = Vec3::Zero();
    std::vector<int> left = children_[at(joint)];
    while (!left.empty()) {
      const int below = left.back();
      left.pop_back();
      left.insert(left.end(), children_[at(below)].begin(), children_[at(below)].end());
      Vec3 along = place(below) - place(joint);
      along -= along.dot(up) * up;
      if (along.norm() > best.norm()) best = along;
    }
    return best;
  }

  // Where the feet point, if the pose is upright as a person's; empty otherwise.
  std::optional<Vec3> facing(const Pair& legs, const BothLimbs& leg, const BothLimbs& arm,
                             const Vec3& up) const {
    const Vec3 ground = 0.5 * (place(leg[0][2]) + place(leg[1][2]));
    const Vec3 stance = place(legs.joint) - ground;
    const double height = stance.norm();
    const double hands = 0.5 * (place(arm[0][2]) + place(arm[1][2]) - 2 * ground).dot(up);
    if (!(stance.dot(up) > 0.8 * height) || !(hands > 0.5 * height)) return std::nullopt;
    Vec3 toes = Vec3::Zero();
    for (const LimbJoints& limb : leg) toes += farthest_aside(limb[2], up);
    if (!(toes.norm() > 0.05 * height)) return std::nullopt;
    return toes.normalized();
  }

  static constexpr std::size_t kMaxChildren = 16, kMaxPairs = 16;
  static constexpr int kMaxJoints = 64;  // of a limb

  const Skeleton& skeleton_;
  std::vector<std::vector<int>> children_;
  std::vector<double> reach_;  // [joints], length of the longest branch below
  std::vector<int> length_;    // [joints], joints of chain_from()
};

}  // namespace

std::optional<std::vector<JointName>> names_from_shape(const Skeleton& skeleton) {
  return ShapeFinder(skeleton).find();
}

}  // namespace krok
