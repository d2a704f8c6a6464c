#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "draw/viewer_page.h"
#include "render/actor.h"
#include "terrain/terrain.h"
#include "tools/shared/moving_actor.h"
#include "tools/shared/shared_options.h"

// The ground and the footprints in images.

namespace krok::cli {

// What lies below actors in images.
struct SheetGround {
  std::unique_ptr<const Terrain> terrain;  // null for none
  std::vector<draw::ViewedPrint> prints;
};

// Reads --ground and --prints; both may be empty.
Result<SheetGround> open_sheet_ground(const GroundChoice& ground, const std::string& prints,
                                      ToolContext& context);

// The part of a ground that an image shows.
struct GroundPart {
  Vec2 low = Vec2::Zero(), high = Vec2::Zero();  // x and z, metres
  // Metres: what is wholly above `top`, a roof, or below `bottom`, a valley, is left out.
  double bottom = 0, top = 0;
};

// Below an actor whose hips are at `carrier`, and below the whole way of one.
GroundPart part_below(const Vec3& carrier);
GroundPart part_below_way(const MovingActor& actor, const ImageSpan& span);

// The ground as surfaces, with a border that goes down so that it is seen from the side, and the
// footprints in it. Empty where there is none.
std::vector<render::Surface> ground_surfaces(const Terrain& ground,
                                             std::span<const draw::ViewedPrint> prints,
                                             const GroundPart& part);

}  // namespace krok::cli
