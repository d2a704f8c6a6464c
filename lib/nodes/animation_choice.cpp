#include "nodes/animation_choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/nearest_name.h"
#include "core/numbers.h"
#include "core/text.h"
#include "nodes/moving.h"

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
  return list + (scene.animations.size() > kMaxListed ? ", ..." : "");
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
  return Error("clip-name", fmt::format("there is no animation {}", shown(wanted)),
               "available: " + animation_list(scene))
      .in_file(file);
}

Diagnostics describe_choice(const Scene& scene, const ChosenAnimation& chosen, const char* code,
                            const char* hint, const std::string& file) {
  if (scene.animations.size() < 2) return {};
  const std::string name = shown(animation_name(scene, static_cast<std::size_t>(chosen.animation)));
  Diagnostic warning =
      make_warning(code,
                   fmt::format("using {} of {} animations, {}; available: {}", name,
                               scene.animations.size(), chosen.why, animation_list(scene)),
                   hint);
  warning.where.file = file;
  return {std::move(warning)};
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

}  // namespace krok::nodes
