#include "body/general_shape.h"

#include <algorithm>
#include <cmath>

namespace krok::body {

namespace {

class GeneralBuilder {
 public:
  GeneralBuilder(const Skeleton& skeleton, std::span<const Transform> pose)
      : skeleton_(skeleton),
        pose_(pose),
        children_(skeleton.children()),
        count_(skeleton.names.size()) {
    Eigen::AlignedBox3d box;
    for (const Transform& transform : pose) box.extend(transform.position);
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

  void measure() {
    length_.assign(count_, 0);
    beyond_.assign(count_, 0);
    along_.assign(count_, 0);
    for (std::size_t j = 1; j < count_; ++j) {
      const std::size_t parent = at(skeleton_.parents[j]);
      length_[j] = (pose_[j].position - pose_[parent].position).norm();
      if (length_[j] < 1e-5 * extent_) length_[j] = 0;
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
    if (parent >= 0) chain.push_back(parent);
    chain.push_back(joint);
    const int index = static_cast<int>(shape_.tubes.size());
    for (int j = joint; j >= 0;) {
      tube_of_[at(j)] = index;
      int heaviest = -1;
      for (const int child : children_[at(j)]) {
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
      for (const int j : chain) {
        if (j != parent) tube_of_[at(j)] = parent >= 0 ? tube_of_[at(parent)] : index;
      }
      if (parent >= 0) return;
    }
    for (std::size_t i = 0; i < chain.size(); ++i)
      add_station(tube, chain, i, parent, chain_length);
    orient(tube);
    shape_.add(std::move(tube));
  }

  void add_station(Tube& tube, const std::vector<int>& chain, std::size_t i, int parent,
                   double chain_length) {
    const int joint = chain[i];
    const bool repeats = i > 0 && length_[at(joint)] == 0;
    const double reach = along_[at(joint)] - along_[at(chain[0])];
    Station station;
    station.center = pose_[at(joint)].position;
    double carried = beyond_[at(joint)];
    if (i == 0 && parent >= 0) {  // a branch starts with the thickness that it continues with
      carried = beyond_[at(chain[1])] + length_[at(chain[1])];
    } else if (i + 1 < chain.size()) {
      carried = beyond_[at(chain[i + 1])] + length_[at(chain[i + 1])];
    }
    if (joint == 0) carried = std::min(carried, 0.5 * total_);
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
      std::vector<int> meeting;
      if (tube_of_[j] >= 0) meeting.push_back(tube_of_[j]);
      for (const int child : children_[j]) {
        if (tube_of_[at(child)] >= 0) meeting.push_back(tube_of_[at(child)]);
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
  std::vector<double> length_;  // of the bone that ends at each joint
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
