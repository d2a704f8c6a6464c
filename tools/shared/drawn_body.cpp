#include "tools/shared/drawn_body.h"

#include <limits>

#include "tools/shared/bone_actor.h"

namespace krok::cli {

namespace {

template <typename Value>
std::vector<Value> chosen(const std::vector<Value>& values,
                          const std::vector<std::uint32_t>& places) {
  std::vector<Value> result;
  if (values.empty()) return result;
  result.reserve(places.size());
  for (const std::uint32_t place : places) result.push_back(values[place]);
  return result;
}

}  // namespace

DrawnBody::DrawnBody(std::shared_ptr<const Model> model, std::span<const Material> materials,
                     SkinMethod method, const DecodedImages& images)
    : model_(std::move(model)), binding_(*model_, method) {
  Material usual;
  if (materials.empty()) usual.base_color = Vec4f::Ones();  // vertex colours alone
  for (const Model::Part& part : model_->parts) {
    if (materials.empty() && model_->colours.empty()) break;
    const Material* const found = find_material(materials, part.material);
    const Material& material = found != nullptr ? *found : usual;
    if (part.triangle_count == 0) continue;
    Part drawn = part_of(part);
    const int set = material.base_color_texture.set;
    const auto look = look_of(material, coordinates_of(drawn, set), images);
    if (!look) continue;
    drawn.look = *look;
    drawn.colours = {look->colour};
    if (!model_->colours.empty()) {
      // A texture has the base colour as its factor.
      const Vec3f factor =
          look->paint != nullptr ? Vec3f(Vec3f::Ones()) : Vec3f(material.base_color.head<3>());
      drawn.colours.clear();
      for (const Vec4f& colour : chosen(model_->colours, drawn.vertices)) {
        drawn.colours.push_back(render::to_colour(factor.cwiseProduct(colour.head<3>())));
      }
    }
    parts_.push_back(std::move(drawn));
  }
  if (parts_.empty()) triangles_ = std::make_shared<render::Triangles>(model_->triangles);
}

SharedCoordinates DrawnBody::coordinates_of(const Part& part, int set) const {
  const auto more = static_cast<std::size_t>(set);
  if (model_->texture_coordinates.empty() || more > model_->more_texture_coordinates.size()) {
    return nullptr;
  }
  return std::make_shared<const std::vector<Vec2f>>(
      chosen(set == 0 ? model_->texture_coordinates : model_->more_texture_coordinates[more - 1],
             part.vertices));
}

DrawnBody::Part DrawnBody::part_of(const Model::Part& part) const {
  constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> place_of(model_->positions.size(), kNone);
  Part drawn;
  render::Triangles triangles;
  triangles.reserve(part.triangle_count);
  for (const auto& triangle :
       std::span(model_->triangles).subspan(part.first_triangle, part.triangle_count)) {
    auto& corners = triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& place = place_of[triangle[k]];
      if (place == kNone) {
        place = static_cast<std::uint32_t>(drawn.vertices.size());
        drawn.vertices.push_back(triangle[k]);
      }
      corners[k] = place;
    }
  }
  drawn.triangles = std::make_shared<render::Triangles>(std::move(triangles));
  return drawn;
}

std::vector<render::Surface> DrawnBody::at(std::span<const Transform> pose) const {
  SkinPose posed(binding_);
  posed.set(pose);
  std::vector<Vec3f> positions(model_->positions.size()), normals(model_->normals.size());
  skin(binding_, posed, {model_->positions, model_->normals, {}}, {positions, normals, {}});
  std::vector<render::Surface> surfaces;
  if (parts_.empty()) {
    surfaces.push_back({std::move(positions), std::move(normals), triangles_, {kBodyColour}});
    return surfaces;
  }
  surfaces.reserve(parts_.size());
  for (const Part& part : parts_) {
    surfaces.push_back({chosen(positions, part.vertices), chosen(normals, part.vertices),
                        part.triangles, part.colours, part.look.paint});
  }
  return surfaces;
}

}  // namespace krok::cli
