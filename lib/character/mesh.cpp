#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "character/mesh_internal.h"
#include "character/motion.h"
#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "scene/skeleton.h"

namespace krok::character {

using nodes::Scene;

namespace {

// Of a mesh at many nodes a model has a copy for each: more vertices than this are refused if they
// are so many times the file's.
constexpr std::size_t kMaxCopied = 1'000'000, kMaxGrowth = 20;
// Copies that are worth a warning: vertices beyond the file's, and as many as the file has.
constexpr std::size_t kMinCopied = 5'000;

// The first few distinct names, for a message.
class NameList {
 public:
  void add(const std::string& name) {
    ++count_;
    if (names_.size() < 4 && std::find(names_.begin(), names_.end(), name) == names_.end()) {
      names_.push_back(name);
    }
  }
  bool empty() const { return count_ == 0; }
  std::string text() const {
    return fmt::format("{}{}", fmt::join(names_, ", "), names_.size() < count_ ? ", ..." : "");
  }

 private:
  std::size_t count_ = 0;
  std::vector<std::string> names_;
};

// Appends what the file has; `count` values in all, `usual` where it has none.
template <typename Value>
void append(const nodes::Shared<Value>& from, std::size_t count, const Value& usual,
            std::vector<Value>& to) {
  if (from) to.insert(to.end(), from->begin(), from->end());
  to.resize(count, usual);
}

class MeshBuilder {
 public:
  MeshBuilder(const Scene& scene, const nodes::Evaluator& evaluator, const Rig& rig,
              const Conversion& conversion, const SceneActorOptions& options,
              Diagnostics& diagnostics)
      : scene_(scene),
        evaluator_(evaluator),
        rig_(rig),
        options_(options),
        diagnostics_(diagnostics),
        placements_(scene, evaluator, rig, conversion),
        targets_(scene, evaluator) {}

  Result<SceneActor> build() {
    for (const nodes::Instance& instance : evaluator_.instances()) {
      if (is_wanted(instance)) wanted_.push_back(instance);
    }
    report_what_is_left();
    if (Status status = check_growth(); !status) return status.error();
    look_at_attributes();
    for (const nodes::Instance& instance : wanted_) add(instance);
    if (with_normals_) make_missing_normals(actor_.model);
    if (Status status = finish(); !status) return status.error();
    if (options_.with_morphs) {
      if (Status status = add_targets(); !status) return status.error();
    }
    return std::move(actor_);
  }

 private:
  const nodes::Node& node_of(const nodes::Instance& instance) const {
    return scene_.nodes[at(instance.node)];
  }
  bool is_skinned(const nodes::Instance& instance) const {
    return placements_.is_skinned(instance);
  }
  bool is_wanted(const nodes::Instance& instance);
  Status check_growth();
  void report_what_is_left();
  void leave_tangents_out(const char* why);
  void look_at_attributes();
  void add(const nodes::Instance& instance);
  void add_vertices(const nodes::Instance& instance);
  void add_influences(const nodes::Instance& instance, std::size_t vertices);
  void add_normals(const nodes::Primitive& shape);
  void add_triangles(const nodes::Instance& instance, std::uint32_t first);
  Status finish();
  Status add_targets();

  const Scene& scene_;
  const nodes::Evaluator& evaluator_;
  const Rig& rig_;
  const SceneActorOptions& options_;
  Diagnostics& diagnostics_;
  Placements placements_;  // of the primitive being added
  std::vector<nodes::Instance> wanted_;
  std::vector<std::size_t> first_vertices_;  // in the model, of those of wanted_ that are added
  TargetNames targets_;
  SceneActor actor_;
  NameList elsewhere_, other_skeleton_, without_triangles_;
  bool with_normals_ = false, with_texture_ = false, with_tangents_ = false, with_colours_ = false;
  std::size_t sets_ = 1;  // of texture coordinates
  int influences_ = 4;
};

bool MeshBuilder::is_wanted(const nodes::Instance& instance) {
  const nodes::Node& node = node_of(instance);
  const std::string name = label("mesh", instance.mesh, scene_.meshes[at(instance.mesh)].name);
  if (node.skin >= 0) {
    const auto& skins = rig_.joints.skins;
    if (std::find(skins.begin(), skins.end(), node.skin) == skins.end()) {
      other_skeleton_.add(name);
      return false;
    }
  }
  if (!is_skinned(instance) && rig_.joints.node_to_joint[at(instance.node)] < 0) {
    elsewhere_.add(name);
    return false;
  }
  if (evaluator_.primitive(instance).triangles.empty()) {
    without_triangles_.add(name);
    return false;
  }
  return true;
}

Status MeshBuilder::check_growth() {
  std::size_t copied = 0, in_file = 0;
  std::set<std::pair<int, int>> seen;
  for (const nodes::Instance& instance : wanted_) {
    const std::size_t count = evaluator_.primitive(instance).vertex_count();
    copied += count;
    if (seen.emplace(instance.mesh, instance.primitive).second) in_file += count;
  }
  if (copied < 2 * in_file || copied - in_file < kMinCopied) return {};
  const std::string growth = fmt::format(
      "{} at {}: {} vertices, {} times the file's {}, as a model has a copy for each "
      "node",
      counted(std::ssize(seen), "primitive"), counted(std::ssize(wanted_), "place"),
      grouped(static_cast<long long>(copied)),
      readable(static_cast<double>(copied) / static_cast<double>(in_file), 3),
      grouped(static_cast<long long>(in_file)));
  if (copied <= kMaxCopied || copied <= kMaxGrowth * in_file) {
    diagnostics_.push_back(make_warning("scene-instances", growth));
    return {};
  }
  return Error(
      "scene-instances", growth,
      fmt::format("models over {} vertices may be {} times the file's: leave instances out",
                  grouped(static_cast<long long>(kMaxCopied)), kMaxGrowth));
}

void MeshBuilder::report_what_is_left() {
  const auto left_out = [&](const NameList& names, const char* why) {
    if (names.empty()) return;
    diagnostics_.push_back(make_warning(
        "scene-mesh", fmt::format("meshes skipped because {}: {}", why, names.text())));
  };
  left_out(elsewhere_, "no joint moves them");
  left_out(other_skeleton_, "they are bound to another skeleton");
  left_out(without_triangles_, "they have points or lines but no triangles");
  NameList outside;
  for (const nodes::Node& node : scene_.nodes) {
    if (node.mesh < 0 || node.in_scene) continue;
    outside.add(label("mesh", node.mesh, scene_.meshes[at(node.mesh)].name));
  }
  left_out(outside, "their nodes are not in the displayed scene");
  std::ptrdiff_t sets = 0;
  for (const nodes::Instance& instance : wanted_) {
    sets = std::max(sets, std::ssize(evaluator_.primitive(instance).more_texture_coordinates) + 1);
  }
  if (sets > Model::kMaxCoordinateSets) {
    diagnostics_.push_back(make_warning(
        "scene-mesh-attributes",
        fmt::format("{} sets of texture coordinates, a model holds {}: the others are left out",
                    sets, Model::kMaxCoordinateSets)));
  }
  if (!options_.with_morphs) return;
  long long tangents = 0;
  for (const nodes::Instance& instance : wanted_) {
    for (const nodes::MorphTarget& target : evaluator_.primitive(instance).targets) {
      if (target.tangents) ++tangents;
    }
  }
  if (tangents > 0) {
    diagnostics_.push_back(make_warning(
        "scene-morph-tangents",
        fmt::format("the tangents of {} are left out", counted(tangents, "morph target"))));
  }
}

void MeshBuilder::leave_tangents_out(const char* why) {
  diagnostics_.push_back(make_warning("scene-tangents",
                                      fmt::format("tangents are left out, as {}", why),
                                      "viewers make those that a normal texture needs (glTF 2.0, "
                                      "3.7.2.1), with small differences"));
}

void MeshBuilder::look_at_attributes() {
  std::size_t with_tangents = 0;
  for (const nodes::Instance& instance : wanted_) {
    const nodes::Primitive& shape = evaluator_.primitive(instance);
    with_normals_ = with_normals_ || shape.normals;
    with_texture_ = with_texture_ || shape.texture_coordinates;
    with_colours_ = with_colours_ || shape.colours;
    sets_ = std::clamp(shape.more_texture_coordinates.size() + 1, sets_,
                       std::size_t{Model::kMaxCoordinateSets});
    with_tangents += shape.tangents ? 1 : 0;
    if (is_skinned(instance) && shape.influences_per_vertex > 4) influences_ = 8;
  }
  with_tangents_ = with_tangents > 0 && with_tangents == wanted_.size() && with_normals_;
  if (with_tangents > 0 && !with_tangents_) leave_tangents_out("not all meshes have some");
  with_texture_ = with_texture_ || sets_ > 1;
  actor_.model.more_texture_coordinates.resize(sets_ - 1);
}

void MeshBuilder::add_influences(const nodes::Instance& instance, std::size_t vertices) {
  const nodes::Primitive& shape = evaluator_.primitive(instance);
  Model& model = actor_.model;
  const std::size_t first = model.influence_joints.size();
  const auto places = at(influences_);
  model.influence_joints.resize(first + vertices * places, 0);
  model.influence_weights.resize(first + vertices * places, 0.0f);
  if (!is_skinned(instance)) {
    const int joint = rig_.joints.node_to_joint[at(instance.node)];
    for (std::size_t v = 0; v < vertices; ++v) {
      model.influence_joints[first + v * places] = static_cast<std::uint16_t>(joint);
      model.influence_weights[first + v * places] = 1.0f;
    }
    return;
  }
  const nodes::Skin& skin = scene_.skins[at(node_of(instance).skin)];
  const auto per_vertex = static_cast<std::size_t>(shape.influences_per_vertex);
  for (std::size_t v = 0; v < vertices; ++v) {
    for (std::size_t k = 0; k < per_vertex; ++k) {
      const int node = skin.joints[shape.influence_joints[v * per_vertex + k]];
      model.influence_joints[first + v * places + k] =
          static_cast<std::uint16_t>(rig_.joints.node_to_joint[at(node)]);
      model.influence_weights[first + v * places + k] = shape.influence_weights[v * per_vertex + k];
    }
  }
}

void MeshBuilder::add_normals(const nodes::Primitive& shape) {
  for (std::size_t v = 0; v < shape.vertex_count(); ++v) {
    const Mat3 linear = placements_.of(v).leftCols<3>();
    if (with_normals_) {
      const Vec3 normal = shape.normals
                              ? Vec3(normal_matrix(linear) * (*shape.normals)[v].cast<double>())
                              : Vec3(Vec3::Zero());
      actor_.model.normals.push_back(normal.stableNormalized().cast<float>());
    }
    if (with_tangents_) {
      const Vec4f& tangent = (*shape.tangents)[v];
      const Vec3 turned = (linear * tangent.head<3>().cast<double>()).stableNormalized();
      const bool mirrored = linear.determinant() < 0;
      const float side = (tangent.w() < 0) != mirrored ? -1.0f : 1.0f;
      actor_.model.tangents.emplace_back(static_cast<float>(turned.x()),
                                         static_cast<float>(turned.y()),
                                         static_cast<float>(turned.z()), side);
    }
  }
}

// If the transform mirrors, the winding is reversed to stay counter-clockwise.
void MeshBuilder::add_triangles(const nodes::Instance& instance, std::uint32_t first) {
  const nodes::Primitive& shape = evaluator_.primitive(instance);
  Model& model = actor_.model;
  const nodes::Mesh& mesh = scene_.meshes[at(instance.mesh)];
  const std::string& node_name = node_of(instance).name;
  const std::string& mesh_name = mesh.name.empty() ? node_name : mesh.name;
  model.parts.push_back({to_utf8(shape.material.empty() ? mesh_name : shape.material),
                         to_utf8(shape.material),
                         static_cast<std::uint32_t>(model.triangles.size()),
                         static_cast<std::uint32_t>(shape.triangles.size()), to_utf8(mesh_name)});
  actor_.part_materials.push_back(shape.material_index);
  for (auto triangle : shape.triangles) {
    const bool mirrored = placements_.of(triangle[0]).leftCols<3>().determinant() < 0;
    if (mirrored) std::swap(triangle[1], triangle[2]);
    for (std::uint32_t& corner : triangle) corner += first;
    model.triangles.push_back(triangle);
  }
}

void MeshBuilder::add(const nodes::Instance& instance) {
  const nodes::Primitive& shape = evaluator_.primitive(instance);
  placements_.find(instance);
  const std::size_t place = first_vertices_.size();
  if (place > 0 && wanted_[place - 1].node == instance.node &&
      same_vertices(evaluator_.primitive(wanted_[place - 1]), shape)) {
    first_vertices_.push_back(first_vertices_.back());
  } else {
    first_vertices_.push_back(actor_.model.positions.size());
    add_vertices(instance);
  }
  add_triangles(instance, static_cast<std::uint32_t>(first_vertices_.back()));
}

void MeshBuilder::add_vertices(const nodes::Instance& instance) {
  const nodes::Primitive& shape = evaluator_.primitive(instance);
  Model& model = actor_.model;
  for (std::size_t v = 0; v < shape.vertex_count(); ++v) {
    const Vec3 position = (*shape.positions)[v].cast<double>();
    model.positions.push_back((placements_.of(v) * position.homogeneous()).cast<float>());
  }
  add_normals(shape);
  const std::size_t count = model.positions.size();
  if (with_texture_) {
    append<Vec2f>(shape.texture_coordinates, count, Vec2f::Zero(), model.texture_coordinates);
  }
  for (std::size_t s = 0; s + 1 < sets_; ++s) {
    const auto& sets = shape.more_texture_coordinates;
    append<Vec2f>(s < sets.size() ? sets[s] : nullptr, count, Vec2f::Zero(),
                  model.more_texture_coordinates[s]);
  }
  // White, where a part has none, looks the same.
  if (with_colours_) append<Vec4f>(shape.colours, count, Vec4f::Ones(), model.colours);
  add_influences(instance, shape.vertex_count());
}

Status MeshBuilder::finish() {
  Model& model = actor_.model;
  const auto near = [](const auto& value) { return is_near(value); };
  if (!std::all_of(model.positions.begin(), model.positions.end(), near) ||
      !std::all_of(model.texture_coordinates.begin(), model.texture_coordinates.end(), near)) {
    return Error("scene-value", "the mesh's vertices are not finite or over 1e9 m away",
                 "the unit may be wrong; set it with --unit");
  }
  // If a tangent is zero in the file or made zero by a flat transform, all are dropped.
  const auto is_unit = [](const Vec4f& tangent) {
    return std::abs(tangent.head<3>().norm() - 1) < 1e-3f;
  };
  if (!std::all_of(model.tangents.begin(), model.tangents.end(), is_unit)) {
    leave_tangents_out("some are zero");
    model.tangents.clear();
  }
  model.influences_per_vertex = influences_;
  normalize_influences(model);
  return {};
}

Status MeshBuilder::add_targets() {
  for (const nodes::Instance& instance : wanted_) targets_.add(instance);
  MorphSet& morphs = actor_.morphs;
  const std::size_t vertices = actor_.model.positions.size();
  morphs.names = targets_.names();
  morphs.vertex_count = static_cast<int>(vertices);
  actor_.weight_sources = targets_.sources();
  const std::size_t all = morphs.names.size() * vertices;
  constexpr std::size_t kMax = 50'000'000;
  if (!morphs.names.empty() && vertices > kMax / morphs.names.size()) {
    return Error(
        "scene-morphs",
        fmt::format("{} morph targets of {} vertices exceed the limit of 50 million in total",
                    morphs.names.size(), vertices));
  }
  morphs.positions.reserve(all);
  for (std::size_t t = 0; t < morphs.names.size(); ++t) {
    const auto& base = actor_.model;
    morphs.positions.insert(morphs.positions.end(), base.positions.begin(), base.positions.end());
    morphs.normals.insert(morphs.normals.end(), base.normals.begin(), base.normals.end());
  }
  for (std::size_t i = 0; i < wanted_.size(); ++i) {
    const nodes::Instance& instance = wanted_[i];
    const nodes::Primitive& shape = evaluator_.primitive(instance);
    if (!shape.targets.empty()) placements_.find(instance);
    for (std::size_t k = 0; k < shape.targets.size(); ++k) {
      const int target = targets_.index_of(instance, static_cast<int>(k));
      const std::size_t offset = at(target) * vertices + first_vertices_[i];
      const nodes::MorphTarget& moved = shape.targets[k];
      for (std::size_t v = 0; v < shape.vertex_count(); ++v) {
        const Mat3 linear = placements_.of(v).leftCols<3>();
        if (moved.positions) {
          const Vec3 place =
              (*shape.positions)[v].cast<double>() + (*moved.positions)[v].cast<double>();
          morphs.positions[offset + v] = (placements_.of(v) * place.homogeneous()).cast<float>();
        }
        if (moved.normals && shape.normals && !morphs.normals.empty()) {
          const Mat3 turn = normal_matrix(linear);
          const Vec3 base = turn * (*shape.normals)[v].cast<double>();
          const double length = base.stableNorm();
          const Vec3 normal = base + turn * (*moved.normals)[v].cast<double>();
          if (length > 0) morphs.normals[offset + v] = (normal / length).cast<float>();
        }
      }
    }
  }
  return check(morphs);
}

}  // namespace

Result<SceneActor> make_actor(const Scene& scene, const nodes::Evaluator& evaluator, const Rig& rig,
                              const Conversion& conversion, const SceneActorOptions& options,
                              Diagnostics& diagnostics) {
  auto actor = MeshBuilder(scene, evaluator, rig, conversion, options, diagnostics).build();
  if (!actor) return actor;
  auto skeleton = skeleton_in_krok(rig, conversion);
  if (!skeleton) return std::move(skeleton).error();
  actor->model.skeleton = *std::move(skeleton);
  if (Status status = check(actor->model); !status) return status.error();
  return actor;
}

}  // namespace krok::character
