#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "compare/scene_comparison_internal.h"
#include "core/index.h"
#include "core/numbers.h"

// Nodes without a mesh, extras and variants.

namespace krok::compare {

namespace {

using Properties = std::vector<MaterialParameter>;

constexpr std::size_t kMaxNamed = 5;

// The largest differences of a place over all moments.
struct PlaceDifference {
  double way = 0, angle = 0, scale = 0;  // metres, radians, ratio
  double time = 0;                       // of the first moment with one of them
};

// Places that only one has, unless they are joints or have a mesh in the other. Cameras and lights
// count; other nodes do where they are found by name, if neither file is baked.
void report_missing_places(SceneComparison& comparison, const Scene& own, const Scene& other,
                           const std::vector<int>& missing, const char* which) {
  const Matching matching = comparison.options.matching;
  const bool by_name = (matching == Matching::automatic || matching == Matching::name) &&
                       own.joint_names.empty() == other.joint_names.empty();
  std::vector<std::string> counted_ones, others;
  for (const int place : missing) {
    const std::string& name = own.places[at(place)].name;
    const auto& parameters = own.places[at(place)].parameters;
    const auto has_node = [&](const SceneMesh& mesh) { return mesh.node_name == name; };
    if (!name.empty() && (std::ranges::find(other.joint_names, name) != other.joint_names.end() ||
                          std::ranges::any_of(other.meshes, has_node))) {
      continue;
    }
    const char* const kind = parameters.empty()                         ? "node"
                             : parameters[0].name.starts_with("camera") ? "camera"
                                                                        : "light";
    (by_name || !parameters.empty() ? counted_ones : others).push_back(label(kind, name, place));
  }
  for (auto* const names : {&counted_ones, &others}) {
    if (names->empty()) continue;
    const auto count = names->size();
    if (count > kMaxNamed) names->resize(kMaxNamed);
    std::string text = fmt::format("only in the {}: {}", which, fmt::join(*names, ", "));
    if (count > kMaxNamed) text += fmt::format(" and {} more", count - kMaxNamed);
    comparison.report(std::move(text), names == &counted_ones);
  }
}

Pairs match_places(SceneComparison& comparison) {
  const auto first = names_of(comparison.first.places), second = names_of(comparison.second.places);
  const auto all_named = [](const std::vector<std::string>& names) {
    return std::ranges::find(names, std::string()) == names.end();
  };
  const bool by_order =
      first.size() == second.size() && comparison.options.matching == Matching::order;
  const bool by_name = !by_order && all_named(first) && all_named(second);
  const ListMatch match = match_lists(first, second, by_name ? Matching::name : Matching::order);
  report_missing_places(comparison, comparison.first, comparison.second, match.only_first, "first");
  report_missing_places(comparison, comparison.second, comparison.first, match.only_second,
                        "second");
  return match.pairs;
}

PlaceDifference between(const Mat4& first, const Mat4& second) {
  PlaceDifference found;
  found.way = (first - second).topRightCorner<3, 1>().norm();
  Mat3 turns[2];
  Vec3 scales[2];
  for (int k = 0; k < 2; ++k) {
    const Mat3 linear = (k == 0 ? first : second).topLeftCorner<3, 3>();
    scales[k] = linear.colwise().norm();
    turns[k] = linear * scales[k].cwiseMax(1e-12).cwiseInverse().asDiagonal();
  }
  found.scale = (scales[0] - scales[1]).cwiseAbs().maxCoeff() / std::max(1.0, scales[0].maxCoeff());
  found.angle =
      std::atan2(0.5 * (turns[0] * turns[1].transpose() - turns[1] * turns[0].transpose()).norm() /
                     std::sqrt(2.0),
                 0.5 * ((turns[0] * turns[1].transpose()).trace() - 1));
  return found;
}

void compare_motion(SceneComparison& comparison, const Pairs& pairs) {
  const Tolerance& tolerance = comparison.options.tolerance;
  std::vector<PlaceDifference> all(pairs.size());
  SceneState a, b;
  a.joints_alone = b.joints_alone = true;
  for (const Moment& moment : comparison.moments) {
    if (pairs.empty()) break;
    comparison.first.evaluate(moment.first_animation, moment.first_time, a);
    comparison.second.evaluate(moment.second_animation, moment.second_time, b);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const PlaceDifference now =
          between(a.places[at(pairs[k].first)], b.places[at(pairs[k].second)]);
      PlaceDifference& largest = all[k];
      if (now.way > largest.way || (largest.way == 0 && now.angle > largest.angle)) {
        largest.time = moment.first_time;
      }
      largest.way = std::max(largest.way, now.way);
      largest.angle = std::max(largest.angle, now.angle);
      largest.scale = std::max(largest.scale, now.scale);
    }
  }
  std::size_t over = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const PlaceDifference& largest = all[k];
    std::string text;
    const auto add = [&](double value, double limit, std::string words) {
      if (!(value <= limit)) text += (text.empty() ? "" : ", ") + std::move(words);
    };
    add(largest.way, tolerance.of_joint_positions(),
        fmt::format("{} mm off", readable(1000 * largest.way, 3)));
    add(largest.angle, tolerance.of_joint_orientations(),
        fmt::format("turned by {} deg", readable(largest.angle / kRadiansPerDegree, 3)));
    add(largest.scale, tolerance.ratio, fmt::format("scale {} apart", readable(largest.scale, 3)));
    if (text.empty() || ++over > kMaxNamed) continue;
    const int place = pairs[k].first;
    comparison.say(fmt::format("{}: {}, at {} s",
                               label("node", comparison.first.places[at(place)].name, place), text,
                               readable(largest.time, 4)));
  }
  if (over > kMaxNamed) comparison.say(fmt::format("{} more nodes are off", over - kMaxNamed));
}

// Values that both have count; of those that only one has, all but those of nodes and meshes, which
// programs leave out as they like.
void compare_properties(SceneComparison& comparison) {
  const auto find = [](const Properties& in, const MaterialParameter& one) {
    const auto found = std::ranges::find(in, one.name, &MaterialParameter::name);
    return found == in.end() ? nullptr : &*found;
  };
  const auto missing = [&](const Properties& own, const Properties& other, const char* which) {
    std::string counts, notes;
    for (const MaterialParameter& one : own) {
      if (find(other, one) != nullptr) continue;
      std::string& list =
          one.name.starts_with("node ") || one.name.starts_with("mesh ") ? notes : counts;
      list += (list.empty() ? "" : "; ") + one.name;
    }
    if (!counts.empty()) comparison.say(fmt::format("only the {} has: {}", which, counts));
    if (!notes.empty()) comparison.note(fmt::format("only the {} has: {}", which, notes));
  };
  const Properties &first = comparison.first.properties, &second = comparison.second.properties;
  for (const MaterialParameter& one : first) {
    const MaterialParameter* const other = find(second, one);
    if (other == nullptr) continue;
    for (std::string& text :
         differences(std::span(&one, 1), std::span(other, 1), comparison.options.tolerance.ratio)) {
      comparison.say(std::move(text));
    }
  }
  missing(first, second, "first");
  missing(second, first, "second");
}

}  // namespace

void compare_places(SceneComparison& comparison) {
  const Scene &first = comparison.first, &second = comparison.second;
  if (!first.knows_nodes || !second.knows_nodes) return;
  const Pairs pairs = match_places(comparison);
  for (const auto& [i, j] : pairs) {
    const Scene::Place &one = first.places[at(i)], &other = second.places[at(j)];
    report_name(comparison, "node", one.name, other.name, false);
    for (const std::string& text :
         differences(one.parameters, other.parameters, comparison.options.tolerance.ratio)) {
      comparison.say(fmt::format("{}: {}", label("node", one.name, i), text));
    }
  }
  compare_motion(comparison, pairs);
  compare_properties(comparison);
}

}  // namespace krok::compare
