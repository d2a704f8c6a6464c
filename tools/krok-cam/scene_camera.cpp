#include "tools/krok-cam/scene_camera.h"

#include <fmt/format.h>

#include "character/motion.h"
#include "character/sampling.h"
#include "core/text.h"
#include "formats/io/open_scene.h"
#include "nodes/animation_choice.h"
#include "nodes/evaluate.h"
#include "nodes/moving.h"
#include "tools/shared/camera_choice.h"

namespace krok::cli::cam {

namespace {

// The animation that moves the camera most; -1 if none does.
int find_animation(const nodes::Scene& scene, int camera, Diagnostics& found) {
  const nodes::ChosenAnimation best =
      best_animation(scene, "camera channel", [&](const nodes::Animation& animation) {
        return nodes::camera_count(scene, animation, camera);
      });
  if (best.count == 0) return -1;
  if (best.moving > 1) {
    const std::string name = animation_name(scene, static_cast<std::size_t>(best.animation));
    found.push_back(make_warning("cam-animations",
                                 fmt::format("using {}, {}", shown(name), best.why),
                                 "krok-import --cam selects another with --clip"));
  }
  return best.animation;
}

}  // namespace

Result<CameraTrack> read_scene_camera(const InputFile& file, const std::string& wanted,
                                      std::optional<double> rate, ToolContext& context) {
  const auto scene = io::open_scene(file, context);
  if (!scene) return scene.error();
  Diagnostics found = scene->diagnostics;
  const auto evaluator = nodes::Evaluator::create(*scene);
  if (!evaluator) return Error(evaluator.error()).in_file(file.path());
  const std::vector<int> cameras = character::camera_nodes(*scene, *evaluator);
  if (cameras.empty()) {
    return Error("cam-missing", "the scene has no camera",
                 "in glTF a camera must be attached to a node of the scene")
        .in_file(file.path());
  }
  const auto camera = choose_camera(*scene, cameras, wanted, file.path(), context);
  if (!camera) return Error(camera.error()).in_file(file.path());
  const int animation = find_animation(*scene, *camera, found);
  character::Sampling sampling;
  if (animation >= 0) {
    character::SamplingOptions how;
    how.rate = rate;
    const auto chosen = character::choose_sampling(
        scene->animations[static_cast<std::size_t>(animation)], how, found);
    if (!chosen) return Error(chosen.error()).in_file(file.path());
    sampling = chosen->sampling;
  }
  // glTF uses the same units and axes as Krok.
  auto track = character::make_camera(*scene, *evaluator, *camera, Conversion(), Mat4::Identity(),
                                      animation, sampling, found);
  if (!track) return Error(track.error()).in_file(file.path());
  context.diagnose_in(file.path(), found);
  return track;
}

}  // namespace krok::cli::cam
