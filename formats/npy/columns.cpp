#include "core/text.h"
#include "formats/json/fields.h"
#include "formats/npy/array_reader.h"

namespace krok::npy {

Result<PositionSkeleton> read_columns(std::string_view text) {
  json::Object<PositionJoint> joint;
  joint.field("name", &PositionJoint::name, json::name()).required();
  joint.field("parent", &PositionJoint::parent,
              json::kind<std::string>("", [](const json::Given& given, std::string& parent) {
                if (given.value.kind == json::Value::Kind::null) return Status();
                return json::text().read(given, &parent);
              }));
  joint.field("role", &PositionJoint::role, json::text())
      .check([](const json::Given& given, PositionJoint& of) -> Status {
        if (of.role.empty() || parse_role_label(of.role)) return {};
        return given.member("role").wrong("\"" + shown(of.role) + "\" is no role");
      });
  joint.field("mean_of", &PositionJoint::mean_of, json::list(json::text(), {"a column", 1, 1000}));
  json::Object<PositionSkeleton> file("the skeleton");
  std::string schema;  // may be missing
  file.context("schema", schema, json::text()).comment();
  file.field("rate", &PositionSkeleton::rate, json::frame_rate());
  file.field("joints", &PositionSkeleton::joints,
             json::list<PositionJoint>(json::object(joint), {"joint {0}", 1, 10'000}))
      .required();
  auto skeleton = file.read_text(text, "columns");
  if (!skeleton) return skeleton;
  if (auto arranged = arrange(*skeleton); !arranged) return arranged.error();
  return skeleton;
}

}  // namespace krok::npy
