#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "rbf/weight_evaluator.h"
#include "rbf/weight_function.h"
#include "scene/model.h"
#include "scene/morph_set.h"
#include "skin/skin.h"

// Shapes by pose: morph targets of a model that correct skinning where joints bend or twist. Their
// weights are radial basis functions of a joint's rotation; targets are added to the mesh before
// skinning. Sources: Lewis, Cordner, Fong, Pose Space Deformation (SIGGRAPH 2000); Sloan, Rose,
// Cohen, Shape by Example (I3D 2001).

namespace krok {

// The rotation of a joint from its reference orientation relative to the parent, as a vector in the
// joint's frame: joint_to_parent = reference * swing * twist, where the twist turns about the unit
// `axis` and the swing about a perpendicular of it. Both are modified Rodrigues parameters,
// 4 tan(angle / 4) times the unit axis of rotation (Schaub, Junkins, Stereographic Orientation
// Parameters, 1996), which is close to the angle in radians and finite (at most 4) for all of them;
// the vector is their sum. A swing of half a turn has twist 0.
Vec3 swing_and_twist(const Vec3& axis, const Quat& reference, const Quat& joint_to_parent);

// The direction of a joint's bone in its own frame: the mean offset of its children in the
// reference pose, unit; +Y for a joint without children or with all of them at its own place.
Vec3 bone_axis(const Skeleton& skeleton, int joint);

// The correctives of one joint.
struct JointCorrective {
  std::string joint;
  Vec3 axis = Vec3::UnitY();  // of the twist, unit, in the joint's frame

  // [d] unit, perpendicular: the parameters are the components of swing_and_twist() along them,
  // clamped to the range of the examples. With `squares` the products of each two parameters
  // follow, p_a p_b for a <= b, row by row: corrections grow with the square of an angle.
  std::vector<Vec3> directions;
  bool squares = false;

  // Of 1 + targets examples: the first is the reference pose, which has no target.
  rbf::WeightFunction weights;

  std::vector<std::uint32_t> vertices;  // that the targets move, increasing
  std::vector<Vec3f> offsets;           // [targets x vertices] metres, from the model's positions
  std::vector<Vec3f> normal_offsets;    // [targets x vertices] from the model's normals, or empty

  int target_count() const { return weights.examples - 1; }

  // The parameters at a rotation: [weights.dimensions] of weights.lower to weights.upper.
  void parameters(const Quat& reference, const Quat& joint_to_parent, std::span<double> out) const;
};

struct Correctives {
  // Weights outside of it are clamped, far from all examples.
  static constexpr double kMinWeight = -1, kMaxWeight = 2;

  int vertex_count = 0;                      // of the model
  SkinMethod method = SkinMethod::linear;    // that they correct
  std::vector<JointCorrective> joints = {};  // each once

  int target_count() const;
};

// Checks everything documented above. Codes: correctives-shape, correctives-value, those of
// rbf::WeightFunction::check().
Status check(const Correctives& correctives);

// All targets as morph targets of the model, named joint_1, joint_2, ... joint by joint. Requires
// the model's vertex count; has normals if the model has.
MorphSet targets_of(const Correctives& correctives, const Model& model);

// The weights of all targets in poses of a skeleton.
class CorrectiveWeights {
 public:
  // Codes: those of check(); correctives-joint for a joint that the skeleton does not have.
  static Result<CorrectiveWeights> create(const Correctives& correctives, const Skeleton& skeleton);

  std::size_t target_count() const { return target_count_; }

  // joint_to_world is [joints] of the skeleton, `weights` [targets]. Thread-safe; allocates
  // nothing.
  void at(std::span<const Transform> joint_to_world, std::span<float> weights) const;

 private:
  struct Joint {
    int joint = 0, parent = 0;
    Quat reference;
    JointCorrective corrective;  // without vertices and targets
    rbf::WeightEvaluator evaluator;
  };
  CorrectiveWeights() = default;
  std::vector<Joint> joints_;
  std::size_t target_count_ = 0;
};

}  // namespace krok
