#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "render/sheet.h"

namespace krok::test {

inline render::Bone ball(const Vec3& at, double radius, render::Colour colour) {
  const Vec3f place = at.cast<float>();
  const auto wide = static_cast<float>(radius);
  return {place, place, wide, wide, colour, colour};
}

// An axis-aligned box as flat triangles.
inline render::Surface box(const Vec3& low, const Vec3& high, render::Colour colour) {
  render::Surface surface;
  for (int i = 0; i < 8; ++i) {
    surface.positions.push_back(Vec3((i & 1) != 0 ? high.x() : low.x(),
                                     (i & 2) != 0 ? high.y() : low.y(),
                                     (i & 4) != 0 ? high.z() : low.z())
                                    .cast<float>());
  }
  surface.triangles = std::make_shared<render::Triangles>(render::Triangles{{0, 1, 3},
                                                                            {0, 3, 2},
                                                                            {4, 7, 5},
                                                                            {4, 6, 7},
                                                                            {0, 5, 1},
                                                                            {0, 4, 5},
                                                                            {2, 3, 7},
                                                                            {2, 7, 6},
                                                                            {0, 2, 6},
                                                                            {0, 6, 4},
                                                                            {1, 5, 7},
                                                                            {1, 7, 3}});
  surface.colours = {colour};
  return surface;
}

// One cell with one figure, seen from one side.
inline render::Sheet sheet_of(const render::Actor& actor, double yaw = 0, double elevation = 0) {
  render::SheetCell cell;
  cell.layers = {{&actor}};
  cell.centre = actor.centre;
  render::Sheet sheet;
  sheet.rows.push_back({"", "", yaw, elevation, {cell}});
  return sheet;
}

// How colourful a pixel is: what is behind figures is grey, and no test figure is.
inline int colourfulness(render::Colour colour) {
  const int most = std::max({colour.red, colour.green, colour.blue});
  const int least = std::min({colour.red, colour.green, colour.blue});
  return most - least;
}

// The figure's pixels in a cell, each by how much of it the figure covers at least.
inline int coloured_pixels(const render::SheetImage& image, int least = 24) {
  int count = 0;
  for (const render::CellLayout& cell : image.cells) {
    for (int y = cell.top; y < cell.bottom; ++y) {
      for (int x = cell.left; x < cell.right; ++x) {
        count += colourfulness(image.image.at(x, y)) >= least ? 1 : 0;
      }
    }
  }
  return count;
}

}  // namespace krok::test
