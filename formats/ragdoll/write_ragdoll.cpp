#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "core/index.h"
#include "core/numbers.h"
#include "formats/json/located_json.h"
#include "formats/ragdoll/ragdoll_format.h"

namespace krok::ragdoll_file {

namespace {

using ragdoll::Body;
using ragdoll::JointKind;
using ragdoll::JointRule;
using ragdoll::Shape;

std::string list_of(const Vec3& v) {
  return fmt::format("[{}, {}, {}]", shortest(v.x()), shortest(v.y()), shortest(v.z()));
}

std::string list_of(const Quat& q) {
  return fmt::format("[{}, {}, {}, {}]", shortest(q.x()), shortest(q.y()), shortest(q.z()),
                     shortest(q.w()));
}

std::string end_of(double value, double unit) {
  if (!std::isfinite(value)) return "null";
  if (unit == 1) return shortest(value);
  return shortest(std::round(value / unit * 1e6) / 1e6);
}

std::string range_of(double min, double max, double unit) {
  return fmt::format("[{}, {}]", end_of(min, unit), end_of(max, unit));
}

std::string shape_of(const Shape& shape) {
  switch (shape.kind) {
    case Shape::Kind::box:
      return fmt::format("\"shape\": \"box\", \"size\": {}", list_of(Vec3(2 * shape.half)));
    case Shape::Kind::capsule:
      return fmt::format("\"shape\": \"capsule\", \"radius\": {}, \"length\": {}",
                         shortest(shape.radius), shortest(2 * shape.half_length));
    case Shape::Kind::sphere:
      break;
  }
  return fmt::format("\"shape\": \"sphere\", \"radius\": {}", shortest(shape.radius));
}

// What is simulated says nothing, as in files from before there were modes.
std::string mode_of(const Body& body) {
  if (body.mode == ragdoll::BodyMode::simulated) return {};
  std::string text = fmt::format(",\n     \"mode\": \"{}\"", body_mode_name(body.mode));
  if (body.mode == ragdoll::BodyMode::powered) {
    text += fmt::format(", \"strength\": {}", shortest(body.strength));
  }
  return text;
}

std::string text_of(const Body& body, const Skeleton& skeleton) {
  return fmt::format(
      "    {{\"name\": {}, \"joint\": {},\n     {}, \"mass\": {},\n     \"offset\": {}, "
      "\"rotation\": {}{}}}",
      json::in_quotes(body.name), json::in_quotes(skeleton.names[at(body.joint)]),
      shape_of(body.shape), shortest(body.mass), list_of(body.to_joint.position),
      list_of(body.to_joint.orientation), mode_of(body));
}

std::string turn_of(const ik::JointLimit& turn) {
  if (turn.kind == ik::JointLimit::Kind::locked) return "\"locked\"";
  if (turn.kind != ik::JointLimit::Kind::cone) return "\"free\"";
  const auto swing = [&](std::size_t i) {
    return range_of(turn.min_swing[i], turn.max_swing[i], kRadiansPerDegree);
  };
  return fmt::format(
      "{{\"axis\": {}, \"swing_axis\": {},\n       \"swing\": [{}, {}], \"twist\": {},\n       "
      "\"zero\": {}}}",
      list_of(turn.axis), list_of(turn.swing_axis), swing(0), swing(1),
      range_of(turn.min_twist, turn.max_twist, kRadiansPerDegree), list_of(turn.zero));
}

std::string text_of(const JointRule& rule, const std::vector<Body>& bodies) {
  const auto name = [&](int body) {
    return body < 0 ? std::string("null") : json::in_quotes(bodies[at(body)].name);
  };
  std::string text = fmt::format("    {{\"kind\": \"{}\", \"parent\": {}, \"child\": {}",
                                 joint_kind_name(rule.kind), name(rule.parent), name(rule.child));
  if (rule.anchor != Vec3::Zero()) text += ", \"anchor\": " + list_of(rule.anchor);
  if (rule.other_end) text += ", \"parent_anchor\": " + list_of(*rule.other_end);
  if (rule.kind == JointKind::revolute || rule.kind == JointKind::prismatic) {
    text += ",\n     \"axis\": " + list_of(rule.axis);
  }
  if (rule.kind == JointKind::revolute) text += ", \"zero\": " + list_of(rule.zero);
  if (rule.kind == JointKind::revolute || rule.kind == JointKind::prismatic ||
      rule.kind == JointKind::distance) {
    const double unit = rule.kind == JointKind::revolute ? kRadiansPerDegree : 1;
    text += ", \"range\": " + range_of(rule.range.min, rule.range.max, unit);
  }
  if (rule.kind == JointKind::spherical || rule.kind == JointKind::six_dof) {
    text += ",\n     \"turn\": " + turn_of(rule.turn);
  }
  if (rule.kind == JointKind::six_dof) {
    const auto slide = [&](std::size_t i) {
      return range_of(rule.slide[i].min, rule.slide[i].max, 1);
    };
    text += fmt::format(",\n     \"slide\": [{}, {}, {}]", slide(0), slide(1), slide(2));
  }
  text += ",\n     \"limit\": ";
  text += rule.soft ? fmt::format("\"soft\", \"stiffness\": {}, \"damping\": {}",
                                  shortest(rule.stiffness), shortest(rule.damping))
                    : "\"hard\"";
  return text + fmt::format(", \"friction\": {}}}", shortest(rule.friction));
}

}  // namespace

std::string write(const ragdoll::Ragdoll& what, const Skeleton& skeleton) {
  std::vector<std::string> bodies, joints;
  for (const Body& body : what.bodies) bodies.push_back(text_of(body, skeleton));
  for (const JointRule& rule : what.joints) joints.push_back(text_of(rule, what.bodies));
  return fmt::format(
      "{{\n  \"schema\": \"krok.ragdoll/1\",\n  \"bodies\": [\n{}\n  ],\n  \"joints\": [\n{}\n  "
      "]\n}}\n",
      fmt::join(bodies, ",\n"), fmt::join(joints, ",\n"));
}

}  // namespace krok::ragdoll_file
