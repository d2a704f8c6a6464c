#include "character/joints.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "nodes/animation_choice.h"
#include "roles/joint_names.h"

namespace krok::character {

using nodes::Scene;

namespace {

constexpr std::size_t kMaxJoints = 65535;
constexpr std::size_t kMaxNamed = 6;  // in a message

// Disjoint sets (union-find).
class Groups {
 public:
  explicit Groups(std::size_t count) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), 0);
  }
  int root(int member) {
    while (parents_[at(member)] != member) {
      parents_[at(member)] = parents_[at(parents_[at(member)])];
      member = parents_[at(member)];
    }
    return member;
  }
  // The lower number stays the root, so that the result does not depend on the order of joining.
  void join(int a, int b) {
    a = root(a);
    b = root(b);
    parents_[at(std::max(a, b))] = std::min(a, b);
  }

 private:
  std::vector<int> parents_;
};

// What nodes and their descendants contain.
struct Subtrees {
  std::vector<char> skinned;                  // a mesh with a skin
  std::vector<char> laden;                    // a mesh, a camera or a light
  std::vector<char> animated;                 // a node that an animation moves
  std::vector<char> useful;                   // something other than cameras and lights
  std::vector<char> moved;                    // a node whose transform an animation changes
  std::vector<char> foreign;                  // a joint of a skin that is not chosen
  std::vector<char> own_animated, own_moved;  // the node by itself
};

std::vector<char> animated_nodes(const Scene& scene) {
  std::vector<char> animated(scene.nodes.size(), 0);
  for (const nodes::Animation& animation : scene.animations) {
    for (const nodes::Channel& channel : animation.channels) {
      if (channel.path != nodes::Path::weights) animated[at(channel.node)] = 1;
    }
  }
  return animated;
}

Subtrees look_at_subtrees(const Scene& scene, const std::vector<int>& order) {
  Subtrees result;
  const std::size_t count = scene.nodes.size();
  result.skinned.assign(count, 0);
  result.laden.assign(count, 0);
  result.useful.assign(count, 0);
  result.animated = animated_nodes(scene);
  result.own_animated = result.animated;
  result.own_moved.assign(count, 0);
  for (const nodes::Animation& animation : scene.animations) {
    const std::vector<char> here = nodes::moved_nodes(scene, animation);
    for (std::size_t n = 0; n < count; ++n) result.own_moved[n] |= here[n];
  }
  result.moved = result.own_moved;
  result.foreign.assign(count, 0);
  for (auto node = order.rbegin(); node != order.rend(); ++node) {
    const nodes::Node& one = scene.nodes[at(*node)];
    char& skinned = result.skinned[at(*node)];
    char& laden = result.laden[at(*node)];
    char& useful = result.useful[at(*node)];
    skinned = one.mesh >= 0 && one.skin >= 0;
    const bool equipment = one.camera >= 0 || one.fixture;
    laden = one.mesh >= 0 || equipment;
    useful = !equipment && (one.children.empty() || one.mesh >= 0);
    for (const int child : one.children) {
      skinned |= result.skinned[at(child)];
      laden |= result.laden[at(child)];
      useful |= result.useful[at(child)];
      result.animated[at(*node)] |= result.animated[at(child)];
      result.moved[at(*node)] |= result.moved[at(child)];
    }
  }
  return result;
}

class Chooser {
 public:
  Chooser(const Scene& scene, const nodes::Evaluator& evaluator, Diagnostics& diagnostics)
      : scene_(scene),
        order_(evaluator.order()),
        diagnostics_(diagnostics),
        below_(look_at_subtrees(scene, order_)),
        taken_(scene.nodes.size(), 0) {}

  Result<Joints> choose(const std::string& skin) {
    if (!scene_.skins.empty()) {
      if (Status status = take_skins(skin); !status) return status.error();
    } else if (!skin.empty()) {
      return Error("scene-skin", fmt::format("no skin '{}': the file has no skins", shown(skin)));
    } else {
      take_without_skin();
    }
    if (std::find(taken_.begin(), taken_.end(), 1) == taken_.end()) {
      return Error("scene-skeleton",
                   "no skeleton found: there is no skin and no node that can be a joint");
    }
    join_trees();
    extend_upwards();
    take_bare_nodes();
    leave_stretches_out();
    auto joints = order_joints();
    if (joints) report_left_out();
    return joints;
  }

 private:
  Status take_skins(const std::string& skin);
  void group_skins(Groups& groups);
  Result<int> find_skin(const std::string& name) const;
  void report_choice(int chosen, const std::vector<std::vector<int>>& skeletons, bool by_name);
  void take_without_skin();
  int top_of_joints() const;
  void join_trees();
  void extend_upwards();
  void report_left_out();
  void take_bare_nodes();
  void leave_stretches_out();
  bool link(Joints& joints) const;
  void keep_still_meshes(Joints& joints) const;
  Result<Joints> order_joints();
  std::string skin_label(int skin) const {
    return label("skin", skin, scene_.skins[at(skin)].name);
  }

  const Scene& scene_;
  const std::vector<int>& order_;
  Diagnostics& diagnostics_;
  Subtrees below_;
  std::vector<char> taken_;  // [nodes]
  std::vector<int> skins_;
  bool several_trees_ = false;
};

void Chooser::group_skins(Groups& groups) {
  std::vector<int> skin_of(scene_.nodes.size(), -1);  // one skin that has the node as a joint
  for (std::size_t s = 0; s < scene_.skins.size(); ++s) {
    for (const int joint : scene_.skins[s].joints) {
      int& first = skin_of[at(joint)];
      if (first >= 0) groups.join(first, static_cast<int>(s));
      if (first < 0) first = static_cast<int>(s);
    }
  }
  std::vector<int> above(scene_.nodes.size(), -1);  // skin of the nearest joint at or above it
  for (const int node : order_) {
    const int parent = scene_.nodes[at(node)].parent;
    const int inherited = parent < 0 ? -1 : above[at(parent)];
    const int own = skin_of[at(node)];
    if (own >= 0 && inherited >= 0) groups.join(own, inherited);
    above[at(node)] = own >= 0 ? own : inherited;
  }
  std::vector<int> within = skin_of;  // a skin with joints at the node or below
  for (auto node = order_.rbegin(); node != order_.rend(); ++node) {
    for (const int child : scene_.nodes[at(*node)].children) {
      int& here = within[at(*node)];
      const int there = within[at(child)];
      if (here >= 0 && there >= 0 && !below_.skinned[at(*node)]) groups.join(here, there);
      if (here < 0) here = there;
    }
  }
}

Result<int> Chooser::find_skin(const std::string& name) const {
  for (std::size_t s = 0; s < scene_.skins.size(); ++s) {
    if (scene_.skins[s].name == name) return static_cast<int>(s);
  }
  const auto number = parse_integer(name);
  if (number && *number >= 0 && *number < static_cast<long long>(scene_.skins.size())) {
    return static_cast<int>(*number);
  }
  std::vector<std::string> known;
  for (std::size_t s = 0; s < std::min(scene_.skins.size(), kMaxNamed); ++s) {
    known.push_back(skin_label(static_cast<int>(s)));
  }
  return Error("scene-skin", fmt::format("the file has no skin '{}'", shown(name)),
               fmt::format("the skins are {}{}", fmt::join(known, ", "),
                           known.size() < scene_.skins.size() ? ", ..." : ""));
}

Status Chooser::take_skins(const std::string& skin) {
  Groups groups(scene_.skins.size());
  group_skins(groups);
  std::vector<std::vector<int>> skeletons(scene_.skins.size());  // by root: its skins
  for (std::size_t s = 0; s < scene_.skins.size(); ++s) {
    skeletons[at(groups.root(static_cast<int>(s)))].push_back(static_cast<int>(s));
  }
  std::vector<std::size_t> joints(scene_.skins.size(), 0);
  std::vector<int> counted(scene_.nodes.size(), -1);
  for (std::size_t g = 0; g < skeletons.size(); ++g) {
    for (const int member : skeletons[g]) {
      for (const int joint : scene_.skins[at(member)].joints) {
        if (counted[at(joint)] >= 0) continue;
        counted[at(joint)] = static_cast<int>(g);
        ++joints[g];
      }
    }
  }
  int chosen = static_cast<int>(std::max_element(joints.begin(), joints.end()) - joints.begin());
  if (!skin.empty()) {
    const auto found = find_skin(skin);
    if (!found) return found.error();
    chosen = groups.root(*found);
  }
  std::erase_if(skeletons, [&](const auto& skeleton) {
    const bool keep = !skeleton.empty();
    if (keep && groups.root(skeleton[0]) == chosen) skins_ = skeleton;
    return !keep;
  });
  report_choice(chosen, skeletons, !skin.empty());
  for (std::size_t s = 0; s < scene_.skins.size(); ++s) {
    const bool own = std::ranges::find(skins_, static_cast<int>(s)) != skins_.end();
    std::vector<char>& which = own ? taken_ : below_.foreign;
    for (const int joint : scene_.skins[s].joints) which[at(joint)] = 1;
  }
  for (auto node = order_.rbegin(); node != order_.rend(); ++node) {
    const int parent = scene_.nodes[at(*node)].parent;
    if (parent >= 0) below_.foreign[at(parent)] |= below_.foreign[at(*node)];
  }
  return {};
}

void Chooser::report_choice(int chosen, const std::vector<std::vector<int>>& skeletons,
                            bool by_name) {
  if (skeletons.size() < 2) return;
  std::vector<std::string> others;
  for (const auto& skeleton : skeletons) {
    if (skeleton[0] == chosen || others.size() == kMaxNamed) continue;
    others.push_back(skin_label(skeleton[0]));
  }
  diagnostics_.push_back(
      make_diagnostic(by_name ? Severity::note : Severity::warning, "scene-skeletons",
                      fmt::format("the file has {} skeletons; using that of {}{}", skeletons.size(),
                                  skin_label(chosen), by_name ? "" : ", which has the most joints"),
                      fmt::format("use --skin to select another: {}{}", fmt::join(others, ", "),
                                  others.size() + 1 < skeletons.size() ? ", ..." : "")));
}

void Chooser::take_without_skin() {
  const std::vector<char> animated = animated_nodes(scene_);
  bool any = false;
  for (std::size_t n = 0; n < taken_.size(); ++n) {
    taken_[n] = animated[n] && below_.useful[n];
    any = any || taken_[n];
  }
  if (any) return;
  for (std::size_t n = 0; n < taken_.size(); ++n) {
    taken_[n] = scene_.nodes[n].in_scene && below_.useful[n];
  }
}

// The lowest common ancestor of all taken nodes (may be one of them), or -1 if there is none. In
// depth-first order it is that of the first and the last.
int Chooser::top_of_joints() const {
  int first = -1, last = -1;
  for (const int node : order_) {
    if (!taken_[at(node)]) continue;
    if (first < 0) first = node;
    last = node;
  }
  const auto parent = [&](int node) { return scene_.nodes[at(node)].parent; };
  const auto depth = [&](int node) {
    int steps = 0;
    for (; node >= 0; node = parent(node)) ++steps;
    return steps;
  };
  for (int a = depth(first), b = depth(last); first != last;) {
    if (a >= b) {
      first = parent(first);
      --a;
    } else {
      last = parent(last);
      --b;
    }
  }
  return first;
}

// Takes the nodes between the joints and their lowest common ancestor.
void Chooser::join_trees() {
  const int top = top_of_joints();
  several_trees_ = top < 0;
  if (top >= 0) taken_[at(top)] = 1;
  std::vector<char> under(taken_.size(), 0), over(taken_.size(), 0);
  for (const int node : order_) {
    const int parent = scene_.nodes[at(node)].parent;
    under[at(node)] = parent >= 0 && (taken_[at(parent)] || under[at(parent)]);
  }
  for (auto node = order_.rbegin(); node != order_.rend(); ++node) {
    const int parent = scene_.nodes[at(*node)].parent;
    if (parent >= 0 && (taken_[at(*node)] || over[at(*node)])) over[at(parent)] = 1;
  }
  for (std::size_t n = 0; n < taken_.size(); ++n) taken_[n] |= under[n] && over[n];
}

// Whether a node is named as the hips are, which root joints without vertices or keys may be.
bool is_named_hips(const std::string& name) {
  Skeleton alone;
  alone.add(to_utf8(name), -1, {});
  const JointName read = read_joint_names(alone)[0];
  return read.part == Part::hips && read.side == Side::middle;
}

// Takes ancestors of the topmost joint that belong to the skeleton, and the nodes up to them.
void Chooser::extend_upwards() {
  const int top = top_of_joints();
  if (several_trees_ || top < 0) return;
  std::vector<int> chain;
  std::size_t kept = 0;
  bool part_beside = false;
  const auto parent = [&](int node) { return scene_.nodes[at(node)].parent; };
  for (int below = top, node = parent(top); node >= 0; below = node, node = parent(node)) {
    const nodes::Node& one = scene_.nodes[at(node)];
    if (below_.foreign[at(node)] || one.mesh >= 0) break;
    chain.push_back(node);
    part_beside |= std::ranges::any_of(one.children, [&](int child) {
      return child != below && below_.moved[at(child)] && below_.useful[at(child)];
    });
    if (one.bone || is_named_hips(one.name) || (part_beside && below_.own_animated[at(node)])) {
      kept = chain.size();
    }
  }
  for (std::size_t i = 0; i < kept; ++i) taken_[at(chain[i])] = 1;
}

// What is neither a joint nor above one, nor a part of another skeleton.
void Chooser::report_left_out() {
  std::vector<char> above(taken_.size(), 0);
  for (auto node = order_.rbegin(); node != order_.rend(); ++node) {
    const int parent = scene_.nodes[at(*node)].parent;
    if (parent >= 0 && (taken_[at(*node)] || above[at(*node)])) above[at(parent)] = 1;
  }
  std::vector<char> of_skeleton(taken_.size(), 0);  // of this or of another
  for (const nodes::Skin& skin : scene_.skins) {
    for (const int joint : skin.joints) of_skeleton[at(joint)] = 1;
  }
  std::vector<std::string> moved, bare;
  for (const int node : order_) {
    const nodes::Node& one = scene_.nodes[at(node)];
    char& part = of_skeleton[at(node)];
    part |= one.parent >= 0 && of_skeleton[at(one.parent)] && !taken_[at(one.parent)];
    if (part || taken_[at(node)] || above[at(node)] || below_.foreign[at(node)]) continue;
    if (!one.in_scene || one.skin >= 0 || !below_.useful[at(node)]) continue;
    if (below_.own_moved[at(node)]) {
      moved.push_back(label("node", node, one.name));
    } else if (!below_.laden[at(node)]) {
      bare.push_back(label("node", node, one.name));
    }
  }
  const auto report = [&](Severity severity, const char* what, std::vector<std::string>& names) {
    if (names.empty()) return;
    const auto count = std::ssize(names);
    if (names.size() > kMaxNamed) {
      names.resize(kMaxNamed);
      names.emplace_back("...");
    }
    diagnostics_.push_back(make_diagnostic(
        severity, "scene-left-out",
        fmt::format("{} outside of the skeleton, left out: {}",
                    counted(count, fmt::format("{} node", what)), fmt::join(names, ", "))));
  };
  report(Severity::warning, "animated", moved);
  report(Severity::note, "bare", bare);
}

void Chooser::take_bare_nodes() {
  for (const int node : order_) {
    const int parent = scene_.nodes[at(node)].parent;
    if (taken_[at(node)] || parent < 0 || !taken_[at(parent)]) continue;
    const bool moved = below_.animated[at(node)] && below_.useful[at(node)];
    if (moved || !below_.laden[at(node)]) taken_[at(node)] = 1;
  }
}

// Nodes that only stretch a joint below them, as krok-skin writes them, are no joints.
void Chooser::leave_stretches_out() {
  std::vector<char> in_skin(taken_.size(), 0);
  for (const nodes::Skin& skin : scene_.skins) {
    for (const int joint : skin.joints) in_skin[at(joint)] = 1;
  }
  for (const int node : order_) {
    const nodes::Node& one = scene_.nodes[at(node)];
    if (!taken_[at(node)] || in_skin[at(node)] || one.children.size() != 1) continue;
    const int child = one.children[0];
    const bool named = one.name == scene_.nodes[at(child)].name + "_stretch";
    if (named && in_skin[at(child)] && taken_[at(child)]) taken_[at(node)] = 0;
  }
}

// Fills the rest of a Joints from its nodes; returns whether parents come before their children.
bool Chooser::link(Joints& joints) const {
  joints.node_to_joint.assign(scene_.nodes.size(), -1);
  joints.parents.assign(joints.nodes.size(), -1);
  for (std::size_t j = 0; j < joints.nodes.size(); ++j) {
    if (joints.nodes[j] >= 0) joints.node_to_joint[at(joints.nodes[j])] = static_cast<int>(j);
  }
  for (std::size_t j = 1; j < joints.nodes.size(); ++j) {
    int above = joints.nodes[j] < 0 ? -1 : scene_.nodes[at(joints.nodes[j])].parent;
    while (above >= 0 && joints.node_to_joint[at(above)] < 0 && !several_trees_) {
      above = scene_.nodes[at(above)].parent;
    }
    const int parent = above < 0 ? -1 : joints.node_to_joint[at(above)];
    if (parent >= static_cast<int>(j) || (parent < 0 && !several_trees_)) return false;
    joints.parents[j] = std::max(parent, 0);
  }
  for (const int node : order_) {
    const int parent = scene_.nodes[at(node)].parent;
    int& joint = joints.node_to_joint[at(node)];
    if (joint < 0 && parent >= 0) joint = joints.node_to_joint[at(parent)];
  }
  keep_still_meshes(joints);
  return true;
}

// A root that never moves holds the meshes beside the skeleton that do not move either.
void Chooser::keep_still_meshes(Joints& joints) const {
  std::vector<char> moves = below_.own_moved;  // with the nodes above
  for (const int node : order_) {
    const int parent = scene_.nodes[at(node)].parent;
    if (parent >= 0) moves[at(node)] |= moves[at(parent)];
  }
  if (joints.nodes.empty() || (joints.nodes[0] >= 0 && moves[at(joints.nodes[0])])) return;
  for (const int node : order_) {
    const nodes::Node& one = scene_.nodes[at(node)];
    int& joint = joints.node_to_joint[at(node)];
    if (joint < 0 && one.mesh >= 0 && one.skin < 0 && !moves[at(node)]) joint = 0;
  }
}

Result<Joints> Chooser::order_joints() {
  Joints result;
  result.skins = skins_;
  if (several_trees_) result.nodes.push_back(-1);
  for (const int node : order_) {
    if (taken_[at(node)]) result.nodes.push_back(node);
  }
  if (result.nodes.size() > kMaxJoints) {
    return Error("scene-joints", fmt::format("the skeleton has {} joints; the limit is {}",
                                             result.nodes.size(), kMaxJoints));
  }
  if (skins_.size() == 1) {
    Joints as_in_skin = result;
    as_in_skin.nodes = scene_.skins[at(skins_[0])].joints;
    std::vector<int> sorted = as_in_skin.nodes, wanted = result.nodes;
    std::sort(sorted.begin(), sorted.end());
    std::sort(wanted.begin(), wanted.end());
    if (sorted == wanted && link(as_in_skin)) return as_in_skin;
  }
  link(result);
  return result;
}

}  // namespace

std::string label(const char* kind, int index, const std::string& name) {
  return name.empty() ? fmt::format("{} {}", kind, index)
                      : fmt::format("{} {} ({})", kind, index, shown(name));
}

Result<Joints> choose_joints(const Scene& scene, const nodes::Evaluator& evaluator,
                             const std::string& skin, Diagnostics& diagnostics) {
  return Chooser(scene, evaluator, diagnostics).choose(skin);
}

}  // namespace krok::character
