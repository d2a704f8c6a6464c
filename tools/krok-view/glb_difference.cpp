#include "tools/krok-view/glb_difference.h"

#include <memory>
#include <utility>

#include "compare/scene_difference.h"
#include "formats/gltf/gltf_reader.h"
#include "nodes/scene_of.h"

namespace krok::cli::view {

namespace {

// The file with the animation alone that it plays first.
Result<Scene> scene_of_glb(const Files::Glb& glb) {
  auto read = gltf::read(glb.bytes);
  if (!read) return std::move(read).error().in_file(glb.path);
  auto made = scene_of(std::make_shared<const nodes::Scene>(*std::move(read)));
  if (!made) return std::move(made).error().in_file(glb.path);
  if (made->animations.empty()) return made;
  const int shown = glb.animation;
  const Scene::Animation animation = made->animations[static_cast<std::size_t>(shown)];
  made->animations.assign(1, animation);
  made->evaluate = [inner = std::move(made->evaluate), shown](int chosen, double time,
                                                              SceneState& state) {
    inner(chosen < 0 ? chosen : shown, time, state);
  };
  made->place = nullptr;  // which way triangles face does not count here
  return made;
}

}  // namespace

Result<std::optional<draw::ViewedDifference>> difference_of(const Files::Glb& other,
                                                            const Files::Glb& file,
                                                            ToolContext& context) {
  const auto first = scene_of_glb(other);
  if (!first) return first.error();
  const auto second = scene_of_glb(file);
  if (!second) return second.error();
  const auto found = compare::difference(*first, *second, {}, context.jobs, *context.progress);
  if (!found) return std::optional<draw::ViewedDifference>();  // the page measures by itself
  draw::ViewedDifference difference{file.animation, other.animation, {}, {}, 0, 0};
  const bool moving = !first->animations.empty() && !second->animations.empty();
  for (const compare::MomentDifference& moment : found->moments) {
    if (moment.positions.mesh < 0 || (moment.animation < 0) == moving) continue;
    const float distance = moment.positions.largest;
    difference.times.push_back(moment.time);
    difference.distances.push_back(distance);
    if (distance <= difference.distance) continue;
    difference.distance = distance;
    difference.time = moment.time;
  }
  std::optional<draw::ViewedDifference> result;
  if (!difference.times.empty()) result = std::move(difference);
  return result;
}

}  // namespace krok::cli::view
