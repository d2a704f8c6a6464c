#include "character/scene_motion.h"

#include <fmt/format.h>

#include "capture/rest_frame.h"
#include "character/space.h"
#include "core/index.h"
#include "core/numbers.h"

namespace krok::character {

Result<Rig> find_rig(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                     const std::string& skin, Diagnostics& diagnostics) {
  auto joints = choose_joints(scene, evaluator, skin, diagnostics);
  if (!joints) return joints.error();
  return make_rig(scene, evaluator, *std::move(joints), diagnostics);
}

Result<Conventions> scene_conventions(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                                      const Rig* rig, const RoleMap& roles, int animation,
                                      const GivenConventions& given) {
  constexpr int kMaxSamples = 200;
  std::vector<Vec3> samples;
  if (rig != nullptr && animation >= 0) {
    Diagnostics reported_elsewhere;
    const auto sampling = choose_sampling(scene.animations[at(animation)], {}, reported_elsewhere);
    if (!sampling) return sampling.error();
    samples = sample_positions(evaluator, *rig, animation, sampling->sampling, kMaxSamples);
  }
  return find_conventions(scene.space, rig, roles, samples, given);
}

Result<ScenePlace> place_scene(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                               const Rig* rig, const RoleMap& roles, int animation,
                               const CaptureOptions& how, const std::string& path,
                               Diagnostics& diagnostics) {
  const auto conventions = scene_conventions(scene, evaluator, rig, roles, animation, how);
  if (!conventions) return conventions.error();
  const auto conversion = Conversion::make(*conventions);
  if (!conversion) return conversion.error();
  GivenConventions said = how;  // from the user or the file
  if (scene.space.metres) said.unit = conventions->unit;
  if (scene.space.up_is_y) said.up = conventions->up;
  if (scene.space.file_to_krok) {
    said.up = conventions->up;
    said.forward = conventions->forward;
  }
  report_conventions(*conventions, said, "scene", path, diagnostics);
  if (rig != nullptr) {
    const auto skeleton = skeleton_in_krok(*rig, *conversion);
    if (!skeleton) return skeleton.error();
    if (said.unit) check_size(*skeleton, roles, diagnostics);
    if (said.complete()) check_actor(*skeleton, roles, diagnostics);
  }
  return ScenePlace{*conventions, *conversion, describe_conversions(*conventions, how)};
}

Result<Clip> make_motion(const nodes::Evaluator& evaluator, const Rig& rig, const RoleMap& roles,
                         const ScenePlace& place, int animation, const ChosenSampling& sampling,
                         int jobs, Progress* progress, Diagnostics& diagnostics,
                         Stretches* stretches) {
  auto clip = make_clip(evaluator, rig, place.conversion, animation, sampling.sampling, jobs,
                        progress, diagnostics, stretches);
  if (!clip) return clip;
  if (const RestPose rest = find_rest_pose(*clip, roles); rest.first_frame_is_rest) {
    diagnostics.push_back(make_warning("import-rest-frame", rest.reason + "; it was kept",
                                       "drop it with krok-edit --from 1f"));
  }
  clip->provenance.conversions = place.conversions;
  clip->provenance.conversions.push_back(
      fmt::format("keys sampled at {} frames per second from {} s on",
                  readable(1 / sampling.sampling.step), readable(sampling.keys_from)));
  return clip;
}

}  // namespace krok::character
