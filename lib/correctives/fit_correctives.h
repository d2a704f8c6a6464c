#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "correctives/correctives.h"
#include "math/transform.h"

// Fits correctives to sculpted shapes in poses, and measures them on poses that were held out.

namespace krok {

// A pose and the model's mesh as it should be in it.
struct SculptedPose {
  std::string name;                       // for messages
  std::vector<Transform> joint_to_world;  // [joints] of the model
  std::vector<Vec3f> positions;           // [vertices] metres, world
  std::vector<Vec3f> normals;             // [vertices] unit, or empty
};

// The poses of one joint. They should differ in other joints only as far as correctives of joints
// before this one make up for it: what is left is attributed to this joint.
struct SculptedJoint {
  int joint = 0;
  std::vector<SculptedPose> examples;  // without the reference pose, which needs no correction
  std::vector<SculptedPose> held_out;
};

struct CorrectiveFitOptions {
  // Refinement: so many of the held-out poses at most become examples, always the one with the
  // largest error, as long as that is above `max_error` metres.
  int refine = 0;
  double max_error = 0;
  int jobs = 1;  // as in parallel_for; does not affect the result
};

// Distances to the sculpt, metres, over the vertices that the joint's correctives move or that
// skinning misses by more than 10 micrometres in any of its poses.
struct SculptError {
  double root_mean_square = 0, largest = 0;
  int vertex = -1;  // with the largest
};
struct PoseError {
  std::string name;
  Vec3 rotation = Vec3::Zero();  // swing_and_twist(), about radians
  bool held_out = false;
  SculptError skinned, corrected;  // by skinning alone, and with correctives
};
struct CorrectiveFit {
  Correctives correctives;
  std::vector<std::vector<PoseError>> errors;  // [joints] of each pose, examples first
  std::vector<int> refined;                    // [joints] held-out poses that became examples
};

// Offsets are the sculpt brought back through the skinning of its pose, in the reference pose, as
// damped least squares where skinning collapses (a factor below about 0.02 of a length), minus the
// model and the correctives of the joints before, rounded to a micrometre. Errors are measured by
// skinning with the result. Parameters are the rotations' components along at most three
// directions, by pivoted Gram-Schmidt of the examples' rotations; those below 0.1 (about 6 degrees)
// are left out, and those that there are too few examples for.
//
// Codes: correctives-vertices (a shape with another vertex count), correctives-examples (none, or
// no rotation in them), and those of rbf::WeightSolver::create(), such as rbf-duplicate for two
// examples, or one and the reference pose, with the same rotation.
Result<CorrectiveFit> fit_correctives(const Model& model, SkinMethod method,
                                      const std::vector<SculptedJoint>& joints,
                                      const CorrectiveFitOptions& options = {});

}  // namespace krok
