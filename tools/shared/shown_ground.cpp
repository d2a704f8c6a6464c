#include "tools/shared/shown_ground.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/numbers.h"
#include "draw/motion_charts.h"
#include "formats/prints/prints.h"
#include "roles/roles.h"
#include "terrain/shapes.h"
#include "terrain/surface.h"

namespace krok::cli {

namespace {

constexpr double kAround = 1.5;  // metres of ground shown round motions and footprints
constexpr double kNear = 10;     // metres: footprints farther off are not shown
constexpr std::size_t kMaxPrints = 20'000;

using Box = Eigen::AlignedBox2d;  // x and z

Box box_of(std::span<const Clip* const> clips) {
  Box box;
  for (const Clip* clip : clips) {
    for (const Vec3f& at : clip->positions) box.extend(Vec2(at.x(), at.z()));
    if (!clip->positions.empty()) continue;
    for (const Transform& joint : clip->skeleton.reference) {
      box.extend(Vec2(joint.position.x(), joint.position.z()));
    }
  }
  return box;
}

}  // namespace

Result<std::vector<gait::Print>> open_prints(const std::string& path, ToolContext& context) {
  const auto file = context.open_input(path);
  if (!file) return file.error();
  auto prints = prints::read(file->text(), path);
  if (prints && prints->empty()) {
    return Error("prints-empty", "there is no footprint",
                 "a line for each: left,0.1,0,0 (formats/prints/SPEC.md)")
        .in_file(path);
  }
  return prints;
}

Result<ShownPrints> show_prints(std::span<const gait::Print> prints, const Terrain& ground,
                                std::span<const Clip* const> clips, ToolContext& context) {
  ShownPrints shown;
  if (!clips.empty()) {
    shown.size = gait::foot_size(*clips.front(), find_roles(clips.front()->skeleton));
  }
  const auto placed = gait::set_on_ground(prints, shown.size, ground);
  if (!placed) return placed.error();
  const Box box = box_of(clips);
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < placed->size(); ++i) {
    const gait::GroundedPrint& print = (*placed)[i];
    const bool near =
        box.isEmpty() || box.exteriorDistance(Vec2(print.heel.x(), print.heel.z())) <= kNear;
    if (!near || shown.prints.size() == kMaxPrints) {
      ++left_out;
      continue;
    }
    shown.prints.push_back(print);
    shown.numbers.push_back(static_cast<int>(i) + 1);
  }
  if (left_out > 0) {
    context.warn(
        "prints-many",
        fmt::format("{} of {} footprints are not shown: farther than {} m from the "
                    "motion, or more than {}",
                    grouped(left_out), grouped(placed->size()), kNear, grouped(kMaxPrints)));
  }
  return shown;
}

std::vector<draw::ViewedPrint> viewed_prints(const ShownPrints& shown) {
  std::vector<draw::ViewedPrint> prints;
  for (std::size_t i = 0; i < shown.prints.size(); ++i) {
    const gait::GroundedPrint& print = shown.prints[i];
    prints.push_back({print.side == FootSide::left, shown.numbers[i], print.heel, print.forward,
                      print.up, shown.size.length});
  }
  return prints;
}

Status add_ground(const Terrain* ground, std::span<const gait::Print> prints,
                  draw::ViewerPage& page, ToolContext& context) {
  std::vector<const Clip*> clips;
  for (const draw::ViewedMotion& motion : page.motions) clips.push_back(motion.clip);
  Box box = box_of(clips);
  if (!prints.empty()) {
    const auto level = terrain::level();
    const Terrain& below = ground != nullptr ? *ground : **level;
    const auto shown = show_prints(prints, below, clips, context);
    if (!shown) return shown.error();
    page.prints = viewed_prints(*shown);
    for (draw::ViewedMotion& motion : page.motions) {
      for (const gait::PrintContact& contact :
           gait::contacts_with_prints(*motion.clip, find_roles(motion.clip->skeleton),
                                      shown->prints, shown->size, below)) {
        motion.print_contacts.push_back({contact.print, contact.start, contact.end});
      }
    }
    for (const gait::GroundedPrint& print : shown->prints) {
      box.extend(Vec2(print.heel.x(), print.heel.z()));
    }
  }
  if (ground == nullptr) return {};
  if (box.isEmpty()) box.extend(Vec2::Zero());
  terrain::SurfaceOptions options;
  options.low = box.min() - Vec2::Constant(kAround);
  options.high = box.max() + Vec2::Constant(kAround);
  auto surface = terrain::surface_of(*ground, options);
  if (!surface) return surface.error();
  page.ground = {std::move(surface->positions), std::move(surface->normals),
                 std::move(surface->triangles)};
  return {};
}

std::string facts_of(const Clip& clip) {
  if (clip.frame_count() == 0) return fmt::format("{} joints, no motion", clip.joint_count());
  return fmt::format("{} s, {} fps, {} frames, {} joints", readable(clip.duration(), 3),
                     readable(clip.rate), clip.frame_count(), clip.joint_count());
}

Result<std::string> walk_page(const std::string& name, const Clip& clip, const MotionKeys& keys,
                              const Terrain& ground, std::span<const gait::Print> prints,
                              ToolContext& context) {
  const auto body = make_body(clip, body_options(BodyChoice::medium, context));
  if (!body) return body.error();
  draw::ViewerPage page;
  page.title = name;
  draw::ViewedMotion& motion = page.motions.emplace_back();
  motion.name = name;
  motion.facts = facts_of(clip);
  motion.clip = &clip;
  motion.body = &body->model;
  motion.keys = keys;
  if (Status status = add_ground(&ground, prints, page, context); !status) return status.error();
  return draw::write_viewer_page(page);
}

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
