#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/actor.h"
#include "scene/material.h"
#include "tools/cli/tool.h"

// Materials for rendered images: base colours and base colour textures.

namespace krok::cli {

// Keyed by encoded image; null if it cannot be decoded.
using DecodedImages = std::map<const EncodedImage*, std::shared_ptr<const render::Mipmap>>;

// Decodes the base colour textures that are not in `known` yet, once each, and adds them. Warns,
// with `path` as location, if an image cannot be decoded (codes of image::decode; the surface keeps
// its plain colour) or is damaged (picture-damaged). `known` holds at most 2^28 pixels (1 GB) in
// total.
void decode_base_colours(std::span<const Material> materials, const std::string& path,
                         ToolContext& context, DecodedImages& known);

// Appearance of a surface with a material.
struct SurfaceLook {
  render::Colour colour;
  std::shared_ptr<const render::Paint> paint;  // null: the plain colour
};

using SharedCoordinates = std::shared_ptr<const std::vector<Vec2f>>;

// Textured if the image is in `images` and `coordinates`, the set of the base colour texture, is
// not null. Alpha cuts out texels: Material::Alpha::mask by its cutoff, blend below an alpha of
// 0.5. Empty if the whole surface is more transparent than that; such surfaces are not drawn, so
// that eyes are visible behind their cornea.
std::optional<SurfaceLook> look_of(const Material& material, const SharedCoordinates& coordinates,
                                   const DecodedImages& images);

}  // namespace krok::cli
