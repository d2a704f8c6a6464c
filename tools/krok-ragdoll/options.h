#pragma once

#include <string>
#include <vector>

#include "core/quantity.h"
#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "math/types.h"
#include "tools/cli/tool.h"
#include "tools/krok-ragdoll/follow.h"

namespace krok::cli::ragdoll {

// The options as given on the command line.
struct Arguments {
  std::string input, map, model;
  std::string bodies, save_bodies;
  std::string at = "0s", duration, mass = "75kg";
  std::vector<std::string> pushes;  // JOINT=X,Y,ZNs[@TIME]
  std::string push_table;
  std::vector<std::string> rises;
  std::string ground = "level";
  std::string limits = "auto";
  FollowArguments follow;
  double friction = 0.7, restitution = 0;
  bool soft = false;
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

inline constexpr double kMaxImpulse = 1e4;  // N s

struct PushAt {
  std::string joint;
  Vec3 impulse = Vec3::Zero();  // N s
  bool timed = false;
  ClipTime time;
};

// The parsed options.
struct Options {
  Arguments given;
  std::vector<PushAt> pushes;
  ClipTime at;
  std::optional<double> duration;
  double mass = 75;
  FollowOptions follow;
};

void declare(CommandOptions& command, Arguments& arguments);

// Code usage; messages name the option.
Result<Options> understand(const Arguments& arguments);

// The tool. Each call has options of its own.
ToolSpec make_spec();

}  // namespace krok::cli::ragdoll
