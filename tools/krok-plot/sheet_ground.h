#pragma once

#include <span>
#include <vector>

#include "draw/viewer_page.h"
#include "render/actor.h"
#include "terrain/terrain.h"

// The ground and the footprints in images.

namespace krok::cli::plot {

// The part of a ground that an image shows.
struct GroundPart {
  Vec2 low = Vec2::Zero(), high = Vec2::Zero();  // x and z, metres
  // Metres: what is wholly above `top`, a roof, or below `bottom`, a valley, is left out.
  double bottom = 0, top = 0;
};

// The ground as surfaces, with a border that goes down so that it is seen from the side, and the
// footprints in it. Empty where there is none.
std::vector<render::Surface> ground_surfaces(const Terrain& ground,
                                             std::span<const draw::ViewedPrint> prints,
                                             const GroundPart& part);

}  // namespace krok::cli::plot
