#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "ik/tree_internal.h"

namespace krok::ik {

int row_count(Goal::Kind kind) {
  switch (kind) {
    case Goal::Kind::pose:
      return 6;
    case Goal::Kind::pole:
      return 1;
    case Goal::Kind::balance:
      return 2;
    default:
      return 3;
  }
}

void ChainJoint::set_local(const Quat& joint_to_parent) {
  if (is_hinge()) {
    set_twist(measure(*limit, joint_to_parent).twist);
  } else {
    local = limit ? clamped(*limit, joint_to_parent) : joint_to_parent;
  }
}

void ChainJoint::set_twist(double angle) {
  const double middle = 0.5 * (limit->min_twist + limit->max_twist);
  // Where a full turn is allowed the angle may go round.
  twist = limit->max_twist - limit->min_twist >= 2 * kPi
              ? angle - 2 * kPi * std::round((angle - middle) / (2 * kPi))
              : std::clamp(angle, limit->min_twist, limit->max_twist);
  const double half = 0.5 * twist, sine = std::sin(half);
  local = limit->zero * Quat(std::cos(half), sine * limit->axis.x(), sine * limit->axis.y(),
                             sine * limit->axis.z());
}

void Tree::prepare(std::span<const int> parents) {
  parents_.assign(parents.begin(), parents.end());
  const std::size_t count = parents.size();
  first_child_.assign(count, -1);
  std::vector<int> size(count, 1);
  for (std::size_t j = count; j-- > 1;) {
    const std::size_t parent = at(parents[j]);
    first_child_[parent] = static_cast<int>(j);
    size[parent] += size[j];
  }
  // Depth-first ranks: joints of one sub-tree follow each other, so that a joint's column has its
  // entries in rows that follow each other.
  rank_.assign(count, 0);
  std::vector<int> next(count, 1);
  for (std::size_t j = 1; j < count; ++j) {
    const std::size_t parent = at(parents[j]);
    rank_[j] = rank_[parent] + next[parent];
    next[parent] += size[j];
  }
}

void Tree::mark_chain(const Goal& goal) {
  if (goal.kind == Goal::Kind::balance) {
    std::fill(chain_of_.begin(), chain_of_.end(), 0);
    return;
  }
  int joint = goal.joint;
  if (goal.kind == Goal::Kind::pole) joint = goal.lower >= 0 ? goal.lower : first_child(joint);
  for (const int first : {joint, goal.anchor}) {
    for (int j = first; j >= 0 && chain_of_[at(j)] < 0; j = parents_[at(j)]) chain_of_[at(j)] = 0;
  }
}

void Tree::collect(std::span<const Goal> wanted, const Limits& limits, const Options& options,
                   std::span<const Transform> joint_to_world) {
  chain_of_.assign(parents_.size(), -1);
  has_balance = false;
  for (const Goal& goal : wanted) {
    mark_chain(goal);
    has_balance = has_balance || goal.kind == Goal::Kind::balance;
  }
  joints.clear();
  for (std::size_t j = 0; j < parents_.size(); ++j) {
    if (chain_of_[j] < 0) continue;
    chain_of_[j] = static_cast<int>(joints.size());
    ChainJoint joint;
    joint.index = static_cast<int>(j);
    joint.parent = parents_[j] < 0 ? -1 : chain_index(parents_[j]);
    joint.world = joint_to_world[j];
    if (!limits.empty() && limits[j].kind != JointLimit::Kind::free) joint.limit = &limits[j];
    if (!options.stiffness.empty()) joint.weight = 1 - options.stiffness[j];
    if (joint.limit && joint.limit->kind == JointLimit::Kind::locked) joint.weight = 0;
    if (has_balance && !options.masses.empty()) {
      joint.own_mass = options.masses[j];
      if (!options.mass_centres.empty()) joint.own_centre = options.mass_centres[j];
    }
    const Transform local =
        joint.parent < 0 ? joint.world : joints[at(joint.parent)].world.inverse() * joint.world;
    joint.offset = local.position;
    joint.start = local.orientation.normalized();
    joint.local = joint.start;
    joints.push_back(joint);
  }
  shifted = options.root_moves ? chain_index(options.moving_joint) : -1;
  add_paths(wanted);
  order_rows();
  for (ChainJoint& joint : joints) {
    joint.mobility = joint.moves ? joint.weight : 0;
    if (joint.moves) joint.set_local(joint.local);
  }
  forward();
}

void Tree::place_balance_path(GoalRows& to) {
  // From the last joint up, so that a depth has no meaning here.
  for (std::size_t j = joints.size(); j-- > 0;) path.push_back(static_cast<int>(j));
  to.moving = static_cast<int>(joints.size());
}

void Tree::add_paths(std::span<const Goal> wanted) {
  goals.clear();
  path.clear();
  for (const Goal& goal : wanted) {
    GoalRows added;
    added.goal = &goal;
    added.rows = row_count(goal.kind);
    added.first_path = static_cast<int>(path.size());
    if (goal.kind == Goal::Kind::balance) {
      place_balance_path(added);
    } else {
      added.effector = chain_index(goal.joint);
      int last = added.effector;
      if (goal.kind == Goal::Kind::pole) {
        added.upper = chain_index(goal.upper >= 0 ? goal.upper : parents_[at(goal.joint)]);
        added.lower = chain_index(goal.lower >= 0 ? goal.lower : first_child(goal.joint));
        last = added.lower;
      }
      for (int j = last; j >= 0; j = joints[at(j)].parent) path.push_back(j);
      const int length = static_cast<int>(path.size()) - added.first_path;
      added.moving = goal.depth > 0 ? std::min(goal.depth, length) : length;
    }
    added.paths = static_cast<int>(path.size()) - added.first_path;
    for (int i = 0; i < added.moving; ++i) {
      ChainJoint& joint = joints[at(path[at(added.first_path + i)])];
      joint.moves = joint.weight > 0;
    }
    if (goal.kind != Goal::Kind::balance && goal.anchor >= 0) {
      added.anchor = chain_index(goal.anchor);
    }
    add_reach(added);
    goals.push_back(added);
  }
}

void Tree::add_reach(GoalRows& to) {
  to.first_reach = to.first_path;
  to.reaches = to.paths;
  if (to.anchor < 0) return;
  to.first_reach = static_cast<int>(path.size());
  // Both run from the last joint up; they meet and go on as one.
  int own = path[at(to.first_path)], other = to.anchor;
  while (own >= 0 || other >= 0) {
    const int next = std::max(own, other);
    path.push_back(next);
    if (own == next) own = joints[at(own)].parent;
    if (other == next) other = joints[at(other)].parent;
  }
  to.reaches = static_cast<int>(path.size()) - to.first_reach;
}

bool Tree::carries(int upper, int lower) const {
  while (lower > upper) lower = joints[at(lower)].parent;
  return lower == upper && lower >= 0;
}

Vec3 Tree::target_of(const GoalRows& g) const {
  return g.anchor < 0 ? g.goal->target : joints[at(g.anchor)].world * g.goal->target;
}

Quat Tree::orientation_of(const GoalRows& g) const {
  return g.anchor < 0 ? g.goal->orientation
                      : joints[at(g.anchor)].world.orientation * g.goal->orientation;
}

void Tree::order_rows() {
  order_.resize(goals.size());
  for (std::size_t g = 0; g < goals.size(); ++g) order_[g] = static_cast<int>(g);
  const auto rank = [&](int g) {
    const Goal& goal = *goals[at(g)].goal;
    return goal.kind == Goal::Kind::balance ? static_cast<int>(rank_.size())
                                            : rank_[at(goal.joint)];
  };
  // By insertion: few goals, and nothing is allocated.
  for (std::size_t i = 1; i < order_.size(); ++i) {
    for (std::size_t k = i; k > 0 && rank(order_[k]) < rank(order_[k - 1]); --k) {
      std::swap(order_[k], order_[k - 1]);
    }
  }
  rows = 0;
  for (const int g : order_) {
    goals[at(g)].row = rows;
    rows += goals[at(g)].rows;
  }
}

void Tree::forward(int first) {
  for (std::size_t j = at(first); j < joints.size(); ++j) {
    ChainJoint& joint = joints[j];
    if (joint.parent < 0) {
      joint.world = {joint.offset, joint.local};
    } else {
      const Transform& parent = joints[at(joint.parent)].world;
      joint.world.position = parent.position + parent.orientation * joint.offset;
      joint.world.orientation = parent.orientation * joint.local;
    }
  }
  if (has_balance) gather_masses();
}

void Tree::gather_masses() {
  for (ChainJoint& joint : joints) {
    joint.mass = joint.own_mass;
    joint.moment = joint.own_mass * (joint.world * joint.own_centre);
  }
  for (std::size_t j = joints.size(); j-- > 1;) {
    ChainJoint& parent = joints[at(joints[j].parent)];
    parent.mass += joints[j].mass;
    parent.moment += joints[j].moment;
  }
}

void Tree::write(std::span<Transform> joint_to_world) {
  // Joints that hang on a chain follow it rigidly: their local transforms are taken before any
  // parent is changed.
  local_.resize(parents_.size());
  for (std::size_t j = 0; j < parents_.size(); ++j) {
    if (chain_of_[j] >= 0 || parents_[j] < 0) continue;
    const Transform& parent = joint_to_world[at(parents_[j])];
    const Quat back = parent.orientation.conjugate();
    local_[j] = {back * (joint_to_world[j].position - parent.position),
                 back * joint_to_world[j].orientation};
  }
  for (std::size_t j = 0; j < parents_.size(); ++j) {
    if (chain_of_[j] >= 0) {
      joint_to_world[j] = joints[at(chain_of_[j])].world;
      joint_to_world[j].orientation.normalize();
    } else if (parents_[j] >= 0) {
      joint_to_world[j] = joint_to_world[at(parents_[j])] * local_[j];
      joint_to_world[j].orientation.normalize();
    }
  }
}

}  // namespace krok::ik
