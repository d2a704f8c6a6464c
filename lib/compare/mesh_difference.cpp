#include "compare/mesh_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/matching.h"
#include "compare/model_difference.h"
#include "math/quaternion.h"

namespace krok::compare {

namespace {

// The same triangle, rotated to start with its smallest index.
Triangle from_smallest(const Triangle& t) {
  const auto smallest = static_cast<std::size_t>(std::min_element(t.begin(), t.end()) - t.begin());
  return {t[smallest], t[(smallest + 1) % 3], t[(smallest + 2) % 3]};
}

std::vector<Triangle> sorted(std::span<const Triangle> triangles) {
  std::vector<Triangle> list(triangles.size());
  std::transform(triangles.begin(), triangles.end(), list.begin(), from_smallest);
  std::sort(list.begin(), list.end());
  return list;
}

std::string text_of(const Triangle& t) {
  return fmt::format("({}, {}, {})", t[0], t[1], t[2]);
}

double weight_of(const Influences& influences, std::span<const int> joint_map, std::size_t vertex,
                 int joint) {
  double sum = 0;
  const auto per_vertex = static_cast<std::size_t>(influences.per_vertex);
  for (std::size_t k = vertex * per_vertex; k < (vertex + 1) * per_vertex; ++k) {
    const int found = influences.joints[k];
    const int mapped = joint_map.empty() ? found : joint_map[static_cast<std::size_t>(found)];
    if (mapped == joint) sum += static_cast<double>(influences.weights[k]);
  }
  return sum;
}

template <typename Vector>
void add_distances_of(std::span<const Vector> first, std::span<const Vector> second,
                      ValueLocation place, Measure& measure) {
  for (std::size_t i = 0; i < first.size(); ++i) {
    place.vertex = static_cast<int>(i);
    const Vec3 apart = first[i].template cast<double>() - second[i].template cast<double>();
    measure.add(apart.norm(), place);
  }
}

template <typename Vector>
void add_angles_of(std::span<const Vector> first, std::span<const Vector> second,
                   ValueLocation place, Measure& measure) {
  for (std::size_t i = 0; i < first.size(); ++i) {
    place.vertex = static_cast<int>(i);
    measure.add(angle_between_directions(first[i].template cast<double>(),
                                         second[i].template cast<double>()),
                place);
  }
}

// The largest difference of the channels of each.
template <typename Vector>
void add_channels_of(std::span<const Vector> first, std::span<const Vector> second,
                     ValueLocation place, Measure& measure) {
  for (std::size_t i = 0; i < first.size(); ++i) {
    place.vertex = static_cast<int>(i);
    const auto apart = first[i].template cast<double>() - second[i].template cast<double>();
    measure.add(apart.cwiseAbs().maxCoeff(), place);
  }
}

}  // namespace

std::vector<Triangle> reversed(std::span<const Triangle> triangles) {
  std::vector<Triangle> list(triangles.begin(), triangles.end());
  for (Triangle& t : list) std::swap(t[1], t[2]);
  return list;
}

std::string difference_in_triangles(std::span<const Triangle> first,
                                    std::span<const Triangle> second) {
  if (first.size() != second.size()) {
    return fmt::format("{} triangles in the first, {} in the second", first.size(), second.size());
  }
  if (std::equal(first.begin(), first.end(), second.begin())) return {};
  std::size_t i = 0;
  while (i < first.size() && from_smallest(first[i]) == from_smallest(second[i])) ++i;
  if (i == first.size() || sorted(first) == sorted(second)) return {};
  return fmt::format("triangle {} is {} in the first and {} in the second", i, text_of(first[i]),
                     text_of(second[i]));
}

void add_weight_differences(const Influences& first, const Influences& second,
                            std::span<const int> first_of_second, ValueLocation place,
                            Measure& measure) {
  const auto per_first = static_cast<std::size_t>(first.per_vertex);
  const auto per_second = static_cast<std::size_t>(second.per_vertex);
  const std::size_t vertices = per_first == 0 ? 0 : first.weights.size() / per_first;
  for (std::size_t v = 0; v < vertices; ++v) {
    double largest = 0;
    place.vertex = static_cast<int>(v);
    place.joint = -1;
    const auto look_at = [&](int joint) {
      const double apart =
          std::abs(weight_of(first, {}, v, joint) - weight_of(second, first_of_second, v, joint));
      if (apart > largest) {
        largest = apart;
        place.joint = joint;
      }
    };
    for (std::size_t k = 0; k < per_first; ++k) look_at(first.joints[v * per_first + k]);
    for (std::size_t k = 0; k < per_second; ++k) {
      look_at(first_of_second[second.joints[v * per_second + k]]);
    }
    measure.add(largest, place);
  }
}

void add_distances(std::span<const Vec3> first, std::span<const Vec3> second, ValueLocation place,
                   Measure& measure) {
  add_distances_of(first, second, place, measure);
}

void add_distances(std::span<const Vec3f> first, std::span<const Vec3f> second, ValueLocation place,
                   Measure& measure) {
  add_distances_of(first, second, place, measure);
}

void add_angles(std::span<const Vec3> first, std::span<const Vec3> second, ValueLocation place,
                Measure& measure) {
  add_angles_of(first, second, place, measure);
}

void add_angles(std::span<const Vec3f> first, std::span<const Vec3f> second, ValueLocation place,
                Measure& measure) {
  add_angles_of(first, second, place, measure);
}

void add_coordinate_differences(std::span<const Vec2f> first, std::span<const Vec2f> second,
                                ValueLocation place, Measure& measure) {
  add_channels_of(first, second, place, measure);
}

void add_colour_differences(std::span<const Vec4f> first, std::span<const Vec4f> second,
                            ValueLocation place, Measure& measure) {
  add_channels_of(first, second, place, measure);
}

bool on_other_sides(const Vec4& first, const Vec4& second) {
  const auto has_side = [](const Vec4& tangent) {
    return std::abs(tangent.w()) >= 0.5 && !tangent.head<3>().isZero(0);
  };
  return (first.w() < 0) != (second.w() < 0) && has_side(first) && has_side(second);
}

namespace {

void say_only_in(const char* which, const MorphSet& morphs, const std::vector<int>& targets,
                 MorphDifference& result) {
  for (const int target : targets) {
    result.structure.push_back(fmt::format("target {} is only in the {}",
                                           morphs.names[static_cast<std::size_t>(target)], which));
  }
}

}  // namespace

Result<MorphDifference> difference(const MorphSet& first, const MorphSet& second,
                                   const Tolerance& tolerance, Matching matching) {
  for (const MorphSet* morphs : {&first, &second}) {
    if (auto ok = check(*morphs); !ok) {
      Error error = ok.error();
      error.message = fmt::format("the {} morph targets: {}", morphs == &first ? "first" : "second",
                                  error.message);
      return error;
    }
  }
  MorphDifference result;
  result.positions = Measure(tolerance.length);
  result.normals = Measure(tolerance.of_normals());
  if (first.vertex_count != second.vertex_count) {
    result.structure.push_back(fmt::format("{} vertices in the first, {} in the second",
                                           first.vertex_count, second.vertex_count));
    return result;
  }
  if (first.normals.empty() != second.normals.empty()) {
    result.structure.push_back(
        fmt::format("only the {} has normals", first.normals.empty() ? "second" : "first"));
  }
  if (matching != Matching::order) matching = Matching::name;
  const ListMatch match = match_lists(first.names, second.names, matching);
  say_only_in("first", first, match.only_first, result);
  say_only_in("second", second, match.only_second, result);
  for (const auto& [i, j] : match.pairs) {
    const ValueLocation place{.target = i};
    add_distances(first.target_positions(i), second.target_positions(j), place, result.positions);
    if (first.normals.empty() || second.normals.empty()) continue;
    add_angles(first.target_normals(i), second.target_normals(j), place, result.normals);
  }
  result.compared_targets = static_cast<int>(match.pairs.size());
  return result;
}

namespace {

std::string shown_cuts(const CameraTrack& camera) {
  constexpr std::size_t kShown = 5;
  const auto& cuts = camera.cuts;
  if (cuts.empty()) return "none";
  const auto last = cuts.begin() + static_cast<std::ptrdiff_t>(std::min(cuts.size(), kShown));
  return fmt::format("{}{}", fmt::join(cuts.begin(), last, ", "), last == cuts.end() ? "" : " ...");
}

}  // namespace

Result<CameraDifference> difference(const CameraTrack& first, const CameraTrack& second,
                                    const Tolerance& tolerance) {
  for (const CameraTrack* camera : {&first, &second}) {
    if (auto ok = check(*camera); !ok) {
      Error error = ok.error();
      error.message =
          fmt::format("the {} camera: {}", camera == &first ? "first" : "second", error.message);
      return error;
    }
  }
  CameraDifference result;
  result.positions = Measure(tolerance.length);
  result.orientations = result.fields_of_view = Measure(tolerance.angle);

  FrameMatch frames =
      match_frames(first.frame_count(), first.rate, second.frame_count(), second.rate);
  result.structure = std::move(frames.differences);
  result.compared_frames = static_cast<int>(frames.frames.size());
  if (result.structure.empty() && first.cuts != second.cuts) {
    result.structure.push_back(fmt::format("cuts at frames {} in the first, {} in the second",
                                           shown_cuts(first), shown_cuts(second)));
  }
  for (const auto& [frame_a, frame_b] : frames.frames) {
    const auto i = static_cast<std::size_t>(frame_a);
    const auto j = static_cast<std::size_t>(frame_b);
    const ValueLocation place{.frame = frame_a, .time = frame_a / first.rate};
    const Vec3 apart = first.positions[i].cast<double>() - second.positions[j].cast<double>();
    result.positions.add(apart.norm(), place);
    result.orientations.add(
        angle_between(first.orientations[i].cast<double>(), second.orientations[j].cast<double>()),
        place);
    result.fields_of_view.add(std::abs(static_cast<double>(first.fields_of_view[i]) -
                                       static_cast<double>(second.fields_of_view[j])),
                              place);
  }
  return result;
}

}  // namespace krok::compare
