#include "body/shapes.h"

#include <algorithm>
#include <cmath>

#include "roles/joint_names.h"

namespace krok::body {

namespace {

class GeneralBuilder {
 public:
  GeneralBuilder(const Skeleton& skeleton, std::span<const Transform> pose)
      : skeleton_(skeleton),
        pose_(pose),
        children_(skeleton.children()),
        count_(skeleton.names.size()) {
    find_flesh();
    if (std::find(flesh_.begin() + 1, flesh_.end(), 1) == flesh_.end()) flesh_.assign(count_, 1);
    Eigen::AlignedBox3d box;
    for (std::size_t j = 0; j < count_; ++j) {
      if (flesh_[j] == 0) continue;
      box.extend(pose[j].position);
      if (j > 0) box.extend(pose[at(skeleton.parents[j])].position);
    }
    extent_ = box.diagonal().norm();
  }

  Shape build(double lone_radius) {
    measure();
    if (!(total_ > 0) || !(extent_ > 0)) return lone_ball(lone_radius);
    tube_of_.assign(count_, -1);
    std::vector<int> starts{0};
    // Each chain follows the heaviest child from its branching point.
    for (std::size_t next = 0; next < starts.size(); ++next) follow(starts[next], starts);
    blend_at_joints();
    return std::move(shape_);
  }

 private:
  std::size_t at(int joint) const { return static_cast<std::size_t>(joint); }

  double distance(int a, int b) const {
    return (pose_[at(a)].position - pose_[at(b)].position).norm();
  }

  // Bones without flesh: those to joints such as IK targets and eyes, by name, unless a part of the
  // body hangs below; and those by which a root only carries the body.
  void find_flesh() {
    flesh_.assign(count_, 1);
    for (int j = skeleton_.joint_count(); j-- > 1;) {
      const auto& below = children_[at(j)];
      const bool bare = std::ranges::all_of(below, [&](int child) {
        return flesh_[at(child)] == 0 || skeleton_.end_sites[at(child)] != 0;
      });
      if (skeleton_.end_sites[at(j)] != 0 || !bare || !names_no_shape(skeleton_.names[at(j)]))
        continue;
      flesh_[at(j)] = 0;
      for (const int child : below) flesh_[at(child)] = 0;
    }
    for (const int j : joints_that_carry()) {
      for (const int child : children_[at(j)]) flesh_[at(child)] = 0;
      if (j == 0) flesh_[0] = 0;
    }
  }

  // The root and the joints between it and the body's first fork, if two tips or more come back
  // from that fork to the root's level, as feet do below hips over a root on the ground. Branches
  // of a tree stay above its root; a crane's gripper comes back to it, but forks far from its post.
  std::vector<int> joints_that_carry() const {
    std::vector<double> reach(count_, 0);  // of the longest way below
    for (int j = skeleton_.joint_count(); j-- > 1;) {
      const int parent = skeleton_.parents[at(j)];
      if (flesh_[at(j)] != 0)
        reach[at(parent)] = std::max(reach[at(parent)], reach[at(j)] + distance(parent, j));
    }
    std::vector<int> carrying;
    int fork = 0;
    for (int next = 0; next >= 0;) {
      fork = next;
      next = -1;
      for (const int child : children_[at(fork)]) {
        if (flesh_[at(child)] == 0 || (next >= 0 && reach[at(child)] <= reach[at(next)])) continue;
        next = child;
      }
      for (const int child : children_[at(fork)]) {
        if (child != next && next >= 0 && flesh_[at(child)] != 0 &&
            4 * reach[at(child)] > reach[at(next)])
          next = -1;
      }
      if (next >= 0) carrying.push_back(fork);
    }
    const double length = distance(0, fork);
    const Vec3 up = (pose_[at(fork)].position - pose_[0].position) / std::max(length, 1e-12);
    // Where the ways to the tips at the root's level part.
    int parting = -1, tips = 0;
    for (int j = fork + 1; j < skeleton_.joint_count(); ++j) {
      const bool low = (pose_[at(j)].position - pose_[0].position).dot(up) < 0.35 * length;
      const auto way = way_from(fork, j);
      if (!low || !children_[at(j)].empty() || flesh_[at(j)] == 0 || way.empty()) continue;
      ++tips;
      if (parting < 0) parting = j;
      while (std::ranges::find(way, parting) == way.end()) parting = skeleton_.parents[at(parting)];
    }
    if (!(length > 0) || tips < 2 || distance(fork, parting) > 0.5 * length) carrying.clear();
    return carrying;
  }

  // The joints from one to another below it, both included; empty if it is not below.
  std::vector<int> way_from(int top, int joint) const {
    std::vector<int> way;
    for (int j = joint; j >= top; j = skeleton_.parents[at(j)]) way.push_back(j);
    return way.back() == top ? way : std::vector<int>();
  }

  void measure() {
    length_.assign(count_, 0);
    beyond_.assign(count_, 0);
    along_.assign(count_, 0);
    for (std::size_t j = 1; j < count_; ++j) {
      const std::size_t parent = at(skeleton_.parents[j]);
      length_[j] = (pose_[j].position - pose_[parent].position).norm();
      if (length_[j] < 1e-5 * extent_ || flesh_[j] == 0) length_[j] = 0;
      along_[j] = along_[parent] + length_[j];
      total_ += length_[j];
    }
    for (std::size_t j = count_; j-- > 1;) {
      beyond_[at(skeleton_.parents[j])] += beyond_[j] + length_[j];
    }
  }

  Shape lone_ball(double radius) {
    Tube tube;
    Station station;
    station.center = pose_[0].position;
    station.width = station.depth = station.cap = radius;
    tube.stations = {station};
    tube.joints = {{0, 0, 0}};
    shape_.add(std::move(tube));
    return std::move(shape_);
  }

  // The radius of a bone with `carried` metres of descendant bones. Skeletons with very many
  // branches and single chains are slimmer than those with a few limbs.
  double radius(double carried) const {
    const double share = std::sqrt(carried / total_), stretched = extent_ / total_;
    const double bush = std::min(1.0, 0.45 + std::sqrt(stretched));
    const double chain = 1 - 1.1 * std::clamp(stretched - 0.45, 0.0, 0.5);
    return extent_ * std::max(0.012, 0.105 * share * bush * chain);
  }

  // Builds the chain that starts with the bone from `joint`'s parent to `joint` (the root: from
  // itself); adds its branches to `starts`.
  void follow(int joint, std::vector<int>& starts) {
    Tube tube;
    std::vector<int> chain;
    const int parent = skeleton_.parents[at(joint)];
    const bool from_parent = parent >= 0 && flesh_[at(joint)] != 0;
    if (from_parent) chain.push_back(parent);
    chain.push_back(joint);
    const int index = static_cast<int>(shape_.tubes.size());
    for (int j = joint; j >= 0;) {
      tube_of_[at(j)] = index;
      int heaviest = -1;
      for (const int child : children_[at(j)]) {
        if (flesh_[at(child)] == 0) continue;
        if (heaviest < 0 || beyond_[at(child)] + length_[at(child)] >
                                beyond_[at(heaviest)] + length_[at(heaviest)]) {
          heaviest = child;
        }
      }
      for (const int child : children_[at(j)]) {
        if (child != heaviest) starts.push_back(child);
      }
      if (heaviest >= 0) chain.push_back(heaviest);
      j = heaviest;
    }
    double chain_length = 0;
    for (std::size_t i = 1; i < chain.size(); ++i) chain_length += length_[at(chain[i])];
    if (chain_length == 0) {  // invisible: its joints influence nothing
      if (flesh_[at(joint)] == 0) {
        tube_of_[at(joint)] = -1;
        return;
      }
      for (const int j : chain) {
        if (j != parent) tube_of_[at(j)] = parent >= 0 ? tube_of_[at(parent)] : index;
      }
      if (parent >= 0) return;
    }
    for (std::size_t i = 0; i < chain.size(); ++i) {
      add_station(tube, chain, i, from_parent, chain_length);
    }
    orient(tube);
    shape_.add(std::move(tube));
  }

  void add_station(Tube& tube, const std::vector<int>& chain, std::size_t i, bool from_parent,
                   double chain_length) {
    const int joint = chain[i];
    const bool repeats = i > 0 && length_[at(joint)] == 0;
    const double reach = along_[at(joint)] - along_[at(chain[0])];
    Station station;
    station.center = pose_[at(joint)].position;
    double carried = beyond_[at(joint)];
    if (i == 0 && from_parent) {  // a branch starts with the thickness that it continues with
      carried = beyond_[at(chain[1])] + length_[at(chain[1])];
    } else if (i + 1 < chain.size()) {
      carried = beyond_[at(chain[i + 1])] + length_[at(chain[i + 1])];
    }
    if (i == 0 && !from_parent) carried = std::min(carried, 0.5 * total_);
    // Limits the thickness by the length.
    const double r = std::min(radius(carried), std::max(0.4 * chain_length, 0.01 * extent_));
    station.width = station.depth = station.cap = r;
    station.arc = reach;
    station.along = along_[at(joint)];
    if (!skeleton_.end_sites[at(joint)]) {
      if (tube.joints.empty()) {
        tube.joints.push_back({joint, -1e300, 0});
      } else {
        tube.joints.push_back({joint, std::max(reach, tube.joints.back().at), 0.9 * r});
      }
    }
    if (!repeats) tube.stations.push_back(station);
  }

  // Assigns minimal-twist frames to the stations.
  void orient(Tube& tube) const {
    Vec3 front = Vec3::UnitZ();
    for (std::size_t i = 0; i < tube.stations.size(); ++i) {
      const auto& stations = tube.stations;
      const Vec3 along = stations[std::min(i + 1, stations.size() - 1)].center -
                         stations[i > 0 ? i - 1 : 0].center;
      const double length = along.norm();
      const Vec3 direction = length > 0 ? Vec3(along / length) : Vec3(Vec3::UnitY());
      if (std::abs(front.dot(direction)) > 0.9 && i == 0) front = Vec3::UnitY();
      front -= direction * front.dot(direction);
      const double rest = front.norm();
      if (rest > 1e-6) {
        front /= rest;
      } else {
        front = direction.unitOrthogonal();
      }
      tube.stations[i].front = front;
      tube.stations[i].side = direction.cross(front);
    }
    double widest = 0;
    for (const Station& station : tube.stations) widest = std::max(widest, station.width);
    for (Station& station : tube.stations) {
      station.detail = std::sqrt(station.width / (0.1 * extent_) + 0.02);
    }
  }

  // Blends tubes that meet at a joint.
  void blend_at_joints() {
    for (std::size_t j = 0; j < count_; ++j) {
      if (tube_of_[j] < 0) continue;
      std::vector<int> meeting = {tube_of_[j]};
      for (const int child : children_[j]) {
        if (tube_of_[at(child)] >= 0 && flesh_[at(child)] != 0)
          meeting.push_back(tube_of_[at(child)]);
      }
      std::sort(meeting.begin(), meeting.end());
      meeting.erase(std::unique(meeting.begin(), meeting.end()), meeting.end());
      if (meeting.size() < 2) continue;
      double thinnest = extent_;
      for (const int tube : meeting) {
        double r = 0;
        for (const Station& s : shape_.tubes[at(tube)].stations) r = std::max(r, s.width);
        thinnest = std::min(thinnest, r);
      }
      // Pairwise with the tube through the joint, so that there is no webbing between neighbouring
      // branches (fingers, legs).
      for (const int tube : meeting) {
        if (tube != tube_of_[j]) shape_.blends.push_back({{tube_of_[j], tube}, 0.9 * thinnest});
      }
    }
  }

  const Skeleton& skeleton_;
  std::span<const Transform> pose_;
  std::vector<std::vector<int>> children_;
  std::size_t count_;
  double extent_ = 0, total_ = 0;
  std::vector<char> flesh_;     // whether the bone that ends at each joint has any
  std::vector<double> length_;  // of these bones; 0 without flesh
  std::vector<double> beyond_;  // of all bones below each joint
  std::vector<double> along_;   // from the root
  std::vector<int> tube_of_;    // the tube that runs through each joint
  Shape shape_;
};

}  // namespace

Shape general_shape(const Skeleton& skeleton, std::span<const Transform> pose, double lone_radius) {
  return GeneralBuilder(skeleton, pose).build(lone_radius);
}

}  // namespace krok::body
