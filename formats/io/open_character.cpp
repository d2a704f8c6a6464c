#include "formats/io/open_character.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/index.h"
#include "core/numbers.h"
#include "core/path_inside.h"
#include "core/text.h"
#include "formats/character/character_format.h"
#include "formats/io/open_motion.h"
#include "formats/io/readers_internal.h"
#include "formats/material/material_format.h"
#include "formats/model/model_format.h"
#include "formats/morph_exr/morph_exr.h"
#include "skin/morph.h"

namespace krok::io {

namespace {

class Loader {
 public:
  Loader(const InputFile& input, Inputs& inputs)
      : path_(input.path()), text_(input.text()), inputs_(inputs) {}

  Result<LoadedCharacter> load() {
    auto character = character_file::read(text_);
    if (!character) return std::move(character.error()).in_file(path_);
    loaded_.character = *std::move(character);
    for (const auto part : {&Loader::load_model, &Loader::load_materials, &Loader::assign_materials,
                            &Loader::load_morphs, &Loader::check_joints, &Loader::load_roles}) {
      if (Status status = (this->*part)(); !status) return std::move(status.error()).in_file(path_);
    }
    loaded_.eyes = loaded_.character.eyes;
    loaded_.sockets = loaded_.character.sockets;
    return std::move(loaded_);
  }

 private:
  // Opens a file that `from` names.
  Result<InputFile> open(const std::string& from, const std::string& path) {
    auto inside = path_inside(folder_of(from), path);
    if (!inside) return std::move(inside.error()).in_file(from);
    return inputs_.open_input(*inside);
  }

  Status load_model() {
    const auto file = open(path_, loaded_.character.model);
    if (!file) {
      Error error = file.error();
      if (error.code == "file-missing") error.hint = fmt::format("{} names it", shown(path_));
      return error;
    }
    auto model = model::read(file->bytes());
    if (!model) return std::move(model.error()).in_file(file->path());
    loaded_.model = *std::move(model);
    return {};
  }

  Status load_materials() {
    for (const std::string& path : loaded_.character.materials) {
      const auto file = open(path_, path);
      if (!file) return file.error();
      auto materials = material::read(file->text());
      if (!materials) return std::move(materials.error()).in_file(file->path());
      for (Material& material : *materials) {
        if (find_material(loaded_.materials, material.name) != nullptr) {
          return Error(
              "character-material",
              fmt::format("two of its material files have a material '{}'", shown(material.name)));
        }
        loaded_.materials.push_back(std::move(material));
        files_.push_back(file->path());
      }
    }
    return {};
  }

  // Assigns materials to the model's parts and drops materials that no part uses.
  Status assign_materials() {
    Model& model = loaded_.model;
    std::vector<std::string> names, materials;
    for (const Model::Part& part : model.parts) names.push_back(part.name);
    for (const Material& material : loaded_.materials) materials.push_back(material.name);
    for (const Character::Part& given : loaded_.character.parts) {
      if (std::ranges::find(names, given.name) == names.end()) {
        return Error("character-part", fmt::format("the model has no part '{}'", shown(given.name)),
                     nearest_hint(given.name, names));
      }
      if (!given.material.empty() &&
          std::ranges::find(materials, given.material) == materials.end()) {
        return Error("character-material",
                     fmt::format("part '{}' has the material '{}', which is in none of its "
                                 "material files",
                                 shown(given.name), shown(given.material)),
                     nearest_hint(given.material, materials));
      }
      for (Model::Part& part : model.parts) {
        if (part.name == given.name) part.material = given.material;
      }
    }
    report_missing_materials();
    return load_images();
  }

  // For the model's own material names; a character without material files is valid.
  void report_missing_materials() {
    std::set<std::string> reported;
    for (const Model::Part& part : loaded_.model.parts) {
      if (loaded_.materials.empty() || part.material.empty()) continue;
      if (find_material(loaded_.materials, part.material) != nullptr) continue;
      if (!reported.insert(part.material).second) continue;
      Diagnostic warning = Error(
          "character-material",
          fmt::format("the material '{}' of part '{}' is in none of its material files; it is "
                      "light grey",
                      shown(part.material), shown(part.name)));
      warning.severity = Severity::warning;
      warning.where.file = path_;
      inputs_.diagnose(std::move(warning));
    }
  }

  Status load_images() {
    std::vector<Material> used;
    for (std::size_t m = 0; m < loaded_.materials.size();) {
      // Materials of one file share their images.
      const std::string& from = files_[m];
      const std::size_t begin = used.size();
      for (; m < loaded_.materials.size() && files_[m] == from; ++m) {
        const auto has = [&](const Model::Part& part) {
          return part.material == loaded_.materials[m].name;
        };
        if (std::ranges::any_of(loaded_.model.parts, has)) {
          used.push_back(std::move(loaded_.materials[m]));
        }
      }
      const Status status =
          material::load_images(std::span(used).subspan(begin),
                                [&](const std::string& path) { return open(from, path); });
      if (!status) return status;
    }
    loaded_.materials = std::move(used);
    return {};
  }

  Status load_morphs() {
    const Character& character = loaded_.character;
    if (character.morphs.empty()) return {};
    const auto file = open(path_, character.morphs);
    if (!file) return file.error();
    auto morphs = morph_exr::read(file->bytes());
    if (!morphs) return std::move(morphs.error()).in_file(file->path());
    if (morphs->vertex_count != loaded_.model.vertex_count()) {
      return Error("character-morphs",
                   fmt::format("the morph targets have {} vertices, the model has {}",
                               morphs->vertex_count, loaded_.model.vertex_count()))
          .in_file(file->path());
    }
    if (character.expressions.empty()) {
      loaded_.rest_weights.assign(morphs->names.size(), 0.0f);
      loaded_.morphs = *std::move(morphs);
      return {};
    }
    MorphSet& chosen = loaded_.morphs;
    chosen.vertex_count = morphs->vertex_count;
    chosen.provenance = morphs->provenance;
    for (const Character::Expression& expression : character.expressions) {
      const std::string& name = expression.target.empty() ? expression.name : expression.target;
      const int target = morphs->find(name);
      if (target < 0) {
        return Error(
            "character-target",
            fmt::format("'{}' has no morph target '{}'", shown(character.morphs), shown(name)),
            nearest_hint(name, morphs->names));
      }
      chosen.names.push_back(expression.name);
      const auto positions = morphs->target_positions(target);
      const auto normals = morphs->target_normals(target);
      chosen.positions.insert(chosen.positions.end(), positions.begin(), positions.end());
      chosen.normals.insert(chosen.normals.end(), normals.begin(), normals.end());
      loaded_.rest_weights.push_back(expression.weight);
    }
    return {};
  }

  Status check_joints() {
    const Character& character = loaded_.character;
    for (const Character::Eye& eye : character.eyes) {
      if (Status status = check_joint("eye", eye.name, eye.joint); !status) return status;
      warn_of_place(eye);
    }
    for (const Character::Socket& socket : character.sockets) {
      if (Status status = check_joint("socket", socket.name, socket.joint); !status) return status;
    }
    return {};
  }

  // Eyes are at a place in the model, not in their joint's frame.
  void warn_of_place(const Character::Eye& eye) {
    constexpr double kFar = 0.25;  // of the model; a head's height is an eighth
    Eigen::AlignedBox3d box;
    for (const Transform& joint : loaded_.model.skeleton.reference) box.extend(joint.position);
    const int joint = loaded_.model.skeleton.find(eye.joint);
    const Vec3& place = loaded_.model.skeleton.reference[at(joint)].position;
    const double away = (eye.position.cast<double>() - place).norm();
    if (away <= kFar * box.sizes().maxCoeff()) return;
    inputs_.diagnose(make_warning(
        "character-eye",
        fmt::format("eye '{}' is {} m from its joint '{}'", shown(eye.name), readable(away, 3),
                    shown(eye.joint)),
        fmt::format("its position is in the model's reference pose, in metres; the joint is at "
                    "{}, {}, {}",
                    readable(place.x(), 4), readable(place.y(), 4), readable(place.z(), 4)),
        path_));
  }

  Status check_joint(const char* what, const std::string& name, const std::string& joint) const {
    const std::vector<std::string>& joints = loaded_.model.skeleton.names;
    if (std::ranges::find(joints, joint) != joints.end()) return {};
    return Error("character-joint",
                 fmt::format("{} '{}' moves with the joint '{}', which the model does not have",
                             what, shown(name), shown(joint)),
                 nearest_hint(joint, joints));
  }

  Status load_roles() {
    std::string path;
    if (!loaded_.character.role_map.empty()) {
      auto inside = path_inside(folder_of(path_), loaded_.character.role_map);
      if (!inside) return inside.error();
      path = *std::move(inside);
    }
    const auto find_roles = open_role_map(path, inputs_);
    if (!find_roles) return find_roles.error();
    auto roles = (*find_roles)(loaded_.model.skeleton);
    if (!roles) return std::move(roles.error()).in_file(path);
    loaded_.roles = *std::move(roles);
    return {};
  }

  const std::string path_;
  std::string_view text_;
  Inputs& inputs_;
  std::vector<std::string> files_;  // [materials] the file that each is from
  LoadedCharacter loaded_;
};

}  // namespace

Result<LoadedCharacter> open_character(const InputFile& input, Inputs& inputs) {
  return Loader(input, inputs).load();
}

Result<LoadedCharacter> open_character(const std::string& path, Inputs& inputs) {
  const auto input = inputs.open_input(path);
  if (!input) return input.error();
  return open_character(*input, inputs);
}

void apply_rest_weights(Actor& actor) {
  Model& model = actor.model;
  std::vector<Vec3f> positions(model.positions.size()), normals(model.normals.size());
  apply_morphs(actor.morphs, actor.rest_weights, {model.positions, model.normals},
               {positions, normals});
  model.positions = std::move(positions);
  model.normals = std::move(normals);
  actor.morphs = {};
  actor.rest_weights.clear();
}

Result<Actor> read_character(const InputFile& file, Inputs& inputs) {
  auto loaded = open_character(file, inputs);
  if (!loaded) return loaded.error();
  return static_cast<Actor&&>(*std::move(loaded));
}

Result<Actor> open_actor(const InputFile& file, Inputs& inputs, const ActorOptions& options) {
  const Format& format = format_of(file);
  if (format.read_scene != nullptr) return read_scene_actor(format, file, inputs, options);
  if (format.read_actor != nullptr && (options.with_camera || format.kind != registry::Kind::cam)) {
    auto actor = format.read_actor(file, inputs);
    if (actor && !options.with_morphs && !actor->morphs.names.empty()) apply_rest_weights(*actor);
    return actor;
  }
  Actor actor;
  Actor::Motion& motion = actor.motions.emplace_back();
  auto clip = open_motion(file, inputs,
                          {.rest_frame_is_note = options.rest_frame_is_note,
                           .stretches = options.with_stretches ? &motion.stretches : nullptr});
  if (!clip) return clip.error();
  motion.clip = *std::move(clip);
  actor.model.skeleton = motion.clip.skeleton;
  return actor;
}

Result<Actor> open_actor(const std::string& path, Inputs& inputs, const ActorOptions& options) {
  const auto file = inputs.open_input(path);
  if (!file) return file.error();
  return open_actor(*file, inputs, options);
}

}  // namespace krok::io
