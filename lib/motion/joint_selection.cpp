#include "motion/joint_selection.h"

#include <fmt/format.h>

#include <string_view>

#include "core/text.h"
#include "motion/hips_root.h"
#include "roles/roles.h"

namespace krok {

namespace {

// Backtracks only to the last * on a mismatch, so the time is bounded by the product of the
// lengths.
bool matches(std::string_view name, std::string_view pattern) {
  std::size_t n = 0, p = 0, star = std::string_view::npos, taken = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      taken = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p;
      ++n;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++taken;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

Error no_such_joint(const std::string& text, const Skeleton& skeleton) {
  const std::string near = nearest_name(text, skeleton.names);
  return Error("motion-joint", fmt::format("no joint is called '{}'", shown(text)),
               near.empty() ? "krok-info lists the joints; * matches any characters"
                            : fmt::format("did you mean '{}'?", shown(near)));
}

}  // namespace

Result<std::vector<std::uint8_t>> select_joints(const Skeleton& skeleton,
                                                const JointSelection& selection) {
  const bool all = selection.patterns.empty() && selection.below.empty();
  std::vector<std::uint8_t> selected(skeleton.names.size(), all ? 1 : 0);
  for (const std::string& pattern : selection.patterns) {
    bool any = false;
    for (std::size_t j = 0; j < selected.size(); ++j) {
      if (!matches(skeleton.names[j], pattern)) continue;
      selected[j] = 1;
      any = true;
    }
    // A name that no joint has may be a role's.
    const Role role = any ? Role::none : parse_role(pattern).value_or(Role::none);
    if (role != Role::none) {
      for (const int joint : find_roles(skeleton).joints(role)) {
        selected[static_cast<std::size_t>(joint)] = 1;
        any = true;
      }
    }
    if (!any) return no_such_joint(pattern, skeleton);
  }
  for (const std::string& name : selection.below) {
    int joint = skeleton.find(name);
    if (joint < 0) joint = find_joint(skeleton, find_roles(skeleton), name);
    if (joint < 0) return no_such_joint(name, skeleton);
    const auto within = subtree(skeleton, joint);
    for (std::size_t j = 0; j < selected.size(); ++j) selected[j] |= within[j];
  }
  return selected;
}

}  // namespace krok
