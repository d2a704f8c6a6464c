#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/result.h"

// The rules of krok-lint, in one table: of motions, then of the meshes of characters.

namespace krok::lint {

enum class Rule : std::uint8_t {
  unreadable,
  unit,
  frame_rate,
  flip,
  pop,
  frozen,
  jitter,
  over_smooth,
  foot_slide,
  drift,
  ground,
  bone_length,
  joint_limit,
  loop_seam,
  rest_frame,
  asymmetric_rest_pose,
  duplicate,
  self_intersection,
  unweighted_vertex,
  vertex_weight,
  bind_pose,
  degenerate_triangle,
  triangle_winding,
  vertex_normal
};
inline constexpr std::size_t kRuleCount = 24;

struct RuleFacts {
  Rule rule;
  std::string_view id;  // "foot-slide"
  Severity severity;
  // A fault is a value above it; of frame-rate and unit also one below its inverse. In `unit`.
  // Lengths of motions are those of a body with legs of 0.86 m and scale with the legs.
  double threshold;
  std::string_view unit;     // "m", "deg", "s", "%", or "" for factors and counts
  std::string_view meaning;  // one line
};

// In the order of Rule.
std::span<const RuleFacts, kRuleCount> rules();
const RuleFacts& facts_of(Rule rule);
std::optional<Rule> find_rule(std::string_view id);

// Which rules run, and their thresholds.
struct Settings {
  std::array<bool, kRuleCount> enabled{};
  std::array<double, kRuleCount> thresholds{};

  // All rules but self-intersection, which is slow, with their own thresholds.
  Settings();
  bool has(Rule rule) const { return enabled[static_cast<std::size_t>(rule)]; }
  double threshold(Rule rule) const { return thresholds[static_cast<std::size_t>(rule)]; }
};

// The rules of feet among those of `settings`, alone, with 0.65 times the limits: what they find is
// over the limit or nearly so, and may be over it in a copy at another rate.
Settings near_limits(const Settings& settings);

}  // namespace krok::lint
