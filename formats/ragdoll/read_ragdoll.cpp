#include <fmt/format.h>

#include <algorithm>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/json/fields.h"
#include "formats/ragdoll/ragdoll_format.h"

namespace krok::ragdoll_file {

namespace {

using ik::JointLimit;
using json::Given;
using ragdoll::Body;
using ragdoll::BodyMode;
using ragdoll::JointKind;
using ragdoll::JointRule;
using ragdoll::Ragdoll;
using ragdoll::Range;
using ragdoll::Shape;
using JsonKind = json::Value::Kind;

constexpr double kMaxSize = 100;      // metres
constexpr double kMaxMass = 1e5;      // kg
constexpr double kMaxStrength = 1e9;  // N m/rad

const std::string kRangeSchema =
    R"({"description": "min and max; null does not limit", "type": "array", "minItems": 2, )"
    R"("maxItems": 2, "items": {"type": ["number", "null"]}})";

// [min, max] in `unit`, both within lowest and highest; null does not limit.
Status read_range(const Given& given, double unit, double lowest, double highest, Range& range) {
  const auto& items = given.value.items;
  bool good = given.value.kind == JsonKind::array && items.size() == 2;
  range = {};
  for (std::size_t i = 0; good && i < 2; ++i) {
    if (items[i].kind == JsonKind::null) continue;
    good = items[i].kind == JsonKind::number && std::isfinite(items[i].number);
    (i == 0 ? range.min : range.max) = items[i].number * unit;
  }
  if (!good) {
    return given.wrong(fmt::format("{} must be a min and a max", given.name()),
                       "write [-30, 45], or null for an end that does not limit");
  }
  if (range.min > range.max) {
    return given.wrong(fmt::format("{} has its min {} above its max {}", given.name(),
                                   readable(range.min / unit), readable(range.max / unit)));
  }
  const auto outside = [&](double end) {
    return std::isfinite(end) && (end < lowest - 1e-9 || end > highest + 1e-9);
  };
  if (!outside(range.min) && !outside(range.max)) return {};
  return given.wrong(fmt::format("{} exceeds {} to {}", given.name(), readable(lowest / unit),
                                 readable(highest / unit)));
}

// A list of ranges, each of which contains 0.
Status read_ranges(const Given& given, double unit, double most, std::span<Range> ranges,
                   const char* count, std::string hint, std::string zero_hint) {
  if (Status status = given.is(JsonKind::array); !status) return status;
  if (given.value.items.size() != ranges.size()) {
    return given.wrong(fmt::format("{} must be {} ranges", given.name(), count), std::move(hint));
  }
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const Given item{given.source, given.value.items[i], given.key, given.what};
    if (Status status = read_range(item, unit, -most, most, ranges[i]); !status) return status;
    if (ranges[i].min > 0 || ranges[i].max < 0) {
      return item.wrong(fmt::format("{} does not contain 0", given.name()), zero_hint);
    }
  }
  return {};
}

Status read_swing(const Given& given, JointLimit& to) {
  std::array<Range, 2> ranges;
  Status status =
      read_ranges(given, kRadiansPerDegree, kPi, ranges, "two", "write [[-30, 45], [-20, 20]]",
                  "turn \"zero\" into the middle of the range");
  for (std::size_t i = 0; i < 2; ++i) {
    to.min_swing[i] = std::max(-kPi, ranges[i].min);
    to.max_swing[i] = std::min(kPi, ranges[i].max);
  }
  return status;
}

Status read_twist(const Given& given, JointLimit& to) {
  Range range;
  Status status = read_range(given, kRadiansPerDegree, -kPi, kPi, range);
  to.min_twist = std::max(-kPi, range.min);
  to.max_twist = std::min(kPi, range.max);
  return status;
}

Status check_perpendicular(const Given& given, JointLimit& to) {
  const double along = to.axis.dot(to.swing_axis);
  if (!(std::abs(along) < 0.01)) {
    return given.member("swing_axis")
        .wrong(
            fmt::format("\"swing_axis\" of {} is not perpendicular to its \"axis\"", given.what));
  }
  if (std::abs(along) > 1e-14) to.swing_axis = (to.swing_axis - along * to.axis).normalized();
  return {};
}

// A word, or a cone.
json::Kind<JointLimit> turn() {
  json::Object<JointLimit> cone;
  cone.field("axis", &JointLimit::axis, json::direction()).required();
  cone.field("swing_axis", &JointLimit::swing_axis, json::direction()).required();
  cone.check(check_perpendicular);
  cone.field("swing", json::kind<JointLimit>(json::schema_of_list(kRangeSchema, 2, 2), read_swing))
      .required();
  cone.field("twist", json::kind<JointLimit>(kRangeSchema, read_twist));
  cone.field("zero", &JointLimit::zero, json::rotation(), "x, y, z, w").comment();
  const auto word = json::choice<JointLimit::Kind>(
      {{"free", JointLimit::Kind::free}, {"locked", JointLimit::Kind::locked}});
  return json::kind<JointLimit>(json::schema_of_either({word.schema(), cone.schema()}),
                                [word, cone](const Given& given, JointLimit& to) {
                                  if (given.value.kind != JsonKind::object) {
                                    return word.read(given, &to.kind);
                                  }
                                  to.kind = JointLimit::Kind::cone;
                                  return cone.read(given.as(given.what), &to);
                                });
}

Status read_size(const Given& given, Vec3& half) {
  if (Status status = json::vector().read(given, &half); !status) return status;
  if (!(half.minCoeff() >= 1e-4 && half.maxCoeff() <= kMaxSize)) {
    return given.wrong(fmt::format("{} is not within 0.1 mm and 100 m", given.name()));
  }
  half *= 0.5;
  return {};
}

Status read_length(const Given& given, double& half) {
  Status status = json::number(0, kMaxSize).read(given, &half);
  half *= 0.5;
  return status;
}

json::Object<Body> body_table() {
  const auto shape = [](auto member) {
    return [member](Body & body) -> auto& {
      return body.shape.*member;
    };
  };
  json::Object<Body> body;
  body.unused("{0} has \"{1}\", which its shape does not use",
              "a box has a size, a capsule radius and length, a sphere a radius");
  body.field("name", &Body::name, json::text()).required();
  body.check([](const Given& given, const Body& of) {
    return !of.name.empty() && of.name.size() <= 200
               ? Status()
               : given.member("name").wrong("the name of a body is empty or longer than 200 bytes");
  });
  body.described([](const Body& of) { return fmt::format("body '{}'", shown(of.name)); });
  body.field("joint",
             json::kind<Body>(R"({"type": "string"})",
                              [](const Given& given, Body&) { return given.is(JsonKind::string); }),
             "of the skeleton")
      .required();
  body.field("shape", shape(&Shape::kind),
             json::choice<Shape::Kind>({{"box", Shape::Kind::box},
                                        {"capsule", Shape::Kind::capsule},
                                        {"sphere", Shape::Kind::sphere}}))
      .required();
  body.field("size", shape(&Shape::half), json::kind<Vec3>(json::schema_of_numbers(3), read_size),
             "metres")
      .required()
      .with("shape", {"box"});
  body.field("radius", shape(&Shape::radius), json::number(1e-4, kMaxSize))
      .required()
      .with("shape", {"capsule", "sphere"});
  body.field("length", shape(&Shape::half_length),
             json::kind<double>(json::number(0, kMaxSize).schema(), read_length),
             "between the centres of its caps")
      .required()
      .with("shape", {"capsule"});
  body.field(
      "offset", [](Body& of) -> Vec3& { return of.to_joint.position; }, json::vector());
  body.check([](const Given& given, const Body& of) {
    return of.to_joint.position.norm() <= kMaxSize
               ? Status()
               : given.member("offset").wrong(
                     fmt::format("{} is over 100 m from its joint", given.what));
  });
  body.field(
      "rotation", [](Body& of) -> Quat& { return of.to_joint.orientation; }, json::rotation(),
      "x, y, z, w");
  body.field("mass", &Body::mass, json::number(1e-3, kMaxMass), "kg").required();
  body.field("mode", &Body::mode,
             json::choice<BodyMode>({{"simulated", BodyMode::simulated},
                                     {"animated", BodyMode::animated},
                                     {"powered", BodyMode::powered}}));
  body.check([](const Given& given, const Body& of) -> Status {
    if (!given.has("strength") || of.mode == BodyMode::powered) return {};
    return given.member("strength")
        .wrong(fmt::format("{} has \"strength\", but is not powered", given.what),
               "add \"mode\": \"powered\"");
  });
  return body.field("strength", &Body::strength, json::number(0, 1)).comment();
}

struct File {
  const Skeleton* skeleton;
  std::vector<Body> bodies = {};  // those that have been read

  // The skeleton's joint, and the body above it.
  Status find_joint(const Given& name, const std::string& what, Body& body) const {
    const std::string& joint = name.value.text;
    body.joint = skeleton->find(joint);
    if (body.joint < 0) {
      return name.error("joint", fmt::format("the skeleton has no joint '{}'", shown(joint)),
                        nearest_hint(joint, skeleton->names));
    }
    const auto twin = std::ranges::find(bodies, body.joint, &Body::joint);
    if (twin != bodies.end()) {
      return name.error(
          "joint", fmt::format("'{}' has the body '{}' already", shown(joint), shown(twin->name)),
          "a joint has one body");
    }
    for (int j = skeleton->parents[at(body.joint)]; j >= 0 && body.parent < 0;
         j = skeleton->parents[at(j)]) {
      const auto above = std::ranges::find(bodies, j, &Body::joint);
      if (above != bodies.end()) body.parent = static_cast<int>(above - bodies.begin());
    }
    if (body.parent >= 0 || bodies.empty()) return {};
    return name.error(
        "joint", fmt::format("no body above {} is listed before it", what),
        fmt::format("'{}' is the root: all others are of joints below its own, each after the body "
                    "above it",
                    shown(bodies.front().name)));
  }

  // A body among those before it.
  Status add_body(const Given& given, Body& body) {
    const std::string what = fmt::format("body '{}'", shown(body.name));
    if (std::ranges::find(bodies, body.name, &Body::name) != bodies.end()) {
      return given.member("name").wrong(fmt::format("there are two bodies '{}'", shown(body.name)));
    }
    if (skeleton != nullptr) {
      Status status = find_joint(given.member("joint"), what, body);
      if (!status) return status;
    }
    // The motion leads what is animated.
    if (body.mode == BodyMode::animated && body.parent >= 0 &&
        bodies[at(body.parent)].mode != BodyMode::animated) {
      return given.member("mode").wrong(
          fmt::format("{} is animated, but '{}', the body above it, is not", what,
                      shown(bodies[at(body.parent)].name)),
          "animate all bodies from the root to it, or make it \"powered\"");
    }
    bodies.push_back(body);
    return {};
  }

  Status read_end(const Given& given, int& to) const {
    if (Status status = given.is(JsonKind::string); !status) return status;
    const auto found = std::ranges::find(bodies, given.value.text, &Body::name);
    to = static_cast<int>(found - bodies.begin());
    if (found != bodies.end()) return {};
    std::vector<std::string> names;
    for (const Body& body : bodies) names.push_back(body.name);
    return given.error("body", fmt::format("there is no body '{}'", shown(given.value.text)),
                       nearest_hint(given.value.text, names));
  }

  Status check_ends(const Given& given, JointRule& rule) const {
    if (!given.has("parent")) rule.parent = bodies[at(rule.child)].parent;
    if (rule.parent == rule.child) {
      return given.member("parent").wrong("the joint ties a body to itself");
    }
    // Where no zero is given, the reference pose has it.
    if (rule.kind == JointKind::revolute && skeleton != nullptr && rule.parent >= 0) {
      const auto turn_of = [&](int body) {
        return skeleton->reference[at(bodies[at(body)].joint)].orientation;
      };
      rule.zero = (turn_of(rule.parent).conjugate() * turn_of(rule.child)).normalized();
    }
    rule.slide.fill({0, 0});
    return {};
  }

  // An animated body is where the motion has it, whatever ties it elsewhere.
  Status check_animated(const Given& given, const JointRule& rule) const {
    const auto animated = [&](int body) {
      return body >= 0 && bodies[at(body)].mode == BodyMode::animated;
    };
    if (skeleton == nullptr || rule.kind == JointKind::distance || !animated(rule.child) ||
        animated(rule.parent)) {
      return {};
    }
    return given.member("child").wrong(
        fmt::format("{} ties an animated body to what is not animated", given.what),
        "leave out the joint, or make its child \"powered\"");
  }

  static Status read_rule_range(const Given& given, JointRule& rule) {
    const bool rope = rule.kind == JointKind::distance, hinge = rule.kind == JointKind::revolute;
    const double most = hinge ? 2 * kPi : kMaxSize;
    Status status =
        read_range(given, hinge ? kRadiansPerDegree : 1, rope ? 0 : -most, most, rule.range);
    return status;
  }

  json::Object<JointRule> joint_table() const {
    json::Object<JointRule> joint;
    joint.unused("{0} has \"{1}\", which is not used",
                 "revolute and prismatic have axis and range, distance a range, spherical and "
                 "six_dof a turn, six_dof a slide; soft limits stiffness and damping");
    const auto end =
        json::kind<int>(R"({"description": "a body", "type": "string"})",
                        [this](const Given& given, int& to) { return read_end(given, to); });
    joint
        .field("kind", &JointRule::kind,
               json::choice<JointKind>({{"fixed", JointKind::fixed},
                                        {"distance", JointKind::distance},
                                        {"spherical", JointKind::spherical},
                                        {"revolute", JointKind::revolute},
                                        {"prismatic", JointKind::prismatic},
                                        {"six_dof", JointKind::six_dof}}))
        .required();
    joint.field("parent", &JointRule::parent,
                json::kind<int>(R"({"description": "a body", "type": ["string", "null"]})",
                                [end](const Given& given, int& to) {
                                  return given.value.kind == JsonKind::null ? Status()
                                                                            : end.read(given, &to);
                                }));
    joint.field("child", &JointRule::child, end).required();
    joint.check([this](const Given& given, JointRule& to) { return check_ends(given, to); });
    joint.described([this](const JointRule& of) {
      return fmt::format("the joint of '{}'", shown(bodies[at(of.child)].name));
    });
    joint.check([this](const Given& given, JointRule& to) { return check_animated(given, to); });
    joint.field("anchor", &JointRule::anchor, json::vector());
    joint.field("parent_anchor", &JointRule::other_end, json::vector()).with("kind", {"distance"});
    joint.field("axis", &JointRule::axis, json::direction())
        .required()
        .with("kind", {"revolute", "prismatic"});
    joint.field("zero", &JointRule::zero, json::rotation(), "x, y, z, w")
        .with("kind", {"revolute"});
    joint.field("range", json::kind<JointRule>(kRangeSchema, read_rule_range))
        .with("kind", {"revolute", "prismatic", "distance"});
    joint.check([](const Given&, JointRule& to) {
      if (to.kind == JointKind::distance) to.range.min = std::max(0.0, to.range.min);
      return Status();
    });
    joint.field("turn", &JointRule::turn, turn()).with("kind", {"spherical", "six_dof"});
    joint
        .field("slide", json::kind<JointRule>(json::schema_of_list(kRangeSchema, 3, 3),
                                              [](const Given& given, JointRule& to) {
                                                return read_ranges(
                                                    given, 1, kMaxSize, to.slide, "three",
                                                    "write [[0, 0], [-0.1, 0.1], [0, 0]]", {});
                                              }))
        .with("kind", {"six_dof"});
    const auto strength = json::number(0, kMaxStrength);
    joint.field("limit", &JointRule::soft, json::choice<bool>({{"hard", false}, {"soft", true}}));
    joint.field("stiffness", &JointRule::stiffness, strength).with("limit", {"soft"});
    joint.field("damping", &JointRule::damping, strength).with("limit", {"soft"});
    return joint.field("friction", &JointRule::friction, strength).comment();
  }

  // Each body but the root is tied to the one above it, else it would leave its joint's place.
  Status check_ties(const Given& root, const Ragdoll& of) const {
    for (std::size_t b = 1; b < bodies.size() && skeleton != nullptr; ++b) {
      const bool tied = std::ranges::any_of(of.joints, [&](const JointRule& rule) {
        return rule.child == static_cast<int>(b) && rule.parent == bodies[b].parent;
      });
      if (tied) continue;
      const Given body{root.source, root.value.find("bodies")->items[b], {}, {}};
      return body.error(
          "body",
          fmt::format("no joint ties '{}' to '{}', the body above it", shown(bodies[b].name),
                      shown(bodies[at(bodies[b].parent)].name)),
          "add one to \"joints\"");
    }
    return {};
  }

  json::Object<Ragdoll> table() {
    json::Object<Ragdoll> file;
    file.file("krok.ragdoll/1",
              "Rigid bodies of a skeleton and the joints between them (krok.ragdoll/1)");
    file.comment();
    file.field("bodies", &Ragdoll::bodies,
               json::list<Body>(json::object(body_table()), {"a body", 1, 1000},
                                [this](const Given& given, std::vector<Body>& all) {
                                  return add_body(given, all.back());
                                }))
        .required();
    file.field("joints", &Ragdoll::joints,
               json::list<JointRule>(json::object(joint_table()), {"a joint", 0, 4000}))
        .required();
    file.check([this](const Given& root, const Ragdoll& of) { return check_ties(root, of); });
    return file;
  }
};

}  // namespace

Result<Ragdoll> read(std::string_view text, const Skeleton* skeleton) {
  return File{skeleton}.table().read_text(text, "ragdoll");
}

std::string schema() {
  return File{nullptr}.table().schema();
}

}  // namespace krok::ragdoll_file
