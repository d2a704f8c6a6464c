#include "formats/correctives/corrective_poses.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "formats/correctives/method_kind_internal.h"
#include "formats/json/fields.h"

namespace krok::corrective_poses {

namespace {

using json::Given;

template <typename T>
Status keep_place(const Given& given, T& of) {
  of.place = given.where();
  return {};
}

json::Kind<std::vector<Pose>> poses(const std::string& each, std::size_t least) {
  json::Object<Pose> pose;
  pose.field("motion", &Pose::motion, json::path(), "path of the motion").required();
  pose.field("frame", &Pose::frame, json::whole(0, 1e9, "a frame number from 0"),
             "frame of the motion, from 0");
  pose.field("shape", &Pose::shape, json::path(), "path of the mesh in this pose").required();
  pose.comment().check(keep_place<Pose>);
  return json::list<Pose>(json::object(pose),
                          {each, least, 1000, "{0} poses in {4}, expected {2} to {3}", true});
}

json::Object<Description> table() {
  json::Object<Joint> joint;
  joint.field("joint", &Joint::joint, json::name(), "of the model").required();
  joint.field("examples", &Joint::examples, poses("example {0}", 1)).required();
  joint.field("held_out", &Joint::held_out, poses("held-out pose {0}", 0));
  joint.comment().check(keep_place<Joint>);
  json::Object<Description> file;
  file.file(kSchema, "Sculpted poses of a model (krok.corrective-poses/1)").comment();
  file.field("model", &Description::model, json::path(), "path relative to this file").required();
  file.field("method", &Description::method, skin_method_kind(), "the skinning to correct");
  const auto is_new = [](const Given& given, const std::vector<Joint>& joints) -> Status {
    const auto& name = joints.back().joint;
    if (std::ranges::count(joints, name, &Joint::joint) == 1) return {};
    return given.member("joint").wrong(fmt::format("{} is '{}' again", given.what, shown(name)),
                                       "put all poses of a joint in one list");
  };
  file.field("joints", &Description::joints,
             json::list<Joint>(json::object(joint),
                               {"joint {0}", 1, 1000, "{0} joints, expected 1 to 1,000", true},
                               is_new))
      .required();
  return file;
}

}  // namespace

Result<Description> read(std::string_view text) {
  return table().read_text(text, "corrective-poses");
}

std::string schema() {
  return table().schema();
}

}  // namespace krok::corrective_poses
