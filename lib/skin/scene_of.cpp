#include "skin/scene_of.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "core/index.h"
#include "math/quaternion.h"
#include "scene/mesh_motion.h"

namespace krok {

namespace {

// A place between two frames: `share` is the weight of the next one.
struct FramePlace {
  int frame = 0;
  double share = 0;
};

FramePlace place_of(double time, const std::vector<double>& times) {
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  if (after == times.begin()) return {};
  const auto frame = static_cast<std::size_t>(after - times.begin()) - 1;
  if (after == times.end()) return {static_cast<int>(frame), 0};
  return {static_cast<int>(frame), (time - times[frame]) / (*after - times[frame])};
}

template <typename From>
std::vector<Eigen::Matrix<double, From::RowsAtCompileTime, 1>> in_doubles(
    std::span<const From> values, std::span<const std::uint32_t> chosen) {
  std::vector<Eigen::Matrix<double, From::RowsAtCompileTime, 1>> result;
  if (values.empty()) return result;
  result.reserve(chosen.empty() ? values.size() : chosen.size());
  if (chosen.empty()) {
    for (const From& value : values) result.push_back(value.template cast<double>());
  }
  for (const std::uint32_t i : chosen) result.push_back(values[i].template cast<double>());
  return result;
}

template <typename Value>
std::vector<Value> chosen_of(const std::vector<Value>& values,
                             std::span<const std::uint32_t> chosen) {
  std::vector<Value> result;
  if (values.empty()) return result;
  result.reserve(chosen.size());
  for (const std::uint32_t i : chosen) result.push_back(values[i]);
  return result;
}

// What a part has of its own.
struct PartMemory {
  const Model::Part* part = nullptr;
  std::vector<std::uint32_t> vertices;  // of the model; empty for all
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Vec2f> coordinates;
  std::vector<std::vector<Vec2f>> more_coordinates;
  std::vector<Vec4f> colours;
};

class ActorPlayer {
 public:
  ActorPlayer(std::shared_ptr<const Actor> actor, SkinMethod method) : actor_(std::move(actor)) {
    if (!actor_->motions.empty() && actor_->model.vertex_count() > 0) {
      binding_.emplace(actor_->model, method);
    }
    for (const Actor::Motion& motion : actor_->motions) {
      auto& times = times_.emplace_back();
      for (int i = 0; i < motion.clip.frame_count(); ++i) times.push_back(i / motion.clip.rate);
    }
  }

  const std::vector<double>& times(std::size_t motion) const { return times_[motion]; }

  SceneMesh mesh_of_all() {
    const Model& model = actor_->model;
    parts_.emplace_back();
    SceneMesh mesh = common();
    mesh.vertex_count = model.positions.size();
    mesh.triangles = model.triangles;
    mesh.texture_coordinates = model.texture_coordinates;
    mesh.more_texture_coordinates.assign(model.more_texture_coordinates.begin(),
                                         model.more_texture_coordinates.end());
    mesh.colours = model.colours;
    mesh.influences = {model.influences_per_vertex, model.influence_joints,
                       model.influence_weights};
    return mesh;
  }

  std::vector<SceneMesh> meshes_of_parts() {
    for (const Model::Part& part : actor_->model.parts) {
      if (part.triangle_count > 0) parts_.push_back(memory_of(part));
    }
    std::vector<SceneMesh> meshes;
    for (const PartMemory& memory : parts_) {
      SceneMesh mesh = common();
      mesh.name = memory.part->name;
      mesh.vertex_count = memory.vertices.size();
      mesh.triangles = memory.triangles;
      mesh.texture_coordinates = memory.coordinates;
      mesh.more_texture_coordinates.assign(memory.more_coordinates.begin(),
                                           memory.more_coordinates.end());
      mesh.colours = memory.colours;
      mesh.material = find_material(actor_->materials, memory.part->material);
      meshes.push_back(std::move(mesh));
    }
    return meshes;
  }

  void evaluate(int animation, double time, SceneState& state) const {
    state.joints = actor_->skeleton().reference;
    std::vector<Stretch> stretches;
    if (animation >= 0) pose_at(at(animation), time, state.joints, stretches);
    state.positions.clear();
    state.normals.clear();
    state.tangents.clear();
    if (state.joints_alone || parts_.empty()) return;
    const Model& model = actor_->model;
    MeshShape shape{model.positions, model.normals, model.tangents};
    ShapeRoom room;
    if (animation >= 0) {
      room.positions.resize(model.positions.size());
      room.normals.resize(model.normals.size());
      room.tangents.resize(model.tangents.size());
      SkinPose pose(*binding_);
      pose.set(state.joints, stretches);
      skin(*binding_, pose, skin_surface(model), {room.positions, room.normals, room.tangents});
      shape = {room.positions, room.normals, room.tangents};
    }
    for (const PartMemory& part : parts_) {
      state.positions.push_back(in_doubles(shape.positions, part.vertices));
      state.normals.push_back(in_doubles(shape.normals, part.vertices));
      state.tangents.push_back(in_doubles(shape.tangents, part.vertices));
    }
  }

 private:
  SceneMesh common() const {
    SceneMesh mesh;
    mesh.has_normals = !actor_->model.normals.empty();
    mesh.has_tangents = !actor_->model.tangents.empty();
    return mesh;
  }

  PartMemory memory_of(const Model::Part& part) const {
    const Model& model = actor_->model;
    constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> place_of(model.positions.size(), kNone);
    PartMemory memory;
    memory.part = &part;
    memory.triangles.reserve(part.triangle_count);
    for (const auto& triangle :
         std::span(model.triangles).subspan(part.first_triangle, part.triangle_count)) {
      auto& corners = memory.triangles.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t& place = place_of[triangle[k]];
        if (place == kNone) {
          place = static_cast<std::uint32_t>(memory.vertices.size());
          memory.vertices.push_back(triangle[k]);
        }
        corners[k] = place;
      }
    }
    memory.coordinates = chosen_of(model.texture_coordinates, memory.vertices);
    for (const auto& set : model.more_texture_coordinates) {
      memory.more_coordinates.push_back(chosen_of(set, memory.vertices));
    }
    memory.colours = chosen_of(model.colours, memory.vertices);
    return memory;
  }

  void pose_at(std::size_t motion, double time, std::vector<Transform>& joints,
               std::vector<Stretch>& stretches) const {
    const Clip& clip = actor_->motions[motion].clip;
    const Stretches& all_stretches = actor_->motions[motion].stretches;
    if (times_[motion].empty()) return;
    const FramePlace place = place_of(time, times_[motion]);
    clip.get_pose(place.frame, joints);
    if (!all_stretches.empty()) {
      stretches.resize(joints.size());
      sample(all_stretches, place.frame + place.share, stretches);
    }
    if (place.share == 0) return;
    std::vector<Transform> next(joints.size());
    clip.get_pose(place.frame + 1, next);
    for (std::size_t j = 0; j < next.size(); ++j) {
      joints[j].position += place.share * (next[j].position - joints[j].position);
      joints[j].orientation = slerp(joints[j].orientation, next[j].orientation, place.share);
    }
  }

  std::shared_ptr<const Actor> actor_;
  std::optional<SkinBinding> binding_;
  std::vector<std::vector<double>> times_;  // [motions][frames]
  std::vector<PartMemory> parts_;           // [meshes]
};

}  // namespace

Scene scene_of(std::shared_ptr<const Actor> actor, const ActorSceneOptions& options) {
  const auto player = std::make_shared<ActorPlayer>(actor, options.method);
  Scene scene;
  scene.memory = player;
  scene.only_joints = actor->model.vertex_count() == 0;
  scene.only_still = actor->motions.empty();
  scene.knows_materials = options.by_part && !actor->materials.empty();
  scene.joint_names = actor->skeleton().names;
  scene.joint_parents.assign(actor->skeleton().parents.begin(), actor->skeleton().parents.end());
  scene.joint_ends = actor->skeleton().end_sites;
  if (!scene.only_joints && options.by_part) {
    scene.meshes = player->meshes_of_parts();
  } else if (!scene.only_joints) {
    scene.meshes.push_back(player->mesh_of_all());
  }
  for (std::size_t i = 0; i < actor->motions.size(); ++i) {
    scene.animations.push_back({actor->motions[i].name, player->times(i)});
  }
  scene.evaluate = [player](int animation, double time, SceneState& state) {
    player->evaluate(animation, time, state);
  };
  return scene;
}

}  // namespace krok
