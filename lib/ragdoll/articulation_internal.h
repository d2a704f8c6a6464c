#pragma once

#include <span>
#include <vector>

#include "core/index.h"
#include "core/result.h"
#include "ik/limits.h"
#include "ragdoll/joint.h"
#include "ragdoll/world.h"

namespace krok::ragdoll {

// Spatial vectors (Featherstone, "Rigid Body Dynamics Algorithms", 2008) about the world's origin:
// twists are (spin, velocity of the point at the origin), wrenches (torque about it, force). In one
// common frame inertias and wrenches of neighbours add up as they are.
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;
using Mat63 = Eigen::Matrix<double, 6, 3>;
using Mat36 = Eigen::Matrix<double, 3, 6>;

inline Vec6 spatial(const Vec3& upper, const Vec3& lower) {
  Vec6 v;
  v << upper, lower;
  return v;
}

// Bodies that joints tie to trees, in reduced coordinates: a joint has only the movements that it
// allows, so that it cannot come apart. A step finds the new speeds by Gauss's principle of least
// constraint: of all that the joints allow, those nearest to what the bodies would do free, by
// their inertias. The recursion is that of the articulated-body algorithm, with momenta in place of
// forces; it needs no terms of Coriolis, as bodies carry their momenta from pose to pose, and
// includes dampers and motors in the joints' inertias, which makes them stable for any gain.
//
// Bullet 3.24 has trees in reduced coordinates, too (btMultiBody). On the same falls, beside this
// in the benchmark, it is slower, sinks centimetres into the ground, because it corrects
// penetrations through velocities, and jitters at rest; its spherical limits are symmetrical. Its
// joints between free bodies came apart by a millimetre at 3840 steps a second.
class Articulation {
 public:
  // `joints` must form trees: each body is the child of at most one joint that is not a distance.
  Status build(std::span<const Body> bodies, std::span<const BodyState> states,
               std::span<const Joint> joints);

  int body_count() const { return static_cast<int>(masses_.size()); }
  int joint_count() const { return static_cast<int>(joints_.size()); }
  const BodyState& state(int body) const { return states_[at(body)]; }
  BodyState& state(int body) { return states_[at(body)]; }
  Joint& joint(int joint) { return joints_[at(joint)]; }
  const Joint& joint(int joint) const { return joints_[at(joint)]; }
  double mass(int body) const { return masses_[at(body)]; }

  // Moves as prescribed from outside, with the speeds of state(). It is the root of its tree, or
  // its parent is kinematic, too.
  void set_kinematic(int body, bool kinematic);
  bool is_kinematic(int body) const { return links_[at(link_of_[at(body)])].kinematic; }
  // Whether no impulse can move one relative to the other; -1: the surroundings.
  bool is_fixed(int a, int b) const {
    return (a < 0 || is_kinematic(a)) && (b < 0 || is_kinematic(b));
  }

  // The speed, in the parent's frame, at which a joint's anchor moves in it, as that of a shoulder
  // does with the collar bone. It moves on with move().
  void move_anchor(int joint, const Vec3& speed) { anchor_speeds_[at(joint)] = speed; }
  Vec3 anchor(int joint) const {
    return joints_[at(joint)].in_parent.position + ties_[at(joint)].moved;
  }

  // A spring to a pose outside, on a body without a joint.
  void hold(int body, const Hold& hold);

  // The joint's frames in the world, and how far the child's has slid.
  struct Frames {
    Transform parent, child;
  };
  Frames frames(int joint) const;
  double hinge_angle(int joint) const;  // of a revolute joint, nearest to the middle of its range
  double slide(int joint, int axis) const;

  // A side of the range that limits a joint's turning. `axis` (world, unit) is the way out, which
  // is exceeded by `beyond` radians, to the first order; below 0 within.
  struct LimitSide {
    int number = 0;
    Vec3 axis;
    double beyond = 0;
  };
  std::span<const LimitSide> limit_sides(int joint) const;  // found once for each pose

  // Errors of the bodies' poses: metres between anchors that should coincide, radians beyond hard
  // limits.
  double gap(int joint) const;
  double excess(int joint) const;

  // Finds the twists after `step` seconds without contacts and hard limits.
  void accelerate(double step, const Vec3& gravity);
  const std::vector<Vec6>& twists() const { return twists_; }  // of bodies

  // After accelerate(): what a wrench of impulses on body a, and its negative on b (-1: none),
  // gives to each freedom up to the roots. Calls visit(number, impulse, speed) for the 3 or 6 of a
  // link, from `number` on. The speed that one wrench gives along another is the sum of the speeds
  // by the one times the impulses by the other (Featherstone's operational-space inertia,
  // factored).
  template <typename Visit>
  void each_answer(int a, int b, const Vec6& wrench, const Visit& visit) const;
  int freedom_count() const { return freedom_count_; }

  // After accelerate(): the twists with a wrench of impulses on each body.
  void answer(std::span<const Vec6> wrenches, std::vector<Vec6>& twists) const;

  // Moves the bodies on with the twists `moving`; their speeds are then those of `left`.
  void move(double step, std::span<const Vec6> moving, std::span<const Vec6> left);

  void move_back();  // to where accelerate() began

  // Impulses about the world's origin at a body, before accelerate().
  void push(int body, const Vec3& impulse);
  double max_spin() const;  // of a body, radians/s

 private:
  enum class Freedom : unsigned char { all, none, turn, hinge, slide };
  struct Link {
    int parent = -1;  // link
    int body = -1;    // none: without mass, between a slide and a turn of the same joint
    int joint = -1;   // none: a free body
    int root = 0;     // link
    int number = 0;   // of its first freedom
    Freedom freedom = Freedom::all;
    bool kinematic = false;
    Mat63 axes = Mat63::Zero();      // S; unused columns are 0
    Mat6 inertia = Mat6::Zero();     // articulated
    Vec6 momentum = Vec6::Zero();    // articulated
    Mat63 coupling = Mat63::Zero();  // U = I S
    Mat3 inverse = Mat3::Zero();     // (S^T U + dampers)^-1
    Mat36 gain = Mat36::Zero();      // inverse U^T
    Mat6 free = Mat6::Zero();        // of a free body, the inverse of its inertia
    Vec3 impulse = Vec3::Zero();     // on the joint's coordinates, of springs and motors
    Vec6 drift = Vec6::Zero();       // against the parent, by the anchor's movement
    Vec6 twist = Vec6::Zero();
  };
  struct Ties {                      // of a joint
    int turn = -1, slide = -1;       // links
    Quat turned = Quat::Identity();  // the child's frame in the parent's
    Vec3 slid = Vec3::Zero();        // in the parent's frame
    Vec3 moved = Vec3::Zero();       // how far the anchor has, in the parent's frame
  };

  void add_links(int body, std::span<const int> joint_of, std::vector<bool>& added);
  void add_joint_links(int body, int joint);
  void take_up(int joint);
  Transform parent_frame(int joint) const;
  Vec6 body_twist(int body) const;
  void set_axes(Link& link) const;
  void set_drift(int number);
  void gather(double step, const Vec3& gravity);
  void pull_held(double step);
  void eliminate(double step);
  void distribute();
  Vec3 last_rate(const Link& link) const;
  void drive(Link& link, double step, Mat3& damping) const;
  void run_motor(Link& link, double step, Mat3& damping) const;
  void soft_turn(Link& link, double step, Mat3& damping) const;
  void soft_slide(Link& link, double step, Mat3& damping) const;
  void spring(Link& link, const Vec3& axis, double beyond, double step, Mat3& damping) const;
  void hold_distances(double step);
  void place(double step, std::span<const Vec6> moving);
  void keep_momenta(double step, std::span<const Vec6> moving, std::span<const BodyState> before);

  std::vector<double> masses_;
  std::vector<Vec3> moments_;
  std::vector<Mat3> inertias_;  // world
  std::vector<BodyState> states_;
  std::vector<Joint> joints_;
  std::vector<Ties> ties_;   // shape [joints]
  std::vector<Link> links_;  // parents first
  int freedom_count_ = 0;
  int pose_ = 0;                                             // counts moves
  mutable std::vector<std::vector<LimitSide>> limit_sides_;  // shape [joints]
  mutable std::vector<int> sides_of_pose_;                   // shape [joints]
  std::vector<int> link_of_;                                 // shape [bodies]
  std::vector<Vec6> twists_;                                 // shape [bodies]
  std::vector<Vec3> anchor_speeds_;                          // shape [joints]
  std::vector<std::pair<int, Hold>> holds_;                  // bodies
  std::vector<BodyState> before_;                            // the last move()
  std::vector<Mat3> inertias_before_;
  std::vector<Ties> ties_before_;
  Vec3 fallen_ = Vec3::Zero();  // by gravity in the step, m/s
};

template <typename Visit>
void Articulation::each_answer(int a, int b, const Vec6& wrench, const Visit& visit) const {
  int i = link_of_[at(a)], j = b < 0 ? -1 : link_of_[at(b)];
  Vec6 here = wrench, there = -wrench;
  while (i >= 0 || j >= 0) {
    if (i == j) {
      here += there;
      j = -1;
    } else if (i < j) {  // parents come first
      std::swap(i, j);
      std::swap(here, there);
    }
    const Link& link = links_[at(i)];
    const bool ends = link.kinematic || link.freedom == Freedom::all;
    if (!link.kinematic && ends) visit(link.number, here, Vec6(link.free * here));
    if (!ends && link.freedom != Freedom::none) {
      const Vec3 impulse = link.axes.transpose() * here;
      const Vec3 speed = link.inverse * impulse;
      visit(link.number, impulse, speed);
      here.noalias() -= link.coupling * speed;
    }
    i = ends ? -1 : link.parent;
  }
}

// Principal moments of inertia of a body.
Vec3 moments_of_inertia(const Body& body);

}  // namespace krok::ragdoll
