#include "tools/shared/drawn_scene.h"

#include <algorithm>

namespace krok::cli {

DrawnScene::DrawnScene(Scene scene, const DecodedImages& images, const DrawnSceneOptions& options)
    : scene_(std::move(scene)) {
  for (const SceneMesh& mesh : scene_.meshes) {
    triangles_.push_back(
        std::make_shared<render::Triangles>(mesh.triangles.begin(), mesh.triangles.end()));
    has_triangles_ = has_triangles_ || !mesh.triangles.empty();
  }
  bones_ = !scene_.joint_names.empty() && (options.bones || !has_triangles_);
  if (bones_) style_ = bone_style(skeleton_of(scene_));
  if (!bones_) set_looks(images, options.one_grey_is_none);
}

SharedCoordinates DrawnScene::coordinates_of(const SceneMesh& mesh, int set) const {
  const auto more = static_cast<std::size_t>(set);
  std::span<const Vec2f> coordinates;
  if (set == 0) {
    coordinates = mesh.texture_coordinates;
  } else if (more <= mesh.more_texture_coordinates.size()) {
    coordinates = mesh.more_texture_coordinates[more - 1];
  }
  if (coordinates.empty()) return nullptr;
  return std::make_shared<const std::vector<Vec2f>>(coordinates.begin(), coordinates.end());
}

void DrawnScene::set_looks(const DecodedImages& images, bool one_grey_is_none) {
  Material usual;
  if (!scene_.knows_materials) usual.base_color = Vec4f::Ones();  // vertex colours alone
  bool chosen = scene_.knows_materials && !one_grey_is_none, drawn = false;
  std::optional<render::Colour> before;
  for (const SceneMesh& mesh : scene_.meshes) {
    const Material& material = mesh.material != nullptr ? *mesh.material : usual;
    const int set = material.base_color_texture.set;
    const auto look = look_of(
        material, material.base_color_texture ? coordinates_of(mesh, set) : nullptr, images);
    looks_.push_back(look);
    auto& colours = vertex_colours_.emplace_back();
    if (!look) continue;
    drawn = drawn || !mesh.triangles.empty();
    // A texture has the base colour as its factor.
    const Vec3f factor =
        look->paint != nullptr ? Vec3f(Vec3f::Ones()) : Vec3f(material.base_color.head<3>());
    for (const Vec4f& colour : mesh.colours) {
      colours.push_back(render::to_colour(factor.cwiseProduct(colour.head<3>())));
    }
    const render::Colour& plain = look->colour;
    const bool grey = plain.red == plain.green && plain.green == plain.blue;
    chosen = chosen || !mesh.colours.empty() || look->paint != nullptr ||
             (one_grey_is_none && (!grey || (before && !(*before == plain))));
    before = plain;
  }
  if (!chosen || !drawn) looks_.assign(looks_.size(), SurfaceLook{kBodyColour, nullptr});
}

render::Surface DrawnScene::surface(const SceneState& state, std::size_t mesh) const {
  render::Surface result;
  result.positions.reserve(state.positions[mesh].size());
  for (const Vec3& point : state.positions[mesh]) result.positions.push_back(point.cast<float>());
  for (const Vec3& normal : state.normals[mesh]) result.normals.push_back(normal.cast<float>());
  result.triangles = triangles_[mesh];
  result.colours = vertex_colours_[mesh];
  if (result.colours.empty()) result.colours = {looks_[mesh]->colour};
  result.paint = looks_[mesh]->paint;
  return result;
}

render::Actor DrawnScene::at(const SceneState& state) const {
  if (bones_) {
    std::vector<Vec3f> joints;
    for (const Transform& joint : state.joints) joints.push_back(joint.position.cast<float>());
    return bone_actor(style_, joints);
  }
  render::Actor actor;
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    if (looks_[i]) actor.surfaces.push_back(surface(state, i));
  }
  return actor;
}

}  // namespace krok::cli
