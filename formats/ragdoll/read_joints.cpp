#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "core/nearest_name.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/ragdoll/reader_internal.h"

namespace krok::ragdoll_file {

namespace {
constexpr double kMaxStrength = 1e9;  // N m/rad
}

using ik::JointLimit;
using json::Value;
using ragdoll::Body;
using ragdoll::JointKind;
using ragdoll::JointRule;
using Kind = Value::Kind;

Result<int> Reader::body_named(const Value& name) const {
  const auto found = std::ranges::find(read_.bodies, name.text, &Body::name);
  if (found != read_.bodies.end()) return static_cast<int>(found - read_.bodies.begin());
  std::vector<std::string> names;
  for (const Body& body : read_.bodies) names.push_back(body.name);
  return json::error_at(text_, name.offset, "ragdoll-body",
                        fmt::format("there is no body '{}'", shown(name.text)),
                        nearest_hint(name.text, names));
}

Status Reader::read_ends(const Value& item, JointRule& rule) const {
  const auto child_name = in_.get(item, "a joint", "child", Kind::string);
  if (!child_name) return child_name.error();
  const auto child = body_named(**child_name);
  if (!child) return child.error();
  rule.child = *child;
  rule.parent = read_.bodies[at(rule.child)].parent;
  const Value* const above = item.find("parent");
  if (above == nullptr) return {};
  if (above->kind == Kind::null) {
    rule.parent = -1;
    return {};
  }
  const auto name = in_.get(item, "a joint", "parent", Kind::string);
  if (!name) return name.error();
  const auto parent = body_named(**name);
  if (!parent) return parent.error();
  rule.parent = *parent;
  if (rule.parent == rule.child) return in_.wrong(**name, "the joint ties a body to itself");
  return {};
}

// A range that the joint's kind does not use must not be taken for one that holds.
Status Reader::check_keys(const Value& item, const std::string& what, const JointRule& rule) const {
  const bool hinge = rule.kind == JointKind::revolute, slides = rule.kind == JointKind::prismatic;
  const bool rope = rule.kind == JointKind::distance, six = rule.kind == JointKind::six_dof;
  const std::pair<const char*, bool> used[] = {{"axis", hinge || slides},
                                               {"zero", hinge},
                                               {"range", hinge || slides || rope},
                                               {"turn", six || rule.kind == JointKind::spherical},
                                               {"slide", six},
                                               {"parent_anchor", rope},
                                               {"stiffness", rule.soft},
                                               {"damping", rule.soft}};
  for (const auto& [key, allowed] : used) {
    if (const Value* value = item.find(key); value != nullptr && !allowed) {
      return in_.wrong(*value, fmt::format("{} has \"{}\", which is not used", what, key),
                       "revolute and prismatic have axis and range, distance a range, spherical "
                       "and six_dof a turn, six_dof a slide; soft limits stiffness and damping");
    }
  }
  return {};
}

Status Reader::read_cone(const Value& cone, const std::string& what, JointLimit& turn) const {
  turn.kind = JointLimit::Kind::cone;
  Status status = in_.only(cone, what, {"axis", "swing_axis", "swing", "twist", "zero", "comment"});
  if (status) status = values_.direction(cone, what, "axis", turn.axis);
  if (status) status = values_.direction(cone, what, "swing_axis", turn.swing_axis);
  if (status) status = values_.rotation(cone, what, "zero", turn.zero);
  if (!status) return status;
  const double along = turn.axis.dot(turn.swing_axis);
  if (!(std::abs(along) < 0.01)) {
    return in_.wrong(
        *cone.find("swing_axis"),
        fmt::format("\"swing_axis\" of {} is not perpendicular to its \"axis\"", what));
  }
  if (std::abs(along) > 1e-14) {
    turn.swing_axis = (turn.swing_axis - along * turn.axis).normalized();
  }
  const auto swing = in_.get(cone, what, "swing", Kind::array);
  if (!swing) return swing.error();
  if ((*swing)->items.size() != 2) {
    return in_.wrong(**swing, fmt::format("\"swing\" of {} must be two ranges", what),
                     "write [[-30, 45], [-20, 20]]");
  }
  for (std::size_t i = 0; i < 2; ++i) {
    const Value& item = (*swing)->items[i];
    const auto range = values_.range(item, what, "swing", kRadiansPerDegree, -kPi, kPi);
    if (!range) return range.error();
    if (range->min > 0 || range->max < 0) {
      return in_.wrong(item, fmt::format("\"swing\" of {} does not contain 0", what),
                       "turn \"zero\" into the middle of the range");
    }
    turn.min_swing[i] = std::max(-kPi, range->min);
    turn.max_swing[i] = std::min(kPi, range->max);
  }
  const Value* const twist = cone.find("twist");
  if (twist == nullptr) return {};
  const auto range = values_.range(*twist, what, "twist", kRadiansPerDegree, -kPi, kPi);
  if (!range) return range.error();
  turn.min_twist = std::max(-kPi, range->min);
  turn.max_twist = std::min(kPi, range->max);
  return {};
}

Status Reader::read_turn(const Value& item, const std::string& what, JointRule& rule) const {
  const Value* const turn = item.find("turn");
  if (turn == nullptr) return {};
  if (turn->kind == Kind::object) return read_cone(*turn, what, rule.turn);
  const auto word = in_.choice(item, what, "turn", {"free", "locked"});
  if (!word) return word.error();
  rule.turn.kind = **word == 0 ? JointLimit::Kind::free : JointLimit::Kind::locked;
  return {};
}

Status Reader::read_slides(const Value& item, const std::string& what, JointRule& rule) const {
  rule.slide.fill({0, 0});
  const auto list = in_.find(item, what, "slide", Kind::array);
  if (!list) return list.error();
  if (*list == nullptr) return {};
  if ((*list)->items.size() != 3) {
    return in_.wrong(**list, fmt::format("\"slide\" of {} must be three ranges", what),
                     "write [[0, 0], [-0.1, 0.1], [0, 0]]");
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const auto range = values_.range((*list)->items[i], what, "slide", 1, -kMaxSize, kMaxSize);
    if (!range) return range.error();
    if (range->min > 0 || range->max < 0) {
      return in_.wrong((*list)->items[i], fmt::format("\"slide\" of {} does not contain 0", what));
    }
    rule.slide[i] = *range;
  }
  return {};
}

Status Reader::read_strength(const Value& item, const std::string& what, JointRule& rule) const {
  const std::pair<const char*, double&> strengths[] = {
      {"stiffness", rule.stiffness}, {"damping", rule.damping}, {"friction", rule.friction}};
  for (const auto& [key, value] : strengths) {
    const Value* const given = item.find(key);
    if (given == nullptr) continue;
    const auto number = in_.within(*given, fmt::format("\"{}\" of {}", key, what), 0, kMaxStrength);
    if (!number) return number.error();
    value = *number;
  }
  return {};
}

// An animated body is where the motion has it, whatever ties it elsewhere.
Status Reader::check_animated(const Value& item, const std::string& what,
                              const JointRule& rule) const {
  const auto animated = [&](int body) {
    return body >= 0 && read_.bodies[at(body)].mode == ragdoll::BodyMode::animated;
  };
  if (skeleton_ == nullptr || rule.kind == JointKind::distance || !animated(rule.child) ||
      animated(rule.parent))
    return {};
  return in_.wrong(*item.find("child"),
                   fmt::format("{} ties an animated body to what is not animated", what),
                   "leave out the joint, or make its child \"powered\"");
}

Status Reader::read_joint(const Value& item) {
  Status status =
      in_.only(item, "a joint",
               {"kind", "parent", "child", "anchor", "parent_anchor", "axis", "zero", "range",
                "turn", "slide", "limit", "stiffness", "damping", "friction", "comment"});
  if (!status) return status;
  if (const auto named = in_.get(item, "a joint", "kind", Kind::string); !named) {
    return named.error();
  }
  const auto kind =
      in_.choice(item, "a joint", "kind",
                 {"fixed", "distance", "spherical", "revolute", "prismatic", "six_dof"});
  if (!kind) return kind.error();
  JointRule rule;
  rule.kind = static_cast<JointKind>(**kind);
  if (status = read_ends(item, rule); !status) return status;
  const std::string what =
      fmt::format("the joint of '{}'", shown(read_.bodies[at(rule.child)].name));
  const auto limit = in_.choice(item, what, "limit", {"hard", "soft"});
  if (!limit) return limit.error();
  rule.soft = *limit && **limit == 1;
  status = check_keys(item, what, rule);
  if (status) status = check_animated(item, what, rule);
  if (status) status = values_.vector(item, what, "anchor", false, rule.anchor);
  if (status && item.find("parent_anchor") != nullptr) {
    rule.other_end = Vec3::Zero();
    status = values_.vector(item, what, "parent_anchor", true, *rule.other_end);
  }
  const bool hinge = rule.kind == JointKind::revolute;
  if (status && (hinge || rule.kind == JointKind::prismatic)) {
    status = values_.direction(item, what, "axis", rule.axis);
  }
  // Where no zero is given, the reference pose has it.
  if (hinge && skeleton_ != nullptr && rule.parent >= 0) {
    const auto turn = [&](int body) {
      return skeleton_->reference[at(read_.bodies[at(body)].joint)].orientation;
    };
    rule.zero = (turn(rule.parent).conjugate() * turn(rule.child)).normalized();
  }
  if (status) status = values_.rotation(item, what, "zero", rule.zero);
  if (status) status = read_turn(item, what, rule);
  if (status) status = read_slides(item, what, rule);
  if (status) status = read_strength(item, what, rule);
  if (!status) return status;
  if (const Value* const given = item.find("range"); given != nullptr) {
    const bool rope = rule.kind == JointKind::distance;
    const auto range = values_.range(*given, what, "range", hinge ? kRadiansPerDegree : 1,
                                     rope    ? 0
                                     : hinge ? -2 * kPi
                                             : -kMaxSize,
                                     hinge ? 2 * kPi : kMaxSize);
    if (!range) return range.error();
    rule.range = *range;
  }
  if (rule.kind == JointKind::distance) rule.range.min = std::max(0.0, rule.range.min);
  read_.joints.push_back(std::move(rule));
  return {};
}

}  // namespace krok::ragdoll_file
