#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/result.h"
#include "math/transform.h"
#include "scene/material.h"

// Textures on surfaces.

namespace krok::render {

// A mipmap chain: each level is half as wide and high as the one before, down to one pixel, to
// avoid aliasing. Averaged in linear light, not in sRGB. Source: Williams, Pyramidal Parametrics
// (SIGGRAPH 1983).
class Mipmap {
 public:
  struct Level {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgba;  // [height x width x 4], sRGB and linear alpha
  };

  // From rgba[height x width x 4], sRGB and linear alpha, top row first. Code render-texture for an
  // empty image, or one whose pixel count does not match its size.
  static Result<Mipmap> create(int width, int height, std::vector<std::uint8_t> rgba);

  const std::vector<Level>& levels() const { return levels_; }

 private:
  Mipmap() = default;
  std::vector<Level> levels_;
};

// A texture on a surface. Colours are linear.
struct Paint {
  std::shared_ptr<const Mipmap> image;  // not null; several paints may share one
  // [vertices of the surface], u to the right and v down, 0 to 1 over the image; shared by the
  // frames of a character.
  std::shared_ptr<const std::vector<Vec2f>> coordinates;
  krok::Texture::Wrap wrap_u = krok::Texture::Wrap::repeat;
  krok::Texture::Wrap wrap_v = krok::Texture::Wrap::repeat;
  bool smooth = true;                    // false: magnified without interpolation
  Vec4f factor{1.0F, 1.0F, 1.0F, 1.0F};  // 0 .. 1, multiplies the image's linear colour and alpha
  // 0 .. 1; alpha test: points with less alpha are not drawn. 0: alpha is ignored.
  float cutoff = 0;

  // Linear colour and alpha at a texture coordinate.
  //
  // `across` and `down` are the offsets of the texture coordinates of the pixels to the right and
  // below. The area between is filtered anisotropically: the mip level is that in which the shorter
  // offset is one pixel, with up to kMaxProbes samples along the longer one. Both zero: bilinear
  // lookup in the full image.
  Vec4f at(const Vec2f& place, const Vec2f& across, const Vec2f& down) const;

  // The alpha of the full image, without filtering: with averaged alpha, cut-outs would vanish at a
  // distance.
  float alpha_at(const Vec2f& place) const;

  static constexpr int kMaxProbes = 8;
};

}  // namespace krok::render
