#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/numbers.h"
#include "core/result.h"
#include "ragdoll/simulate.h"
#include "roles/roles.h"
#include "tools/cli/tool.h"

// Options that let the motion play on in the simulation.

namespace krok::cli::ragdoll {

struct FollowOptions {
  std::optional<double> powered, hold;
  std::vector<std::string> simulated;
  std::optional<ClipTime> until;
  double push_every = 0;  // seconds; 0: none
  std::uint32_t seed = 1;

  bool any() const { return powered || hold || !simulated.empty(); }
};

void declare_follow(CommandOptions& command, FollowOptions& options);

// Sets the modes of bodies as the options say; without, they keep those of the file. Code
// ragdoll-joint if the skeleton has no joint of a name, usage if what is asked for (`gets_up`:
// --get-up) does not go with bodies that follow the motion, or with such that do not.
Status set_modes(const FollowOptions& options, bool gets_up, const Skeleton& skeleton,
                 const RoleMap& roles, std::vector<krok::ragdoll::Body>& bodies);

// Sets duration and go_on of a fall that begins at `fall.at`, and adds the pushes of --push-every:
// at the chest, impulses that give the whole body 1 m/s, alternately to opposite sides of the
// character, turned by up to 60 degrees by chance. The same seed gives the same pushes. `duration`
// is as given. Code ragdoll-time if --until is not within the motion.
Status set_end(const FollowOptions& options, std::optional<double> duration, const Clip& motion,
               const RoleMap& roles, const std::vector<krok::ragdoll::Body>& bodies,
               krok::ragdoll::FallOptions& fall);

}  // namespace krok::cli::ragdoll
