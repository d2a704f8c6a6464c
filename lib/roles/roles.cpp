#include "roles/roles.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "roles/body_shape.h"
#include "roles/joint_names.h"
#include "roles/role_finder.h"

namespace krok {

namespace {

struct ArmRoles {
  Role collar, upper, lower, hand, fingers;
};
struct LegRoles {
  Role upper, lower, foot, toes;
};
constexpr ArmRoles kLeftArm = {Role::left_collar, Role::left_upper_arm, Role::left_lower_arm,
                               Role::left_hand, Role::left_fingers};
constexpr ArmRoles kRightArm = {Role::right_collar, Role::right_upper_arm, Role::right_lower_arm,
                                Role::right_hand, Role::right_fingers};
constexpr LegRoles kLeftLeg = {Role::left_upper_leg, Role::left_lower_leg, Role::left_foot,
                               Role::left_toes};
constexpr LegRoles kRightLeg = {Role::right_upper_leg, Role::right_lower_leg, Role::right_foot,
                                Role::right_toes};

// Matches names with the hierarchy: finds the ends of the limbs by name; joints that several limbs
// descend from are the trunk, joints between trunk and end are the limb.
class RoleFinder {
 public:
  RoleFinder(const Skeleton& skeleton, std::vector<JointName> names)
      : skeleton_(skeleton), names_(std::move(names)), children_(skeleton.children()) {
    const std::size_t count = skeleton.names.size();
    map_.roles.assign(count, Role::none);
    depths_.assign(count, 0);
    counts_below_.assign(count, 1);
    for (std::size_t j = 1; j < count; ++j) depths_[j] = depths_[at(skeleton.parents[j])] + 1;
    for (std::size_t j = count; j-- > 1;) {
      counts_below_[at(skeleton.parents[j])] += counts_below_[j];
    }
  }

  RoleMap find() {
    find_tips();
    mark_trunk();
    for (const Side side : {Side::left, Side::right}) {
      assign_arm(side);
      assign_leg(side);
    }
    if (limbs_ > 0) {
      assign_trunk();
      assign_rest();
    } else {
      std::fill(map_.roles.begin(), map_.roles.end(), Role::none);
    }
    for (std::size_t j = 0; j < map_.roles.size(); ++j) {
      if (skeleton_.end_sites[j] != 0) map_.roles[j] = Role::end;
    }
    assign_fingers();
    map_.humanoid = missing_roles(map_).empty();
    return std::move(map_);
  }

 private:
  static std::size_t at(int joint) { return static_cast<std::size_t>(joint); }
  int parent(int joint) const { return skeleton_.parents[at(joint)]; }
  Part part(int joint) const { return names_[at(joint)].part; }
  Role& role(int joint) { return map_.roles[at(joint)]; }
  bool is_end(int joint) const { return skeleton_.end_sites[at(joint)] != 0; }
  bool is_helper(int joint) const { return part(joint) == Part::helper; }
  bool placed(int joint) const { return joint >= 0 && map_.roles[at(joint)] != Role::none; }

  bool descends(int joint, int ancestor) const {
    while (joint >= 0 && depths_[at(joint)] > depths_[at(ancestor)]) joint = parent(joint);
    return joint == ancestor;
  }

  // The lowest common ancestor, which may be a or b. If one is -1, the other; -1 if both are.
  int common_ancestor(int a, int b) const {
    if (a < 0 || b < 0) return std::max(a, b);
    while (a != b) {
      if (depths_[at(a)] >= depths_[at(b)]) {
        a = parent(a);
      } else {
        b = parent(b);
      }
    }
    return a;
  }

  double distance(int a, int b) const {
    return (skeleton_.reference[at(a)].position - skeleton_.reference[at(b)].position).norm();
  }

  // The joint nearest to the root for which `wanted` holds, without end sites; the first of equals.
  template <typename Condition>
  int nearest(const Condition& wanted) const {
    int best = -1;
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      if (!is_end(j) && wanted(j) && (best < 0 || depths_[at(j)] < depths_[at(best)])) best = j;
    }
    return best;
  }

  // Whether an ancestor of `joint` on `side` is named as one of `parts`.
  bool hangs_under(int joint, Side side, std::span<const Part> parts) const {
    for (int j = parent(joint); j >= 0; j = parent(j)) {
      if (names_[at(j)].side == side &&
          std::find(parts.begin(), parts.end(), part(j)) != parts.end()) {
        return true;
      }
    }
    return false;
  }

  // The end joint of a limb: a joint named `tip` below a joint of that limb, else the main child of
  // the limb's last part, else a joint named `tip` anywhere.
  int find_tip(Side side, Part tip, std::span<const Part> limb) const {
    const auto named = [&](int j) { return part(j) == tip && names_[at(j)].side == side; };
    int found = nearest([&](int j) { return named(j) && hangs_under(j, side, limb); });
    if (found >= 0) return found;
    const int last =
        nearest([&](int j) { return part(j) == limb.back() && names_[at(j)].side == side; });
    if (last >= 0) return main_child(last);
    return nearest(named);
  }

  // The child with the most descendants, other than helpers and end sites; -1 if there is none.
  int main_child(int joint) const {
    int best = -1;
    for (const int child : children_[at(joint)]) {
      if (is_end(child) || is_helper(child)) continue;
      if (best < 0 || counts_below_[at(child)] > counts_below_[at(best)]) best = child;
    }
    return best;
  }

  void find_tips() {
    constexpr std::array kArm = {Part::collar, Part::shoulder, Part::upper_arm, Part::arm,
                                 Part::lower_arm};
    constexpr std::array kLeg = {Part::hip, Part::upper_leg, Part::leg, Part::lower_leg};
    hands_ = {find_tip(Side::left, Part::hand, kArm), find_tip(Side::right, Part::hand, kArm)};
    feet_ = {find_tip(Side::left, Part::foot, kLeg), find_tip(Side::right, Part::foot, kLeg)};
    head_ = nearest([&](int j) { return part(j) == Part::head; });
    neck_ = nearest([&](int j) { return part(j) == Part::neck; });
    if (head_ < 0 && neck_ >= 0) {
      int last = neck_;
      while (main_child(last) >= 0 && part(main_child(last)) == Part::neck) last = main_child(last);
      head_ = main_child(last);
      if (head_ < 0 && last != neck_) head_ = last;  // the last of several necks
    }
    if (head_ < 0 && neck_ < 0) head_ = unnamed_head();
  }

  // If both arms and legs are known by name, but no neck or head (only numbered vertebrae, for
  // example): the last joint of the single branch above the arms.
  int unnamed_head() const {
    if (hands_[0] < 0 || hands_[1] < 0 || feet_[0] < 0 || feet_[1] < 0) return -1;
    const auto may_lead_on = [&](int j) {
      const bool named = part(j) != Part::unknown && part(j) != Part::spine;
      return !is_end(j) && !named && names_[at(j)].side == Side::middle;
    };
    const int chest = common_ancestor(hands_[0], hands_[1]);
    if (descends(feet_[0], chest)) return -1;  // all limbs on one joint: up is unknown
    int head = -1;
    for (const int child : children_[at(chest)]) {
      if (is_end(child) || descends(hands_[0], child) || descends(hands_[1], child)) continue;
      if (head >= 0 || !may_lead_on(child)) return -1;
      head = child;
    }
    while (head >= 0 && children_[at(head)].size() == 1 && may_lead_on(children_[at(head)][0])) {
      head = children_[at(head)][0];
    }
    return head;
  }

  // Trunk: joints that two limbs, or a limb and the head, descend from.
  void mark_trunk() {
    const std::array tips = {hands_[0], hands_[1], feet_[0], feet_[1], head_ >= 0 ? head_ : neck_};
    std::vector<int> tips_below(skeleton_.names.size(), 0);
    for (const int tip : tips) {
      for (int j = tip < 0 ? -1 : parent(tip); j >= 0; j = parent(j)) ++tips_below[at(j)];
    }
    trunk_.assign(skeleton_.names.size(), 0);
    for (std::size_t j = 0; j < trunk_.size(); ++j) trunk_[j] = tips_below[j] >= 2 ? 1 : 0;
  }

  // The joints between the trunk and `tip`, both exclusive, without helpers.
  std::vector<int> limb_above(int tip) const {
    std::vector<int> chain;
    for (int j = parent(tip); j >= 0 && trunk_[at(j)] == 0; j = parent(j)) {
      if (!is_helper(j) && !is_middle(j)) chain.push_back(j);
    }
    std::reverse(chain.begin(), chain.end());
    return chain;
  }

  // Whether the joint is named as part of the trunk; needed for skeletons with a single limb.
  bool is_middle(int joint) const {
    const Part p = part(joint);
    return p == Part::hips || p == Part::spine || p == Part::neck || p == Part::head;
  }

  // Index in `chain` of the first joint named `wanted`, starting at `from`; -1 if there is none.
  int position(const std::vector<int>& chain, Part wanted, int from = 0) const {
    for (int i = from; i < static_cast<int>(chain.size()); ++i) {
      if (part(chain[at(i)]) == wanted) return i;
    }
    return -1;
  }

  void assign_arm(Side side) {
    const int hand = hands_[side == Side::left ? 0 : 1];
    if (hand < 0) return;
    const ArmRoles& roles = side == Side::left ? kLeftArm : kRightArm;
    const std::vector<int> chain = limb_above(hand);
    const int count = static_cast<int>(chain.size());
    int lower = position(chain, Part::lower_arm);
    int upper = position(chain, Part::upper_arm);
    if (upper < 0) upper = position(chain, Part::arm);
    if (upper >= 0 && part(chain[at(upper)]) == Part::arm && lower < 0 &&
        position(chain, Part::collar) < 0 && upper == count - 1 &&
        position(chain, Part::shoulder) >= 0) {
      lower = upper;  // shoulder, arm, hand
      upper = -1;
    }
    if (upper < 0) upper = position(chain, Part::shoulder);
    if (lower < 0 && upper >= 0) lower = position(chain, Part::arm, upper + 1);
    if (lower < 0 && count > 0 && upper != count - 1) lower = count - 1;
    if (upper < 0 && lower > 0 && part(chain[at(lower - 1)]) != Part::collar) upper = lower - 1;
    if (upper < 0 || lower < 0 || lower <= upper) {
      role(hand) = upper >= 0 ? roles.hand : Role::none;
      if (upper >= 0) role(chain[at(upper)]) = roles.upper;
      return;
    }
    upper = repaired_upper_arm(chain, upper, lower, hand);
    int collar = -1;
    for (int i = 0; i < upper && collar < 0; ++i) {
      if (part(chain[at(i)]) == Part::collar) collar = i;
    }
    if (collar < 0) collar = position(chain, Part::shoulder);
    if (collar < 0 || collar >= upper) collar = upper - 1;
    for (const int j : chain) role(j) = Role::helper;
    if (collar >= 0) role(chain[at(collar)]) = roles.collar;
    role(chain[at(upper)]) = roles.upper;
    role(chain[at(lower)]) = roles.lower;
    role(hand) = roles.hand;
    ++limbs_;
  }

  // If a joint in the middle of the upper arm is named upper arm (MakeHuman's upperarm02 below
  // shoulder02 below clavicle), returns the one before it, provided that the upper arm is then
  // about as long as the lower arm.
  int repaired_upper_arm(const std::vector<int>& chain, int upper, int lower, int hand) const {
    const int collar = position(chain, Part::collar);
    if (collar < 0 || upper - 1 <= collar) return upper;
    const double lower_length = distance(chain[at(lower)], hand);
    const double named = distance(chain[at(upper)], chain[at(lower)]);
    const double before = distance(chain[at(upper - 1)], chain[at(lower)]);
    const bool too_short = named < 0.8 * lower_length;
    const bool fits = before > 0.9 * lower_length && before < 1.3 * lower_length;
    return too_short && fits ? upper - 1 : upper;
  }

  void assign_leg(Side side) {
    const int foot = feet_[side == Side::left ? 0 : 1];
    if (foot < 0) return;
    const LegRoles& roles = side == Side::left ? kLeftLeg : kRightLeg;
    const std::vector<int> chain = limb_above(foot);
    const int count = static_cast<int>(chain.size());
    int lower = position(chain, Part::lower_leg);
    int upper = position(chain, Part::upper_leg);
    if (upper < 0) upper = position(chain, Part::hip);
    if (upper < 0 && lower > 0) upper = position(chain, Part::leg);
    if (lower < 0) lower = position(chain, Part::leg, upper + 1);
    if (lower < 0 && count > 0 && upper != count - 1) lower = count - 1;
    if (upper < 0 && lower > 0) upper = lower - 1;
    if (upper < 0 || lower <= upper) return;
    for (const int j : chain) role(j) = Role::helper;
    role(chain[at(upper)]) = roles.upper;
    role(chain[at(lower)]) = roles.lower;
    role(foot) = roles.foot;
    ++limbs_;
  }

  int find_hips(int legs, int top) const {
    const int meeting = common_ancestor(legs, top);
    // A joint named hips at or above the meeting point; without legs, any joint named hips.
    for (int j = meeting; j >= 0; j = parent(j)) {
      if (part(j) == Part::hips) return j;
    }
    return legs >= 0 ? meeting : nearest([&](int j) { return part(j) == Part::hips; });
  }

  void assign_trunk() {
    const int top = head_ >= 0 ? head_ : neck_;
    const auto above = [&](Role wanted) {
      const int joint = map_.joint(wanted);
      return joint < 0 ? -1 : parent(joint);
    };
    const int arms = common_ancestor(above(Role::left_upper_arm), above(Role::right_upper_arm));
    const int legs = common_ancestor(above(Role::left_upper_leg), above(Role::right_upper_leg));
    int chest = common_ancestor(arms, top >= 0 ? parent(top) : -1);
    while (chest >= 0 && placed(chest)) chest = parent(chest);  // one arm only: the collar
    const int hips = find_hips(legs, chest >= 0 ? chest : top);
    if (hips >= 0) {
      role(hips) = Role::hips;
      for (int j = parent(hips); j >= 0; j = parent(j)) role(j) = Role::root;
    }
    if (chest >= 0 && chest != hips && arms >= 0 && (hips < 0 || descends(chest, hips))) {
      role(chest) = Role::chest;
      for (int j = parent(chest); j >= 0 && !placed(j); j = parent(j)) {
        role(j) = is_helper(j) ? Role::helper : Role::spine;
      }
    }
    if (head_ >= 0) role(head_) = Role::head;
    int upward = head_ >= 0 ? parent(head_) : neck_;
    for (; upward >= 0 && !placed(upward); upward = parent(upward)) {
      // Joints between arms and head are neck, unless another joint is named neck.
      const bool spine =
          part(upward) != Part::neck && (arms < 0 || (part(upward) == Part::spine && neck_ >= 0));
      role(upward) = is_helper(upward) ? Role::helper : spine ? Role::spine : Role::neck;
    }
  }

  void assign_rest() {
    // Parents come first, so their roles are known.
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      if (placed(j)) continue;
      int above = parent(j);
      if (part(j) == Part::toes) {
        while (above >= 0 && role(above) == Role::helper) above = parent(above);
      }
      const Role from = above >= 0 ? role(above) : Role::none;
      const Role inherited = beyond(from);
      const bool metatarsal = (from == Role::left_foot || from == Role::right_foot) &&
                              part(j) == Part::unknown && leads_to_toes(j);
      if (is_helper(j) || part(j) == Part::hips || metatarsal) {
        role(j) = Role::helper;
      } else if (inherited != Role::none) {
        role(j) = inherited;
      }
    }
  }

  // Whether a child is named toes; that child is then the joint at the ball of the foot.
  bool leads_to_toes(int joint) const {
    for (const int child : children_[at(joint)]) {
      if (part(child) == Part::toes) return true;
    }
    return false;
  }

  void assign_fingers() {
    map_.fingers.assign(map_.roles.size(), {});
    for (const Role fingers : {Role::left_fingers, Role::right_fingers}) {
      const std::vector<int> joints = map_.joints(fingers);
      const std::vector<FingerJoint> places = find_fingers(skeleton_, joints);
      for (std::size_t i = 0; i < joints.size(); ++i) map_.fingers[at(joints[i])] = places[i];
    }
  }

  // The role of an unnamed joint below a joint with this role.
  static Role beyond(Role role) {
    switch (role) {
      case Role::left_hand:
      case Role::left_fingers:
        return Role::left_fingers;
      case Role::right_hand:
      case Role::right_fingers:
        return Role::right_fingers;
      case Role::left_foot:
      case Role::left_toes:
        return Role::left_toes;
      case Role::right_foot:
      case Role::right_toes:
        return Role::right_toes;
      case Role::none:
      case Role::root:
      case Role::hips:
      case Role::spine:
      case Role::chest:
        return Role::none;
      default:
        return Role::helper;
    }
  }

  const Skeleton& skeleton_;
  std::vector<JointName> names_;
  std::vector<std::vector<int>> children_;
  std::vector<int> depths_;                // [joints], 0 for the root
  std::vector<std::size_t> counts_below_;  // [joints], the joint included
  RoleMap map_;
  std::array<int, 2> hands_ = {-1, -1};  // left, right
  std::array<int, 2> feet_ = {-1, -1};
  int head_ = -1;
  int neck_ = -1;
  std::vector<char> trunk_;  // [joints]
  int limbs_ = 0;
};

}  // namespace

RoleMap roles_from_names(const Skeleton& skeleton, std::vector<JointName> names) {
  return RoleFinder(skeleton, std::move(names)).find();
}

RoleMap find_roles(const Skeleton& skeleton) {
  RoleMap map = roles_from_names(skeleton, read_joint_names(skeleton));
  const bool nothing_found = std::all_of(map.roles.begin(), map.roles.end(), [](Role role) {
    return role == Role::none || role == Role::end;
  });
  if (!nothing_found) return map;
  auto names = names_from_shape(skeleton);
  if (!names) return map;
  RoleMap by_shape = roles_from_names(skeleton, std::move(*names));
  return by_shape.humanoid ? by_shape : map;
}

}  // namespace krok
