#include "tools/krok-walk/node_way.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "core/text.h"
#include "formats/io/open_scene.h"
#include "nodes/evaluate.h"

namespace krok::cli::walk {

namespace {

constexpr double kRate = 60;           // places per second
constexpr double kMaxPlaces = 1e6;     // of a node
constexpr double kMinTravel = 0.05;    // metres from the first place
constexpr double kStrideWindow = 1.1;  // seconds, see gait::way_of()

// The places of all nodes: a clip of joints without parents.
Clip places_of(const nodes::Scene& scene, const nodes::Evaluator& evaluator) {
  Clip clip;
  for (const nodes::Node& node : scene.nodes) {
    clip.skeleton.add(node.name, Skeleton::kNoParent, {});
  }
  const std::vector<double> times = evaluator.key_times(0);
  const double length = times.empty() ? 0 : times.back() - times.front();
  clip.rate = std::min(kRate, kMaxPlaces / std::max(length * double(scene.nodes.size()), 1e-9));
  clip.resize(static_cast<int>(std::floor(length * clip.rate)) + 2);
  nodes::Evaluation state;
  for (int f = 0; f < clip.frame_count(); ++f) {
    const double time = times.empty() ? 0 : std::min(times.front() + f / clip.rate, times.back());
    evaluator.place_nodes(0, time, state);
    for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
      clip.frame_positions(f)[n] = state.node_to_world[n].block<3, 1>(0, 3).cast<float>();
    }
  }
  return clip;
}

bool goes_anywhere(const Clip& clip, int node) {
  const Vec3f from = clip.frame_positions(0)[at(node)];
  for (int f = 1; f < clip.frame_count(); ++f) {
    const Vec3f way = clip.frame_positions(f)[at(node)] - from;
    if (std::hypot(way.x(), way.z()) > kMinTravel) return true;
  }
  return false;
}

}  // namespace

Result<std::vector<gait::PathPoint>> way_of_node(const InputFile& file, const std::string& name,
                                                 io::Inputs& inputs) {
  auto scene = io::open_scene(file, inputs);
  if (!scene) return std::move(scene).error();
  const auto fail = [&](std::string message, const char* hint) {
    return Error("path-node", std::move(message), hint).in_file(file.path());
  };
  if (scene->animations.empty()) {
    return fail("nothing is animated, so that no node has a way",
                "animate the node that goes ahead");
  }
  const auto evaluator = nodes::Evaluator::create(*scene);
  if (!evaluator) return Error(evaluator.error()).in_file(file.path());
  const Clip clip = places_of(*scene, *evaluator);
  int found = -1;
  for (int node = 0; node < clip.joint_count() && found < 0; ++node) {
    const bool named = clip.skeleton.names[at(node)] == name;
    if (name.empty() ? goes_anywhere(clip, node) : named) found = node;
  }
  if (found < 0 && !name.empty()) {
    return fail(fmt::format("no node is called '{}'", shown(name)), "krok-info lists the nodes");
  }
  if (found < 0 || !goes_anywhere(clip, found)) {
    return fail(
        found < 0 ? "no node goes anywhere" : fmt::format("'{}' stays where it is", shown(name)),
        "name an animated node with --path-id");
  }
  const bool sways = std::ranges::any_of(scene->skins, [&](const nodes::Skin& skin) {
    return std::ranges::find(skin.joints, found) != skin.joints.end();
  });
  return gait::way_of(clip, found, sways ? kStrideWindow : 0);
}

}  // namespace krok::cli::walk
