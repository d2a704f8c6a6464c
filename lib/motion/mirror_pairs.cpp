#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "motion/hips_root.h"
#include "motion/mirror.h"
#include "roles/joint_names.h"

namespace krok {

namespace {

bool is_middle_role(Role role) {
  return role == Role::root || role == Role::hips || role == Role::spine || role == Role::chest ||
         role == Role::neck || role == Role::head;
}

constexpr std::pair<Role, Role> kSides[] = {{Role::left_collar, Role::right_collar},
                                            {Role::left_upper_arm, Role::right_upper_arm},
                                            {Role::left_lower_arm, Role::right_lower_arm},
                                            {Role::left_hand, Role::right_hand},
                                            {Role::left_upper_leg, Role::right_upper_leg},
                                            {Role::left_lower_leg, Role::right_lower_leg},
                                            {Role::left_foot, Role::right_foot}};

// The tokens of a name with left and right exchanged; empty if it has neither.
std::optional<std::vector<std::string>> other_side(std::vector<std::string> words) {
  bool any = false;
  for (std::string& word : words) {
    for (const auto& [left, right] : {std::pair("left", "right"), std::pair("l", "r")}) {
      if (word != left && word != right) continue;
      word = word == left ? right : left;
      any = true;
      break;
    }
  }
  if (!any) return std::nullopt;
  return words;
}

// Sine of the angle from the plane of symmetry up to which a bone is one of the middle.
constexpr double kSwung = 0.7;

// What a name has beside letters and digits.
std::string signs_of(std::string_view name) {
  std::string signs;
  std::ranges::copy_if(name, std::back_inserter(signs), [](char sign) {
    const bool letter = (sign | 0x20) >= 'a' && (sign | 0x20) <= 'z';
    return !letter && !(sign >= '0' && sign <= '9');
  });
  return signs;
}

class PairFinder {
 public:
  PairFinder(const Skeleton& skeleton, const RoleMap& roles)
      : skeleton_(skeleton), roles_(roles), children_(skeleton.children()) {
    pairs_.partners.assign(skeleton.names.size(), MirrorPairs::kNone);
  }

  MirrorPairs find() {
    if (skeleton_.empty()) return pairs_;
    pair(0, 0);
    pair_by_roles();
    pair_by_names();
    find_across();
    find_plane();
    near_ = 0.02 * reference_extent(skeleton_);
    // Parents precede their children, so they are paired already.
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      const int other = partner(j);
      if (other == j) pair_children_of_middle(j);
      if (other > j) pair_children_of_sides(j, other);
    }
    return pairs_;
  }

 private:
  static std::size_t at(int joint) { return static_cast<std::size_t>(joint); }
  int partner(int joint) const { return pairs_.partners[at(joint)]; }
  bool open(int joint) const { return partner(joint) == MirrorPairs::kNone; }
  Role role(int joint) const { return roles_.roles[at(joint)]; }
  void pair(int a, int b) {
    pairs_.partners[at(a)] = b;
    pairs_.partners[at(b)] = a;
  }

  // Only the topmost joint of a role: find_roles assigns each of these once, a user's role map may
  // not.
  void pair_by_roles() {
    for (const auto& [left, right] : kSides) {
      const int a = roles_.joint(left), b = roles_.joint(right);
      if (a > 0 && b > 0) pair(a, b);
    }
    for (int j = 1; j < skeleton_.joint_count(); ++j) {
      if (is_middle_role(role(j))) pair(j, j);
    }
  }

  void pair_by_names() {
    std::map<std::vector<std::string>, std::vector<int>> by_words;
    for (int j = 1; j < skeleton_.joint_count(); ++j) {
      by_words[name_tokens(skeleton_.names[at(j)])].push_back(j);
    }
    for (int j = 1; j < skeleton_.joint_count(); ++j) {
      if (!open(j)) continue;
      const auto wanted = other_side(name_tokens(skeleton_.names[at(j)]));
      if (!wanted) continue;
      const auto found = by_words.find(*wanted);
      if (found == by_words.end()) continue;
      std::vector<int> others = found->second;
      // Of "__brow.r" and "brow.r" the one that is written as this joint.
      if (others.size() > 1) {
        const std::string mine = signs_of(skeleton_.names[at(j)]);
        std::erase_if(others, [&](int k) { return signs_of(skeleton_.names[at(k)]) != mine; });
      }
      if (others.size() == 1 && others[0] != j && open(others[0])) pair(j, others[0]);
    }
  }

  // From the right to the left: along x, unless pairs lie far from it, as where the reference pose
  // faces aside.
  void find_across() {
    constexpr double kAlongX = 0.87;  // cosine of 30 degrees
    Vec3 sum = Vec3::Zero();
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      if (partner(j) <= j) continue;
      const Vec3 apart =
          skeleton_.reference[at(j)].position - skeleton_.reference[at(partner(j))].position;
      sum += apart.dot(sum) < 0 ? Vec3(-apart) : apart;
    }
    const Vec3 across = sum.stableNormalized();
    if (sum.norm() > 0 && std::abs(across.x()) < kAlongX) pairs_.across = across;
  }

  void find_plane() {
    std::vector<double> middles;
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      if (partner(j) > j) middles.push_back(0.5 * (x(j) + x(partner(j))));
    }
    if (middles.empty()) {
      pairs_.plane = x(0);
      return;
    }
    const auto half = middles.begin() + static_cast<std::ptrdiff_t>(middles.size() / 2);
    std::nth_element(middles.begin(), half, middles.end());
    pairs_.plane = *half;
    // Makes the usual plane exactly 0 despite rounding of the offsets.
    if (std::abs(pairs_.plane) < 1e-6) pairs_.plane = 0;
  }
  double x(int joint) const { return pairs_.across.dot(skeleton_.reference[at(joint)].position); }

  // A joint in the reference pose relative to its parent, so that asymmetric parents do not matter.
  Vec3 from_parent(int joint) const {
    return skeleton_.reference[at(joint)].position -
           skeleton_.reference[at(skeleton_.parents[at(joint)])].position;
  }

  // The joint of `among`, which is sorted by height, that is nearest to the mirror image of
  // `joint`, and nearer than `within`; of two equally near ones the first in the skeleton.
  int nearest(int joint, const std::vector<int>& among, double within) const {
    const Vec3 bone = from_parent(joint);
    const Vec3 image = bone - 2 * pairs_.across.dot(bone) * pairs_.across;
    const auto height = [&](int j) { return from_parent(j).y(); };
    int best = MirrorPairs::kNone;
    for (auto k = std::ranges::lower_bound(among, image.y() - within, {}, height); k != among.end();
         ++k) {
      if (height(*k) > image.y() + within) break;
      if (*k == joint || !open(*k)) continue;
      if (skeleton_.end_sites[at(*k)] != skeleton_.end_sites[at(joint)]) continue;
      const double distance = (image - from_parent(*k)).norm();
      if (distance < within || (distance == within && *k < best)) {
        within = distance;
        best = *k;
      }
    }
    return best;
  }

  std::vector<int> by_height(std::vector<int> joints) const {
    std::ranges::stable_sort(joints, {}, [&](int j) { return from_parent(j).y(); });
    return joints;
  }

  void pair_children_of_middle(int parent) {
    const std::vector<int> sorted = by_height(children_[at(parent)]);
    for (const int j : children_[at(parent)]) {
      if (!open(j)) continue;
      if (std::abs(x(j) - pairs_.plane) < near_) {
        pair(j, j);
        continue;
      }
      const int other = nearest(j, sorted, 2.5 * near_);
      if (other != MirrorPairs::kNone) pair(j, other);
    }
    // If the reference pose tilts the head, jaw and tongue are off the plane.
    for (const int j : children_[at(parent)]) {
      const bool sided = other_side(name_tokens(skeleton_.names[at(j)])).has_value();
      if (open(j) && !sided && std::abs(x(j) - pairs_.plane) < 5 * near_) pair(j, j);
    }
    // A tail or trunk that the reference pose swings to a side: nothing else can be its image.
    std::vector<int> left;
    for (const int j : children_[at(parent)]) {
      if (open(j) && !other_side(name_tokens(skeleton_.names[at(j)]))) left.push_back(j);
    }
    if (left.size() != 1) return;
    const Vec3 bone = from_parent(left[0]);
    if (std::abs(pairs_.across.dot(bone)) < kSwung * bone.norm()) pair(left[0], left[0]);
  }

  void pair_children_of_sides(int left, int right) {
    std::vector<int> mine, theirs;
    for (const int j : children_[at(left)]) {
      if (open(j)) mine.push_back(j);
    }
    for (const int j : children_[at(right)]) {
      if (open(j)) theirs.push_back(j);
    }
    theirs = by_height(std::move(theirs));
    const bool only = mine.size() == 1 && theirs.size() == 1;
    for (const int j : mine) {
      const int other =
          nearest(j, theirs, only ? std::numeric_limits<double>::infinity() : 5 * near_);
      if (other != MirrorPairs::kNone) pair(j, other);
    }
  }

  const Skeleton& skeleton_;
  const RoleMap& roles_;
  std::vector<std::vector<int>> children_;
  MirrorPairs pairs_;
  double near_ = 0;
};

}  // namespace

std::vector<int> MirrorPairs::unpaired() const {
  std::vector<int> list;
  for (std::size_t j = 0; j < partners.size(); ++j) {
    if (partners[j] == kNone) list.push_back(static_cast<int>(j));
  }
  return list;
}

MirrorPairs find_mirror_pairs(const Skeleton& skeleton, const RoleMap& roles) {
  MirrorPairs pairs = PairFinder(skeleton, roles).find();
  pairs.carrier = skeleton.empty() ? 0 : carrying_joint(roles);
  for (const Role role : roles.roles) {
    const bool unknown = role == Role::none || role == Role::helper || role == Role::end;
    pairs.in_body.push_back(unknown ? 0 : 1);
  }
  return pairs;
}

}  // namespace krok
