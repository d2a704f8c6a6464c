#include "tools/shared/animation_choice.h"

#include <fmt/format.h>

#include "core/nearest_name.h"
#include "core/numbers.h"
#include "core/text.h"

namespace krok::cli {

std::string animation_name(const nodes::Scene& scene, std::size_t index) {
  const std::string& name = scene.animations[index].name;
  return name.empty() ? fmt::format("animation {}", index) : to_utf8(name);
}

std::string animation_list(const nodes::Scene& scene) {
  constexpr std::size_t kMaxListed = 20;
  std::string list;
  for (std::size_t i = 0; i < scene.animations.size() && i < kMaxListed; ++i) {
    list += fmt::format("{}{} ({})", i == 0 ? "" : ", ", i, shown(animation_name(scene, i)));
  }
  return list + (scene.animations.size() > kMaxListed ? ", ..." : "");
}

Result<int> find_animation(const nodes::Scene& scene, const std::string& wanted,
                           const std::string& file) {
  const std::size_t count = scene.animations.size();
  if (count == 0) {
    return Error("clip-name",
                 fmt::format("the file has no animations: --clip {} cannot be used", shown(wanted)))
        .in_file(file);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (animation_name(scene, i) == wanted) return static_cast<int>(i);
  }
  const auto number = parse_integer(wanted);
  if (number && *number >= 0 && *number < static_cast<long long>(count)) {
    return static_cast<int>(*number);
  }
  return Error("clip-name", fmt::format("there is no animation {}", shown(wanted)),
               "available: " + animation_list(scene))
      .in_file(file);
}

Result<int> choose_animation(const nodes::Scene& scene, const std::string& wanted,
                             const std::string& file, ToolContext& context) {
  if (!wanted.empty()) return find_animation(scene, wanted, file);
  if (scene.animations.empty()) return -1;
  if (scene.animations.size() > 1) {
    Diagnostic warning =
        make_warning("clip-first",
                     fmt::format("the first of {} animations is used, {}; available: {}",
                                 scene.animations.size(), shown(animation_name(scene, 0)),
                                 animation_list(scene)),
                     "select another with --clip NAME or NUMBER");
    warning.where.file = file;
    context.diagnose(std::move(warning));
  }
  return 0;
}

}  // namespace krok::cli
