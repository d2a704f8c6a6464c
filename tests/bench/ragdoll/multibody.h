#pragma once

#include <memory>
#include <span>

#include "ragdoll/world.h"

// A tree of bodies as Bullet's own btMultiBody: reduced coordinates, its contact solver and its
// limits, on a plane. For comparison alone.

class Multibody {
 public:
  Multibody(std::span<const krok::ragdoll::Body> bodies,
            std::span<const krok::ragdoll::BodyState> states,
            std::span<const krok::ragdoll::Joint> joints, int iterations);
  ~Multibody();

  void step();                          // krok::ragdoll::World::kStep
  double penetration() const;           // metres
  krok::Vec3 position(int body) const;  // centre of mass
  double fastest() const;               // m/s, of all bodies

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};
