#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/result.h"
#include "math/types.h"
#include "scene/material.h"

// Pictures on surfaces.

namespace krok::render {

// A picture and smaller ones of it, each half as wide and high as the one before, down to one
// pixel: what covers little of an image is taken from a small one, so that it does not become
// noise. Averages are of light, not of the numbers that screens take. Source: Williams, Pyramidal
// Parametrics (SIGGRAPH 1983).
class Mipmap {
 public:
  struct Level {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgba;  // [height x width x 4], sRGB and linear alpha
  };

  // Of rgba[height x width x 4], sRGB and linear alpha, the upper row first. Code render-texture
  // for a picture without a pixel, or with another number of them.
  static Result<Mipmap> create(int width, int height, std::vector<std::uint8_t> rgba);

  const std::vector<Level>& levels() const { return levels_; }

 private:
  Mipmap() = default;
  std::vector<Level> levels_;
};

// What a surface shows of a picture. Light is linear.
struct Paint {
  std::shared_ptr<const Mipmap> image;  // not null; several paints may share one
  // [vertices of the surface], u to the right and v down, the picture from 0 to 1; shared by the
  // moments of a figure.
  std::shared_ptr<const std::vector<Vec2f>> coordinates;
  krok::Texture::Wrap wrap_u = krok::Texture::Wrap::repeat;
  krok::Texture::Wrap wrap_v = krok::Texture::Wrap::repeat;
  bool smooth = true;                    // false: from near each pixel is a square
  Vec4f factor{1.0F, 1.0F, 1.0F, 1.0F};  // 0 .. 1, multiplies the picture's light and alpha
  // 0 .. 1; where alpha is less, nothing is drawn and what is behind shows. 0: alpha does not
  // count.
  float cutoff = 0;

  // Light and alpha at a place of the picture.
  //
  // `across` and `down` lead to what the neighbours see, to the right and below. What lies between
  // is averaged: by the level in which the shorter of the two ways is a pixel, and along the longer
  // one at up to kMostProbes places of it. Both zero: the picture as it is, between its four
  // nearest pixels.
  Vec4f at(const Vec2f& place, const Vec2f& across, const Vec2f& down) const;

  // The alpha alone, of the picture as it is: cut-outs of averages would vanish from afar.
  float alpha_at(const Vec2f& place) const;

  static constexpr int kMaxProbes = 8;
};

}  // namespace krok::render
