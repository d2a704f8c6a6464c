#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "ragdoll/articulation_internal.h"

namespace krok::ragdoll {

// A point at which a body touches another, or is about to.
struct Contact {
  int a = 0, b = -1;                 // bodies; -1: the surroundings
  Vec3 on_a = Vec3::Zero();          // in a's frame
  Vec3 on_b = Vec3::Zero();          // in b's frame, or the world
  Vec3 normal = Vec3::UnitY();       // world, from b to a
  std::array<float*, 3> impulses{};  // of the last step, along the normal and across it
};

// Impulses at contacts and hard limits by the projected Gauss-Seidel method: each row asks for a
// least relative speed. A row knows how the whole trees answer, not only its bodies.
//
// Contacts and limits act before they are reached: their gap may close, but not go below 0.
// Existing penetration is corrected apart from the speeds: there are two sets of twists, those that
// move the bodies on, and those that they keep. Sweeps are in single precision, with twists and
// wrenches of eight numbers (two are 0), which fill whole registers; from their impulses the twists
// are then found in double.
using Vec8f = Eigen::Matrix<float, 8, 1>;
using Mat8f = Eigen::Matrix<float, 8, 8>;

class ImpulseSolver {
 public:
  // Of one step of an articulation, after accelerate().
  void begin(const Articulation& bodies, double step);
  void add_contacts(std::span<const Contact> contacts, double friction, double restitution);
  void add_limits();
  bool has_rows() const { return !rows_.empty(); }
  void solve(int iterations);

  // Whether the bodies, moved on by moving(), miss what a row asked for by much, because rows are
  // linear and rotation is not. If so, those rows are corrected by what is missing in the new
  // poses, to be solved again from the old ones.
  bool missed();
  void solve_again(int iterations);

  const std::vector<Vec6>& moving() const { return moving_; }
  const std::vector<Vec6>& left() const { return left_; }

 private:
  struct Row {
    Vec6 wrench = Vec6::Zero();     // on the group's first body; the other has the negative
    double target = 0, kept = 0;    // least relative speeds: while moving, and afterwards
    float impulse = 0, pushed = 0;  // the latter with the target
    bool both = false;              // pulls, too
    int joint = -1, side = 0;       // of a limit
    int contact = -1;
    double gap = 0, asked = 0;  // metres or radians, now and where the step may end
    float* cache = nullptr;
  };
  // Contacts of two bodies in about one plane have one friction: across at the middle of their
  // pressure, and against spinning on the spot. Friction at each point could strain against itself.
  struct Patch {
    std::size_t first = 0, end = 0;  // rows of the contacts; the next three are the friction
    float friction = 0;
    std::vector<float> arms;
  };
  struct Swept {           // of a row
    Vec8f wrench, answer;  // the relative twist's answer to an impulse of 1
    float inverse = 0;     // 1 / (wrench . answer)
    float target = 0;
  };
  struct Group {
    int a = 0, b = -1;
    std::size_t first = 0, end = 0;     // rows
    int patch = -1;                     // all rows are of it
    int touched_a = 0, touched_b = -1;  // of touched_
  };

  void open_group(int a, int b);
  void add_patch(std::span<const Contact> contacts, double friction, double restitution);
  Row& add_row(const Vec6& wrench);
  double speed_along(const Group& group, const Vec6& wrench) const;
  void add_gap(double gap, double fastest);
  void add_limit(int joint, int side, const Vec3& axis, double beyond);
  template <typename Side>
  void each_limit(int joint, const Side& side) const;
  bool aim_again(const Group& group, Row& row);
  void add_slides(int joint);
  void add_distance(int joint);
  void add_slide(int joint, const Vec3& axis, double beyond);
  void connect();
  void warm_start(bool again);
  void sweep_all(int iterations);
  float sweep();
  std::vector<Vec6> sum() const;
  void sweep_until(bool relax, int count);
  void sweep_row(std::size_t r, Vec8f& difference, Vec8f& wrench, float& largest);
  void sweep_friction(const Patch& patch, Vec8f& difference, Vec8f& wrench, float& largest);
  void spread(std::size_t group, const Vec8f& wrench);

  const Articulation* bodies_ = nullptr;
  double step_ = 0;
  std::span<const Contact> contacts_;
  std::vector<Row> rows_;
  std::vector<Group> groups_;
  std::vector<Patch> patches_;
  std::vector<int> touched_;    // bodies that have rows
  std::vector<Mat8f> answers_;  // shape [groups, touched]
  std::vector<Vec6> moving_, left_;
  std::vector<Swept> swept_;
  std::vector<Vec8f> twists_, twists_before_, turns_;  // shape [touched]
  std::vector<float> directions_, before_;             // of impulses, shape [rows]
};

// Finds where bodies touch: by Bullet, but for an endless plane and faces of a mesh, whose
// distances from a shape's corners or ends are exact and quick.
class Collision {
 public:
  explicit Collision(const Surroundings& surroundings);
  ~Collision();
  Collision(const Collision&) = delete;
  Collision& operator=(const Collision&) = delete;

  void add(std::span<const Body> bodies, std::span<const BodyState> states,
           std::span<const Joint> joints);

  // Contacts of bodies in these states, and those that may touch within `step` seconds. Their
  // memory of impulses is kept from call to call.
  std::span<const Contact> find(std::span<const BodyState> states, double step);

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace krok::ragdoll
