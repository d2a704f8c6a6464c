#include "roles/roles.h"

#include <algorithm>
#include <utility>

#include "core/index.h"
#include "roles/joint_names.h"
#include "roles/role_finder_internal.h"

namespace krok {

namespace {

// Matches names with the hierarchy: finds the ends of the limbs by name; joints that several limbs
// descend from are the trunk, joints between trunk and end are the limb.
class RoleFinder {
 public:
  RoleFinder(const Skeleton& skeleton, std::vector<JointName> names)
      : joints_(skeleton, std::move(names)), tips_(find_limb_tips(joints_)) {
    map_.roles.assign(at(joints_.count()), Role::none);
  }

  RoleMap find() {
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
      if (joints_.is_end(static_cast<int>(j))) map_.roles[j] = Role::end;
    }
    assign_fingers();
    map_.humanoid = missing_roles(map_).empty();
    return std::move(map_);
  }

 private:
  Role& role(int joint) { return map_.roles[at(joint)]; }
  bool placed(int joint) const { return joint >= 0 && map_.roles[at(joint)] != Role::none; }

  // Trunk: joints that two limbs, or a limb and the head, descend from.
  void mark_trunk() {
    const std::array tips = {tips_.hands[0], tips_.hands[1], tips_.feet[0], tips_.feet[1],
                             tips_.head >= 0 ? tips_.head : tips_.neck};
    std::vector<int> tips_below(map_.roles.size(), 0);
    for (const int tip : tips) {
      for (int j = tip < 0 ? -1 : joints_.parent(tip); j >= 0; j = joints_.parent(j)) {
        ++tips_below[at(j)];
      }
    }
    trunk_.assign(map_.roles.size(), 0);
    for (std::size_t j = 0; j < trunk_.size(); ++j) trunk_[j] = tips_below[j] >= 2 ? 1 : 0;
  }

  // The joints between the trunk and `tip`, both exclusive, by default without helpers.
  std::vector<int> limb_above(int tip, bool with_helpers = false) const {
    std::vector<int> chain;
    for (int j = joints_.parent(tip); j >= 0 && trunk_[at(j)] == 0; j = joints_.parent(j)) {
      if ((with_helpers || !joints_.is_helper(j)) && !is_middle(j)) chain.push_back(j);
    }
    std::reverse(chain.begin(), chain.end());
    return chain;
  }

  // Whether the joint is named as part of the trunk; needed for skeletons with a single limb.
  bool is_middle(int joint) const {
    const Part p = joints_.part(joint);
    return p == Part::hips || p == Part::spine || p == Part::neck || p == Part::head;
  }

  // Index in `chain` of the first joint named `wanted`, starting at `from`; -1 if there is none.
  int position(const std::vector<int>& chain, Part wanted, int from = 0) const {
    for (int i = from; i < static_cast<int>(chain.size()); ++i) {
      if (joints_.part(chain[at(i)]) == wanted) return i;
    }
    return -1;
  }

  void assign_arm(Side side) {
    const int hand = tips_.hands[side == Side::left ? 0 : 1];
    if (hand < 0) return;
    const ArmRoles& roles = kArmRoles[side == Side::left ? 0 : 1];
    const std::vector<int> chain = limb_above(hand);
    const int count = static_cast<int>(chain.size());
    int lower = position(chain, Part::lower_arm);
    int upper = position(chain, Part::upper_arm);
    if (upper < 0) upper = position(chain, Part::arm);
    if (upper >= 0 && joints_.part(chain[at(upper)]) == Part::arm && lower < 0 &&
        position(chain, Part::collar) < 0 && upper == count - 1 &&
        position(chain, Part::shoulder) >= 0) {
      lower = upper;  // shoulder, arm, hand
      upper = -1;
    }
    if (upper < 0) upper = position(chain, Part::shoulder);
    if (lower < 0 && upper >= 0) lower = position(chain, Part::arm, upper + 1);
    if (lower < 0 && count > 0 && upper != count - 1) lower = count - 1;
    if (upper < 0 && lower > 0 && joints_.part(chain[at(lower - 1)]) != Part::collar) {
      upper = lower - 1;
    }
    if (upper < 0 || lower < 0 || lower <= upper) {
      role(hand) = upper >= 0 ? roles.hand : Role::none;
      if (upper >= 0) role(chain[at(upper)]) = roles.upper;
      return;
    }
    upper = repaired_upper_arm(chain, upper, lower, hand);
    int collar = -1;
    for (int i = 0; i < upper && collar < 0; ++i) {
      if (joints_.part(chain[at(i)]) == Part::collar) collar = i;
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
    const double lower_length = joints_.distance(chain[at(lower)], hand);
    const double named = joints_.distance(chain[at(upper)], chain[at(lower)]);
    const double before = joints_.distance(chain[at(upper - 1)], chain[at(lower)]);
    const bool too_short = named < 0.8 * lower_length;
    const bool fits = before > 0.9 * lower_length && before < 1.3 * lower_length;
    return too_short && fits ? upper - 1 : upper;
  }

  void assign_leg(Side side) {
    const int foot = tips_.feet[side == Side::left ? 0 : 1];
    if (foot < 0) return;
    const LegRoles& roles = kLegRoles[side == Side::left ? 0 : 1];
    std::vector<int> chain = limb_above(foot);
    if (chain.size() == 1) add_thigh(foot, chain);
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

  // Where only one joint above the foot is named as a leg (LHipJoint, LLeg, LFoot), a helper above
  // it whose bone has the length of a thigh is one.
  void add_thigh(int foot, std::vector<int>& chain) const {
    const double shank = joints_.distance(chain.front(), foot);
    for (const int j : limb_above(foot, true)) {
      const double bone = joints_.distance(j, chain.front());
      if (!(bone > 0.6 * shank && bone < 1.6 * shank)) continue;
      chain.insert(chain.begin(), j);
      return;
    }
  }

  int find_hips(int legs, int top) const {
    const int meeting = joints_.common_ancestor(legs, top);
    // A joint named hips at or above the meeting point; without legs, any joint named hips.
    for (int j = meeting; j >= 0; j = joints_.parent(j)) {
      if (joints_.part(j) == Part::hips) return j;
    }
    return legs >= 0 ? meeting
                     : joints_.nearest([&](int j) { return joints_.part(j) == Part::hips; });
  }

  void assign_trunk() {
    const int top = tips_.head >= 0 ? tips_.head : tips_.neck;
    const auto above = [&](Role wanted) {
      const int joint = map_.joint(wanted);
      return joint < 0 ? -1 : joints_.parent(joint);
    };
    const int arms =
        joints_.common_ancestor(above(Role::left_upper_arm), above(Role::right_upper_arm));
    const int legs =
        joints_.common_ancestor(above(Role::left_upper_leg), above(Role::right_upper_leg));
    int chest = joints_.common_ancestor(arms, top >= 0 ? joints_.parent(top) : -1);
    while (chest >= 0 && placed(chest)) chest = joints_.parent(chest);  // one arm only: the collar
    const int hips = find_hips(legs, chest >= 0 ? chest : top);
    if (hips >= 0) {
      role(hips) = Role::hips;
      for (int j = joints_.parent(hips); j >= 0; j = joints_.parent(j)) role(j) = Role::root;
    }
    if (chest >= 0 && chest != hips && arms >= 0 && (hips < 0 || joints_.descends(chest, hips))) {
      role(chest) = Role::chest;
      for (int j = joints_.parent(chest); j >= 0 && !placed(j); j = joints_.parent(j)) {
        role(j) = joints_.is_helper(j) ? Role::helper : Role::spine;
      }
    }
    if (tips_.head >= 0) role(tips_.head) = Role::head;
    int upward = tips_.head >= 0 ? joints_.parent(tips_.head) : tips_.neck;
    for (; upward >= 0 && !placed(upward); upward = joints_.parent(upward)) {
      // Joints between arms and head are neck, unless another joint is named neck.
      const bool spine = joints_.part(upward) != Part::neck &&
                         (arms < 0 || (joints_.part(upward) == Part::spine && tips_.neck >= 0));
      role(upward) = joints_.is_helper(upward) ? Role::helper : spine ? Role::spine : Role::neck;
    }
  }

  void assign_rest() {
    // Parents come first, so their roles are known.
    for (int j = 0; j < joints_.count(); ++j) {
      if (placed(j)) continue;
      int above = joints_.parent(j);
      if (joints_.part(j) == Part::toes) {
        while (above >= 0 && role(above) == Role::helper) above = joints_.parent(above);
      }
      const Role from = above >= 0 ? role(above) : Role::none;
      const Role inherited = beyond(from);
      // Beside or above the toes: a metatarsal, a heel, the joint of a mesh, another foot.
      const bool beside = above >= 0 && leads_to_toes(above);
      const bool of_foot = (from == Role::left_foot || from == Role::right_foot) &&
                           ((joints_.part(j) == Part::unknown && (leads_to_toes(j) || beside)) ||
                            (joints_.part(j) == Part::foot && beside && !leads_to_toes(j)));
      if (joints_.is_helper(j) || joints_.part(j) == Part::hips || of_foot) {
        role(j) = Role::helper;
      } else if (inherited != Role::none) {
        role(j) = inherited;
      }
    }
  }

  // Whether a child is named toes; that child is then the joint at the ball of the foot.
  bool leads_to_toes(int joint) const {
    for (const int child : joints_.children(joint)) {
      if (joints_.part(child) == Part::toes) return true;
    }
    return false;
  }

  void assign_fingers() {
    map_.fingers.assign(map_.roles.size(), {});
    for (const Role fingers : {Role::left_fingers, Role::right_fingers}) {
      const std::vector<int> joints = map_.joints(fingers);
      const std::vector<FingerJoint> places = find_fingers(joints_.skeleton(), joints);
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

  NamedJoints joints_;
  LimbTips tips_;
  RoleMap map_;
  std::vector<char> trunk_;  // [joints]
  int limbs_ = 0;
};

}  // namespace

RoleMap roles_from_names(const Skeleton& skeleton, std::vector<JointName> names) {
  return RoleFinder(skeleton, std::move(names)).find();
}

namespace {

bool is_of_limb(Role role) {
  return role >= Role::left_collar && role <= Role::right_toes;
}

}  // namespace

RoleMap find_roles(const Skeleton& skeleton) {
  RoleMap map = roles_from_names(skeleton, read_joint_names(skeleton));
  if (map.humanoid) return map;
  auto names = names_from_shape(skeleton);
  if (!names) return map;
  RoleMap by_shape = roles_from_names(skeleton, std::move(*names));
  // The shape must not contradict a limb that has a name.
  const bool agrees = std::ranges::equal(map.roles, by_shape.roles, [](Role name, Role shape) {
    return !is_of_limb(name) || name == shape;
  });
  return by_shape.humanoid && agrees ? by_shape : map;
}

}  // namespace krok
