#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "capture/unique_names.h"
#include "character/mesh.h"
#include "character/motion.h"
#include "core/file.h"
#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/anim/anim.h"
#include "formats/cam/cam.h"
#include "formats/character/character_format.h"
#include "formats/container/packed_orientation.h"
#include "formats/csv/csv_writer.h"
#include "formats/material/material_format.h"
#include "formats/model/model_format.h"
#include "formats/morph_exr/morph_exr.h"
#include "nodes/animation_choice.h"
#include "nodes/scene.h"
#include "roles/roles.h"
#include "scene/character.h"
#include "scene/encoded_image.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/output_set.h"
#include "tools/cli/paths.h"
#include "tools/krok-import/facts.h"
#include "tools/krok-import/repeats.h"
#include "tools/krok-import/scene_importer.h"

// Outputs of a scene import: the actor, its motions, a camera.

namespace krok::cli::import {

namespace {

// Input of --save-character hero.character, which writes hero.model, hero.material with its images
// in hero_textures/, hero_morphs.exr, and hero.character, which refers to them. Files without
// content are not written.
struct CharacterFiles {
  std::string path;  // of the .character file
  OrientationEncoding orientation = OrientationEncoding::xyz;
  std::vector<float> weights;  // [targets] of the actor, at rest
  Provenance provenance;       // of model and morph targets
};

// Summary for the report.
struct AddedCharacter {
  Character character;
  std::size_t materials = 0, images = 0;
  std::set<std::string> extensions;  // of the materials, left out
};

// Creates file names for images in their own folder.
class ImageNames {
 public:
  // The image's name, or `fallback` ("Skin_normal") if it has none, with the extension of its kind.
  // Always valid on common file systems and unique, ignoring case.
  std::string make(const EncodedImage& image, ImageKind kind, const std::string& fallback);

 private:
  std::set<std::string> taken_;  // in lower case
};

// Removes the extension of an image file.
std::string without_ending(const std::string& name) {
  const std::string ending = extension(name);
  for (const char* known :
       {".png", ".jpg", ".jpeg", ".jpe", ".tga", ".bmp", ".tif", ".dds", ".webp", ".ktx2"}) {
    if (ending == known) return name.substr(0, name.size() - ending.size());
  }
  return name;
}

std::string ImageNames::make(const EncodedImage& image, ImageKind kind,
                             const std::string& fallback) {
  std::string path = image.path.empty() ? image.name : image.path;
  std::replace(path.begin(), path.end(), '\\', '/');
  std::string stem = without_ending(to_utf8(base_name(path)));
  std::replace(stem.begin(), stem.end(), ' ', '_');
  if (stem.empty()) stem = fallback;
  stem = file_name_of(stem);
  while (stem.ends_with('.')) stem.pop_back();
  if (stem.empty()) stem = "picture";
  std::string name = stem;
  for (int number = 2; !taken_.insert(ascii_lower(name)).second; ++number) {
    name = stem + "_" + std::to_string(number);
  }
  return name + std::string(extension_of(kind));
}

// For images without a name, in the order of textures_of().
constexpr std::array<const char*, 5> kTextureNames = {"color", "surface", "normal", "occlusion",
                                                      "emissive"};

// A valid name made from `name`, see is_name.
std::string usable_name(const std::string& name, const std::string& fallback) {
  std::string text = name.substr(0, name.find('\0'));
  if (text.size() > kLongestName) text = to_utf8(text.substr(0, kLongestName / 2));
  return is_name(text) ? text : fallback;
}

class Adder {
 public:
  Adder(const CharacterFiles& files, const nodes::Scene& scene, character::SceneActor& actor,
        OutputSet& outputs, NewFolders& folder)
      : files_(files), scene_(scene), actor_(actor), outputs_(outputs), new_folders_(folder) {
    const std::string end = extension(files.path);
    stem_ = files.path.substr(0, files.path.size() - end.size());
    name_ = base_name(stem_);
  }

  Result<AddedCharacter> add() {
    name_parts();
    // The model first: if its folder is missing, this fails before the image folder is created.
    for (const auto step :
         {&Adder::add_model, &Adder::add_materials, &Adder::add_morphs, &Adder::add_character}) {
      if (Status status = (this->*step)(); !status) return status.error();
    }
    return std::move(added_);
  }

 private:
  // Gives each part a unique name, so that the character can assign it a material.
  void name_parts() {
    std::vector<Model::Part>& parts = actor_.model.parts;
    UniqueNames names;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      parts[p].name = names.make(usable_name(parts[p].name, "part"));
      const int material = actor_.part_materials[p];
      parts[p].material =
          material < 0 ? "" : scene_.materials[static_cast<std::size_t>(material)].name;
      added_.character.parts.push_back({parts[p].name, parts[p].material});
    }
  }

  Status add_text(const std::string& path, const Result<std::string>& text) {
    if (!text) return Error(text.error()).in_file(path);
    return outputs_.add(path, *text);
  }

  Status add_materials() {
    std::vector<Material> used;
    for (const Material& material : scene_.materials) {
      const auto has = [&](const Model::Part& part) { return part.material == material.name; };
      if (std::ranges::any_of(actor_.model.parts, has)) used.push_back(material);
    }
    if (used.empty()) return {};
    for (Material& material : used) {
      const auto textures = textures_of(material);
      for (std::size_t t = 0; t < textures.size(); ++t) {
        if (!*textures[t]) continue;
        if (Status status = add_image(material.name + "_" + kTextureNames[t], *textures[t]);
            !status) {
          return status;
        }
      }
    }
    for (const Material& material : used) {
      for (const MaterialExtension& one : material.extensions) {
        added_.extensions.insert(shown(one.name));
      }
    }
    added_.materials = used.size();
    added_.images = images_.size();
    added_.character.materials = {name_ + ".material"};
    return add_text(stem_ + ".material", material::write(used));
  }

  Status add_image(const std::string& fallback, Texture& texture) {
    const auto [place, added] = images_.try_emplace(texture.image.get());
    if (added) {
      const EncodedImage& image = *texture.image;
      const auto facts = image_info(image.bytes);
      if (!facts) return facts.error();
      const std::string file = image_names_.make(image, facts->kind, fallback);
      if (Status status = new_folders_.make(stem_ + "_textures"); !status) return status;
      const Status status = outputs_.add(stem_ + "_textures/" + file, image.bytes);
      if (!status) return status;
      place->second =
          std::make_shared<const EncodedImage>(EncodedImage{{}, name_ + "_textures/" + file, {}});
    }
    texture.image = place->second;
    return {};
  }

  Status add_model() {
    added_.character.model = name_ + ".model";
    actor_.model.provenance = files_.provenance;
    return outputs_.add(stem_ + ".model", [&](OutputFile& file) {
      return model::write(actor_.model, {.orientation = files_.orientation}, file);
    });
  }

  Status add_morphs() {
    MorphSet& morphs = actor_.morphs;
    if (morphs.names.empty()) return {};
    added_.character.morphs = name_ + "_morphs.exr";
    morphs.provenance = files_.provenance;
    for (std::size_t t = 0; t < morphs.names.size(); ++t) {
      const float weight = t < files_.weights.size() ? files_.weights[t] : 0.0f;
      const float most = Character::kMaxWeight;
      added_.character.expressions.push_back(
          {morphs.names[t], {}, std::clamp(weight, -most, most)});
    }
    return outputs_.add(stem_ + "_morphs.exr",
                        [&](OutputFile& file) { return morph_exr::write(morphs, file); });
  }

  Status add_character() {
    added_.character.name = usable_name(to_utf8(name_), "");
    const Skeleton& skeleton = actor_.model.skeleton;
    const EyeJoints eyes = find_eyes(skeleton);
    for (const auto& [name, joint] : {std::pair{"left", eyes.left}, {"right", eyes.right}}) {
      if (joint < 0) continue;
      const auto j = static_cast<std::size_t>(joint);
      added_.character.eyes.push_back(
          {name, skeleton.names[j], skeleton.reference[j].position.cast<float>()});
    }
    return add_text(files_.path, character_file::write(added_.character));
  }

  const CharacterFiles& files_;
  const nodes::Scene& scene_;
  character::SceneActor& actor_;
  OutputSet& outputs_;
  NewFolders& new_folders_;
  std::string stem_, name_;  // of all files, with and without folder
  ImageNames image_names_;
  std::map<const EncodedImage*, std::shared_ptr<const EncodedImage>>
      images_;  // -> images with paths
  AddedCharacter added_;
};

// Adds the files to `outputs`; `folder` is for the images. Parts of the actor get unique names and
// the names of the scene's materials. Codes: those of the writers.
Result<AddedCharacter> add_character(const CharacterFiles& files, const nodes::Scene& scene,
                                     character::SceneActor& actor, OutputSet& outputs,
                                     NewFolders& folder) {
  return Adder(files, scene, actor, outputs, folder).add();
}

}  // namespace

using registry::Kind;

namespace {

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
    return missing(scene_.meshes.empty() ? "mesh" : "mesh with triangles", "--save-character",
                   "use --save-model for the skeleton alone");
  }
  if (wants_character() && scene_.skins.empty() && !find_roles(actor_.model.skeleton).humanoid) {
    context_.warn("import-no-skin",
                  fmt::format("no mesh is skinned: each moves with its node as a whole, and the "
                              "skeleton is {}",
                              counted(actor_.model.skeleton.joint_count(), "node")),
                  "export it with its armature and skin weights, if it has some");
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
                      counted(model.triangles.size(), "triangle"));
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
  if (!added->extensions.empty()) {
    warn("import-material",
         fmt::format("{} of the materials: not written: {}",
                     counted(std::ssize(added->extensions), "extension"),
                     fmt::join(added->extensions, ", ")),
         "they may look different; krok-skin with the file itself keeps them");
  }
  report_model();
  result_["character"] = {{"materials", added->materials},
                          {"textures", added->images},
                          {"expressions", added->character.expressions.size()},
                          {"eyes", added->character.eyes.size()}};
  line_ += fmt::format(", {}, {}", counted(added->materials, "material"),
                       counted(added->images, "texture"));
  return {};
}

Status SceneImporter::add_morphs() {
  MorphSet& morphs = actor_.morphs;
  const char* option = options_.morphs.empty() ? "--morph-weights" : "--save-morphs";
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
    const bool pose = animation.channels.empty();  // of a file without animations
    if (!pose && nodes::moved_count(scene_, animation, rig_->joints.nodes) == 0) {
      warn("import-still",
           fmt::format("{} does not move any joint of the skeleton", shown(chosen.name)));
    }
    if (const int targets = nodes::animated_targets(animation);
        targets > 0 && options_.weights.empty()) {
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
    if (const auto repeats = Repeats::in(*clip)) context_.diagnose_in(path_, {*repeats});
    report_sampling(chosen, animation, sampling->sampling, facts);
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

// What the motion loses between its frames.
void SceneImporter::report_sampling(const ChosenClip& chosen, const nodes::Animation& animation,
                                    const character::Sampling& sampling, Json& facts) {
  constexpr double kWanted = 1e-4;  // metres
  const auto error = character::sampling_error(evaluator_, *rig_, place_.conversion, animation,
                                               chosen.animation, sampling, kWanted, context_.jobs);
  if (error.joint >= 0) facts["sampling_error"] = error.largest;
  if (error.largest <= kWanted) return;
  context_.log(fmt::format(
      "{}: between frames joints are up to {} mm from the file's curves ({} at {} s){}",
      shown(chosen.name), readable(1e3 * error.largest, 3),
      shown(rig_->skeleton.names[at(error.joint)]), readable(error.time, 4),
      error.rate    ? fmt::format("; --rate {} keeps them within 0.1 mm", readable(*error.rate))
      : error.jumps ? "; keys that step become ramps of one frame"
                    : ""));
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
  const auto path = clip_path(options_.cam, "--save-cam", clip, clips_.size() > 1, ".cam");
  if (!path) return path.error();
  if (Status status = check_output_kind(*path, "--save-cam", Kind::cam); !status) return status;
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
