#include "tools/shared/surface_look.h"

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
                                              std::size_t most_pixels, ToolContext& context) {
  const EncodedImage& image = *material.base_color_texture.image;
  const std::string words = words_for(material, image);
  auto pixels = image::decode(image.bytes, std::min(most_pixels, image::kMaxPixels));
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
