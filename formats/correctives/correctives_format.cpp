#include "formats/correctives/correctives_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "formats/json/fields.h"

namespace krok {

namespace {

// The skinning method that correctives correct.
json::Kind<SkinMethod> skin_method_kind() {
  return json::choice<SkinMethod>({{"linear", SkinMethod::linear},
                                   {"dual-quaternion", SkinMethod::dual_quaternion},
                                   {"spherical", SkinMethod::spherical},
                                   {"rigid", SkinMethod::rigid}});
}

}  // namespace

}  // namespace krok

namespace krok::correctives_file {

namespace {

using json::Given;
using Numbers = std::vector<double>;

constexpr std::size_t kLargest = std::size_t{256} << 20;  // bytes
constexpr double kPerMetre = 1e6, kPerNormal = 1e4;

json::Kind<Numbers> numbers() {
  return json::kind<Numbers>(R"({"type": "array", "items": {"type": "number"}})",
                             [](const Given& given, Numbers& to) -> Status {
                               auto read = json::numbers(given, given.value.items.size());
                               if (!read) return read.error();
                               to = *std::move(read);
                               return {};
                             })
      .written([](const Numbers& from) { return json::list_text(from); });
}

struct Joint {
  JointCorrective corrective;
  Numbers vertices = {};
  std::vector<Numbers> offsets = {}, normals = {};
};

struct File {
  Correctives correctives;
  std::vector<Joint> joints = {};
};

std::vector<Numbers> flat(const std::vector<Vec3f>& vectors, std::size_t each, double scale) {
  std::vector<Numbers> rows;
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    if (i % each == 0) rows.emplace_back();
    for (const float x : vectors[i]) {
      rows.back().push_back(std::round(static_cast<double>(x) * scale) + 0.0);  // no -0
    }
  }
  return rows;
}

Status unflatten(const Given& given, const std::vector<Numbers>& rows, std::size_t each,
                 double scale, std::vector<Vec3f>& vectors) {
  for (const Numbers& row : rows) {
    if (row.size() != 3 * each) {
      return given.wrong(
          fmt::format("a list of {} has {} numbers, expected 3 for each of {} vertices",
                      given.name(), row.size(), each));
    }
    for (std::size_t i = 0; i < row.size(); i += 3) {
      vectors.push_back((Vec3(row[i], row[i + 1], row[i + 2]) / scale).cast<float>());
    }
  }
  return {};
}

json::Object<File> table() {
  const auto of = [](auto member) {
    return [member](Joint & joint) -> auto& {
      return joint.corrective.*member;
    };
  };
  const auto weights = [](Numbers rbf::WeightFunction::*member) {
    return [member](Joint& joint) -> Numbers& { return joint.corrective.weights.*member; };
  };
  const auto rows = [](std::string each) {
    return json::list<Numbers>(numbers(), {std::move(each), 0, rbf::kMaxExamples});
  };
  json::Object<Joint> joint;
  joint.field("joint", of(&JointCorrective::joint), json::name()).required();
  joint.field("axis", of(&JointCorrective::axis), json::direction()).required();
  joint
      .field("directions", of(&JointCorrective::directions),
             json::list<Vec3>(json::direction(), {"direction {0}", 1, 3}))
      .required();
  joint.field("squares", of(&JointCorrective::squares), json::boolean()).required();
  joint.field("lower", weights(&rbf::WeightFunction::lower), numbers()).required();
  joint.field("upper", weights(&rbf::WeightFunction::upper), numbers()).required();
  joint.field("centres", weights(&rbf::WeightFunction::centres), numbers()).required();
  joint.field("affine", weights(&rbf::WeightFunction::affine), numbers()).required();
  joint.field("coefficients", weights(&rbf::WeightFunction::coefficients), numbers())
      .required()
      .line(5);
  joint.field("vertices", &Joint::vertices, numbers(), "increasing, from 0").required().line(5);
  joint.field("offsets", &Joint::offsets, rows("target {0}"), "micrometres").required().line(5);
  joint.field("normals", &Joint::normals, rows("target {0}"), "units of 1e-4")
      .written_if([](const Joint& from) { return !from.normals.empty(); });
  joint.check([](const Given& given, Joint& to) -> Status {
    JointCorrective& made = to.corrective;
    made.weights.dimensions = static_cast<int>(made.weights.lower.size());
    const std::size_t d = made.weights.lower.size();
    made.weights.examples = static_cast<int>(made.weights.affine.size() / (d + 1));
    for (const double v : to.vertices) {
      if (!(v >= 0 && v < 4294967296.0 && v == std::floor(v))) {
        return given.member("vertices").wrong(fmt::format("{} is not a vertex number", v));
      }
      made.vertices.push_back(static_cast<std::uint32_t>(v));
    }
    const std::size_t each = made.vertices.size();
    Status status = unflatten(given.member("offsets"), to.offsets, each, kPerMetre, made.offsets);
    if (!status || to.normals.empty()) return status;
    return unflatten(given.member("normals"), to.normals, each, kPerNormal, made.normal_offsets);
  });
  json::Object<File> file;
  file.lines(2).file("krok.correctives/1", "Shapes by pose (krok.correctives/1)").comment();
  file.field(
          "vertices", [](File& to) -> int& { return to.correctives.vertex_count; },
          json::whole(1, 2147483647, "a number of vertices"), "of the model")
      .required();
  file.field(
          "method", [](File& to) -> SkinMethod& { return to.correctives.method; },
          skin_method_kind())
      .required();
  file.field("joints", &File::joints,
             json::list<Joint>(json::object(joint),
                               {"joint {0}", 0, 1000, "{0} {1}, expected {2} to {3}", true}))
      .required();
  return file;
}

}  // namespace

Result<Correctives> read(std::string_view text) {
  auto file = table().read_text(text, "correctives", kLargest);
  if (!file) return file.error();
  for (Joint& joint : file->joints) {
    file->correctives.joints.push_back(std::move(joint.corrective));
  }
  if (Status status = check(file->correctives); !status) return status.error();
  return std::move(file->correctives);
}

Result<std::string> write(const Correctives& correctives) {
  if (Status status = check(correctives); !status) return status.error();
  File file{{correctives.vertex_count, correctives.method, {}}};
  for (const JointCorrective& from : correctives.joints) {
    if (from.weights.kernel != rbf::Kernel::cubic || from.weights.smoothing != 0 ||
        from.weights.inserted() != 0) {
      return Error("correctives-shape", "the weights are not plain cubic splines");
    }
    Joint& to = file.joints.emplace_back(Joint{from});
    to.vertices.assign(from.vertices.begin(), from.vertices.end());
    to.offsets = flat(from.offsets, from.vertices.size(), kPerMetre);
    to.normals = flat(from.normal_offsets, from.vertices.size(), kPerNormal);
  }
  return table().write(&file) + '\n';
}

std::string schema() {
  return table().schema();
}

}  // namespace krok::correctives_file

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
