#include "formats/role_map/role_map.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "core/text.h"
#include "formats/json/located_json.h"

namespace krok::role_map {

namespace {

constexpr std::string_view kSchema = "krok.role-map/1";
constexpr const char* kForm =
    "write {\"joints\": {\"Bone_012\": \"left_hand\", ...}}; see formats/role_map/SPEC.md";

// All valid role labels.
std::vector<std::string> all_labels() {
  std::vector<std::string> labels;
  for (int r = 0; r <= static_cast<int>(Role::helper); ++r) {
    const auto role = static_cast<Role>(r);
    if (role != Role::end) labels.emplace_back(role_name(role));
  }
  for (const char* side : {"left_", "right_"}) {
    for (int f = static_cast<int>(Finger::thumb); f <= static_cast<int>(Finger::all); ++f) {
      for (int phalanx = FingerJoint::kMetacarpal; phalanx <= FingerJoint::kTip; ++phalanx) {
        labels.push_back(side + finger_place_name({static_cast<Finger>(f), phalanx}));
      }
    }
  }
  return labels;
}

class Reader {
 public:
  Reader(std::string_view text, const Skeleton& skeleton) : text_(text), skeleton_(skeleton) {}

  Result<RoleMap> read() {
    auto root = json::parse(text_);
    if (!root) return root.error();
    const json::Value* joints = nullptr;
    if (Status status = check_shape(*root, joints); !status) return status.error();
    for (const json::Value::Member& member : joints->members) {
      if (Status status = add(member); !status) return status.error();
    }
    auto map = find_roles(skeleton_, given_);
    if (!map) return located(std::move(map).error(), *joints);
    if (sides_differ(*map)) {
      return json::error_at(text_, joints->offset, "role-map-sides",
                            "left_upper_leg is on the side of right_upper_arm",
                            "exchange left and right of the legs, or give those of the arms, too");
    }
    return map;
  }

 private:
  // Whether legs and arms are on different sides in the reference pose.
  bool sides_differ(const RoleMap& map) const {
    const auto across = [&](Role left, Role right) -> Vec3 {
      const int a = map.joint(left), b = map.joint(right);
      if (a < 0 || b < 0) return Vec3::Zero();
      const auto place = [&](int joint) {
        return skeleton_.reference[static_cast<std::size_t>(joint)].position;
      };
      return (place(a) - place(b)).stableNormalized();
    };
    return across(Role::left_upper_leg, Role::right_upper_leg)
               .dot(across(Role::left_upper_arm, Role::right_upper_arm)) < -0.5;
  }

  Status check_shape(const json::Value& root, const json::Value*& joints) const {
    if (root.kind != json::Value::Kind::object) {
      return json::error_at(text_, root.offset, "role-map-shape",
                            fmt::format("expected an object, found {}", json::kind_name(root.kind)),
                            kForm);
    }
    for (const json::Value::Member& member : root.members) {
      if (member.key == "joints") {
        joints = &member.value;
      } else if (member.key == "schema") {
        if (member.value.text != kSchema) {
          return json::error_at(text_, member.value.offset, "role-map-shape",
                                fmt::format("the schema is not \"{}\"", kSchema),
                                "remove it or write this schema");
        }
      } else if (member.key != "comment") {
        return json::error_at(text_, member.key_offset, "role-map-shape",
                              fmt::format("unknown key \"{}\"", shown(member.key)), kForm);
      }
    }
    if (joints == nullptr || joints->kind != json::Value::Kind::object) {
      return json::error_at(text_, joints == nullptr ? root.offset : joints->offset,
                            "role-map-shape", "\"joints\" is missing or not an object", kForm);
    }
    return {};
  }

  Status add(const json::Value::Member& member) {
    const int joint = skeleton_.find(member.key);
    const bool swapped = member.value.kind == json::Value::Kind::string &&
                         skeleton_.find(member.value.text) >= 0 && parse_role_label(member.key);
    if (joint < 0 && swapped) {
      return json::error_at(text_, member.key_offset, "role-map-joint",
                            fmt::format("\"{}\" is a role, not a joint", shown(member.key)),
                            fmt::format("the joint comes first: \"{}\": \"{}\"",
                                        shown(member.value.text), shown(member.key)));
    }
    if (joint < 0) {
      const std::string nearest = nearest_name(member.key, skeleton_.names);
      return json::error_at(
          text_, member.key_offset, "role-map-joint",
          fmt::format("the skeleton has no joint \"{}\"", shown(member.key)),
          nearest.empty()
              ? "krok-info -v lists the joints"
              : fmt::format("did you mean \"{}\"? krok-info -v lists the joints", nearest));
    }
    if (member.value.kind != json::Value::Kind::string) {
      return json::error_at(
          text_, member.value.offset, "role-map-role",
          fmt::format("expected a role (a string), found {}", json::kind_name(member.value.kind)),
          "use \"none\" to remove a joint's role");
    }
    auto given = parse_role_label(member.value.text);
    if (!given || given->role == Role::end) {
      const std::string nearest = nearest_name(member.value.text, all_labels());
      return json::error_at(text_, member.value.offset, "role-map-role",
                            fmt::format("there is no role \"{}\"", shown(member.value.text)),
                            nearest.empty()
                                ? "roles are hips, left_upper_leg, left_foot, right_hand and "
                                  "so on: krok-info -v shows those of joints that it "
                                  "knows"
                                : fmt::format("did you mean \"{}\"?", nearest));
    }
    given->joint = joint;
    given_.push_back(*given);
    return {};
  }

  // Adds the location of the joint named in an error of find_roles.
  Error located(Error error, const json::Value& joints) const {
    std::size_t offset = joints.offset;
    for (const json::Value::Member& member : joints.members) {
      if (member.key == error.joint) offset = member.key_offset;
    }
    const Error place = json::error_at(text_, offset, error.code, error.message, error.hint);
    error.where = place.where;
    return error;
  }

  std::string_view text_;
  const Skeleton& skeleton_;
  std::vector<GivenRole> given_;
};

}  // namespace

Result<RoleMap> read(std::string_view text, const std::string& path, const Skeleton& skeleton) {
  auto map = Reader(text, skeleton).read();
  if (!map) return std::move(map).error().in_file(path);
  return map;
}

}  // namespace krok::role_map
