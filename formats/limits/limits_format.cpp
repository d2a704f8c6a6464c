#include "formats/limits/limits_format.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "core/index.h"
#include "core/nearest_name.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/json/json_text.h"
#include "formats/json/members.h"

namespace krok::limits {

namespace {

using ik::JointLimit;
using json::Value;
using Kind = Value::Kind;

constexpr std::string_view kSchema = "krok.limits/1";
constexpr std::string_view kWhole = "the file";
// Numbers written by hand have few digits.
constexpr double kHandWritten = 0.01;

class Reader {
 public:
  Reader(std::string_view text, const Skeleton& skeleton)
      : text_(text), in_(text, "limits"), skeleton_(skeleton) {}

  Result<ik::Limits> read() {
    const auto root = json::parse(text_);
    if (!root) return root.error();
    if (Status status = in_.only(*root, kWhole, {"schema", "comment", "angle_unit", "joints"});
        !status) {
      return status.error();
    }
    if (Status status = in_.has_schema(*root, kWhole, kSchema); !status) return status.error();
    const auto unit = in_.choice(*root, kWhole, "angle_unit", {"deg", "rad"});
    if (!unit) return unit.error();
    if (*unit && **unit == 1) radians_ = 1;
    const auto joints = in_.get(*root, kWhole, "joints", Kind::object);
    if (!joints) return joints.error();
    limits_.resize(skeleton_.names.size());
    for (const Value::Member& member : (*joints)->members) {
      if (Status status = read_joint(member); !status) return status.error();
    }
    return std::move(limits_);
  }

 private:
  Status read_direction(const Value& item, const std::string& what, std::string_view key,
                        bool needed, Vec3& direction) const {
    const auto list =
        needed ? in_.get(item, what, key, Kind::array) : in_.find(item, what, key, Kind::array);
    if (!list) return list.error();
    if (*list == nullptr) return {};
    const auto values = in_.numbers(**list, what, key, 3);
    if (!values) return values.error();
    const Vec3 given((*values)[0], (*values)[1], (*values)[2]);
    const double length = given.norm();
    if (!(std::abs(length - 1) < kHandWritten)) {
      return in_.wrong(**list, fmt::format("\"{}\" of {} has length {}, expected 1", key, what,
                                           readable(length)));
    }
    // What is of length 1 stays bit for bit.
    direction = std::abs(length - 1) < 1e-14 ? given : Vec3(given / length);
    return {};
  }

  Status read_zero(const Value& item, const std::string& what, int joint, Quat& zero) const {
    zero = skeleton_.reference_local(joint).orientation.normalized();
    const auto list = in_.find(item, what, "zero", Kind::array);
    if (!list) return list.error();
    if (*list == nullptr) return {};
    const auto values = in_.numbers(**list, what, "zero", 4);
    if (!values) return values.error();
    const Quat given((*values)[3], (*values)[0], (*values)[1], (*values)[2]);
    if (!(std::abs(given.norm() - 1) < kHandWritten)) {
      return in_.wrong(
          **list,
          fmt::format("\"zero\" of {} has length {}, expected 1", what, readable(given.norm())),
          "it is a unit quaternion: x, y, z, w");
    }
    zero = std::abs(given.norm() - 1) < 1e-14 ? given : given.normalized();
    return {};
  }

  // [min, max] in the file's unit, both within [lowest, highest] radians.
  Status read_range(const Value& list, const std::string& what, std::string_view key, double lowest,
                    double highest, double& least, double& most) const {
    const auto values = in_.numbers(list, what, key, 2);
    if (!values) return values.error();
    least = (*values)[0] * radians_;
    most = (*values)[1] * radians_;
    if (least > most) {
      return in_.wrong(list, fmt::format("\"{}\" of {} has its min {} above its max {}", key, what,
                                         readable((*values)[0]), readable((*values)[1])));
    }
    if (least < lowest - 1e-9 || most > highest + 1e-9) {
      return in_.wrong(
          list, fmt::format("\"{}\" of {} exceeds {} to {}", key, what, readable(lowest / radians_),
                            readable(highest / radians_)));
    }
    return {};
  }

  Status read_swing(const Value& item, const std::string& what, JointLimit& limit) const {
    const auto list = in_.get(item, what, "swing", Kind::array);
    if (!list) return list.error();
    const auto& ranges = (*list)->items;
    if (ranges.size() != 2 || ranges[0].kind != Kind::array || ranges[1].kind != Kind::array) {
      return in_.wrong(**list, fmt::format("\"swing\" of {} must be two ranges", what),
                       "write [[-30, 45], [-20, 20]]");
    }
    for (std::size_t i = 0; i < 2; ++i) {
      if (Status status = read_range(ranges[i], what, "swing", -kPi, kPi, limit.min_swing[i],
                                     limit.max_swing[i]);
          !status) {
        return status;
      }
      if (limit.min_swing[i] > 0 || limit.max_swing[i] < 0) {
        return in_.wrong(ranges[i], fmt::format("\"swing\" of {} does not contain 0", what),
                         "turn \"zero\" into the middle of the range");
      }
    }
    return {};
  }

  Status read_cone(const Value& item, const std::string& what, JointLimit& limit) const {
    if (Status status = read_direction(item, what, "swing_axis", true, limit.swing_axis); !status) {
      return status;
    }
    const double along = limit.axis.dot(limit.swing_axis);
    if (!(std::abs(along) < kHandWritten)) {
      return in_.wrong(
          *item.find("swing_axis"),
          fmt::format("\"swing_axis\" of {} is not perpendicular to its \"axis\"", what));
    }
    if (std::abs(along) > 1e-14) {
      limit.swing_axis = (limit.swing_axis - along * limit.axis).normalized();
    }
    if (Status status = read_swing(item, what, limit); !status) return status;
    const auto twist = in_.get(item, what, "twist", Kind::array);
    if (!twist) return twist.error();
    return read_range(**twist, what, "twist", -kPi, kPi, limit.min_twist, limit.max_twist);
  }

  Status read_hinge(const Value& item, const std::string& what, JointLimit& limit) const {
    limit.swing_axis = limit.axis.unitOrthogonal();
    const auto range = in_.get(item, what, "range", Kind::array);
    if (!range) return range.error();
    return read_range(**range, what, "range", -4 * kPi, 4 * kPi, limit.min_twist, limit.max_twist);
  }

  Status read_joint(const Value::Member& member) {
    const int joint = skeleton_.find(member.key);
    if (joint < 0) {
      return json::error_at(text_, member.key_offset, "limits-joint",
                            fmt::format("the skeleton has no joint '{}'", shown(member.key)),
                            nearest_hint(member.key, skeleton_.names));
    }
    const std::string what = fmt::format("joint '{}'", shown(member.key));
    const Value& item = member.value;
    if (Status status =
            in_.only(item, what,
                     {"kind", "axis", "swing_axis", "range", "swing", "twist", "zero", "comment"});
        !status) {
      return status;
    }
    if (auto kind = in_.get(item, what, "kind", Kind::string); !kind) return kind.error();
    const auto kind = in_.choice(item, what, "kind", {"free", "locked", "hinge", "cone"});
    if (!kind) return kind.error();
    JointLimit& limit = limits_[at(joint)];
    limit.kind = static_cast<JointLimit::Kind>(**kind);
    if (Status status = check_keys(item, what, limit.kind); !status) return status;
    if (limit.kind == JointLimit::Kind::free || limit.kind == JointLimit::Kind::locked) return {};
    if (Status status = read_zero(item, what, joint, limit.zero); !status) return status;
    if (Status status = read_direction(item, what, "axis", true, limit.axis); !status) {
      return status;
    }
    return limit.kind == JointLimit::Kind::hinge ? read_hinge(item, what, limit)
                                                 : read_cone(item, what, limit);
  }

  // A range that the joint's kind does not use must not be taken for one that holds.
  Status check_keys(const Value& item, const std::string& what, JointLimit::Kind kind) const {
    const bool hinge = kind == JointLimit::Kind::hinge, cone = kind == JointLimit::Kind::cone;
    const std::pair<const char*, bool> used[] = {{"range", hinge},        {"twist", cone},
                                                 {"swing", cone},         {"swing_axis", cone},
                                                 {"axis", hinge || cone}, {"zero", hinge || cone}};
    for (const auto& [key, allowed] : used) {
      if (const Value* value = item.find(key); value != nullptr && !allowed) {
        return in_.wrong(*value,
                         fmt::format("{} has \"{}\", which its kind does not use", what, key),
                         "a hinge has axis and range, a cone axis, swing_axis, swing and twist");
      }
    }
    return {};
  }

  std::string_view text_;
  json::Members in_;
  const Skeleton& skeleton_;
  ik::Limits limits_;
  double radians_ = kRadiansPerDegree;
};

std::string list_of(const Vec3& v) {
  return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z());
}

std::string range_of(double least, double most) {
  return fmt::format("[{}, {}]", least / kRadiansPerDegree, most / kRadiansPerDegree);
}

std::string zero_of(const Quat& q) {
  return fmt::format("[{}, {}, {}, {}]", q.x(), q.y(), q.z(), q.w());
}

std::string text_of(const JointLimit& limit) {
  switch (limit.kind) {
    case JointLimit::Kind::hinge:
      return fmt::format("{{\"kind\": \"hinge\", \"axis\": {}, \"range\": {}, \"zero\": {}}}",
                         list_of(limit.axis), range_of(limit.min_twist, limit.max_twist),
                         zero_of(limit.zero));
    case JointLimit::Kind::cone:
      return fmt::format(
          "{{\"kind\": \"cone\", \"axis\": {}, \"swing_axis\": {},\n      \"swing\": [{}, {}], "
          "\"twist\": {},\n      \"zero\": {}}}",
          list_of(limit.axis), list_of(limit.swing_axis),
          range_of(limit.min_swing[0], limit.max_swing[0]),
          range_of(limit.min_swing[1], limit.max_swing[1]),
          range_of(limit.min_twist, limit.max_twist), zero_of(limit.zero));
    default:
      return "{\"kind\": \"locked\"}";
  }
}

}  // namespace

Result<ik::Limits> read(std::string_view text, const Skeleton& skeleton) {
  return Reader(text, skeleton).read();
}

std::string write(const ik::Limits& limits, const Skeleton& skeleton) {
  std::vector<std::string> joints;
  for (std::size_t j = 0; j < limits.size(); ++j) {
    if (limits[j].kind == JointLimit::Kind::free) continue;
    joints.push_back(
        fmt::format("    {}: {}", json::in_quotes(skeleton.names[j]), text_of(limits[j])));
  }
  return fmt::format(
      "{{\n  \"schema\": \"{}\",\n  \"angle_unit\": \"deg\",\n  \"joints\": {{\n{}\n  }}\n}}\n",
      kSchema, fmt::join(joints, ",\n"));
}

}  // namespace krok::limits
