#include <fmt/format.h>

#include <algorithm>

#include "core/index.h"
#include "core/nearest_name.h"
#include "core/text.h"
#include "formats/ragdoll/reader_internal.h"

namespace krok::ragdoll_file {

namespace {
constexpr double kMaxMass = 1e5;  // kg
}

using json::Value;
using ragdoll::Body;
using ragdoll::BodyMode;
using ragdoll::Shape;
using Kind = Value::Kind;

Status Reader::read_shape(const Value& item, const std::string& what, Shape& shape) const {
  if (const auto named = in_.get(item, what, "shape", Kind::string); !named) return named.error();
  const auto kind = in_.choice(item, what, "shape", {"box", "capsule", "sphere"});
  if (!kind) return kind.error();
  shape.kind = static_cast<Shape::Kind>(**kind);
  const bool box = shape.kind == Shape::Kind::box;
  for (const auto& [key, used] :
       {std::pair{"size", box}, {"radius", !box}, {"length", shape.kind == Shape::Kind::capsule}}) {
    const Value* const value = item.find(key);
    if (value != nullptr && !used) {
      return in_.wrong(*value,
                       fmt::format("{} has \"{}\", which its shape does not use", what, key),
                       "a box has a size, a capsule radius and length, a sphere a radius");
    }
  }
  if (box) {
    Vec3 size = Vec3::Zero();
    if (Status status = values_.vector(item, what, "size", true, size); !status) return status;
    if (!(size.minCoeff() >= 1e-4 && size.maxCoeff() <= kMaxSize)) {
      return in_.wrong(*item.find("size"),
                       fmt::format("\"size\" of {} is not within 0.1 mm and 100 m", what));
    }
    shape.half = 0.5 * size;
    return {};
  }
  const auto radius = in_.number(item, what, "radius", 1e-4, kMaxSize);
  if (!radius) return radius.error();
  shape.radius = *radius;
  if (shape.kind == Shape::Kind::sphere) return {};
  const auto length = in_.number(item, what, "length", 0, kMaxSize);
  if (!length) return length.error();
  shape.half_length = 0.5 * *length;
  return {};
}

// The skeleton's joint, and the body above it.
Status Reader::find_joint(const Value& item, const std::string& what, Body& body) {
  const auto name = in_.get(item, what, "joint", Kind::string);
  if (!name) return name.error();
  if (skeleton_ == nullptr) return {};
  const auto wrong = [&](std::string message, std::string hint) {
    return json::error_at(text_, (*name)->offset, "ragdoll-joint", std::move(message),
                          std::move(hint));
  };
  body.joint = skeleton_->find((*name)->text);
  if (body.joint < 0) {
    return wrong(fmt::format("the skeleton has no joint '{}'", shown((*name)->text)),
                 nearest_hint((*name)->text, skeleton_->names));
  }
  for (const Body& other : read_.bodies) {
    if (other.joint == body.joint) {
      return wrong(
          fmt::format("'{}' has the body '{}' already", shown((*name)->text), shown(other.name)),
          "a joint has one body");
    }
  }
  for (int j = skeleton_->parents[at(body.joint)]; j >= 0 && body.parent < 0;
       j = skeleton_->parents[at(j)]) {
    const auto above = std::ranges::find(read_.bodies, j, &Body::joint);
    if (above != read_.bodies.end()) body.parent = static_cast<int>(above - read_.bodies.begin());
  }
  if (body.parent < 0 && !read_.bodies.empty()) {
    return wrong(fmt::format("no body above {} is listed before it", what),
                 fmt::format("'{}' is the root: all others are of joints below its own, each after "
                             "the body above it",
                             shown(read_.bodies.front().name)));
  }
  return {};
}

// Whether the motion leads it, once it plays on.
Status Reader::read_mode(const Value& item, const std::string& what, Body& body) const {
  const auto mode = in_.choice(item, what, "mode", {"simulated", "animated", "powered"});
  if (!mode) return mode.error();
  if (*mode) body.mode = static_cast<BodyMode>(**mode);
  const bool hangs = body.parent >= 0 && read_.bodies[at(body.parent)].mode != BodyMode::animated;
  if (body.mode == BodyMode::animated && hangs) {
    return in_.wrong(*item.find("mode"),
                     fmt::format("{} is animated, but '{}', the body above it, is not", what,
                                 shown(read_.bodies[at(body.parent)].name)),
                     "animate all bodies from the root to it, or make it \"powered\"");
  }
  const Value* const strength = item.find("strength");
  if (strength == nullptr) return {};
  if (body.mode != BodyMode::powered) {
    return in_.wrong(*strength, fmt::format("{} has \"strength\", but is not powered", what),
                     "add \"mode\": \"powered\"");
  }
  const auto number = in_.within(*strength, fmt::format("\"strength\" of {}", what), 0, 1);
  if (!number) return number.error();
  body.strength = *number;
  return {};
}

Status Reader::read_body(const Value& item) {
  Status status = in_.only(item, "a body",
                           {"name", "joint", "shape", "size", "radius", "length", "offset",
                            "rotation", "mass", "mode", "strength", "comment"});
  if (!status) return status;
  const auto name = in_.get(item, "a body", "name", Kind::string);
  if (!name) return name.error();
  Body body;
  body.name = (*name)->text;
  if (body.name.empty() || body.name.size() > 200) {
    return in_.wrong(**name, "the name of a body is empty or longer than 200 bytes");
  }
  if (std::ranges::find(read_.bodies, body.name, &Body::name) != read_.bodies.end()) {
    return in_.wrong(**name, fmt::format("there are two bodies '{}'", shown(body.name)));
  }
  const std::string what = fmt::format("body '{}'", shown(body.name));
  status = find_joint(item, what, body);
  if (status) status = read_shape(item, what, body.shape);
  if (status) status = values_.vector(item, what, "offset", false, body.to_joint.position);
  if (status && !(body.to_joint.position.norm() <= kMaxSize)) {
    return in_.wrong(*item.find("offset"), fmt::format("{} is over 100 m from its joint", what));
  }
  if (status) status = values_.rotation(item, what, "rotation", body.to_joint.orientation);
  if (!status) return status;
  const auto mass = in_.number(item, what, "mass", 1e-3, kMaxMass);
  if (!mass) return mass.error();
  body.mass = *mass;
  if (status = read_mode(item, what, body); !status) return status;
  read_.bodies.push_back(std::move(body));
  return {};
}

}  // namespace krok::ragdoll_file
