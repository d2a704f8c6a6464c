#pragma once

#include <span>
#include <vector>

#include "render/actor.h"
#include "scene/skeleton.h"

namespace krok {

enum class BodySide : unsigned char { middle, left, right };

// On which side of the body each joint is, by the joints' roles; middle where they do not tell.
std::vector<BodySide> body_sides(const Skeleton& skeleton);

// Blue for the left, orange for the right, grey for the middle.
render::Colour side_colour(BodySide side);

// The colour of bodies.
inline constexpr render::Colour kBodyColour = render::colour(0xC9B49E);

// The radius of joints that suits a figure of this extent, metres; that of no extent gets 1 cm.
double bone_radius(double extent);

// How a skeleton is drawn.
struct BoneStyle {
  std::vector<int> parents;             // [joints], -1 for none
  std::vector<render::Colour> colours;  // [joints]; a bone has that of its far end
  bool blended = false;                 // a bone goes over from its parent's colour
  double radius = 0.01;                 // metres, of the joints
};

// With the colours of the sides and a radius that suits the skeleton's size.
BoneStyle bone_style(const Skeleton& skeleton);

// A bar from each joint to its parent, thinner towards the far end, and a ball at each joint.
// Short bones are thinner, so that fingers can be told apart. `positions` has [joints] elements.
render::Actor bone_actor(const BoneStyle& style, std::span<const Vec3f> positions);

}  // namespace krok
