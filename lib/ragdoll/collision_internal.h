#pragma once

#include <memory>
#include <span>
#include <vector>

#include "ragdoll/impulse_solver_internal.h"

namespace krok::ragdoll {

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
