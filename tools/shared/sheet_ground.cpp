#include "tools/shared/sheet_ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "draw/sole_outline.h"
#include "terrain/surface.h"
#include "tools/shared/shown_ground.h"

namespace krok::cli {

namespace {

constexpr double kAroundActor = 0.35;  // metres of ground on each side of an actor
constexpr double kAroundWay = 0.6;     // metres on each side of a way
constexpr double kDeepest = 2;         // metres below the hips: deeper ground is not shown
constexpr int kWayPoints = 400;
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

GroundPart around(const Eigen::AlignedBox3d& box, double metres) {
  const Vec2 border = Vec2::Constant(metres);
  GroundPart part;
  part.low = Vec2(box.min().x(), box.min().z()) - border;
  part.high = Vec2(box.max().x(), box.max().z()) + border;
  part.bottom = box.min().y() - kDeepest;
  part.top = box.max().y();
  return part;
}

}  // namespace

Result<SheetGround> open_sheet_ground(const GroundChoice& ground, const std::string& prints,
                                      ToolContext& context) {
  SheetGround result;
  if (ground.empty()) return result;
  auto opened = ground.open(context);
  if (!opened) return opened.error();
  result.terrain = *std::move(opened);
  if (prints.empty()) return result;
  const auto read = open_prints(prints, context);
  if (!read) return read.error();
  const auto shown = show_prints(*read, *result.terrain, {}, context);
  if (!shown) return Error(shown.error()).in_file(prints);
  result.prints = viewed_prints(*shown);
  return result;
}

GroundPart part_below(const Vec3& carrier) {
  return around(Eigen::AlignedBox3d(carrier), kAroundActor);
}

GroundPart part_below_way(const MovingActor& actor, const ImageSpan& span) {
  Eigen::AlignedBox3d box;
  for (int i = 0; i <= kWayPoints; ++i) {
    box.extend(actor.carrier(span.start + (span.end - span.start) * i / kWayPoints));
  }
  return around(box, kAroundWay);
}

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

}  // namespace krok::cli
