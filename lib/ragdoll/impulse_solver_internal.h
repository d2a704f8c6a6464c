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
// move the bodies on, and those that they keep. Sweeps are in single precision and know the speed
// along each row alone; from their impulses the twists are then found in double.

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
    Vec6 wrench = Vec6::Zero();   // on the group's first body; the other has the negative
    double target = 0, kept = 0;  // least relative speeds: while moving, and afterwards
    float pushed = 0;             // impulse with the target
    bool both = false;            // pulls, too
    int joint = -1, side = 0;     // of a limit
    int contact = -1;
    double gap = 0, asked = 0;  // metres or radians, now and where the step may end
    float* cache = nullptr;
  };
  // Contacts of two bodies in about one plane have one friction: across at the middle of their
  // pressure, and, of more than one, against spinning on the spot. Friction at each point could
  // strain against itself.
  struct Patch {
    std::size_t first = 0, end = 0;  // rows of the contacts; the next are the friction
    float friction = 0;
    std::vector<float> arms;
  };
  struct Term {
    std::size_t row = 0;
    float factor = 0;
  };
  struct Swept {                     // of a row
    std::size_t first = 0, end = 0;  // of terms_: what an impulse of 1 gives to freedoms
    float own = 0, inverse = 0;      // the answer of its own speed to that
    float target = 0;
    bool answered = false;  // whether its row of answers_ is found
  };
  struct Group {
    int a = 0, b = -1;
    std::size_t first = 0, end = 0;  // rows
    int patch = -1;                  // all rows are of it
  };

  void open_group(int a, int b);
  void add_patch(std::span<const Contact> contacts, double friction, double restitution);
  Row& add_row(const Vec6& wrench);
  double speed_along(const Group& group, const Vec6& wrench) const;
  void add_gap(double gap, double fastest);
  void add_limit(int joint, int side, const Vec3& axis, double beyond);
  bool aim_again(const Group& group, Row& row);
  void add_slides(int joint);
  void add_distance(int joint);
  void add_slide(int joint, const Vec3& axis, double beyond);
  void connect();
  float* answer(std::size_t r);
  void change(std::size_t r, float by);
  float speed(std::size_t r) const;
  void add_terms(std::span<const Term> terms, const std::vector<float>& rows, float* to) const;
  void warm_start(bool again);
  void sweep_all(int iterations);
  float sweep();
  void sum(std::vector<Vec6>& all);
  void sweep_until(bool relax, int count);
  void sweep_row(std::size_t r, float& largest);
  void sweep_friction(const Patch& patch, float& largest);

  const Articulation* bodies_ = nullptr;
  double step_ = 0;
  std::span<const Contact> contacts_;
  std::vector<Row> rows_;
  std::vector<Group> groups_;
  std::vector<Patch> patches_;
  std::vector<Vec6> moving_, left_, pushes_;
  std::vector<Swept> swept_;
  std::size_t stride_ = 0;                // rows, in whole registers
  std::vector<float> freedom_impulses_;   // by an impulse of 1 of rows, shape [freedoms, stride_]
  std::vector<Term> terms_;               // speeds of freedoms
  std::vector<Term> changes_;             // of impulses, not yet in speeds_
  std::vector<float> answers_;            // of speeds to an impulse of 1, shape [rows, stride_]
  std::vector<float> impulses_, speeds_;  // of rows, as the next
  std::vector<float> impulses_before_, speeds_before_, impulse_turns_, speed_turns_;
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
