#include "tools/shared/camera_choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/numbers.h"
#include "core/text.h"

namespace krok::cli {

namespace {

constexpr std::size_t kMaxListed = 20;

const nodes::Node& node_of(const nodes::Scene& scene, int node) {
  return scene.nodes[static_cast<std::size_t>(node)];
}

const std::string& lens_name(const nodes::Scene& scene, const nodes::Node& node) {
  return scene.cameras[static_cast<std::size_t>(node.camera)].name;
}

std::string list_of(const nodes::Scene& scene, std::span<const int> cameras) {
  std::string list;
  for (std::size_t i = 0; i < std::min(cameras.size(), kMaxListed); ++i) {
    const nodes::Node& node = node_of(scene, cameras[i]);
    list += fmt::format("{}{} ({})", i == 0 ? "" : ", ", i,
                        shown(node.name.empty() ? lens_name(scene, node) : node.name));
  }
  return list;
}

}  // namespace

Result<int> choose_camera(const nodes::Scene& scene, std::span<const int> cameras,
                          const std::string& wanted, const std::string& path,
                          ToolContext& context) {
  if (wanted.empty()) {
    if (cameras.size() == 1) return cameras[0];
    context.diagnose_in(path, {make_warning("import-cameras",
                                            fmt::format("using the first of {} cameras: {}",
                                                        cameras.size(), list_of(scene, cameras)),
                                            "select another with --camera NAME or NUMBER")});
    return cameras[0];
  }
  for (const int camera : cameras) {
    const nodes::Node& node = node_of(scene, camera);
    if (node.name == wanted || lens_name(scene, node) == wanted) return camera;
  }
  const auto number = parse_integer(wanted);
  if (number && *number >= 0 && *number < static_cast<long long>(cameras.size())) {
    return cameras[static_cast<std::size_t>(*number)];
  }
  return Error("import-camera", fmt::format("there is no camera {}", shown(wanted)),
               "available: " + list_of(scene, cameras));
}

}  // namespace krok::cli
