#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "character/motion.h"
#include "character/space.h"
#include "core/numbers.h"
#include "formats/io/open_scene.h"
#include "nodes/animation_choice.h"
#include "nodes/evaluate.h"
#include "tools/krok-info/describe.h"
#include "tools/krok-info/description.h"

namespace krok::cli::info {

namespace {

constexpr std::size_t kMaxNames = 12;

std::string named(const std::string& name, std::size_t index) {
  return name.empty() ? fmt::format("number {}", index) : name;
}

void add_meshes(const nodes::Scene& scene, Description& out) {
  std::vector<std::string> lines;
  out.json["meshes"] = Json::array();
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    const nodes::Mesh& mesh = scene.meshes[i];
    std::size_t vertices = 0, triangles = 0;
    for (const nodes::Primitive& primitive : mesh.primitives) {
      vertices += primitive.vertex_count();
      triangles += primitive.triangles.size();
    }
    std::string line =
        fmt::format("{}: {}, {}", named(mesh.name, i), counted(vertices, "vertex", "vertices"),
                    counted(triangles, "triangle"));
    Json targets = Json::array();
    std::string names;
    if (mesh.target_count() > 0) {
      line += ", " + counted(mesh.target_count(), "morph target");
      for (const nodes::MorphTarget& target : mesh.primitives[0].targets) {
        targets.push_back(target.name);
        if (targets.size() <= kMaxNames) names += (names.empty() ? "" : ", ") + target.name;
      }
      const bool named = names.find_first_not_of(", ") != std::string::npos;
      if (named) line += ": " + names + (targets.size() > kMaxNames ? ", ..." : "");
    }
    lines.push_back(std::move(line));
    out.json["meshes"].push_back({{"name", mesh.name},
                                  {"vertices", vertices},
                                  {"triangles", triangles},
                                  {"primitives", mesh.primitives.size()},
                                  {"morph_targets", mesh.target_count()},
                                  {"target_names", std::move(targets)}});
  }
  out.add("meshes", std::move(lines));
}

void add_skins(const nodes::Scene& scene, Description& out) {
  std::vector<std::string> lines;
  out.json["skins"] = Json::array();
  for (std::size_t i = 0; i < scene.skins.size(); ++i) {
    const nodes::Skin& skin = scene.skins[i];
    lines.push_back(
        fmt::format("{}: {}", named(skin.name, i), counted(skin.joints.size(), "joint")));
    out.json["skins"].push_back({{"name", skin.name}, {"joints", skin.joints.size()}});
  }
  out.add("skins", std::move(lines));
}

void add_animations(const nodes::Scene& scene, Description& out) {
  std::vector<std::string> lines;
  out.json["animations"] = Json::array();
  for (std::size_t i = 0; i < scene.animations.size(); ++i) {
    const nodes::Animation& animation = scene.animations[i];
    double end = 0;
    std::size_t keys = 0;
    for (const nodes::Channel& channel : animation.channels) {
      if (!channel.times || channel.times->empty()) continue;
      end = std::max(end, static_cast<double>(channel.times->back()));
      keys = std::max(keys, channel.times->size());
    }
    lines.push_back(fmt::format("{}: {} s, {}, up to {} each", named(animation.name, i),
                                readable(end, 5), counted(animation.channels.size(), "channel"),
                                counted(keys, "key")));
    out.json["animations"].push_back({{"name", animation.name},
                                      {"duration", end},
                                      {"channels", animation.channels.size()},
                                      {"keys", keys}});
  }
  out.add("animations", std::move(lines));
}

// The cameras at nodes of the default scene.
void add_cameras(const nodes::Scene& scene, Description& out) {
  std::vector<std::string> lines;
  out.json["cameras"] = Json::array();
  for (const nodes::Node& node : scene.nodes) {
    if (node.camera < 0 || !node.in_scene) continue;
    const nodes::Camera& camera = scene.cameras[static_cast<std::size_t>(node.camera)];
    const std::string& name = node.name.empty() ? camera.name : node.name;
    const double degrees = camera.field_of_view / kRadiansPerDegree;
    lines.push_back(fmt::format("{}: {}", named(name, lines.size()),
                                camera.perspective
                                    ? fmt::format("{} deg field of view", readable(degrees, 4))
                                    : "orthographic"));
    out.json["cameras"].push_back({{"name", name}, {"perspective", camera.perspective}});
    if (camera.perspective) out.json["cameras"].back()["field_of_view"] = degrees;
  }
  out.add("cameras", std::move(lines));
}

// Whether an animation moves nodes, not only morph targets.
bool moves_nodes(const nodes::Scene& scene) {
  const auto moves = [](const nodes::Channel& channel) {
    return channel.path != nodes::Path::weights;
  };
  return std::ranges::any_of(scene.animations, [&](const nodes::Animation& animation) {
    return std::ranges::any_of(animation.channels, moves);
  });
}

// Volumes of the meshes; `positions` as in an Evaluation, but in metres. The primitives of a mesh
// at a node are one volume.
void add_volumes(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                 const std::vector<std::vector<Vec3>>& positions, Description& out) {
  std::vector<NamedVolume> volumes;
  const auto& instances = evaluator.instances();
  for (std::size_t i = 0; i < instances.size();) {
    const nodes::Instance& first = instances[i];
    std::vector<Vec3> points;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (; i < instances.size() && instances[i].node == first.node; ++i) {
      const auto before = static_cast<std::uint32_t>(points.size());
      points.insert(points.end(), positions[i].begin(), positions[i].end());
      for (const auto& [a, b, c] : evaluator.primitive(instances[i]).triangles) {
        triangles.push_back({before + a, before + b, before + c});
      }
    }
    if (triangles.empty()) continue;
    const auto mesh = static_cast<std::size_t>(first.mesh);
    volumes.push_back({named(scene.meshes[mesh].name, mesh), mesh_volume(points, triangles)});
  }
  add_volumes(volumes, out);
}

// Size as displayed by a viewer before an animation plays, in metres.
Status add_shown_size(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                      const Conventions& conventions, Description& out) {
  const auto conversion = Conversion::make(conventions);
  if (!conversion) return conversion.error();
  const Mat4 turn = character::rotation_to_apply(scene.space);
  const auto converted = [&](const Vec3& position) {
    const Vec3 turned = turn.topLeftCorner<3, 3>() * position;
    return conversion->pose({turned, Quat::Identity()}).position;
  };
  Eigen::AlignedBox3d box;
  nodes::Evaluation shown;
  evaluator.evaluate(-1, 0, shown);
  for (auto& positions : shown.positions) {
    for (Vec3& position : positions) {
      position = converted(position);
      box.extend(position);
    }
  }
  if (!box.isEmpty()) {
    add_size(box, "meshes as shown without animation", out);
    add_volumes(scene, evaluator, shown.positions, out);
    return {};
  }
  for (const int joint : evaluator.joints()) {
    const Mat4& to_world = shown.node_to_world[static_cast<std::size_t>(joint)];
    box.extend(converted(to_world.topRightCorner<3, 1>()));
  }
  add_size(box, "nodes as shown without animation", out);
  return {};
}

// The skeleton with roles, unit, axes and size.
Status add_actor(const nodes::Scene& scene, const std::string& path, const SkeletonOptions& how,
                 ToolContext& context, Description& out) {
  const auto evaluator = nodes::Evaluator::create(scene);
  if (!evaluator) return evaluator.error();
  Diagnostics found;
  auto rig = character::find_rig(scene, *evaluator, "", found);
  if (!rig && rig.error().code != "scene-skeleton") return rig.error();
  const character::Rig* const skeleton = rig ? &*rig : nullptr;
  // With neither skins nor animated nodes any node might be a joint, which is no skeleton to tell
  // of.
  const bool listed = !scene.skins.empty() || moves_nodes(scene);
  if (!listed) found.clear();
  context.diagnose_in(path, found);
  RoleMap roles;
  if (skeleton != nullptr) {
    auto map = how.roles(skeleton->skeleton);
    if (!map) return map.error();
    roles = *std::move(map);
  }
  const std::vector<int> joints = skeleton != nullptr ? skeleton->joints.nodes : std::vector<int>();
  const int animation = best_animation(scene, joints).animation;
  const auto conventions =
      character::scene_conventions(scene, *evaluator, skeleton, roles, animation, {});
  if (!conventions) return conventions.error();
  if (listed && skeleton != nullptr) {
    add_skeleton(skeleton->skeleton, roles, how.verbose, conventions->unit.metres, out);
  }
  add_conventions(*conventions, out);
  return add_shown_size(scene, *evaluator, *conventions, out);
}

// "a glTF scene", "an FBX file".
std::string name_of(registry::Kind kind, const InputFile& file) {
  if (!registry::is_read_through_assimp(kind)) return "a glTF scene";
  if (registry::kind_of_content(file.bytes()) == registry::Kind::unknown) {
    return fmt::format("a scene (.{})", registry::kind_name(kind));
  }
  return std::string(registry::describe_content(file.bytes()));
}

}  // namespace

Result<Description> describe_scene(const InputFile& file, registry::Kind kind,
                                   const SkeletonOptions& how, ToolContext& context) {
  const auto scene = io::open_scene(file, context);
  if (!scene) return scene.error();
  context.diagnose(scene->diagnostics);
  Description out(name_of(kind, file),
                  registry::is_read_through_assimp(kind) ? registry::kind_name(kind) : "gltf");
  out.add("nodes", grouped(std::ssize(scene->nodes)));
  out.json["nodes"] = scene->nodes.size();
  add_meshes(*scene, out);
  add_skins(*scene, out);
  add_animations(*scene, out);
  add_cameras(*scene, out);
  if (Status status = add_actor(*scene, file.path(), how, context, out); !status) {
    return status.error();
  }
  if (!scene->generator.empty()) out.add("made by", scene->generator);
  out.json["generator"] = scene->generator;
  return out;
}

}  // namespace krok::cli::info
