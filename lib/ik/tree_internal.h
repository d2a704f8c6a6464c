#pragma once

#include <span>
#include <vector>

#include "ik/solver.h"

// The joints that take part in a solve, and what the goals' errors and derivatives are in them.

namespace krok::ik {

// A joint on some goal's chain, or above one.
struct ChainJoint {
  int index = 0;                      // in the skeleton
  int parent = -1;                    // in Tree::joints
  bool moves = false;                 // within the depth of a goal, neither locked nor fully stiff
  double weight = 1;                  // 1 - stiffness
  double mobility = 0;                // weight of its turns in least squares
  const JointLimit* limit = nullptr;  // nullptr: free
  Vec3 offset = Vec3::Zero();         // position in the parent's frame
  Quat local = Quat::Identity();      // joint_to_parent
  double twist = 0;                   // of a hinge, from which `local` follows
  Quat start = Quat::Identity();      // joint_to_parent of the start pose
  Transform world;                    // joint_to_world

  // The centre of mass of it and all below it, times the mass, and the mass.
  double mass = 0, own_mass = 0;
  Vec3 moment = Vec3::Zero(), own_centre = Vec3::Zero();

  bool is_hinge() const { return limit && limit->kind == JointLimit::Kind::hinge; }
  bool is_cone() const { return limit && limit->kind == JointLimit::Kind::cone; }

  // Sets the rotation, brought within the limit. For joints that move.
  void set_local(const Quat& joint_to_parent);
  void set_twist(double angle);
};

// A goal as it is solved for: its chain, and its rows in the vector of all errors.
struct GoalRows {
  const Goal* goal = nullptr;
  int effector = -1;              // in Tree::joints; -1 for balance
  int anchor = -1;                // the same of Goal::anchor; -1 for none
  int upper = -1, lower = -1;     // of a pole
  int first_path = 0, paths = 0;  // its joints, in Tree::path, from the effector up
  int row = 0, rows = 0;
  int moving = 0;  // the first `moving` of its joints are within its depth
  // All joints that change its error, in Tree::path: its chain and that of its anchor, from the
  // last in Tree::joints to the first.
  int first_reach = 0, reaches = 0;
};

// A direction in which the pose can change: a turn of a joint about an axis, or a shift of one.
struct Freedom {
  int joint = 0;  // in Tree::joints
  bool shift = false;
  Vec3 local = Vec3::Zero();  // the axis in the joint's frame (for a shift, in the world)
  Vec3 world = Vec3::Zero();
};

class Tree {
 public:
  // What does not change from solve to solve.
  void prepare(std::span<const int> parents);

  // Collects the chains of `goals` and their start pose. The goals are valid (see solve).
  void collect(std::span<const Goal> goals, const Limits& limits, const Options& options,
               std::span<const Transform> joint_to_world);

  // joint_to_world of all joints from their local rotations, from joint `first` on.
  void forward(int first = 0);

  // Errors of all goals, weighted, [rows]; returns their square sum.
  double errors(std::span<double> rows) const;

  // The derivatives of minus the errors by one freedom, added to a column that is zero, [rows].
  void column(const GoalRows& rows, const Freedom& freedom, double* column) const;

  // The goal's target and orientation in the world, as its anchor stands now.
  Vec3 target_of(const GoalRows& rows) const;
  Quat orientation_of(const GoalRows& rows) const;
  // Whether turning a joint moves another, both in `joints`. Any joint moves itself, none moves -1.
  bool carries(int upper, int lower) const;

  // Whether all goals are reached, from errors().
  bool reached(std::span<const double> errors, const Options& options) const;
  // A goal's residual from the world transforms as they are now.
  Residual residual(const GoalRows& rows, const Options& options) const;

  // Puts joint_to_world of the chains, and of all joints that hang on them, into a pose.
  void write(std::span<Transform> joint_to_world);

  // In which chain a skeleton's first child of a joint lies: the default lower joint of a pole.
  int first_child(int joint) const { return first_child_[static_cast<std::size_t>(joint)]; }
  std::span<const int> parents() const { return parents_; }

  std::vector<ChainJoint> joints;  // parents first
  int shifted = -1;                // of these, the joint that may be shifted; -1: none
  std::vector<GoalRows> goals;     // in the order of the caller's
  std::vector<int> path;
  int rows = 0;
  bool has_balance = false;

 private:
  int chain_index(int joint) const { return chain_of_[static_cast<std::size_t>(joint)]; }
  void mark_chain(const Goal& goal);
  void add_paths(std::span<const Goal> goals);
  void add_reach(GoalRows& rows);
  void order_rows();
  void place_balance_path(GoalRows& rows);
  void gather_masses();

  std::vector<int> parents_, first_child_, rank_;
  std::vector<int> chain_of_;     // [joints] -> joints, -1
  std::vector<int> order_;        // of the goals' rows
  std::vector<Transform> local_;  // scratch of write()
};

// How many rows a goal has.
int row_count(Goal::Kind kind);

// From a point to the support polygon of a balance goal; zero inside.
Vec2 to_support(std::span<const Vec2> support, const Vec2& point);

// The methods; each leaves the pose in the tree's local and world transforms and returns the number
// of iterations it made.
class LeastSquares;
int solve_ccd(Tree& tree, const Options& options);
void solve_limbs(Tree& tree, const Options& options);

// Fills in held_by of residuals that are not reached.
void find_holding_joints(Tree& tree, std::span<Residual> residuals);

}  // namespace krok::ik
