#include "timeline/mask.h"

#include <algorithm>

#include "motion/joint_selection.h"

namespace krok::timeline {

namespace {

Status check_rule(const MaskRule& rule) {
  if (!(rule.weight >= 0 && rule.weight <= 1)) {
    return Error("timeline-mask", "the weight of a mask rule is not between 0 and 1");
  }
  if (rule.soft < 0) return Error("timeline-mask", "the soft edge of a mask rule is negative");
  if (rule.joints.empty() == rule.below.empty()) {
    return Error("timeline-mask", "a mask rule needs either \"joints\" or \"below\"");
  }
  return {};
}

}  // namespace

Result<std::vector<double>> mask_weights(const Skeleton& skeleton,
                                         std::span<const MaskRule> rules) {
  std::vector<double> weights(skeleton.names.size(), rules.empty() ? 1 : 0);
  for (const MaskRule& rule : rules) {
    const auto located = [&](Error error) {
      error.code = "timeline-mask";
      error.where = rule.where;
      return error;
    };
    if (Status status = check_rule(rule); !status) return located(status.error());
    JointSelection selection;
    if (rule.below.empty()) {
      selection.patterns = {rule.joints};
    } else {
      selection.below = {rule.below};
    }
    const auto selected = select_joints(skeleton, selection);
    if (!selected) return located(selected.error());
    const int top = rule.below.empty() ? -1 : skeleton.find(rule.below);
    std::vector<int> depth(weights.size(), 0);
    for (std::size_t j = 0; j < weights.size(); ++j) {
      if (!(*selected)[j]) continue;
      if (top >= 0 && static_cast<int>(j) != top) {
        depth[j] = depth[static_cast<std::size_t>(skeleton.parents[j])] + 1;
      }
      const double rise = top < 0 ? 1.0 : std::min(1.0, (depth[j] + 1.0) / (rule.soft + 1.0));
      weights[j] = rule.weight * rise;
    }
  }
  return weights;
}

}  // namespace krok::timeline
