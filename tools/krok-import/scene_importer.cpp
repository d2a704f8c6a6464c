#include "tools/krok-import/scene_importer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "nodes/animation_choice.h"
#include "tools/shared/camera_choice.h"
#include "tools/shared/role_report.h"

namespace krok::cli::import {

Result<int> SceneImporter::run() {
  for (auto step :
       {&SceneImporter::choose, &SceneImporter::find_rig, &SceneImporter::choose_animations,
        &SceneImporter::find_space, &SceneImporter::add_actor, &SceneImporter::add_clips}) {
    if (Status status = (this->*step)(); !status) return std::move(status.error()).in_file(path_);
  }
  report_what_else_is_there();
  const std::string written = outputs_.names();
  if (Status status = outputs_.finish(); !status) return status.error();
  textures_.keep();
  report();
  context_.log(fmt::format("{} -> {}", line_, written));
  if (rig_) log_roles(rig_->skeleton, roles_, context_);
  return kExitDone;
}

void SceneImporter::warn(const char* code, std::string message, std::string hint,
                         Severity severity) {
  Diagnostic diagnostic = make_warning(code, std::move(message), std::move(hint));
  diagnostic.severity = severity;
  context_.diagnose_in(path_, {diagnostic});
}

Error SceneImporter::missing(const std::string& what, const std::string& option, std::string hint) {
  return Error("import-missing",
               fmt::format("the file has no {}: {} cannot be written", what, option),
               std::move(hint));
}

Status SceneImporter::choose_camera() {
  if (cameras_.empty()) {
    return missing("camera", "--save-cam", "in glTF, a camera must be used by a node of the scene");
  }
  const auto chosen = krok::cli::choose_camera(scene_, cameras_, options_.camera, path_, context_);
  if (!chosen) return chosen.error();
  camera_ = *chosen;
  return {};
}

Status SceneImporter::choose() {
  cameras_ = character::camera_nodes(scene_, evaluator_);
  if (wants_camera()) {
    if (Status status = choose_camera(); !status) return status;
  }
  // In a batch, the motion of this particular file was not requested.
  const bool none = scene_.animations.empty();
  still_ = none && context_.one_of_many != nullptr &&
           (wants_model() || wants_character() || wants_camera() || wants_morphs());
  if (wants_motion() && none && (options_.clip.empty() || options_.clip == "all")) {
    return missing("animation", "-o",
                   "use --save-model without -o for the character, or --save-cam for a camera");
  }
  return {};
}

Status SceneImporter::choose_animations() {
  nodes::ChosenAnimation best, of_camera;
  if (wants_camera()) {
    of_camera = best_animation(scene_, "camera channel", [&](const auto& animation) {
      return nodes::camera_count(scene_, animation, camera_);
    });
  }
  if (rig_ && (wants_motion() || !(wants_camera() || wants_morphs()))) {
    best = best_animation(scene_, rig_->joints.nodes);
  } else {
    best = wants_camera() ? of_camera : best_animation(scene_, "morph target", nodes::target_count);
  }
  auto clips = choose_clips(scene_, options_.clip, best, path_, context_);
  if (!clips) return clips.error();
  clips_ = std::move(*clips);
  // Programs write an animation for each object, on one time axis.
  const bool still =
      clips_.size() == 1 && of_camera.count > 0 &&
      nodes::camera_count(scene_, scene_.animations[at(clips_[0].animation)], camera_) == 0;
  if (!still) return {};
  const std::string name = animation_name(scene_, at(of_camera.animation));
  if (options_.clip.empty()) camera_clip_ = {of_camera.animation, name, {}, of_camera.why};
  warn("import-camera-clip",
       fmt::format("{} does not move the camera; {} does{}", shown(clips_[0].name), shown(name),
                   camera_clip_ ? " and is used for it, over the time of the motion" : ""),
       camera_clip_ ? "--save-cam without -o writes it over its own time" : "");
  return {};
}

Status SceneImporter::find_rig() {
  const bool known = scene_.space.metres && scene_.space.file_to_krok;
  const bool needed = wants_motion() || wants_model() || wants_character() || wants_morphs();
  if (!needed && known) return {};
  Diagnostics found;
  auto rig = character::find_rig(scene_, evaluator_, options_.skin, found);
  if (!rig && !needed && rig.error().code != "scene-value") return {};  // a camera needs none
  if (!rig) return rig.error();
  rig_ = std::move(*rig);
  for (Diagnostic& one : found) {
    // A model is in its bind pose; the other one would be lost.
    if (one.code != "scene-pose" || !scene_.animations.empty() || wants_motion()) continue;
    one.severity = Severity::warning;
    one.hint = "-o POSE.anim writes the pose that the file shows as a motion of one frame";
  }
  if (needed) context_.diagnose_in(path_, found);
  auto roles = roles_of(rig_->skeleton, how_);
  if (!roles) return roles.error();
  roles_ = *std::move(roles);
  return {};
}

Status SceneImporter::find_space() {
  const int first = clips_.empty() ? -1 : clips_[0].animation;
  Diagnostics found;
  auto place = character::place_scene(scene_, evaluator_, rig_ ? &*rig_ : nullptr, roles_, first,
                                      how_, path_, found);
  context_.diagnose_in(path_, found);
  if (!place) return place.error();
  place_ = *std::move(place);
  return {};
}

// Lists contents of the file that were not requested.
void SceneImporter::report_what_else_is_there() {
  if (still_) warn("import-missing", "the file has no animations: no motion is written");
  std::vector<std::string> more;
  const auto has = [&](std::size_t count, const char* one, const char* option) {
    if (count > 0) {
      more.push_back(fmt::format("{} ({})", counted(count, one), option));
    }
  };
  std::size_t targets = 0, meshes = 0;
  for (const nodes::Mesh& mesh : scene_.meshes) targets += mesh.target_count();
  if (!wants_model() && !wants_character()) meshes = scene_.meshes.size();
  if (meshes > 0) more.push_back(meshes == 1 ? "a mesh (--save-model)" : "meshes (--save-model)");
  if (!wants_camera()) has(cameras_.size(), "camera", "--save-cam");
  if (!wants_morphs() && !wants_character()) has(targets, "morph target", "--save-morphs");
  if (more.empty()) return;
  warn("import-more", fmt::format("the file also has {}", fmt::join(more, ", ")), "",
       Severity::note);
}

void SceneImporter::report() {
  Json result = Json::object();
  // The facts of a single clip go where those of a capture do.
  if (clip_facts_.size() == 1) result.update(clip_facts_[0]);
  if (rig_) result.update(roles_json(rig_->skeleton, roles_));
  result.update(facts_of(place_.conventions));
  if (clip_facts_.size() > 1) result["clips"] = clip_facts_;
  result["animations"] = Json::array();
  for (const nodes::Animation& one : scene_.animations) result["animations"].push_back(one.name);
  result.update(result_);
  result["repairs"] = Json::array();
  context_.report.result = std::move(result);
}

}  // namespace krok::cli::import
