#include "lint/rules.h"

#include <algorithm>

namespace krok::lint {

namespace {

constexpr auto kError = Severity::error;
constexpr auto kWarning = Severity::warning;

constexpr std::array<RuleFacts, kRuleCount> kRules = {{
    {Rule::unreadable, "unreadable", kError, 0, "", "The file cannot be read"},
    {Rule::unit, "unit", kError, 2, "", "The body is far taller or shorter than people are"},
    {Rule::frame_rate, "frame-rate", kError, 1.55, "",
     "The motion plays at another speed than it was captured, or frames are doubled"},
    {Rule::flip, "flip", kError, 90, "deg", "A joint turns half round within a frame"},
    {Rule::pop, "pop", kError, 4, "deg", "A joint jumps: a spike, a step, or a seam of two takes"},
    {Rule::frozen, "frozen", kError, 0.15, "s", "The whole body stands still, to the last digit"},
    {Rule::jitter, "jitter", kWarning, 0.8, "deg", "Joints shake from frame to frame"},
    {Rule::over_smooth, "over-smooth", kWarning, 8, "",
     "A stretch has lost the detail that the rest of the motion has"},
    {Rule::foot_slide, "foot-slide", kWarning, 0.04, "m", "A foot slides while it stands"},
    {Rule::drift, "drift", kWarning, 0.1, "m",
     "The whole body is carried off while the feet stand"},
    {Rule::ground, "ground", kWarning, 0.06, "m", "Feet sink into the ground or float above it"},
    {Rule::bone_length, "bone-length", kError, 2, "%", "A bone changes its length"},
    {Rule::joint_limit, "joint-limit", kWarning, 20, "deg", "A knee bends forwards"},
    {Rule::loop_seam, "loop-seam", kWarning, 3, "deg",
     "The last pose of a loop does not lead to the first"},
    {Rule::rest_frame, "rest-frame", kWarning, 0, "", "The first frame is a rest pose"},
    {Rule::asymmetric_rest_pose, "asymmetric-rest-pose", kWarning, 4, "%",
     "Left and right limbs of the reference pose differ in length"},
    {Rule::duplicate, "duplicate", kWarning, 4, "deg", "The same motion is in two files"},
    {Rule::self_intersection, "self-intersection", kWarning, 0.07, "m",
     "Limbs go into each other or into the trunk"},
    {Rule::unweighted_vertex, "unweighted-vertex", kError, 0, "",
     "Vertices of a skinned mesh follow no joint"},
    {Rule::vertex_weight, "vertex-weight", kWarning, 0, "",
     "Weights do not sum to 1, are negative, or name no joint"},
    {Rule::bind_pose, "bind-pose", kError, 2, "",
     "Inverse bind matrices that are singular, scaled, or tear the mesh"},
    {Rule::degenerate_triangle, "degenerate-triangle", kWarning, 0.5, "%",
     "Triangles without area, or with a vertex twice"},
    {Rule::triangle_winding, "triangle-winding", kWarning, 0.5, "%",
     "Neighbouring triangles face opposite sides"},
    {Rule::vertex_normal, "vertex-normal", kWarning, 0.5, "%",
     "Normals are zero, or opposite to the triangles around"},
}};

}  // namespace

std::span<const RuleFacts, kRuleCount> rules() {
  return kRules;
}

const RuleFacts& facts_of(Rule rule) {
  return kRules[static_cast<std::size_t>(rule)];
}

std::optional<Rule> find_rule(std::string_view id) {
  const auto found = std::ranges::find(kRules, id, &RuleFacts::id);
  if (found == kRules.end()) return std::nullopt;
  return found->rule;
}

Settings::Settings() {
  enabled.fill(true);
  enabled[static_cast<std::size_t>(Rule::self_intersection)] = false;
  for (const RuleFacts& facts : kRules) {
    thresholds[static_cast<std::size_t>(facts.rule)] = facts.threshold;
  }
}

Settings near_limits(const Settings& settings) {
  Settings near = settings;
  near.enabled.fill(false);
  for (const Rule rule : {Rule::foot_slide, Rule::drift, Rule::ground}) {
    const auto i = static_cast<std::size_t>(rule);
    near.enabled[i] = settings.enabled[i];
    near.thresholds[i] *= 0.65;
  }
  return near;
}

}  // namespace krok::lint
