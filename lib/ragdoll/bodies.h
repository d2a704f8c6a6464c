#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "math/transform.h"
#include "ragdoll/body_mode.h"
#include "roles/roles.h"
#include "scene/model.h"
#include "scene/skeleton.h"

// Rigid bodies that stand for the bones of a skeleton. Metres, kilograms.

namespace krok::ragdoll {

// A convex shape about its own origin, which is its centre of mass.
struct Shape {
  enum class Kind : unsigned char { box, capsule, sphere };
  Kind kind = Kind::box;
  Vec3 half = Vec3::Constant(0.1);  // box: half its extents, > 0
  double radius = 0.1;              // capsule, sphere: > 0
  double half_length = 0;           // capsule: half the distance between its caps, along y, >= 0
};

// Volume in cubic metres.
double volume(const Shape& shape);

struct Body {
  std::string name;
  int joint = -1;   // of the skeleton, whose frame the body moves with
  int parent = -1;  // the body above it, or -1 for the root; less than its own index
  Shape shape;
  Transform to_joint;  // body_to_joint
  double mass = 1;     // > 0
  BodyMode mode = BodyMode::simulated;
  double strength = 1;  // powered: 0 (limp) to 1 (an adult's; the root: as animated)
};

struct BodyOptions {
  // Of all bodies. Without: 75 kg, of others than humanoids their volume at 1000 kg/m^3.
  std::optional<double> mass;
  // Fits shapes to its vertices. Its skeleton has the same joints; its reference pose is used.
  const Model* model = nullptr;
};

// Bodies. Of a humanoid: pelvis, one or two for the trunk, head (with the neck), upper and lower
// arms, hands, thighs, shanks and feet. Other joints (collar bones, spine joints between, fingers,
// toes, helpers) have none and follow the joint above. Sizes are shares of the stature and the
// bones' lengths (Drillis and Contini 1966), or with a model those of its vertices, each of which
// belongs to the body of the joint with its largest weight: capsules and boxes reach as far as 90 %
// of them. Masses are de Leva's shares (1996, ik::body_masses). Parents come before their children.
//
// Skeletons that are no humanoids get a capsule for each bone below the carrying joint, with masses
// by volume (bone_bodies()); with a model their radii are those of its vertices.
//
// Codes: ragdoll-model if the model has other joints; ragdoll-size if a part has no extent, or the
// mass is not above 0.
Result<std::vector<Body>> make_bodies(const Skeleton& motion, const RoleMap& roles,
                                      const BodyOptions& options = {});

// Share of the model's vertices within `distance` (metres) of a body or inside one, in the
// reference pose; 1 for a model without vertices.
double covered_share(const Model& model, const std::vector<Body>& bodies, double distance);

// For each joint the body that carries it: its own, or the nearest above; -1 above the root body.
std::vector<int> body_of_joint(const Skeleton& skeleton, const std::vector<Body>& bodies);

}  // namespace krok::ragdoll
