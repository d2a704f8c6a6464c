#include <fmt/format.h>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/anim/anim.h"
#include "formats/cam/cam.h"
#include "formats/csv/csv_writer.h"
#include "formats/model/model_format.h"
#include "formats/morph_exr/morph_exr.h"
#include "nodes/moving.h"
#include "tools/cli/output_kind.h"
#include "tools/krok-import/character_files.h"
#include "tools/krok-import/facts.h"
#include "tools/krok-import/scene_importer.h"

// Outputs of a scene import: the actor, its motions, a camera.

namespace krok::cli::import {

using registry::Kind;

namespace {

int animated_targets(const nodes::Animation& animation) {
  int targets = 0;
  for (const nodes::Channel& channel : animation.channels) {
    if (channel.path == nodes::Path::weights) targets += channel.width;
  }
  return targets;
}

Json to_json(const ChosenClip& clip) {
  return {{"name", clip.name}, {"number", clip.animation}, {"reason", clip.why}};
}

}  // namespace

Status SceneImporter::add_actor() {
  if (!wants_model() && !wants_character() && !wants_morphs()) return {};
  Diagnostics found;
  auto actor = character::make_actor(scene_, evaluator_, *rig_, place_.conversion,
                                     {.with_morphs = wants_morphs() || wants_character()}, found);
  if (!actor) return actor.error();
  context_.diagnose_in(path_, found);
  actor_ = std::move(*actor);
  if (wants_character() && actor_.model.triangles.empty()) {
    return missing(scene_.meshes.empty() ? "mesh" : "mesh with triangles", "--character",
                   "use --model for the skeleton alone");
  }
  if (Status status = add_model(); !status) return status;
  if (wants_character()) {
    if (Status status = add_whole_character(); !status) return status;
  }
  return wants_morphs() ? add_morphs() : Status();
}

Status SceneImporter::add_model() {
  if (!wants_model()) return {};
  Model& model = actor_.model;
  model.provenance = context_.provenance();
  model.provenance.conversions = place_.conversions;
  report_model();
  return outputs_.add(options_.model, [&](OutputFile& file) {
    return model::write(model, {.orientation = options_.orientation}, file);
  });
}

void SceneImporter::report_model() {
  const Model& model = actor_.model;
  result_["model"] = {{"vertices", model.vertex_count()},
                      {"triangles", model.triangles.size()},
                      {"parts", model.parts.size()},
                      {"joints", model.skeleton.joint_count()}};
  line_ = fmt::format("{}: {}, {}, {}", base_name(path_),
                      counted(model.skeleton.joint_count(), "joint"),
                      counted(model.vertex_count(), "vertex", "vertices"),
                      counted(static_cast<long long>(model.triangles.size()), "triangle"));
}

Status SceneImporter::add_whole_character() {
  CharacterFiles files{options_.character, options_.orientation, {}, context_.provenance()};
  files.provenance.conversions = place_.conversions;
  if (!actor_.morphs.names.empty()) {
    auto weights = character::make_weights(actor_, evaluator_, -1, {});
    if (!weights) return weights.error();
    files.weights = std::move(weights->values);
  }
  const auto added = add_character(files, scene_, actor_, outputs_, textures_);
  if (!added) return added.error();
  report_model();
  result_["character"] = {{"materials", added->materials},
                          {"textures", added->images},
                          {"expressions", added->character.expressions.size()},
                          {"eyes", added->character.eyes.size()}};
  line_ += fmt::format(", {}, {}", counted(static_cast<long long>(added->materials), "material"),
                       counted(static_cast<long long>(added->images), "texture"));
  return {};
}

Status SceneImporter::add_morphs() {
  MorphSet& morphs = actor_.morphs;
  const char* option = options_.morphs.empty() ? "--morph-weights" : "--morphs";
  if (morphs.names.empty()) return missing("morph target", option, "");
  result_["morph_targets"] = morphs.names;
  morphs.provenance = context_.provenance();
  morphs.provenance.conversions = place_.conversions;
  if (line_.empty()) {
    line_ = fmt::format("{}: {} of {}", base_name(path_),
                        counted(morphs.target_count(), "morph target"),
                        counted(morphs.vertex_count, "vertex", "vertices"));
  }
  return outputs_.add(options_.morphs,
                      [&](OutputFile& file) { return morph_exr::write(morphs, file); });
}

Status SceneImporter::add_weights(const ChosenClip& clip,
                                  const character::ChosenSampling& sampling) {
  if (options_.weights.empty()) return {};
  const auto weights =
      character::make_weights(actor_, evaluator_, clip.animation, sampling.sampling);
  if (!weights) return weights.error();
  const auto path = clip_path(options_.weights, "--morph-weights", clip, clips_.size() > 1, ".csv");
  if (!path) return path.error();
  return outputs_.add(*path, [&](OutputFile& file) { return csv::write(*weights, file); });
}

Status SceneImporter::add_clips() {
  if (clips_.empty()) {  // a static camera
    const character::ChosenSampling still;
    if (Status status = add_weights({}, still); !status) return status;
    return wants_camera() ? add_camera({}, still) : Status();
  }
  if (!wants_motion() && !wants_camera() && options_.weights.empty()) return {};
  for (const ChosenClip& clip : clips_) {
    if (Status status = add_clip(clip); !status) return status;
  }
  return {};
}

Status SceneImporter::add_clip(const ChosenClip& chosen) {
  Diagnostics found;
  character::SamplingOptions wanted;
  wanted.source_rate = how_.rate;
  if (options_.resample > 0) wanted.rate = options_.resample;
  const auto& animation = scene_.animations[static_cast<std::size_t>(chosen.animation)];
  const auto sampling = character::choose_sampling(animation, wanted, found);
  if (!sampling) return sampling.error();
  Json facts = Json::object();
  facts["clip"] = to_json(chosen);
  if (wants_motion()) {
    if (nodes::moved_count(scene_, animation, rig_->joints.nodes) == 0) {
      warn("import-still",
           fmt::format("{} does not move any joint of the skeleton", shown(chosen.name)));
    }
    if (const int targets = animated_targets(animation); targets > 0 && options_.weights.empty()) {
      warn("import-weights",
           fmt::format("{} moves {}: not written", shown(chosen.name),
                       counted(targets, "morph target")),
           "write their weights with --morph-weights OUT.csv");
    }
    Stretches stretches;
    auto clip =
        character::make_motion(evaluator_, *rig_, roles_, place_, chosen.animation, *sampling,
                               context_.jobs, context_.progress, found, &stretches);
    if (!clip) return clip.error();
    context_.diagnose_in(path_, std::exchange(found, {}));
    auto conversions = std::move(clip->provenance.conversions);
    clip->provenance = context_.provenance();
    clip->provenance.conversions = std::move(conversions);
    const auto path = clip_path(context_.output, "-o", chosen, clips_.size() > 1, ".anim");
    if (!path) return path.error();
    if (Status status = check_output_kind(*path, "-o", Kind::anim); !status) return status;
    const Status status = outputs_.add(*path, [&](OutputFile& file) {
      return anim::write(
          *clip,
          {.orientation = options_.orientation, .stretches = stretches, .jobs = context_.jobs},
          file);
    });
    if (!status) return status;
    if (!stretches.empty()) {
      facts["largest_stretch"] = largest_stretch(stretches, clip->joint_count()).size;
    }
    const FrameSource frames = frames_of(*clip);
    facts.update(facts_of(frames, roles_));
    facts["output"] = *path;
    line_ = line_about(path_, frames, roles_);
  }
  context_.diagnose_in(path_, found);
  facts["source_rate"] = to_json(sampling->rate);
  facts["keys"] = {{"start", sampling->keys_from}, {"end", sampling->keys_to}};
  clip_facts_.push_back(std::move(facts));
  if (Status status = add_weights(chosen, *sampling); !status) return status;
  return wants_camera() ? add_camera(chosen, *sampling) : Status();
}

Status SceneImporter::add_camera(const ChosenClip& clip,
                                 const character::ChosenSampling& sampling) {
  Diagnostics found;
  auto track = character::make_camera(
      scene_, evaluator_, camera_, place_.conversion, character::rotation_to_apply(scene_.space),
      (camera_clip_ ? *camera_clip_ : clip).animation, sampling.sampling, found);
  if (!track) return track.error();
  context_.diagnose_in(path_, found);
  track->provenance = context_.provenance();
  track->provenance.conversions = place_.conversions;
  const auto path = clip_path(options_.cam, "--cam", clip, clips_.size() > 1, ".cam");
  if (!path) return path.error();
  if (Status status = check_output_kind(*path, "--cam", Kind::cam); !status) return status;
  result_["camera"] = {
      {"name", scene_.nodes[static_cast<std::size_t>(camera_)].name},
      {"frames", track->frame_count()},
      {"rate", track->rate},
      {"field_of_view", static_cast<double>(track->fields_of_view.front()) / kRadiansPerDegree}};
  if (camera_clip_) result_["camera"]["clip"] = to_json(*camera_clip_);
  if (line_.empty()) {
    line_ = fmt::format("{}: camera {}, {} at {} fps", base_name(path_),
                        shown(scene_.nodes[static_cast<std::size_t>(camera_)].name),
                        counted(track->frame_count(), "frame"), readable(track->rate));
  }
  return outputs_.add(*path, [&](OutputFile& file) {
    return cam::write(*track, {.orientation = options_.orientation}, file);
  });
}

}  // namespace krok::cli::import
