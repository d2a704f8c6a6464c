#include "nodes/animation_choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"

namespace krok::nodes {

std::string animation_name(const Scene& scene, std::size_t index) {
  const std::string& name = scene.animations[index].name;
  return name.empty() ? fmt::format("animation {}", index) : to_utf8(name);
}

std::string animation_list(const Scene& scene) {
  constexpr std::size_t kMaxListed = 20;
  std::string list;
  for (std::size_t i = 0; i < scene.animations.size() && i < kMaxListed; ++i) {
    list += fmt::format("{}{} ({})", i == 0 ? "" : ", ", i, shown(animation_name(scene, i)));
  }
  return list + (scene.animations.size() > kMaxListed ? ", ...; krok-info lists all" : "");
}

Result<int> find_animation(const Scene& scene, const std::string& wanted, const std::string& file) {
  const std::size_t count = scene.animations.size();
  if (count == 0) {
    return Error("clip-name",
                 fmt::format("the file has no animations: --clip {} cannot be used", shown(wanted)))
        .in_file(file);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (animation_name(scene, i) == wanted) return static_cast<int>(i);
  }
  // Blender names an action with its armature: "Armature|Walk".
  int named = -1, of_that_name = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!animation_name(scene, i).ends_with("|" + wanted)) continue;
    named = static_cast<int>(i);
    ++of_that_name;
  }
  if (of_that_name == 1) return named;
  const auto number = parse_integer(wanted);
  if (number && *number >= 0 && *number < static_cast<long long>(count)) {
    return static_cast<int>(*number);
  }
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i) names.push_back(animation_name(scene, i));
  const std::string near = nearest_name(wanted, names);
  return Error("clip-name", fmt::format("there is no animation {}", shown(wanted)),
               (near.empty() ? "" : "did you mean '" + shown(near) + "'? ") +
                   "available: " + animation_list(scene))
      .in_file(file);
}

Diagnostics describe_choice(const Scene& scene, const ChosenAnimation& chosen, const char* code,
                            const char* hint, const std::string& file) {
  if (scene.animations.size() < 2) return {};
  const std::string name = shown(animation_name(scene, static_cast<std::size_t>(chosen.animation)));
  return {make_warning(code,
                       fmt::format("using {} of {} animations, {}; available: {}", name,
                                   scene.animations.size(), chosen.why, animation_list(scene)),
                       hint, file)};
}

ChosenAnimation best_animation(
    const Scene& scene, const char* what,
    const std::function<std::size_t(const Animation& animation)>& count) {
  std::vector<std::size_t> counts;
  for (const Animation& animation : scene.animations) counts.push_back(count(animation));
  ChosenAnimation best;
  best.moving =
      static_cast<std::size_t>(std::ranges::count_if(counts, [](auto n) { return n > 0; }));
  // Alternative clips of a character move about the same joints; another object's clip hardly any.
  const std::size_t enough = counts.empty() ? 0 : (*std::ranges::max_element(counts) + 1) / 2;
  const auto first = std::ranges::find_if(counts, [&](auto n) { return n >= enough; });
  if (first != counts.end()) {
    best.animation = static_cast<int>(first - counts.begin());
    best.count = *first;
  }
  const std::string most = counted(static_cast<long long>(best.count), what);
  best.why =
      scene.animations.size() == 1 ? "the only one"
      : best.moving == 0           ? fmt::format("the first, since none moves a {}", what)
      : best.moving == 1
          ? fmt::format("the only one that moves a {}: {}", what, most)
          : fmt::format(
                "the first of {} that move any to move at least half as many {}s as the most: {}",
                best.moving, what, most);
  return best;
}

ChosenAnimation best_animation(const Scene& scene) {
  const ChosenAnimation best = best_animation(scene, "node", [&](const Animation& animation) {
    return std::ranges::count(moved_nodes(scene, animation), 1);
  });
  return best.count > 0 ? best : best_animation(scene, "morph target", target_count);
}

ChosenAnimation best_animation(const Scene& scene, std::span<const int> joints) {
  return best_animation(scene, "joint", [&](const Animation& animation) {
    return moved_count(scene, animation, joints);
  });
}

Result<int> choose_animation(const Scene& scene, const std::string& wanted, const std::string& file,
                             Diagnostics& diagnostics) {
  if (!wanted.empty()) return find_animation(scene, wanted, file);
  if (scene.animations.empty()) return -1;
  const ChosenAnimation chosen = best_animation(scene);
  diagnostics = describe_choice(scene, chosen, "clip-choice",
                                "select another with --clip NAME or NUMBER", file);
  return chosen.animation;
}

bool changes(const Channel& channel) {
  const auto width = at(channel.width);
  const bool spline = channel.interpolation == Interpolation::cubic_spline;
  const std::size_t each = width * (spline ? 3 : 1);
  const float* const first = channel.values->data() + (spline ? width : 0);
  const std::size_t keys = each > 0 ? channel.values->size() / each : 0;
  for (std::size_t k = 1; k < keys; ++k) {
    const auto size = static_cast<Eigen::Index>(width);
    const Eigen::Map<const Eigen::ArrayXf> a(first, size), b(first + k * each, size);
    // A quaternion and its negative are one rotation.
    const float sign = channel.path == Path::rotation && (a * b).sum() < 0 ? -1.0f : 1.0f;
    const float size_of_key = std::max(a.abs().maxCoeff(), b.abs().maxCoeff());
    const float rounding = channel.path == Path::translation ? 1e-6f + 1e-5f * size_of_key : 1e-4f;
    if ((b - sign * a).abs().maxCoeff() > rounding) return true;
  }
  return false;
}

int animated_targets(const Animation& animation) {
  int targets = 0;
  for (const Channel& channel : animation.channels) {
    if (channel.path == Path::weights) targets += channel.width;
  }
  return targets;
}

std::vector<char> moved_nodes(const Scene& scene, const Animation& animation) {
  std::vector<char> moved(scene.nodes.size(), 0);
  for (const Channel& channel : animation.channels) {
    char& node = moved[at(channel.node)];
    if (channel.path != Path::weights && node == 0 && changes(channel)) node = 1;
  }
  return moved;
}

std::size_t moved_count(const Scene& scene, const Animation& animation,
                        std::span<const int> nodes) {
  std::vector<char> moved = moved_nodes(scene, animation);
  std::size_t count = 0, above = 0;
  for (const int node : nodes) count += node >= 0 && moved[at(node)] != 0 ? 1 : 0;
  for (int node : nodes) {
    for (; count == 0 && node >= 0; node = scene.nodes[at(node)].parent) {
      above += moved[at(node)] != 0 ? 1 : 0;
      moved[at(node)] = 0;
    }
  }
  return count > 0 ? count : above;
}

std::size_t camera_count(const Scene& scene, const Animation& animation, int node) {
  const auto of = [](const std::vector<Channel>& channels, int target) {
    return static_cast<std::size_t>(std::ranges::count_if(channels, [&](const Channel& channel) {
      return channel.node == target && channel.path != Path::weights && changes(channel);
    }));
  };
  std::size_t count = of(animation.lenses, scene.nodes[at(node)].camera);
  for (; node >= 0; node = scene.nodes[at(node)].parent) count += of(animation.channels, node);
  return count;
}

std::size_t target_count(const Animation& animation) {
  std::size_t count = 0;
  for (const Channel& channel : animation.channels) {
    if (channel.path == Path::weights && changes(channel)) count += at(channel.width);
  }
  return count;
}

}  // namespace krok::nodes
