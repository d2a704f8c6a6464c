#include "roles/role_finder_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace krok {

namespace {

using Chain = std::vector<int>;

struct Pair {
  Chain first, second;
};

class ShapeFinder {
 public:
  explicit ShapeFinder(const Skeleton& skeleton)
      : skeleton_(skeleton), children_(skeleton.children()), reach_(skeleton.names.size(), 0.0) {
    for (std::size_t j = reach_.size(); j-- > 1;) {
      const auto parent = static_cast<std::size_t>(skeleton.parents[j]);
      reach_[parent] = std::max(reach_[parent], reach_[j] + bone(static_cast<int>(j)));
    }
  }

  std::optional<std::vector<JointName>> find() {
    for (int hips = 0; hips < skeleton_.joint_count(); ++hips) {
      const auto legs = mirrored_pair(hips, kLegJoints);
      if (!legs) continue;
      for (int chest = hips; (chest = leading_on(chest, *legs)) >= 0;) {
        const auto arms = mirrored_pair(chest, kArmJoints);
        if (!arms) continue;
        const int head = leading_on(chest, *arms);
        if (head < 0) break;
        return name_actor(hips, *legs, chest, *arms, head);
      }
    }
    return std::nullopt;
  }

 private:
  static constexpr int kLegJoints = 3;  // upper leg, lower leg, foot
  static constexpr int kArmJoints = 3;  // upper arm, lower arm, hand

  static std::size_t at(int joint) { return static_cast<std::size_t>(joint); }
  const Vec3& place(int joint) const { return skeleton_.reference[at(joint)].position; }
  bool is_end(int joint) const { return skeleton_.end_sites[at(joint)] != 0; }
  double bone(int joint) const {
    const int parent = skeleton_.parents[at(joint)];
    return parent < 0 ? 0.0 : (place(joint) - place(parent)).norm();
  }

  // `joint` and its descendants down to the first branch, without end sites.
  Chain chain_from(int joint) const {
    Chain chain;
    while (joint >= 0 && !is_end(joint)) {
      chain.push_back(joint);
      const auto& below = children_[at(joint)];
      if (below.size() != 1) break;
      joint = below.front();
    }
    return chain;
  }

  bool mirrored(const Chain& a, const Chain& b) const {
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double longer = std::max(bone(a[i]), bone(b[i]));
      if (std::abs(bone(a[i]) - bone(b[i])) > 0.15 * longer + 1e-9) return false;
    }
    return (place(a.front()) - place(b.front())).norm() > 0;
  }

  // The longest two mirrored branches below a joint.
  std::optional<Pair> mirrored_pair(int joint, int least_joints) const {
    const auto& below = children_[at(joint)];
    if (below.size() < 3 || below.size() > 8) return std::nullopt;
    std::optional<Pair> best;
    for (std::size_t i = 0; i < below.size(); ++i) {
      for (std::size_t k = i + 1; k < below.size(); ++k) {
        Pair pair{chain_from(below[i]), chain_from(below[k])};
        if (static_cast<int>(pair.first.size()) < least_joints) continue;
        if (!mirrored(pair.first, pair.second)) continue;
        if (!best || reach_[at(below[i])] > reach_[at(best->first.front())]) best = std::move(pair);
      }
    }
    return best;
  }

  // The child of a trunk joint with the longest branch, other than the two of the pair; -1 if none.
  int leading_on(int joint, const Pair& besides) const {
    int best = -1;
    for (const int child : children_[at(joint)]) {
      if (is_end(child) || child == besides.first.front() || child == besides.second.front())
        continue;
      if (best < 0 || reach_[at(child)] > reach_[at(best)]) best = child;
    }
    return best;
  }

  // Arms: the last three joints of the chain. Legs: the first three, without a short first bone.
  std::optional<std::vector<JointName>> name_actor(int hips, const Pair& legs, int chest,
                                                   const Pair& arms, int neck) const {
    const auto leg = [&](const Chain& chain) {
      const bool short_first = chain.size() > 3 && (place(chain[1]) - place(chain[0])).norm() <
                                                       0.15 * reach_[at(chain.front())];
      return Chain(chain.begin() + (short_first ? 1 : 0), chain.end());
    };
    const Chain a = leg(legs.first);
    const Chain b = leg(legs.second);
    if (a.size() < 3 || arms.first.size() > 4) return std::nullopt;
    const auto forward_and_up = stance(hips, chest, a[2], b[2], arms, neck);
    if (!forward_and_up) return std::nullopt;
    const Vec3 left = forward_and_up->second.cross(forward_and_up->first);

    std::vector<JointName> names(skeleton_.names.size());
    names[at(hips)] = {Part::hips, Side::middle};
    int head = neck;  // follows the branch to its end or first fork (the face)
    while (children_[at(head)].size() == 1 && !is_end(children_[at(head)].front())) {
      names[at(head)] = {Part::neck, Side::middle};
      head = children_[at(head)].front();
    }
    names[at(head)] = {Part::head, Side::middle};
    if (!name_pair(names, {a, b}, {Part::upper_leg, Part::lower_leg, Part::foot}, left)) return {};
    const auto arm = [](const Chain& chain) { return Chain(chain.end() - 3, chain.end()); };
    if (!name_pair(names, {arm(arms.first), arm(arms.second)},
                   {Part::upper_arm, Part::lower_arm, Part::hand}, left)) {
      return {};
    }
    return names;
  }

  bool name_pair(std::vector<JointName>& names, const Pair& pair, const std::array<Part, 3>& parts,
                 const Vec3& left) const {
    const double apart = (place(pair.first.front()) - place(pair.second.front())).dot(left);
    if (!(std::abs(apart) > 0)) return false;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      names[at(pair.first[i])] = {parts[i], apart > 0 ? Side::left : Side::right};
      names[at(pair.second[i])] = {parts[i], apart > 0 ? Side::right : Side::left};
    }
    return true;
  }

  // Forward and up, if the pose is upright as a person's; empty otherwise.
  std::optional<std::pair<Vec3, Vec3>> stance(int hips, int chest, int foot_a, int foot_b,
                                              const Pair& arms, int neck) const {
    const Vec3 ground = 0.5 * (place(foot_a) + place(foot_b));
    const Vec3 legs = place(hips) - ground;
    const Vec3 trunk = place(chest) - place(hips);
    const double height = legs.norm();
    if (!(height > 0) || !(trunk.norm() > 0)) return std::nullopt;
    const Vec3 up = legs / height;
    const double hands =
        0.5 * (place(arms.first.back()) + place(arms.second.back()) - 2 * ground).dot(up);
    const bool upright = trunk.normalized().dot(up) > 0.8 && hands > 0.5 * height &&
                         (place(neck) - place(hips)).dot(up) > 0;
    if (!upright) return std::nullopt;
    Vec3 toes = Vec3::Zero();
    for (const int foot : {foot_a, foot_b}) {
      if (children_[at(foot)].empty()) return std::nullopt;
      const Vec3 along = place(children_[at(foot)].front()) - place(foot);
      toes += along - along.dot(up) * up;
    }
    if (!(toes.norm() > 0.05 * height)) return std::nullopt;
    return std::pair(Vec3(toes.normalized()), up);
  }

  const Skeleton& skeleton_;
  std::vector<std::vector<int>> children_;
  std::vector<double> reach_;  // [joints], length of the longest branch below
};

}  // namespace

std::optional<std::vector<JointName>> names_from_shape(const Skeleton& skeleton) {
  return ShapeFinder(skeleton).find();
}

}  // namespace krok
