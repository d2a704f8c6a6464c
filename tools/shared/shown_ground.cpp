#include "tools/shared/shown_ground.h"

#include <fmt/format.h>

#include "core/numbers.h"
#include "formats/prints/prints.h"
#include "roles/roles.h"
#include "terrain/shapes.h"
#include "terrain/surface.h"
#include "tools/shared/shared_options.h"

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

}  // namespace krok::cli
