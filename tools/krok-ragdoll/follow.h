#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/quantity.h"
#include "core/result.h"
#include "ragdoll/simulate.h"
#include "roles/roles.h"
#include "tools/cli/tool.h"

// Options that let the motion play on in the simulation.

namespace krok::cli::ragdoll {

struct FollowArguments {
  std::string powered, hold, until, push_every;
  std::vector<std::string> simulated;  // joints, by name or role
  std::uint32_t seed = 1;
};

struct FollowOptions {
  std::optional<double> powered, hold;
  std::vector<std::string> simulated;
  std::optional<ClipTime> until;
  double push_every = 0;  // seconds; 0: none
  std::uint32_t seed = 1;

  bool any() const { return powered || hold || !simulated.empty(); }
};

void declare_follow(CommandOptions& command, FollowArguments& arguments);

// Code usage; messages name the option.
Result<FollowOptions> understand_follow(const FollowArguments& arguments);

// Sets the modes of bodies as the options say; without, they keep those of the file. Code
// ragdoll-joint if the skeleton has no joint of a name.
Status set_modes(const FollowOptions& options, const Skeleton& skeleton, const RoleMap& roles,
                 std::vector<krok::ragdoll::Body>& bodies);

bool follows_motion(const std::vector<krok::ragdoll::Body>& bodies);

// The pushes of --push-every at the chest, from `begin` to before `end` (seconds of the motion):
// impulses that give the whole body 1 m/s, alternately to opposite sides of the character, turned
// by up to 60 degrees by chance. The same seed gives the same pushes.
std::vector<krok::ragdoll::Push> regular_pushes(const FollowOptions& options, const Clip& motion,
                                                const RoleMap& roles,
                                                const std::vector<krok::ragdoll::Body>& bodies,
                                                double begin, double end);

}  // namespace krok::cli::ragdoll
