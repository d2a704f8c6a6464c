#include "retarget/joint_mapping.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <unordered_map>

#include "core/index.h"
#include "math/quaternion.h"

namespace krok::retarget {

namespace {

// The relative position of each joint along a chain, 0 to 1, by bone lengths; by index if these are
// all 0.
std::vector<double> places_along(const Skeleton& skeleton, const std::vector<int>& chain) {
  std::vector<double> places = {0.0};
  for (std::size_t i = 1; i < chain.size(); ++i) {
    places.push_back(places.back() + (skeleton.reference[at(chain[i])].position -
                                      skeleton.reference[at(chain[i - 1])].position)
                                         .norm());
  }
  const double length = places.back();
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (length > 0) {
      places[i] /= length;
    } else if (places.size() > 1) {
      places[i] = static_cast<double>(i) / static_cast<double>(places.size() - 1);
    }
  }
  return places;
}

class RoleMapper {
 public:
  RoleMapper(const Skeleton& source, const RoleMap& source_roles, const Skeleton& target,
             const RoleMap& target_roles)
      : source_(source),
        source_roles_(source_roles),
        target_(target),
        target_roles_(target_roles),
        mapping_(target.names.size()) {}

  JointMapping map(bool without_left_fingers, bool without_right_fingers) {
    pair(Role::hips);
    map_trunk();
    for (const Role role :
         {Role::left_collar, Role::left_upper_arm, Role::left_lower_arm, Role::right_collar,
          Role::right_upper_arm, Role::right_lower_arm, Role::left_upper_leg, Role::left_lower_leg,
          Role::left_foot, Role::right_upper_leg, Role::right_lower_leg, Role::right_foot}) {
      pair(role);
    }
    for (const Role foot : {Role::left_foot, Role::right_foot}) map_toes(foot);
    map_hand(Role::left_hand, Role::left_fingers, !without_left_fingers);
    map_hand(Role::right_hand, Role::right_fingers, !without_right_fingers);
    map_between();
    return std::move(mapping_);
  }

 private:
  void pair(Role role) {
    const int to = target_roles_.joint(role);
    if (to >= 0) mapping_[at(to)].first = source_roles_.joint(role);
  }

  static int top_of_trunk(const RoleMap& roles) {
    const int chest = roles.joint(Role::chest);
    return chest >= 0 ? chest : roles.joint(Role::hips);
  }

  // The head, or the last joint of the neck.
  static int top_of_neck(const RoleMap& roles) {
    const int head = roles.joint(Role::head);
    if (head >= 0) return head;
    const std::vector<int> neck = roles.joints(Role::neck);
    return neck.empty() ? -1 : neck.back();
  }

  void map_trunk() {
    const int from_chest = top_of_trunk(source_roles_);
    const int to_chest = top_of_trunk(target_roles_);
    spread(chain_between(source_, source_roles_, source_roles_.joint(Role::hips), from_chest),
           chain_between(target_, target_roles_, target_roles_.joint(Role::hips), to_chest), true);
    spread(chain_between(source_, source_roles_, from_chest, top_of_neck(source_roles_)),
           chain_between(target_, target_roles_, to_chest, top_of_neck(target_roles_)), false);
  }

  // Maps the joints of chain `to`, without its first, to the same relative positions along `from`.
  void spread(const std::vector<int>& from, const std::vector<int>& to, bool is_trunk) {
    const std::vector<double> from_places = places_along(source_, from);
    const std::vector<double> to_places = places_along(target_, to);
    for (std::size_t i = 1; i < to.size(); ++i) {
      JointSource& entry = mapping_[at(to[i])];
      if (is_trunk) entry.along = to_places[i];
      if (from.size() == to.size()) {
        entry.first = from[i];
        continue;
      }
      std::size_t below = 0;
      while (below + 1 < from.size() && from_places[below + 1] <= to_places[i] + 1e-9) ++below;
      if (i + 1 == to.size()) below = from.size() - 1;
      entry.first = from[below];
      if (below + 1 == from.size()) continue;
      entry.second = from[below + 1];
      entry.share =
          (to_places[i] - from_places[below]) / (from_places[below + 1] - from_places[below]);
    }
  }

  void map_toes(Role foot) {
    const std::vector<int> from = first_toes(source_, source_roles_, foot);
    if (from.empty()) return;
    for (const int toe : first_toes(target_, target_roles_, foot)) {
      mapping_[at(toe)].first = from.front();
    }
  }

  void map_hand(Role hand, Role fingers, bool with_fingers) {
    const int from = palm_joint(source_, source_roles_, hand);
    const int to = target_roles_.joint(hand);
    if (from < 0 || to < 0) return;
    mapping_[at(to)].first = from;
    const int palm = palm_joint(target_, target_roles_, hand);
    if (palm != to) mapping_[at(palm)].first = from;
    if (wrist_twists(target_, target_roles_, hand)) {
      if (wrist_twists(source_, source_roles_, hand)) {
        mapping_[at(to)].first = source_roles_.joint(hand);
      } else {
        mapping_[at(to)].twists = true;
      }
    }
    if (!with_fingers) return;
    for (const int joint : target_roles_.joints(fingers)) {
      const FingerJoint place = target_roles_.fingers[at(joint)];
      if (joint != palm && place.finger != Finger::none) {
        mapping_[at(joint)].first = finger_source(fingers, place);
      }
    }
  }

  static bool has_role(const RoleMap& roles, std::size_t joint) {
    return roles.roles[joint] != Role::none && roles.roles[joint] != Role::helper;
  }

  // Joints without a role that lie between two mapped ones in both skeletons, by the same name and
  // reference orientation: those between hips and thighs of Acclaim skeletons turn by 10 degrees.
  void map_between() {
    constexpr double kAlike = 1 * kRadiansPerDegree;
    JointMapping named = map_by_names(source_, target_);
    std::vector<char> leads_on(named.size(), 0);  // to a joint that is mapped below the named ones
    for (std::size_t k = named.size(); k-- > 1;) {
      const int from = mapping_[k].first >= 0 ? mapping_[k].first : named[k].first;
      const std::size_t parent = at(target_.parents[k]);
      const bool leads = mapping_[k].first >= 0 ? mapping_[k].second < 0 : leads_on[k] != 0;
      if (leads && from > 0 && source_.parents[at(from)] == named[parent].first)
        leads_on[parent] = 1;
    }
    for (std::size_t k = 1; k < named.size(); ++k) {
      const int from = named[k].first;
      const JointSource& above = mapping_[at(target_.parents[k])];
      if (leads_on[k] == 0 || mapping_[k].first >= 0 || from <= 0 || above.second >= 0) continue;
      if (has_role(target_roles_, k) || has_role(source_roles_, at(from))) continue;
      const bool alike =
          above.first >= 0 && above.first == source_.parents[at(from)] &&
          angle_between(source_.reference_local(from).orientation,
                        target_.reference_local(static_cast<int>(k)).orientation) < kAlike;
      if (alike) mapping_[k].first = from;
    }
  }

  bool has_finger(Role fingers, Finger finger) const {
    for (std::size_t j = 0; j < source_roles_.fingers.size(); ++j) {
      if (source_roles_.roles[j] == fingers && source_roles_.fingers[j].finger == finger &&
          source_roles_.fingers[j].phalanx >= 1) {
        return true;
      }
    }
    return false;
  }

  int finger_source(Role fingers, FingerJoint place) const {
    if (place.phalanx == FingerJoint::kTip) return -1;
    if (has_finger(fingers, place.finger)) return source_roles_.finger_joint(fingers, place);
    if (place.finger == Finger::thumb || place.phalanx == FingerJoint::kMetacarpal) return -1;
    // The nearest finger that exists, the one closer to the index finger of two, or the joint for
    // all.
    constexpr std::array kFour = {Finger::index, Finger::middle, Finger::ring, Finger::little};
    const Finger wanted = place.finger == Finger::all ? Finger::middle : place.finger;
    Finger best = has_finger(fingers, Finger::all) ? Finger::all : Finger::none;
    int best_distance = 100;
    for (const Finger other : kFour) {
      const int distance = std::abs(static_cast<int>(other) - static_cast<int>(wanted));
      if (distance >= best_distance || !has_finger(fingers, other)) continue;
      best = other;
      best_distance = distance;
    }
    if (best == Finger::none) return -1;
    return source_roles_.finger_joint(fingers, {best, place.phalanx});
  }

  const Skeleton& source_;
  const RoleMap& source_roles_;
  const Skeleton& target_;
  const RoleMap& target_roles_;
  JointMapping mapping_;
};

}  // namespace

std::vector<int> chain_between(const Skeleton& skeleton, const RoleMap& roles, int bottom,
                               int top) {
  std::vector<int> chain;
  int joint = top;
  for (; joint >= 0 && joint != bottom; joint = skeleton.parents[at(joint)]) {
    if (roles.roles[at(joint)] != Role::helper) chain.push_back(joint);
  }
  if (joint != bottom) chain.clear();
  chain.push_back(bottom);
  std::reverse(chain.begin(), chain.end());
  return chain;
}

int palm_joint(const Skeleton& skeleton, const RoleMap& roles, Role hand) {
  const int wrist = roles.joint(hand);
  if (wrist < 0) return -1;
  int palm = -1;
  bool has_fingers_below = false;
  for (int j = wrist + 1; j < skeleton.joint_count(); ++j) {
    const int parent = skeleton.parents[at(j)];
    if (skeleton.end_sites[at(j)] != 0) continue;
    if (parent == palm && palm >= 0) has_fingers_below = true;
    if (parent != wrist || roles.roles[at(j)] == Role::helper) continue;
    const Finger finger = roles.fingers[at(j)].finger;
    if (finger == Finger::thumb) continue;
    if (finger != Finger::none || palm >= 0)
      return wrist;  // fingers are children of the wrist itself
    palm = j;
  }
  return palm >= 0 && has_fingers_below ? palm : wrist;
}

bool wrist_twists(const Skeleton& skeleton, const RoleMap& roles, Role hand) {
  constexpr double kFar = 0.4;  // of the way from the elbow to the wrist
  const int wrist = roles.joint(hand), palm = palm_joint(skeleton, roles, hand);
  if (wrist < 0 || palm == wrist) return false;
  const int elbow = skeleton.parents[at(wrist)];
  if (elbow < 0) return false;
  return skeleton.reference_local(palm).position.norm() >
         kFar * skeleton.reference_local(wrist).position.norm();
}

std::vector<int> first_toes(const Skeleton& skeleton, const RoleMap& roles, Role foot) {
  const Role wanted = foot == Role::left_foot ? Role::left_toes : Role::right_toes;
  std::vector<int> found;
  for (const int joint : roles.joints(wanted)) {
    int above = skeleton.parents[at(joint)];
    while (above >= 0 && roles.roles[at(above)] == Role::helper) {
      above = skeleton.parents[at(above)];
    }
    if (above >= 0 && roles.roles[at(above)] == foot) found.push_back(joint);
  }
  return found;
}

JointMapping map_by_roles(const Skeleton& source, const RoleMap& source_roles,
                          const Skeleton& target, const RoleMap& target_roles,
                          bool without_left_fingers, bool without_right_fingers) {
  return RoleMapper(source, source_roles, target, target_roles)
      .map(without_left_fingers, without_right_fingers);
}

JointMapping map_by_names(const Skeleton& source, const Skeleton& target) {
  std::unordered_map<std::string_view, int> by_name;
  for (int j = 0; j < source.joint_count(); ++j) {
    if (source.end_sites[at(j)] == 0) by_name.emplace(source.names[at(j)], j);
  }
  JointMapping mapping(target.names.size());
  for (int k = 0; k < target.joint_count(); ++k) {
    const auto found = by_name.find(target.names[at(k)]);
    if (found != by_name.end() && target.end_sites[at(k)] == 0)
      mapping[at(k)].first = found->second;
  }
  return mapping;
}

}  // namespace krok::retarget
