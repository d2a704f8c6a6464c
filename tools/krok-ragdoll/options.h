#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/numbers.h"
#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "math/transform.h"
#include "tools/cli/tool.h"
#include "tools/krok-ragdoll/follow.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::ragdoll {

inline constexpr double kMaxImpulse = 1e4;  // N s

struct PushAt {
  std::string joint;
  Vec3 impulse = Vec3::Zero();  // N s
  bool timed = false;
  ClipTime time;
};

struct Options {
  std::string input, map, model;
  std::string bodies, save_bodies;
  ClipTime at;
  std::optional<double> duration;  // seconds
  std::optional<double> mass;      // kg
  std::vector<PushAt> pushes;
  std::string push_table;
  std::vector<std::string> rises;
  GroundChoice ground;
  std::string limits = "auto";
  FollowOptions follow;
  double friction = 0, restitution = 0;
  bool soft = false;
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

// The tool. Each call has options of its own.
ToolSpec make_spec();

// Reads the motion, model, limits and ground; writes the motion with its fall. A character that
// does not come to rest is a warning (ragdoll-moving). Codes: those of the readers, formats/limits
// and lib/ragdoll; ragdoll-joint for a joint of an option that the motion has not, ragdoll-time for
// times outside it.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::ragdoll
