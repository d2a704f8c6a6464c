#include "roles/named_joints_internal.h"

#include <algorithm>
#include <utility>

namespace krok {

NamedJoints::NamedJoints(const Skeleton& skeleton, std::vector<JointName> names)
    : skeleton_(skeleton), names_(std::move(names)), children_(skeleton.children()) {
  const std::size_t count = skeleton.names.size();
  depths_.assign(count, 0);
  counts_below_.assign(count, 1);
  for (std::size_t j = 1; j < count; ++j) depths_[j] = depths_[at(skeleton.parents[j])] + 1;
  for (std::size_t j = count; j-- > 1;) {
    counts_below_[at(skeleton.parents[j])] += counts_below_[j];
  }
}

bool NamedJoints::descends(int joint, int ancestor) const {
  while (joint >= 0 && depths_[at(joint)] > depths_[at(ancestor)]) joint = parent(joint);
  return joint == ancestor;
}

int NamedJoints::common_ancestor(int a, int b) const {
  if (a < 0 || b < 0) return std::max(a, b);
  while (a != b) {
    if (depths_[at(a)] >= depths_[at(b)]) {
      a = parent(a);
    } else {
      b = parent(b);
    }
  }
  return a;
}

double NamedJoints::distance(int a, int b) const {
  return (skeleton_.reference[at(a)].position - skeleton_.reference[at(b)].position).norm();
}

int NamedJoints::main_child(int joint) const {
  int best = -1;
  for (const int child : children_[at(joint)]) {
    if (is_end(child) || is_helper(child)) continue;
    if (best < 0 || counts_below_[at(child)] > counts_below_[at(best)]) best = child;
  }
  return best;
}

}  // namespace krok
