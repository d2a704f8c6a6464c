#pragma once

#include <span>
#include <vector>

#include "render/actor.h"
#include "scene/skeleton.h"

namespace krok::cli {

enum class BodySide : unsigned char { middle, left, right };

// Blue for left, orange for right, grey for middle.
render::Colour side_colour(BodySide side);

// Default colour of bodies.
inline constexpr render::Colour kBodyColour = render::colour(0xC9B49E);

// The radius of joints that suits an actor of this size, in metres; 1 cm for extent 0.
double bone_radius(double extent);

// Drawing style of a skeleton.
struct BoneStyle {
  // A joint that is not drawn, nor a bone to it.
  static constexpr int kLeftOut = -2;
  std::vector<int> parents;             // [joints], -1 for none, or kLeftOut
  std::vector<render::Colour> colours;  // [joints]; a bone has the colour of its child joint
  bool blended = false;                 // bone colours blend from parent to child
  double radius = 0.01;                 // of joints, metres
};

// Coloured by side, with a radius that suits the skeleton's size. Joints above the hips, which may
// stay where the capture began, are no part of the body and are left out. Names that are not unique
// tell no sides.
BoneStyle bone_style(const Skeleton& skeleton);

// A tapered bar from each parent to its child joint and a ball at each joint. Short bones are
// thinner, so that fingers stay distinguishable. `positions`: [joints].
render::Actor bone_actor(const BoneStyle& style, std::span<const Vec3f> positions);

}  // namespace krok::cli
