#include <fmt/format.h>

#include "core/text.h"
#include "formats/json/located_json.h"
#include "formats/npy/array_reader.h"
#include "scene/frame_moment.h"

namespace krok::npy {

Result<PositionSkeleton> read_columns(std::string_view text) {
  const auto root = json::parse(text);
  if (!root) return root.error();
  const auto wrong = [&](std::size_t offset, const std::string& what) {
    return json::error_at(text, offset, "columns-structure", what,
                          "write {\"joints\": [{\"name\": \"hips\"}, {\"name\": \"spine\", "
                          "\"parent\": \"hips\"}, ...]}; see formats/npy/SPEC.md");
  };
  using Kind = json::Value::Kind;
  PositionSkeleton skeleton;
  const json::Value* joints = root->find("joints");
  if (joints == nullptr || joints->kind != Kind::array) {
    return wrong(root->offset, "\"joints\" is missing or not an array");
  }
  if (const json::Value* rate = root->find("rate"); rate != nullptr) {
    if (rate->kind != Kind::number || !check_frame_rate(rate->number, "npy-rate")) {
      return wrong(rate->offset, "\"rate\" is no frame rate");
    }
    skeleton.rate = rate->number;
  }
  for (const json::Value& item : joints->items) {
    PositionJoint joint;
    for (const json::Value::Member& member : item.members) {
      const json::Value& value = member.value;
      const bool is_text = value.kind == Kind::string;
      if (member.key == "name" && is_text) {
        joint.name = value.text;
      } else if (member.key == "parent" && (is_text || value.kind == Kind::null)) {
        joint.parent = value.text;
      } else if (member.key == "role" && is_text && parse_role_label(value.text)) {
        joint.role = value.text;
      } else if (member.key == "mean_of" && value.kind == Kind::array && !value.items.empty()) {
        for (const json::Value& name : value.items) joint.mean_of.push_back(name.text);
      } else {
        return wrong(
            member.key_offset,
            fmt::format("\"{}\" of a joint is not known, or has a wrong value", shown(member.key)));
      }
    }
    if (joint.name.empty()) return wrong(item.offset, "a joint has no name");
    skeleton.joints.push_back(std::move(joint));
  }
  if (skeleton.joints.empty()) return wrong(joints->offset, "there are no joints");
  if (auto arranged = arrange(skeleton); !arranged) return arranged.error();
  return skeleton;
}

}  // namespace krok::npy
