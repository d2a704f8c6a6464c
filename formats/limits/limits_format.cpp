#include "formats/limits/limits_format.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/json/fields.h"
#include "formats/json/located_json.h"

namespace krok::limits {

namespace {

using ik::JointLimit;
using json::Given;

// [min, max] in the file's unit, both within +-most radians.
Status read_range(const Given& given, double unit, double most, double& min, double& max) {
  const auto values = json::numbers(given, 2);
  if (!values) return values.error();
  min = (*values)[0] * unit;
  max = (*values)[1] * unit;
  if (min > max) {
    return given.wrong(fmt::format("{} has its min {} above its max {}", given.name(),
                                   readable((*values)[0]), readable((*values)[1])));
  }
  if (min >= -most - 1e-9 && max <= most + 1e-9) return {};
  return given.wrong(fmt::format("{} exceeds {} to {}", given.name(), readable(-most / unit),
                                 readable(most / unit)));
}

std::string range_text(double min, double max) {
  return fmt::format("[{}, {}]", min / kRadiansPerDegree, max / kRadiansPerDegree);
}

json::Kind<JointLimit> twist(const double& unit, double most) {
  return json::kind<JointLimit>(json::schema_of_numbers(2),
                                [&unit, most](const Given& given, JointLimit& to) {
                                  return read_range(given, unit, most, to.min_twist, to.max_twist);
                                })
      .written([](const JointLimit& of) { return range_text(of.min_twist, of.max_twist); });
}

json::Kind<JointLimit> swing(const double& unit) {
  return json::kind<JointLimit>(
             json::schema_of_list(json::schema_of_numbers(2), 2, 2),
             [&unit](const Given& given, JointLimit& to) -> Status {
               if (Status status = given.is(json::Value::Kind::array); !status) return status;
               const auto& ranges = given.value.items;
               constexpr auto kArray = json::Value::Kind::array;
               if (ranges.size() != 2 || ranges[0].kind != kArray || ranges[1].kind != kArray) {
                 return given.wrong(fmt::format("{} must be two ranges", given.name()),
                                    "write [[-30, 45], [-20, 20]]");
               }
               for (std::size_t i = 0; i < 2; ++i) {
                 const Given range{given.source, ranges[i], given.key, given.what};
                 Status status = read_range(range, unit, kPi, to.min_swing[i], to.max_swing[i]);
                 if (!status) return status;
                 if (to.min_swing[i] > 0 || to.max_swing[i] < 0) {
                   return range.wrong(fmt::format("{} does not contain 0", given.name()),
                                      "turn \"zero\" into the middle of the range");
                 }
               }
               return {};
             })
      .written([](const JointLimit& of) {
        return fmt::format("[{}, {}]", range_text(of.min_swing[0], of.max_swing[0]),
                           range_text(of.min_swing[1], of.max_swing[1]));
      });
}

// The two axes of a cone are perpendicular; a hinge has a second one for what needs it.
Status finish_axes(const Given& joint, JointLimit& limit) {
  if (limit.kind == JointLimit::Kind::hinge) limit.swing_axis = limit.axis.unitOrthogonal();
  if (limit.kind != JointLimit::Kind::cone) return {};
  const double along = limit.axis.dot(limit.swing_axis);
  if (!(std::abs(along) < 0.01)) {
    return joint.member("swing_axis")
        .wrong(
            fmt::format("\"swing_axis\" of {} is not perpendicular to its \"axis\"", joint.what));
  }
  if (std::abs(along) > 1e-14) {
    limit.swing_axis = (limit.swing_axis - along * limit.axis).normalized();
  }
  return {};
}

template <typename T>
std::string digits_text(const T& numbers) {
  return fmt::format("[{}]", fmt::join(numbers.data(), numbers.data() + numbers.size(), ", "));
}

json::Object<JointLimit> joint_table(const double& unit) {
  const auto direction = [] { return json::direction().written(digits_text<Vec3>); };
  const auto rotation = [] {
    return json::rotation().written([](const Quat& q) { return digits_text(q.coeffs()); });
  };
  json::Object<JointLimit> joint;
  joint.unused("{0} has \"{1}\", which its kind does not use",
               "a hinge has axis and range, a cone axis, swing_axis, swing and twist");
  joint
      .field("kind", &JointLimit::kind,
             json::choice<JointLimit::Kind>({{"free", JointLimit::Kind::free},
                                             {"locked", JointLimit::Kind::locked},
                                             {"hinge", JointLimit::Kind::hinge},
                                             {"cone", JointLimit::Kind::cone}}))
      .required();
  joint.field("axis", &JointLimit::axis, direction(), "unit vector in the joint's frame")
      .required()
      .with("kind", {"hinge", "cone"});
  joint.field("swing_axis", &JointLimit::swing_axis, direction())
      .required()
      .with("kind", {"cone"})
      .line(6);
  joint.check(finish_axes);
  joint.field("range", twist(unit, 4 * kPi), "min, max").required().with("kind", {"hinge"});
  joint.field("swing", swing(unit)).required().with("kind", {"cone"});
  joint.field("twist", twist(unit, kPi)).required().with("kind", {"cone"}).line(6);
  joint.field("zero", &JointLimit::zero, rotation(), "x, y, z, w, joint to parent")
      .with("kind", {"hinge", "cone"});
  return joint.comment();
}

// The limits of a skeleton's joints, shape [joints].
struct File {
  const Skeleton& skeleton;
  double unit = kRadiansPerDegree;

  json::Object<ik::Limits> table() {
    json::Object<ik::Limits> file;
    file.lines(2).file("krok.limits/1", "Ranges of motion of joints (krok.limits/1)").comment();
    file.context("angle_unit", unit,
                 json::choice<double>({{"deg", kRadiansPerDegree}, {"rad", 1}}));
    file.check([this](const Given&, ik::Limits& limits) {
      limits.resize(skeleton.names.size());
      return Status();
    });
    const auto joint = json::object(joint_table(unit));
    file.field("joints", json::keyed<ik::Limits>(joint, "joint '{}'",
                                                 [this](const Given& key, ik::Limits& limits) {
                                                   return joint_of(key, limits);
                                                 })
                             .written([this, joint](const ik::Limits& limits) {
                               std::vector<std::string> joints;
                               for (std::size_t j = 0; j < limits.size(); ++j) {
                                 if (limits[j].kind == JointLimit::Kind::free) continue;
                                 joints.push_back(fmt::format("    {}: {}",
                                                              json::in_quotes(skeleton.names[j]),
                                                              joint.write(&limits[j])));
                               }
                               return fmt::format("{{\n{}\n  }}", fmt::join(joints, ",\n"));
                             }))
        .required();
    return file;
  }

  Result<JointLimit*> joint_of(const Given& key, ik::Limits& limits) const {
    const int joint = skeleton.find(key.key);
    if (joint < 0) {
      return key.error("joint", fmt::format("the skeleton has no joint '{}'", shown(key.key)),
                       nearest_hint(key.key, skeleton.names));
    }
    JointLimit& limit = limits[at(joint)];
    limit.zero = skeleton.reference_local(joint).orientation.normalized();
    return &limit;
  }
};

}  // namespace

Result<ik::Limits> read(std::string_view text, const Skeleton& skeleton) {
  return File{skeleton}.table().read_text(text, "limits");
}

std::string write(const ik::Limits& limits, const Skeleton& skeleton) {
  return File{skeleton}.table().write(&limits) + '\n';
}

std::string schema() {
  return File{{}}.table().schema();
}

}  // namespace krok::limits
