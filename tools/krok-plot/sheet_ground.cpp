#include "tools/krok-plot/sheet_ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "draw/sole_outline.h"
#include "terrain/surface.h"

namespace krok::cli::plot {

namespace {

constexpr float kBorder = 0.06F;  // metres
constexpr double kLift = 0.004;   // metres of a footprint over the ground
constexpr std::int64_t kMaxFaces = 40'000;
constexpr render::Colour kGroundColour = render::colour(0x9fb0a6);
constexpr render::Colour kLeftColour = render::colour(0x2f74c0);
constexpr render::Colour kRightColour = render::colour(0xd9801a);

// Faces for the edges of the surface that lie on the rectangle.
void add_border(const GroundPart& part, render::Surface& surface, render::Triangles& triangles) {
  const std::array<std::pair<int, double>, 4> sides = {
      {{0, part.low.x()}, {0, part.high.x()}, {2, part.low.y()}, {2, part.high.y()}}};
  const std::size_t count = triangles.size();
  for (std::size_t t = 0; t < count; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f from = surface.positions[triangles[t][k]];
      const Vec3f to = surface.positions[triangles[t][(k + 1) % 3]];
      const bool on_side = std::ranges::any_of(sides, [&](const auto& side) {
        const auto [axis, at] = side;
        return std::abs(from[axis] - at) < 1e-5 && std::abs(to[axis] - at) < 1e-5;
      });
      const Vec3f along = to - from;
      if (!on_side || std::hypot(along.x(), along.z()) < 1e-5F) continue;
      const Vec3f outwards = Vec3f(-along.z(), 0, along.x()).normalized();
      const auto first = static_cast<std::uint32_t>(surface.positions.size());
      for (const Vec3f& corner : {from, to, Vec3f(to - kBorder * Vec3f::UnitY()),
                                  Vec3f(from - kBorder * Vec3f::UnitY())}) {
        surface.positions.push_back(corner);
        surface.normals.push_back(outwards);
      }
      triangles.push_back({first, first + 3, first + 1});
      triangles.push_back({first + 1, first + 3, first + 2});
    }
  }
}

render::Surface sole(const draw::ViewedPrint& print, const std::vector<Vec2>& outline) {
  render::Surface surface;
  surface.colours = {print.left ? kLeftColour : kRightColour};
  const Vec3 left = (print.left ? 1 : -1) * print.up.cross(print.forward);
  const auto add = [&](const Vec2& point) {
    const Vec3 at = print.heel + kLift * print.up +
                    print.length * (point.x() * left + point.y() * print.forward);
    surface.positions.push_back(at.cast<float>());
    surface.normals.push_back(print.up.cast<float>());
  };
  auto triangles = std::make_shared<render::Triangles>();
  add({0, 0.5});
  for (const Vec2& point : outline) add(point);
  const auto corners = static_cast<std::uint32_t>(outline.size());
  for (std::uint32_t i = 0; i < corners; ++i)
    triangles->push_back({0, 1 + i, 1 + (i + 1) % corners});
  surface.triangles = std::move(triangles);
  return surface;
}

}  // namespace

std::vector<render::Surface> ground_surfaces(const Terrain& ground,
                                             std::span<const draw::ViewedPrint> prints,
                                             const GroundPart& part) {
  std::vector<render::Surface> surfaces;
  terrain::SurfaceOptions options;
  options.low = part.low;
  options.high = part.high;
  options.triangles = kMaxFaces;
  auto all = terrain::surface_of(ground, options);
  if (!all) return surfaces;
  auto triangles = std::make_shared<render::Triangles>();
  for (const auto& corners : all->triangles) {
    float low = all->positions[corners[0]].y(), high = low;
    for (const std::uint32_t corner : corners) {
      low = std::min(low, all->positions[corner].y());
      high = std::max(high, all->positions[corner].y());
    }
    if (low <= part.top && high >= part.bottom) triangles->push_back(corners);
  }
  if (triangles->empty()) return surfaces;
  render::Surface surface;
  surface.colours = {kGroundColour};
  // Corners of faces that were left out would count for the image's extent.
  std::vector<std::int64_t> kept(all->positions.size(), -1);
  for (auto& corners : *triangles) {
    for (std::uint32_t& corner : corners) {
      if (kept[corner] < 0) {
        kept[corner] = static_cast<std::int64_t>(surface.positions.size());
        surface.positions.push_back(all->positions[corner]);
        surface.normals.push_back(all->normals[corner]);
      }
      corner = static_cast<std::uint32_t>(kept[corner]);
    }
  }
  add_border(part, surface, *triangles);
  surface.triangles = std::move(triangles);
  surfaces.push_back(std::move(surface));
  const std::vector<Vec2> outline = draw::sole_outline();
  for (const draw::ViewedPrint& print : prints) {
    const Vec3 toes = print.heel + print.length * print.forward;
    const bool inside = std::ranges::all_of(std::array{print.heel, toes}, [&](const Vec3& at) {
      return at.x() > part.low.x() && at.x() < part.high.x() && at.z() > part.low.y() &&
             at.z() < part.high.y();
    });
    if (inside) surfaces.push_back(sole(print, outline));
  }
  return surfaces;
}

}  // namespace krok::cli::plot
