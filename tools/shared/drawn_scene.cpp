#include "tools/shared/drawn_scene.h"

#include <fmt/format.h>
#include <algorithm>

#include "core/text.h"
#include "formats/image/decode_image.h"

namespace krok::cli {

namespace {

constexpr float kSeenThrough = 0.5F;  // not drawn below this alpha
constexpr std::size_t kMaxPixels = std::size_t{1} << 28;

std::size_t pixels_of(const DecodedImages& images) {
  std::size_t pixels = 0;
  for (const auto& [image, mipmap] : images) {
    if (mipmap != nullptr) pixels += mipmap->levels()[0].rgba.size() / 4;
  }
  return pixels;
}

std::string words_for(const Material& material, const EncodedImage& image) {
  const std::string& called = image.path.empty() ? image.name : image.path;
  const std::string name = called.empty() ? std::string() : fmt::format(" '{}'", shown(called));
  return fmt::format("image{} of material '{}'", name, shown(material.name));
}

void warn(Error error, const std::string& message, const std::string& path, ToolContext& context) {
  Diagnostic warning = std::move(error).in_file(path);
  warning.severity = Severity::warning;
  warning.message = message;
  context.diagnose(std::move(warning));
}

std::shared_ptr<const render::Mipmap> decoded(const Material& material, const std::string& path,
                                              std::size_t max_pixels, ToolContext& context) {
  const EncodedImage& image = *material.base_color_texture.image;
  const std::string words = words_for(material, image);
  auto pixels = image::decode(image.bytes, std::min(max_pixels, image::kMaxPixels));
  if (!pixels) {
    warn(pixels.error(),
         fmt::format("{}: {}; the plain colour is used", words, pixels.error().message), path,
         context);
    return nullptr;
  }
  if (!pixels->damage.empty()) {
    warn(Error("picture-damaged", ""), fmt::format("{} is damaged: {}", words, pixels->damage),
         path, context);
  }
  auto mipmap = render::Mipmap::create(pixels->width, pixels->height, std::move(pixels->rgba));
  if (mipmap) return std::make_shared<const render::Mipmap>(*std::move(mipmap));
  warn(mipmap.error(), mipmap.error().message, path, context);
  return nullptr;
}

}  // namespace

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

void decode_base_colours(std::span<const Material> materials, const std::string& path,
                         ToolContext& context, DecodedImages& known) {
  for (const Material& material : materials) {
    const Texture& texture = material.base_color_texture;
    if (!texture || known.contains(texture.image.get())) continue;
    const std::size_t left = kMaxPixels - std::min(pixels_of(known), kMaxPixels);
    // Also null, so that each image is warned about once.
    known[texture.image.get()] = decoded(material, path, left, context);
  }
}

std::optional<SurfaceLook> look_of(const Material& material, const SharedCoordinates& coordinates,
                                   const DecodedImages& images) {
  const Texture& texture = material.base_color_texture;
  const auto found = images.find(texture.image.get());
  const bool painted =
      texture && coordinates != nullptr && found != images.end() && found->second != nullptr;
  float cutoff = 0;
  if (material.alpha != Material::Alpha::opaque) {
    cutoff =
        painted && material.alpha == Material::Alpha::mask ? material.alpha_cutoff : kSeenThrough;
    if (material.base_color.w() < cutoff) return std::nullopt;
  }
  SurfaceLook look{render::to_colour(material.base_color.head<3>()), nullptr};
  if (!painted) return look;
  auto paint = std::make_shared<render::Paint>();
  paint->image = found->second;
  paint->coordinates = coordinates;
  if (texture.transforms()) {
    auto moved = *coordinates;
    for (Vec2f& place : moved) place = texture.at(place);
    paint->coordinates = std::make_shared<const std::vector<Vec2f>>(std::move(moved));
  }
  paint->wrap_u = texture.wrap_u;
  paint->wrap_v = texture.wrap_v;
  paint->smooth = texture.smooth;
  paint->factor = material.base_color;
  paint->cutoff = cutoff;
  look.paint = std::move(paint);
  return look;
}

}  // namespace krok::cli
