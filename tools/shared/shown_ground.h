#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "draw/viewer_page.h"
#include "gait/print.h"
#include "gait/shown_prints.h"
#include "render/actor.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"
#include "terrain/terrain.h"
#include "tools/cli/tool.h"
#include "tools/shared/moving_actor.h"
#include "tools/shared/shared_options.h"

// --ground and --prints, for tools that show a walk.

namespace krok::cli {

// The footprints of a file. Codes: those of prints::read(); prints-empty for a file without one.
Result<std::vector<gait::Print>> open_prints(const std::string& path, ToolContext& context);

// The footprints of a motion, or as many as are near it.
struct ShownPrints {
  std::vector<gait::GroundedPrint> prints;
  std::vector<int> numbers;  // from 1, [prints]
  gait::FootSize size;
};

// Sets footprints on the ground. Those farther than a few metres from all motions are left out, and
// of more than can be drawn those beyond that number, with a warning (code prints-many). Codes:
// those of gait::set_on_ground().
Result<ShownPrints> show_prints(std::span<const gait::Print> prints, const Terrain& ground,
                                std::span<const Clip* const> clips, ToolContext& context);

// As pages and charts take them.
std::vector<draw::ViewedPrint> viewed_prints(const ShownPrints& shown);

// Puts a ground, if there is one, and footprints, which lie on it or otherwise level at height 0,
// on a page of motions. Codes: those of show_prints() and terrain::surface_of().
Status add_ground(const Terrain* ground, std::span<const gait::Print> prints,
                  draw::ViewerPage& page, ToolContext& context);

// The web page of a walk, as krok-view makes it.

// "29 joints, 240 frames, 60 fps, 3.98 s".
std::string facts_of(const Clip& clip);

// A page of one motion with a generated body, on a ground, with footprints. `name` is its title.
// Codes: those of make_body(), add_ground() and draw::write_viewer_page().
Result<std::string> walk_page(const std::string& name, const Clip& clip, const MotionKeys& keys,
                              const Terrain& ground, std::span<const gait::Print> prints,
                              ToolContext& context);

// The ground and the footprints in images.

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
