#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/numbers.h"
#include "describe.h"
#include "formats/gltf/gltf_reader.h"
#include "nodes/evaluate.h"

namespace krok::info {

namespace {

constexpr std::size_t kMostNames = 12;

std::string named(const std::string& name, std::size_t index) {
  return name.empty() ? fmt::format("number {}", index) : name;
}

void add_meshes(const nodes::Scene& asset, Description& out) {
  std::vector<std::string> lines;
  out.json["meshes"] = Json::array();
  for (std::size_t i = 0; i < asset.meshes.size(); ++i) {
    const nodes::Mesh& mesh = asset.meshes[i];
    std::size_t vertices = 0, triangles = 0;
    for (const nodes::Primitive& primitive : mesh.primitives) {
      vertices += primitive.vertex_count();
      triangles += primitive.triangles.size();
    }
    std::string line =
        fmt::format("{}: {}, {}", named(mesh.name, i), count_of(vertices, "vertex", "vertices"),
                    count_of(triangles, "triangle"));
    Json targets = Json::array();
    std::string names;
    if (mesh.target_count() > 0) {
      line += ", " + count_of(mesh.target_count(), "morph target");
      for (const nodes::MorphTarget& target : mesh.primitives[0].targets) {
        targets.push_back(target.name);
        if (targets.size() <= kMostNames) names += (names.empty() ? "" : ", ") + target.name;
      }
      const bool named = names.find_first_not_of(", ") != std::string::npos;
      if (named) line += ": " + names + (targets.size() > kMostNames ? ", ..." : "");
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

void add_skins(const nodes::Scene& asset, Description& out) {
  std::vector<std::string> lines;
  out.json["skins"] = Json::array();
  for (std::size_t i = 0; i < asset.skins.size(); ++i) {
    const nodes::Skin& skin = asset.skins[i];
    lines.push_back(
        fmt::format("{}: {}", named(skin.name, i), count_of(skin.joints.size(), "joint")));
    out.json["skins"].push_back({{"name", skin.name}, {"joints", skin.joints.size()}});
  }
  out.add("skins", std::move(lines));
}

void add_animations(const nodes::Scene& asset, Description& out) {
  std::vector<std::string> lines;
  out.json["animations"] = Json::array();
  for (std::size_t i = 0; i < asset.animations.size(); ++i) {
    const nodes::Animation& animation = asset.animations[i];
    double end = 0;
    std::size_t keys = 0;
    for (const nodes::Channel& channel : animation.channels) {
      if (!channel.times || channel.times->empty()) continue;
      end = std::max(end, static_cast<double>(channel.times->back()));
      keys = std::max(keys, channel.times->size());
    }
    lines.push_back(fmt::format("{}: {} s, {}, up to {} each", named(animation.name, i),
                                readable(end, 5), count_of(animation.channels.size(), "channel"),
                                count_of(keys, "key")));
    out.json["animations"].push_back({{"name", animation.name},
                                      {"duration", end},
                                      {"channels", animation.channels.size()},
                                      {"keys", keys}});
  }
  out.add("animations", std::move(lines));
}

// The cameras at nodes of the scene that is shown.
void add_cameras(const nodes::Scene& asset, Description& out) {
  std::vector<std::string> lines;
  out.json["cameras"] = Json::array();
  for (const nodes::Node& node : asset.nodes) {
    if (node.camera < 0 || !node.in_scene) continue;
    const nodes::Camera& camera = asset.cameras[static_cast<std::size_t>(node.camera)];
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

// What a viewer shows before it plays an animation.
Status add_shown_size(const nodes::Scene& asset, Description& out) {
  const auto evaluator = nodes::Evaluator::create(asset);
  if (!evaluator) return evaluator.error();
  nodes::Evaluation shown;
  evaluator->evaluate(-1, 0, shown);
  Eigen::AlignedBox3d box;
  for (const auto& positions : shown.positions) {
    for (const Vec3& position : positions) box.extend(position);
  }
  if (!box.isEmpty()) {
    add_size(box, "meshes as shown without animation", out);
    return {};
  }
  for (const int joint : evaluator->joints()) {
    const Mat4& to_world = shown.node_to_world[static_cast<std::size_t>(joint)];
    box.extend(Vec3(to_world.topRightCorner<3, 1>()));
  }
  add_size(box, "nodes as shown without animation", out);
  return {};
}

}  // namespace

Result<Description> describe_gltf(const InputFile& file, ToolContext& context) {
  const std::string folder = std::filesystem::path(file.path()).parent_path().string();
  const auto asset = gltf::read(file.bytes(), {.folder = folder.empty() ? "." : folder});
  if (!asset) return asset.error();
  for (Diagnostic diagnostic : asset->diagnostics) {
    if (diagnostic.where.file.empty()) diagnostic.where.file = file.path();
    context.tell(std::move(diagnostic));
  }
  Description out;
  out.what = "a glTF scene";
  out.json["kind"] = "gltf";
  out.add("nodes", std::to_string(asset->nodes.size()));
  out.json["nodes"] = asset->nodes.size();
  add_meshes(*asset, out);
  add_skins(*asset, out);
  add_animations(*asset, out);
  add_cameras(*asset, out);
  if (Status sized = add_shown_size(*asset, out); !sized) return sized.error();
  if (!asset->generator.empty()) out.add("made by", asset->generator);
  out.json["generator"] = asset->generator;
  return out;
}

}  // namespace krok::info
