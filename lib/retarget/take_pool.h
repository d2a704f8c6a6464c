#pragma once

#include <cstddef>

#include "roles/roles.h"
#include "scene/clip.h"

namespace krok::retarget {

// Frames of many takes of an actor as one motion, which find_stance() builds a T-pose from: each
// take alone shows how its feet stand to a few degrees only. Memory does not grow with the length
// of the takes. A take that begins in a T-pose gives the first frame.
class TakePool {
 public:
  // Of so many takes, all of one skeleton by joints and parents; `roles` are those of its joints.
  TakePool(std::size_t takes, const RoleMap& roles);

  // Up to 20,000 frames over all takes, evenly spaced in each and at least 4 of each.
  void add(const Clip& take);

  // The skeleton is that of the first take; rate and provenance have no meaning.
  const Clip& clip() const { return pool_; }

 private:
  int frames_each_;
  const RoleMap& roles_;
  Clip pool_;
  bool has_stance_ = false;
};

}  // namespace krok::retarget
