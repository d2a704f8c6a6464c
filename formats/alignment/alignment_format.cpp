#include "formats/alignment/alignment_format.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "core/index.h"
#include "core/nearest_name.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/json/json_text.h"
#include "formats/json/members.h"

namespace krok::alignment {

namespace {

using json::Value;
using Kind = Value::Kind;

constexpr std::string_view kSchema = "krok.alignment/1";
constexpr std::string_view kWhole = "the file";

class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text), in_(text, "alignment") {}

  Result<AlignedPoses> read(const Skeleton& source, const Skeleton& target) {
    const auto root = json::parse(text_);
    if (!root) return root.error();
    if (Status status = in_.only(*root, kWhole, {"schema", "comment", "source", "target"});
        !status) {
      return status.error();
    }
    if (Status status = in_.has_schema(*root, kWhole, kSchema); !status) return status.error();
    AlignedPoses poses;
    if (Status status = read_pose(*root, "source", source, poses.source); !status) {
      return status.error();
    }
    if (Status status = read_pose(*root, "target", target, poses.target); !status) {
      return status.error();
    }
    return poses;
  }

 private:
  Status read_pose(const Value& root, std::string_view key, const Skeleton& skeleton,
                   std::vector<Transform>& pose) const {
    const auto joints = in_.get(root, kWhole, key, Kind::object);
    if (!joints) return joints.error();
    pose.resize(skeleton.names.size());
    std::vector<char> given(skeleton.names.size(), 0);
    for (const Value::Member& member : (*joints)->members) {
      const int joint = skeleton.find(member.key);
      if (joint < 0) {
        return json::error_at(
            text_, member.key_offset, "alignment-joint",
            fmt::format("the {} skeleton has no joint '{}'", key, shown(member.key)),
            nearest_hint(member.key, skeleton.names));
      }
      given[at(joint)] = 1;
      const std::string what = fmt::format("joint '{}' of \"{}\"", shown(member.key), key);
      if (Status status = read_joint(member.value, what, pose[at(joint)]); !status) return status;
    }
    for (std::size_t j = 0; j < given.size(); ++j) {
      if (given[j] != 0) continue;
      Error missing = in_.wrong(
          **joints,
          fmt::format("\"{}\" lacks the skeleton's joint '{}'", key, shown(skeleton.names[j])),
          "an alignment is for the two skeletons that it was saved for");
      missing.code = "alignment-joint";
      return missing;
    }
    return {};
  }

  Status read_joint(const Value& item, const std::string& what, Transform& joint) const {
    if (Status status = in_.only(item, what, {"position", "orientation"}); !status) return status;
    const auto position = in_.get(item, what, "position", Kind::array);
    if (!position) return position.error();
    const auto place = in_.numbers(**position, what, "position", 3);
    if (!place) return place.error();
    const auto orientation = in_.get(item, what, "orientation", Kind::array);
    if (!orientation) return orientation.error();
    const auto turn = in_.numbers(**orientation, what, "orientation", 4);
    if (!turn) return turn.error();
    joint.position = Vec3((*place)[0], (*place)[1], (*place)[2]);
    joint.orientation = Quat((*turn)[3], (*turn)[0], (*turn)[1], (*turn)[2]);
    constexpr double kFar = 1e6;  // metres
    if (!(joint.position.cwiseAbs().maxCoeff() <= kFar)) {
      return in_.wrong(**position, fmt::format("{} is more than {} m away", what, readable(kFar)));
    }
    if (!(std::abs(joint.orientation.norm() - 1) < 1e-6)) {
      return in_.wrong(**orientation,
                       fmt::format("\"orientation\" of {} has length {}, expected 1", what,
                                   readable(joint.orientation.norm())),
                       "it is a unit quaternion: x, y, z, w");
    }
    return {};
  }

  std::string_view text_;
  json::Members in_;
};

std::string text_of(std::span<const Transform> pose, const Skeleton& skeleton) {
  std::vector<std::string> joints;
  for (std::size_t j = 0; j < pose.size(); ++j) {
    const Vec3& p = pose[j].position;
    const Quat& q = pose[j].orientation;
    joints.push_back(fmt::format(
        "    {}: {{\"position\": [{}, {}, {}], \"orientation\": [{}, {}, {}, {}]}}",
        json::in_quotes(skeleton.names[j]), p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()));
  }
  return fmt::format("{{\n{}\n  }}", fmt::join(joints, ",\n"));
}

}  // namespace

Result<AlignedPoses> read(std::string_view text, const Skeleton& source, const Skeleton& target) {
  return Reader(text).read(source, target);
}

std::string write(const AlignedPoses& poses, const Skeleton& source, const Skeleton& target) {
  return fmt::format("{{\n  \"schema\": \"{}\",\n  \"source\": {},\n  \"target\": {}\n}}\n",
                     kSchema, text_of(poses.source, source), text_of(poses.target, target));
}

}  // namespace krok::alignment
