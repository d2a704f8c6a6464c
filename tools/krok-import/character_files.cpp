#include "tools/krok-import/character_files.h"

#include <algorithm>
#include <array>
#include <map>

#include "capture/unique_names.h"
#include "core/path_inside.h"
#include "core/text.h"
#include "formats/character/character_format.h"
#include "formats/material/material_format.h"
#include "formats/model/model_format.h"
#include "formats/morph_exr/morph_exr.h"
#include "roles/eyes.h"
#include "tools/krok-import/image_names.h"

namespace krok::cli::import {

namespace {

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
    return outputs_.add(path, [&](OutputFile& file) { return file.write(*text); });
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
      const Status status = outputs_.add(stem_ + "_textures/" + file, [&](OutputFile& output) {
        return output.write(image.bytes);
      });
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

}  // namespace

Result<AddedCharacter> add_character(const CharacterFiles& files, const nodes::Scene& scene,
                                     character::SceneActor& actor, OutputSet& outputs,
                                     NewFolders& folder) {
  return Adder(files, scene, actor, outputs, folder).add();
}

}  // namespace krok::cli::import
