#include "formats/alignment/alignment_format.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/json/fields.h"
#include "formats/json/located_json.h"

namespace krok::alignment {

namespace {

using json::Given;

constexpr double kFar = 1e6;  // metres

template <typename T>
std::string digits_text(const T& numbers) {
  return fmt::format("[{}]", fmt::join(numbers.data(), numbers.data() + numbers.size(), ", "));
}

json::Object<Transform> joint_table() {
  json::Object<Transform> joint;
  joint.field("position", &Transform::position, json::vector().written(digits_text<Vec3>))
      .required();
  joint.check([](const Given& given, Transform& of) -> Status {
    if (of.position.cwiseAbs().maxCoeff() <= kFar) return {};
    return given.member("position")
        .wrong(fmt::format("{} is more than {} m away", given.what, readable(kFar)));
  });
  joint
      .field("orientation", &Transform::orientation,
             json::rotation(1e-6, 1).written([](const Quat& q) { return digits_text(q.coeffs()); }),
             "x, y, z, w")
      .required();
  return joint;
}

// The pose of one of the skeletons, shape [joints].
json::Kind<std::vector<Transform>> pose(const Skeleton& skeleton) {
  using Pose = std::vector<Transform>;
  const auto joint = json::object(joint_table());
  auto made = json::keyed<Pose>(
      joint, "joint '{0}' of \"{2}\"",
      [&skeleton](const Given& key, Pose& to) -> Result<Transform*> {
        to.resize(skeleton.names.size());
        const int found = skeleton.find(key.key);
        if (found >= 0) return &to[at(found)];
        return key.error("joint",
                         fmt::format("the {} skeleton has no joint '{}'", key.what, shown(key.key)),
                         nearest_hint(key.key, skeleton.names));
      });
  made.read = [&skeleton, read = made.read](const Given& given, void* to) -> Status {
    const Given named{given.source, given.value, given.key, given.key};
    if (Status status = read(named, to); !status) {
      return given.value.kind == json::Value::Kind::object ? status
                                                           : given.is(json::Value::Kind::object);
    }
    for (const std::string& name : skeleton.names) {
      if (given.has(name)) continue;
      return given.error(
          "joint", fmt::format("\"{}\" lacks the skeleton's joint '{}'", given.key, shown(name)),
          "an alignment is for the two skeletons that it was saved for");
    }
    return {};
  };
  return std::move(made).written([joint, &skeleton](const Pose& pose_of) {
    std::vector<std::string> joints;
    for (std::size_t j = 0; j < pose_of.size(); ++j) {
      joints.push_back(
          fmt::format("    {}: {}", json::in_quotes(skeleton.names[j]), joint.write(&pose_of[j])));
    }
    return fmt::format("{{\n{}\n  }}", fmt::join(joints, ",\n"));
  });
}

json::Object<AlignedPoses> table(const Skeleton& source, const Skeleton& target) {
  json::Object<AlignedPoses> file;
  file.lines(2).file("krok.alignment/1", "Two skeletons in the same pose (krok.alignment/1)");
  file.comment();
  file.field("source", &AlignedPoses::source, pose(source)).required();
  file.field("target", &AlignedPoses::target, pose(target)).required();
  return file;
}

}  // namespace

Result<AlignedPoses> read(std::string_view text, const Skeleton& source, const Skeleton& target) {
  return table(source, target).read_text(text, "alignment");
}

std::string write(const AlignedPoses& poses, const Skeleton& source, const Skeleton& target) {
  return table(source, target).write(&poses) + '\n';
}

std::string schema() {
  const Skeleton none;
  return table(none, none).schema();
}

}  // namespace krok::alignment
