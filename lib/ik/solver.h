#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "ik/goal.h"
#include "ik/limits.h"
#include "math/transform.h"

// Inverse kinematics of any tree of joints for any number of goals at once, by one interface.

namespace krok::ik {

enum class Method : unsigned char {
  // Levenberg and Marquardt's damped least squares over all goals, with analytic derivatives.
  // Damping follows the error (Sugihara, "Solvability-unconcerned inverse kinematics by the
  // Levenberg-Marquardt method", 2011). Limits are an active set: a rotation that would pass one
  // is fixed there and the others are solved anew, so that the pose is within them after every
  // step. What the goals leave open (the null space, Liegeois 1977) pulls towards the start pose.
  least_squares,
  // Selectively damped least squares (Buss and Kim, "Selectively damped least squares for inverse
  // kinematics", 2005): each singular vector of the derivatives is damped by itself, by how far it
  // would move the effectors for what it brings them nearer. A joint's three turns count as one, so
  // that how it is oriented does not matter; their largest step shrinks while the error grows.
  // Goals, limits, pull and starts are those of least_squares, which also settles what is out of
  // reach, where it would wander about the nearest pose. For motions in and out of reach.
  selectively_damped,
  // Cyclic coordinate descent (Wang and Chen 1991): from the end effectors up, each joint turns the
  // line from it to the effector onto the line to the goal. Where several goals hang on a joint it
  // turns by their weighted mean. Poles and balance are left to least squares.
  ccd,
  // Position, pose and pole goals whose joint has at least two joints above it: the closed form of
  // two_bone.h for the limb (the joint's parent and grandparent); pose goals turn the end joint,
  // too. Cones and hinges are kept by clamping the result. Other goals are not acted on.
  two_bone
};

struct Options {
  Method method = Method::least_squares;

  // A goal is reached within both.
  double distance = 1e-4;  // metres
  double angle = 1e-3;     // radians

  // Most sweeps (ccd) or steps (both kinds of least squares) from one start.
  int iterations = 60;

  // Further starts of both kinds of least squares for goals that are not reached: the same sequence
  // on every run. Each one's joints are turned at random within their limits. The best result is
  // kept.
  int restarts = 0;
  std::uint64_t seed = 1;

  // How strongly what the goals leave open is drawn back to the start pose, 0 to 1; half as much
  // from step to step.
  double rest_pull = 0.0;

  // Whether a joint may be shifted with all that hangs on it, for goals of a whole body: the root,
  // or the pelvis of a skeleton whose root lies on the ground. The root always may turn.
  bool root_moves = false;
  int moving_joint = 0;

  // [joints] or empty: 0 moves freely, 1 not at all. Least squares weights a joint's turns by (1 -
  // stiffness), ccd multiplies them.
  std::vector<double> stiffness;

  // [joints] or empty: kilograms that move with the joint, their centre in its frame; balance goals
  // need them.
  std::vector<double> masses;
  std::vector<Vec3> mass_centres;
};

struct Outcome {
  std::vector<Residual> goals;  // [goals]
  bool reached = false;         // all goals
  int iterations = 0;           // over all starts
  int starts = 0;
};

// Solves for one skeleton, one set of limits and options; keeps its memory from call to call, so
// that a motion solved frame by frame allocates nothing after the first. Not for several threads at
// once.
class Solver {
 public:
  // `parents` as in Skeleton, limits [joints] or empty. Checks them and the options; codes those of
  // check(Limits), ik-option.
  static Result<Solver> create(std::span<const int> parents, Limits limits, Options options);

  Solver(Solver&&) noexcept;
  Solver& operator=(Solver&&) noexcept;
  ~Solver();

  // Moves the pose `joint_to_world` ([joints]), from which the solution starts, to the goals or as
  // near as it gets. Positions of joints in their parents' frames stay. Joints above or beside the
  // goals' chains do not move. A joint of a chain that starts beyond its limits is clamped first.
  //
  // Codes: ik-goal for a goal whose joint does not exist, whose values are not finite or whose
  // weight is not positive, or a pole without joints above and below; then the pose is untouched.
  // The outcome is valid until the next call.
  Result<const Outcome*> solve(std::span<const Goal> goals, std::span<Transform> joint_to_world);

  const Limits& limits() const;
  const Options& options() const;

 private:
  struct State;
  explicit Solver(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// By how much goals are missed by a pose; held_by stays -1. `skeleton_parents` is [joints].
std::vector<Residual> residuals(std::span<const Goal> goals, std::span<const int> parents,
                                std::span<const Transform> joint_to_world, const Options& options);

}  // namespace krok::ik
