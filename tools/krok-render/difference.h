#pragma once

#include "render/actor.h"
#include "render/sheet.h"

// Two actors with the same points: how far apart, and coloured so.

namespace krok::cli::film {

// Whether both have as many surfaces, vertices and bones, in the same order.
bool points_correspond(const render::Actor& first, const render::Actor& second);

// The largest distance of corresponding points, metres.
double largest_distance(const render::Actor& first, const render::Actor& second);

// The second, coloured by the distance of its points from those of the first.
render::Actor coloured_by_distance(const render::Actor& first, const render::Actor& second,
                                   const render::ColourKey& key, double units_in_a_metre);

render::Actor in_grey(render::Actor actor);

}  // namespace krok::cli::film
