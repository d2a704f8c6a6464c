#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/actor.h"
#include "scene/material.h"
#include "tools/common/tool.h"

// Materials as pictures of figures show them: base colours and the pictures that go with them.

namespace krok {

// By the picture as its file holds it; null for one that cannot be shown.
using DecodedImages = std::map<const EncodedImage*, std::shared_ptr<const render::Mipmap>>;

// Decodes the base colours' pictures of materials, those of `known` aside, once each, and adds
// them. One that cannot be decoded is warned of with the place of `path` (codes of picture::decode;
// the surface keeps its plain colour), as is one in which something is damaged (picture-damaged).
// All of `known` together have at most 2^28 pixels, a gigabyte.
void decode_base_colours(std::span<const Material> materials, const std::string& path,
                         ToolContext& context, DecodedImages& known);

// How a surface of a material is drawn.
struct SurfaceLook {
  render::Colour colour;
  std::shared_ptr<const render::Paint> paint;  // null: the plain colour
};

using SharedCoordinates = std::shared_ptr<const std::vector<Vec2f>>;

// With the picture where it is among `pictures` and there are coordinates (may be null). Pictures
// cut out by their alpha: those of Material::Alpha::mask by its cutoff, those of blend where they
// let through more than half of the light. Nothing for what is left out: surfaces that let through
// more than that all over, so that eyes are seen behind their cornea.
std::optional<SurfaceLook> look_of(const Material& material, const SharedCoordinates& coordinates,
                                   const DecodedImages& images);

}  // namespace krok
