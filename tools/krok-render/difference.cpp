#include "tools/krok-render/difference.h"

#include <algorithm>

namespace krok::cli::film {

namespace {

constexpr render::Colour kGrey = render::colour(0x8E99A5);

double distance(const Vec3f& a, const Vec3f& b) {
  return (a.cast<double>() - b.cast<double>()).norm();
}

}  // namespace

bool points_correspond(const render::Actor& first, const render::Actor& second) {
  return first.bones.size() == second.bones.size() &&
         std::ranges::equal(first.surfaces, second.surfaces,
                            [](const render::Surface& a, const render::Surface& b) {
                              return a.positions.size() == b.positions.size();
                            });
}

double largest_distance(const render::Actor& first, const render::Actor& second) {
  double largest = 0;
  for (std::size_t i = 0; i < second.surfaces.size(); ++i) {
    const auto &a = first.surfaces[i].positions, &b = second.surfaces[i].positions;
    for (std::size_t v = 0; v < b.size(); ++v) largest = std::max(largest, distance(a[v], b[v]));
  }
  for (std::size_t i = 0; i < second.bones.size(); ++i) {
    largest = std::max({largest, distance(first.bones[i].from, second.bones[i].from),
                        distance(first.bones[i].to, second.bones[i].to)});
  }
  return largest;
}

render::Actor coloured_by_distance(const render::Actor& first, const render::Actor& second,
                                   const render::ColourKey& key, double units_in_a_metre) {
  render::Actor result = second;
  const auto colour = [&](const Vec3f& a, const Vec3f& b) {
    return key.at(distance(a, b) * units_in_a_metre);
  };
  for (std::size_t i = 0; i < result.surfaces.size(); ++i) {
    render::Surface& surface = result.surfaces[i];
    surface.paint = nullptr;
    surface.colours.clear();
    for (std::size_t v = 0; v < surface.positions.size(); ++v) {
      surface.colours.push_back(colour(first.surfaces[i].positions[v], surface.positions[v]));
    }
    if (surface.colours.empty()) surface.colours = {kGrey};
  }
  for (std::size_t i = 0; i < result.bones.size(); ++i) {
    render::Bone& bone = result.bones[i];
    bone.from_colour = colour(first.bones[i].from, bone.from);
    bone.to_colour = colour(first.bones[i].to, bone.to);
  }
  return result;
}

render::Actor in_grey(render::Actor actor) {
  for (render::Surface& surface : actor.surfaces) {
    surface.paint = nullptr;
    surface.colours = {kGrey};
  }
  for (render::Bone& bone : actor.bones) bone.from_colour = bone.to_colour = kGrey;
  return actor;
}

}  // namespace krok::cli::film
