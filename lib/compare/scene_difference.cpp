#include "compare/scene_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <utility>

#include "compare/skeleton_match.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "math/quaternion.h"

namespace krok::compare {

namespace {

constexpr double kSameMoment = 1e-4;  // seconds
constexpr std::size_t kMostMoments = 1'000'000;

using Pairs = std::vector<std::pair<int, int>>;  // of the first, of the second

// By name where all names are unique and both sides have the same; otherwise place by place, as
// many as both have.
template <typename Item>
Pairs match(const std::vector<Item>& first, const std::vector<Item>& second) {
  Pairs pairs;
  std::unordered_map<std::string_view, int> index;
  for (std::size_t i = 0; i < second.size(); ++i) {
    index.emplace(second[i].name, static_cast<int>(i));
  }
  std::vector<char> taken(second.size(), 0);
  for (std::size_t i = 0; i < first.size() && first.size() == second.size(); ++i) {
    const auto found = index.find(first[i].name);
    if (found == index.end() || taken[static_cast<std::size_t>(found->second)]) break;
    taken[static_cast<std::size_t>(found->second)] = 1;
    pairs.emplace_back(static_cast<int>(i), found->second);
  }
  if (pairs.size() == first.size() && first.size() == second.size()) return pairs;
  pairs.clear();
  for (std::size_t i = 0; i < std::min(first.size(), second.size()); ++i) {
    pairs.emplace_back(static_cast<int>(i), static_cast<int>(i));
  }
  return pairs;
}

std::string label(const char* kind, const std::string& name, int index) {
  return name.empty() ? fmt::format("{} {}", kind, index) : fmt::format("{} {}", kind, name);
}

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

// One moment at which both scenes are evaluated.
struct Moment {
  int first_animation = -1;
  int second_animation = -1;
  int frame = -1;
  double time = 0;
};

// What was measured at one moment, merged in the order of moments.
struct Measured {
  Measure positions, normals, joint_positions, joint_orientations;
  bool finite = true;

  explicit Measured(const Tolerance& tolerance)
      : positions(tolerance.length),
        normals(tolerance.angle),
        joint_positions(tolerance.length),
        joint_orientations(tolerance.angle) {}
};

class Comparison {
 public:
  Comparison(const Scene& first, const Scene& second, const Tolerance& tolerance)
      : first_(first), second_(second), tolerance_(tolerance) {
    result_.positions = result_.joint_positions = result_.target_positions =
        Measure(tolerance.length);
    result_.normals = result_.joint_orientations = Measure(tolerance.angle);
    result_.target_normals = result_.texture_coordinates = result_.weights =
        Measure(tolerance.ratio);
  }

  Result<SceneDifference> run(int jobs, Progress& progress) {
    match_joint_lists();
    match_meshes();
    if (auto chosen = choose_moments(); !chosen) return chosen.error();
    if (auto done = compare_moments(jobs, progress); !done) return done.error();
    return std::move(result_);
  }

 private:
  void say(std::string sentence) { result_.structure.push_back(std::move(sentence)); }

  void match_joint_lists();
  void match_meshes();
  // Whether the vertices of the two can be compared one by one.
  bool compare_shape(int first_index, int second_index);
  void compare_targets(const SceneMesh& a, const SceneMesh& b, const std::string& name,
                       Place place);
  void compare_weights(const SceneMesh& a, const SceneMesh& b, const std::string& name,
                       Place place);
  Status choose_moments();
  Status add_moments(int first_animation, int second_animation);
  Status compare_moments(int jobs, Progress& progress);
  void compare_moment(const Moment& moment, const SceneState& a, const SceneState& b,
                      Measured& measured) const;

  const Scene& first_;
  const Scene& second_;
  const Tolerance& tolerance_;
  SceneDifference result_;
  std::vector<int> second_joint_of_first_;  // empty: joints are not compared
  std::vector<int> first_joint_of_second_;
  Pairs meshes_;  // those whose vertices can be compared
  std::vector<Moment> moments_;
};

void Comparison::match_joint_lists() {
  if (first_.joint_names.empty() && second_.joint_names.empty()) return;
  if (first_.joint_names.empty() || second_.joint_names.empty()) {
    const bool first_has = second_.joint_names.empty();
    std::string text = fmt::format(
        "only the {} has joints ({}), so joints are not compared", first_has ? "first" : "second",
        first_has ? first_.joint_names.size() : second_.joint_names.size());
    // Without meshes there is nothing else that could be the same.
    const bool meshes = !first_.meshes.empty() && !second_.meshes.empty();
    (meshes ? result_.notes : result_.structure).push_back(std::move(text));
    return;
  }
  SkeletonMatch joints = match_joints(first_.joint_names, first_.joint_parents, second_.joint_names,
                                      second_.joint_parents);
  if (!joints.difference.empty()) {
    say("skeletons differ: " + joints.difference);
    return;
  }
  second_joint_of_first_ = std::move(joints.second_of_first);
  first_joint_of_second_.resize(second_joint_of_first_.size());
  for (std::size_t i = 0; i < second_joint_of_first_.size(); ++i) {
    first_joint_of_second_[static_cast<std::size_t>(second_joint_of_first_[i])] =
        static_cast<int>(i);
  }
}

void Comparison::match_meshes() {
  if (first_.meshes.size() != second_.meshes.size()) {
    say(fmt::format("{} in the first, {} in the second",
                    counted(first_.meshes.size(), "mesh", "meshes"), second_.meshes.size()));
  }
  for (const auto& [i, j] : match(first_.meshes, second_.meshes)) {
    if (compare_shape(i, j)) meshes_.emplace_back(i, j);
  }
}

bool Comparison::compare_shape(int first_index, int second_index) {
  const SceneMesh& a = first_.meshes[static_cast<std::size_t>(first_index)];
  const SceneMesh& b = second_.meshes[static_cast<std::size_t>(second_index)];
  const std::string name = label("mesh", a.name, first_index);
  const Place place{.mesh = first_index};
  if (a.vertex_count != b.vertex_count) {
    say(fmt::format("{}: {} vertices in the first, {} in the second", name, a.vertex_count,
                    b.vertex_count));
    return false;
  }
  if (std::string text = difference_in_triangles(a.triangles, b.triangles); !text.empty()) {
    say(fmt::format("{}: {}", name, text));
  }
  const auto only = [&](const char* what, bool first_has, bool second_has) {
    if (first_has == second_has) return;
    say(fmt::format("{}: only the {} has {}", name, first_has ? "first" : "second", what));
  };
  only("normals", a.has_normals, b.has_normals);
  only("texture coordinates", !a.texture_coordinates.empty(), !b.texture_coordinates.empty());
  if (!a.texture_coordinates.empty() && !b.texture_coordinates.empty()) {
    add_coordinate_differences(a.texture_coordinates, b.texture_coordinates, place,
                               result_.texture_coordinates);
  }
  compare_targets(a, b, name, place);
  compare_weights(a, b, name, place);
  return true;
}

void Comparison::compare_targets(const SceneMesh& a, const SceneMesh& b, const std::string& name,
                                 Place place) {
  if (a.targets.size() != b.targets.size()) {
    std::string text = fmt::format("{}: {} morph targets in the first, {} in the second", name,
                                   a.targets.size(), b.targets.size());
    // One with a skin against one with targets is a rig against its baked motion.
    const bool baked = a.targets.empty() || b.targets.empty();
    const bool skinned = a.influences.per_vertex > 0 || b.influences.per_vertex > 0;
    (baked && skinned ? result_.notes : result_.structure).push_back(std::move(text));
    return;
  }
  const std::vector<Vec3f> none(a.targets.empty() ? 0 : a.vertex_count, Vec3f::Zero());
  const auto or_none = [&](std::span<const Vec3f> values) {
    return values.empty() ? std::span<const Vec3f>(none) : values;
  };
  for (const auto& [i, j] : match(a.targets, b.targets)) {
    const SceneMesh::Target& target = a.targets[static_cast<std::size_t>(i)];
    const SceneMesh::Target& other = b.targets[static_cast<std::size_t>(j)];
    place.target = i;
    add_distances(or_none(target.positions), or_none(other.positions), place,
                  result_.target_positions);
    if (target.normals.empty() && other.normals.empty()) continue;
    add_distances(or_none(target.normals), or_none(other.normals), place, result_.target_normals);
  }
}

void Comparison::compare_weights(const SceneMesh& a, const SceneMesh& b, const std::string& name,
                                 Place place) {
  const bool first_has = a.influences.per_vertex > 0;
  const bool second_has = b.influences.per_vertex > 0;
  if (first_has && second_has) {
    if (second_joint_of_first_.empty()) return;
    add_weight_differences(a.influences, b.influences, first_joint_of_second_, place,
                           result_.weights);
  } else if (first_has || second_has) {
    result_.notes.push_back(
        fmt::format("{}: only the {} has a skin", name, first_has ? "first" : "second"));
  }
}

Status Comparison::choose_moments() {
  if (first_.animations.size() != second_.animations.size()) {
    say(fmt::format("{} in the first, {} in the second",
                    counted(first_.animations.size(), "animation", "animations"),
                    second_.animations.size()));
  }
  for (const auto& [i, j] : match(first_.animations, second_.animations)) {
    if (auto added = add_moments(i, j); !added) return added;
  }
  if (moments_.empty()) moments_.push_back({});
  return {};
}

Status Comparison::add_moments(int first_animation, int second_animation) {
  const Scene::Animation& a = first_.animations[static_cast<std::size_t>(first_animation)];
  const Scene::Animation& b = second_.animations[static_cast<std::size_t>(second_animation)];
  const std::string name = label("animation", a.name, first_animation);
  if (a.key_times.empty() || b.key_times.empty()) {
    if (a.key_times.empty() != b.key_times.empty()) {
      say(fmt::format("{}: only the {} has keys", name, a.key_times.empty() ? "second" : "first"));
    }
    return {};
  }
  if (a.key_times.size() + b.key_times.size() + moments_.size() > kMostMoments) {
    return Error("compare-too-long", fmt::format("{} has more than a million key times", name));
  }
  if (std::abs(a.key_times.back() - b.key_times.back()) > kSameMoment ||
      std::abs(a.key_times.front() - b.key_times.front()) > kSameMoment) {
    say(
        fmt::format("{}: {} s to {} s in the first, {} s to {} s in the second; compared where "
                    "both have it",
                    name, readable(a.key_times.front()), readable(a.key_times.back()),
                    readable(b.key_times.front()), readable(b.key_times.back())));
  }

  std::vector<double> times = a.key_times;
  times.insert(times.end(), b.key_times.begin(), b.key_times.end());
  std::sort(times.begin(), times.end());
  const double begin = std::max(a.key_times.front(), b.key_times.front()) - kSameMoment;
  const double end = std::min(a.key_times.back(), b.key_times.back()) + kSameMoment;
  int frame = 0;
  std::optional<double> last;
  for (const double time : times) {
    if (time < begin || time > end || (last && time - *last <= kSameMoment)) continue;
    moments_.push_back({first_animation, second_animation, frame++, time});
    last = time;
  }
  const auto frames = static_cast<std::size_t>(frame);
  if (frames > a.key_times.size() || frames > b.key_times.size()) {
    result_.notes.push_back(
        fmt::format("{}: {} key times in the first, {} in the second; compared at the {} of both",
                    name, a.key_times.size(), b.key_times.size(), frames));
  }
  return {};
}

void Comparison::compare_moment(const Moment& moment, const SceneState& a, const SceneState& b,
                                Measured& measured) const {
  Place place{.animation = first_.animations.size() > 1 ? moment.first_animation : -1,
              .frame = moment.frame,
              .time = moment.time};
  const auto finite = [](const std::vector<Vec3>& values) {
    return std::all_of(values.begin(), values.end(), [](const Vec3& v) { return v.allFinite(); });
  };
  for (const auto& [i, j] : meshes_) {
    const auto first = static_cast<std::size_t>(i);
    const auto second = static_cast<std::size_t>(j);
    place.mesh = i;
    measured.finite = measured.finite && finite(a.positions[first]) && finite(b.positions[second]);
    add_distances(std::span(a.positions[first]), b.positions[second], place, measured.positions);
    if (!a.normals[first].empty() && !b.normals[second].empty()) {
      add_angles(std::span(a.normals[first]), b.normals[second], place, measured.normals);
    }
  }
  place.mesh = -1;
  for (std::size_t i = 0; i < second_joint_of_first_.size(); ++i) {
    place.joint = static_cast<int>(i);
    const Transform& joint = a.joints[i];
    const Transform& other = b.joints[static_cast<std::size_t>(second_joint_of_first_[i])];
    measured.finite = measured.finite && joint.position.allFinite() && other.position.allFinite();
    measured.joint_positions.add((joint.position - other.position).norm(), place);
    measured.joint_orientations.add(angle_between(joint.orientation, other.orientation), place);
  }
}

Status Comparison::compare_moments(int jobs, Progress& progress) {
  progress.begin("comparing", moments_.size());
  // So many moments are measured before they are merged that memory stays bounded.
  constexpr std::size_t kBatch = 4096;
  for (std::size_t start = 0; start < moments_.size(); start += kBatch) {
    const std::size_t count = std::min(kBatch, moments_.size() - start);
    std::vector<Measured> measured(count, Measured(tolerance_));
    parallel_for(count, 4, jobs, [&](std::size_t begin, std::size_t end) {
      SceneState a, b;
      for (std::size_t k = begin; k < end; ++k) {
        const Moment& moment = moments_[start + k];
        first_.evaluate(moment.first_animation, moment.time, a);
        second_.evaluate(moment.second_animation, moment.time, b);
        compare_moment(moment, a, b, measured[k]);
      }
      progress.advance(end - begin);
    });
    for (const Measured& one : measured) {
      if (!one.finite) {
        return Error("compare-value", "a scene gives positions that are not finite numbers",
                     "its nodes or keys hold values that are too large");
      }
      result_.positions.merge(one.positions);
      result_.normals.merge(one.normals);
      result_.joint_positions.merge(one.joint_positions);
      result_.joint_orientations.merge(one.joint_orientations);
    }
  }
  progress.end();
  result_.compared_times = static_cast<int>(moments_.size());
  return {};
}

}  // namespace

bool SceneDifference::same() const {
  return structure.empty() && positions.within() && normals.within() && joint_positions.within() &&
         joint_orientations.within() && target_positions.within() && target_normals.within() &&
         texture_coordinates.within() && weights.within();
}

Result<SceneDifference> difference(const Scene& first, const Scene& second,
                                   const Tolerance& tolerance, int jobs, Progress& progress) {
  return Comparison(first, second, tolerance).run(jobs, progress);
}

}  // namespace krok::compare
