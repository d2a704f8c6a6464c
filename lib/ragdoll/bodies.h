#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "ik/limits.h"
#include "math/transform.h"
#include "roles/roles.h"
#include "scene/model.h"
#include "scene/skeleton.h"

// Rigid bodies that stand for the bones of a skeleton. Metres, kilograms.

namespace krok::ragdoll {

// How a body moves during the simulation.
enum class BodyMode : unsigned char {
  simulated,  // by gravity, by contacts and with what it hangs from
  animated,   // as the motion has it, whatever it touches, and so does the body above it
  powered     // as simulated, but a motor in its joint follows the motion; the root body, which has
              // no joint, follows it by a spring from outside
};

std::string_view body_mode_name(BodyMode mode);  // "powered"

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

// The bodies as meshes on the skeleton, in its reference pose: a part for each, by its name, whose
// vertices move with the body's joint alone. The material is "bodies".
Model body_meshes(const Skeleton& skeleton, const std::vector<Body>& bodies);

// Bodies and ranges for skeletons that are no humanoids: animals, robots, hands, plants. Metres,
// kilograms.

// The largest distance between two joints in the reference pose along an axis: how large the
// skeleton is.
double extent(const Skeleton& skeleton);

// A capsule for each bone, from its joint to the joint below; where the skeleton forks, to the
// middle of the joints below, or to the farthest one if they surround it; at a leaf on from the
// bone above, half as long. Radii are 0.2 of the length, at least 0.012 and at most 0.08 of the
// extent. Joints whose bones are under 0.03 of the extent have no body and follow the joint above.
// All bodies are of `root` or below it, or of what is above it and carries half of the bones'
// length. Masses are not set. Empty if the skeleton has no extent.
std::vector<Body> bone_bodies(const Skeleton& skeleton, int root);

// Cones about the reference pose for joints with a body: they swing by 50 degrees and twist by 30
// about the body's own axis. All others are free.
ik::Limits cone_limits(const Skeleton& skeleton, const std::vector<Body>& bodies);

}  // namespace krok::ragdoll
