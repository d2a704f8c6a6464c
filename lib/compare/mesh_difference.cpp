#include "compare/mesh_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

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

}  // namespace krok::compare
