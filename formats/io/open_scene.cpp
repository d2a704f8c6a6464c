#include "formats/io/open_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "character/mesh.h"
#include "character/motion.h"
#include "core/index.h"
#include "core/numbers.h"
#include "core/path_inside.h"
#include "core/text.h"
#include "formats/assimp/assimp_reader.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/io/readers_internal.h"
#include "formats/zip/zip_archive.h"
#include "nodes/animation_choice.h"
#include "nodes/scene_of.h"

namespace krok::io {

namespace {

// Opens the other files that a scene was read from, and names its file in its diagnostics.
Result<nodes::Scene> with_its_files(Result<nodes::Scene> scene, const InputFile& file,
                                    Inputs& inputs) {
  if (!scene) return std::move(scene.error()).in_file(file.path());
  for (const std::string& path : scene->files) {
    if (path == file.path()) continue;
    if (const auto other = inputs.open_input(path); !other) return other.error();
  }
  for (Diagnostic& diagnostic : scene->diagnostics) {
    if (diagnostic.where.file.empty()) diagnostic.where.file = file.path();
  }
  return scene;
}

}  // namespace

Result<nodes::Scene> read_gltf(const InputFile& file, Inputs& inputs, bool with_materials) {
  gltf::ReadOptions options;
  options.with_materials = with_materials;
  options.limits = inputs.limits;
  if (file.path() != "-") options.folder = folder_of(file.path());
  return with_its_files(gltf::read(file.bytes(), options), file, inputs);
}

Result<nodes::Scene> read_zipped_gltf(const InputFile& file, Inputs& inputs, bool with_materials) {
  auto archive = zip::Archive::open(file.bytes());
  if (!archive) return std::move(archive.error()).in_file(file.path());
  std::vector<std::string> scenes;
  for (const std::string& name : archive->names()) {
    const std::string ending = extension(name);
    if (ending == ".gltf" || ending == ".glb") scenes.push_back(name);
  }
  if (scenes.size() != 1) {
    return Error("zip-scene",
                 scenes.empty() ? "the archive has no glTF scene (.gltf, .glb)"
                                : fmt::format("the archive has {} glTF scenes, such as {} and {}",
                                              scenes.size(), shown(scenes[0]), shown(scenes[1])),
                 "unpack it and give the file, or the folder of its files")
        .in_file(file.path());
  }
  constexpr std::uint64_t kSmall = std::uint64_t{256} << 20, kExpansion = 64;
  std::uint64_t left = kSmall + kExpansion * file.bytes().size();
  const auto unpack = [&](const std::string& name,
                          std::uint64_t most) -> Result<std::vector<std::byte>> {
    auto bytes = archive->read(name, std::min(most, left));
    if (bytes) left -= bytes->size();
    return bytes;
  };
  const auto bytes = unpack(scenes[0], left);
  if (!bytes) return Error(bytes.error()).in_file(file.path());
  const std::size_t slash = scenes[0].rfind('/');
  const std::string folder = slash == std::string::npos ? "" : scenes[0].substr(0, slash + 1);
  gltf::ReadOptions options;
  options.with_materials = with_materials;
  options.limits = inputs.limits;
  options.open = [&](const std::string& path, std::uint64_t most) {
    return unpack(folder + path, most);
  };
  return with_its_files(gltf::read(*bytes, options), file, inputs);
}

Result<nodes::Scene> read_through_assimp(const InputFile& file, Inputs& inputs,
                                         bool with_materials) {
  if (file.path() == "-") {
    return Error("assimp-kind",
                 "only BVH, Acclaim's formats and GLB can be read from standard input")
        .in_file(file.path());
  }
  const registry::Kind kind = registry::identify(file.path(), file.bytes());
  if (kind == registry::Kind::md5anim) inputs.depends_on_neighbours(file.path(), ".md5mesh");
  if (kind == registry::Kind::md5mesh) inputs.depends_on_neighbours(file.path(), ".md5anim");
  assimp::ReadOptions options;
  options.with_materials = with_materials;
  options.limits = inputs.limits;
  return with_its_files(assimp::read_file(file.path(), options), file, inputs);
}

namespace {

// Whether an animation begins with joints turned otherwise than at rest, by half a degree.
bool poses(const nodes::Scene& scene, const nodes::Animation& animation,
           std::span<const int> joints) {
  return std::ranges::any_of(animation.channels, [&](const nodes::Channel& channel) {
    if (std::ranges::find(joints, channel.node) == joints.end() || channel.values->empty()) {
      return false;
    }
    const bool spline = channel.interpolation == nodes::Interpolation::cubic_spline;
    const float* const key = channel.values->data() + (spline ? channel.width : 0);
    const nodes::Node& rest = scene.nodes[at(channel.node)];
    if (rest.has_matrix || channel.path != nodes::Path::rotation) return false;
    const Vec4f turn = Eigen::Map<const Vec4f>(key);
    return std::abs(turn.dot(rest.rotation.coeffs().cast<float>())) < 1 - 1e-5F;
  });
}

// The animations that move or pose joints; none where each moves a few of many, as programs write
// one motion with an animation for each joint.
std::vector<int> moving(const nodes::Scene& scene, std::span<const int> joints) {
  constexpr std::size_t kFewOf = 4;
  std::vector<int> animations;
  std::size_t most = 0;
  for (std::size_t i = 0; i < scene.animations.size(); ++i) {
    const std::size_t moved = moved_count(scene, scene.animations[i], joints);
    most = std::max(most, moved);
    if (moved > 0 || poses(scene, scene.animations[i], joints)) {
      animations.push_back(static_cast<int>(i));
    }
  }
  if (kFewOf * most < joints.size()) animations.clear();
  return animations;
}

// Metres between a motion and its file's curves that are warned of, and noted.
constexpr double kLost = 1e-3, kNoted = 1e-5;

// "A, B and 3 more"
std::string some_of(const std::vector<std::string>& names) {
  constexpr std::size_t kMaxNamed = 5;
  const std::size_t named = std::min(kMaxNamed, names.size());
  std::string text = fmt::format("{}", fmt::join(std::span(names).first(named), ", "));
  if (names.size() > named) text += fmt::format(" and {} more", names.size() - named);
  return text;
}

// Nodes that are neither joints nor have a mesh, and variants of materials.
void warn_of_left_out(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                      std::span<const int> joints, Diagnostics& found) {
  std::vector<std::string> names, variants;
  for (const int place : nodes::places_of(scene, evaluator)) {
    if (std::ranges::find(joints, place) != joints.end()) continue;
    const std::string& name = scene.nodes[at(place)].name;
    names.push_back(name.empty() ? fmt::format("node {}", place) : shown(name));
  }
  for (const MaterialParameter& one : scene.properties) {
    if (one.name.starts_with("variant ")) variants.push_back(one.name);
  }
  if (!names.empty()) {
    found.push_back(make_warning(
        "scene-nodes",
        fmt::format("{} without a mesh (cameras, lights or others): not in the result: {}",
                    counted(std::ssize(names), "node"), some_of(names))));
  }
  if (!variants.empty()) {
    found.push_back(make_warning(
        "scene-variants", "materials to choose from: not in the result: " + some_of(variants)));
  }
}

// The morph weights of an animation, named as those of the mesh. Its warnings are those of the mesh
// that they are for.
Result<MorphWeights> face_weights(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                                  const character::Rig& rig, int animation,
                                  const character::Sampling& sampling) {
  Diagnostics of_mesh;
  const auto face =
      character::make_actor(scene, evaluator, rig, {}, {.with_morphs = true}, of_mesh);
  if (!face) return face.error();
  return character::make_weights(*face, evaluator, animation, sampling);
}

// The parts of a scene that are asked for, of its animations `part` alone unless that is -1; adds
// to `found` what is to be reported.
Result<Actor> actor_of_scene(const nodes::Scene& scene, const std::string& path, int part,
                             Inputs& inputs, const ActorOptions& options, Diagnostics& found) {
  const auto evaluator = nodes::Evaluator::create(scene);
  if (!evaluator) return evaluator.error();
  const auto rig = character::find_rig(scene, *evaluator, "", found);
  if (!rig) return rig.error();
  if (options.keeps_mesh_alone) warn_of_left_out(scene, *evaluator, rig->joints.nodes, found);
  int animation = best_animation(scene, rig->joints.nodes).animation;
  std::vector<int> animations;
  if (options.every_clip && options.clip.empty() && part < 0) {
    animations = moving(scene, rig->joints.nodes);
  }
  if (part >= 0) {
    animation = part;
  } else if (!options.clip.empty()) {
    const auto chosen = find_animation(scene, options.clip, path);
    if (!chosen) return chosen.error();
    animation = *chosen;
  } else if (options.with_motions && !options.every_clip && animation >= 0) {
    const Diagnostics choice = describe_choice(
        scene, best_animation(scene, rig->joints.nodes), "clip-choice",
        "FILE#NAME, or FILE#NUMBER, is another: give it in quotes; krok-import FILE "
        "--out-dir DIR writes a motion for each",
        path);
    found.insert(found.end(), choice.begin(), choice.end());
  }
  if (animations.empty() && animation >= 0) animations = {animation};
  const CaptureOptions how;
  const auto roles = roles_of(rig->skeleton, how);
  if (!roles) return roles.error();
  const auto place =
      character::place_scene(scene, *evaluator, &*rig, *roles, animation, how, path, found);
  if (!place) return place.error();
  Actor actor;
  if (options.with_mesh) {
    auto made = character::make_actor(scene, *evaluator, *rig, place->conversion,
                                      {.with_morphs = true}, found);
    if (!made) return made.error();
    if (!made->morphs.names.empty()) {
      auto rest = character::make_weights(*made, *evaluator, -1, {});
      if (!rest) return rest.error();
      made->rest_weights = std::move(rest->values);
      if (!options.with_morphs) apply_rest_weights(*made);
    }
    for (std::size_t p = 0; p < made->model.parts.size(); ++p) {
      const int material = made->part_materials[p];
      if (options.with_materials && material >= 0)
        made->model.parts[p].material = scene.materials[at(material)].name;
    }
    made->materials = scene.materials;
    actor = static_cast<Actor&&>(*std::move(made));
  } else {
    auto skeleton = character::skeleton_in_krok(*rig, place->conversion);
    if (!skeleton) return skeleton.error();
    actor.model.skeleton = *std::move(skeleton);
  }
  if (!options.with_motions) return actor;
  character::SamplingError lost;
  std::string lost_by;
  for (const int one : animations) {
    const auto sampling = character::choose_sampling(scene.animations[at(one)], {}, found);
    if (!sampling) return sampling.error();
    Actor::Motion& motion = actor.motions.emplace_back();
    auto clip = character::make_motion(*evaluator, *rig, *roles, *place, one, *sampling,
                                       inputs.jobs, inputs.progress, found,
                                       options.with_stretches ? &motion.stretches : nullptr);
    if (!clip) return clip.error();
    const auto error =
        character::sampling_error(*evaluator, *rig, place->conversion, scene.animations[at(one)],
                                  one, sampling->sampling, HUGE_VAL, inputs.jobs);
    if (error.largest > lost.largest) {
      lost = error;
      lost_by = animation_name(scene, at(one));
    }
    motion.name = animation_name(scene, at(one));
    motion.clip = *std::move(clip);
    // One for all motions, that of the first, where it is made from it.
    Skeleton& skeleton = actor.motions.front().clip.skeleton;
    motion.clip.skeleton.reference = skeleton.reference;
    actor.model.skeleton.reference = skeleton.reference;
    if (options.with_weights && animated_targets(scene.animations[at(one)]) > 0) {
      auto weights = face_weights(scene, *evaluator, *rig, one, sampling->sampling);
      if (!weights) return weights.error();
      motion.weights = *std::move(weights);
    }
  }
  if (lost.largest > kNoted) {
    found.push_back(make_diagnostic(
        lost.largest > kLost ? Severity::warning : Severity::note, "scene-sampling",
        fmt::format("{}: between frames joints are up to {} mm from the file's curves ({} at {} s)"
                    "{}",
                    shown(lost_by), readable(1e3 * lost.largest, 3),
                    shown(rig->skeleton.names[at(lost.joint)]), readable(lost.time, 4),
                    lost.jumps ? "; keys that step become ramps of one frame" : ""),
        "krok-import --rate N keeps more of them", path));
  }
  return actor;
}

// What moves or poses the file's character is not in a result of the character alone.
void warn_of_stillness(const nodes::Scene& scene, Diagnostics& found) {
  if (!scene.animations.empty()) {
    found.push_back(make_warning(
        "scene-still",
        fmt::format("{} of the file: not in the result, as no motion is given",
                    counted(std::ssize(scene.animations), "animation")),
        "krok-import FILE --clip all -o '{clip}.anim' writes motions to be given after "
        "the mesh"));
  }
  for (Diagnostic& one : found) {
    if (one.code != "scene-pose") continue;
    one.severity = Severity::warning;
    if (!scene.animations.empty()) continue;
    one.hint = "krok-import FILE -o pose.anim writes the pose that the file shows as a motion";
  }
}

// The animation that the part of a file names; -1 for a file without one.
Result<int> part_of(const nodes::Scene& scene, const InputFile& file) {
  if (file.part().empty()) return -1;
  const auto number =
      file.part().starts_with('#') ? parse_integer(file.part().substr(1)) : std::nullopt;
  const bool is_number = number && *number >= 0 && *number < std::ssize(scene.animations);
  return is_number ? Result<int>(static_cast<int>(*number))
                   : find_animation(scene, file.part(), file.path());
}

// The scene of a file, of whose animations its part alone is kept.
Result<nodes::Scene> read_scene(const Format& format, const InputFile& file, Inputs& inputs,
                                bool with_materials) {
  auto scene = format.read_scene(file, inputs, with_materials);
  if (!scene) return scene;
  const auto chosen = part_of(*scene, file);
  if (!chosen) return chosen.error();
  if (*chosen < 0) return scene;
  nodes::Animation only = std::move(scene->animations[at(*chosen)]);
  scene->animations.clear();
  scene->animations.push_back(std::move(only));
  return scene;
}

}  // namespace

Result<Actor> read_scene_actor(const Format& format, const InputFile& file, Inputs& inputs,
                               const ActorOptions& options) {
  // All animations: joints are what any of them moves, as in the mesh that the motions are for.
  const auto scene = format.read_scene(file, inputs, options.with_mesh && options.with_materials);
  if (!scene) return scene.error();
  const auto part = part_of(*scene, file);
  if (!part) return part.error();
  Diagnostics found = scene->diagnostics;
  auto actor = actor_of_scene(*scene, file.path(), *part, inputs, options, found);
  if (options.rest_frame_is_note) rest_frame_as_note(found);
  if (options.stays_still) warn_of_stillness(*scene, found);
  inputs.diagnose_in(file.path(), found);
  if (!actor) return std::move(actor.error()).in_file(file.path());
  return actor;
}

bool is_scene(registry::Kind kind) {
  return format_of(kind).read_scene != nullptr;
}

Result<nodes::Scene> open_scene(const InputFile& file, Inputs& inputs, bool with_materials) {
  const Format& format = format_of(file);
  if (format.read_scene == nullptr) {
    return Error("scene-kind", "is not a scene: glTF, FBX, COLLADA, SMD, MS3D, 3DS, ASE or MD5")
        .in_file(file.path());
  }
  return read_scene(format, file, inputs, with_materials);
}

namespace {

// Whether a look at the bytes shows that a file has one animation at most: reading some of these
// formats takes long.
bool has_one_animation(std::string_view text) {
  // The names of a binary FBX file's animations end so (type and class of objects).
  constexpr std::string_view kOfFbx("\0\1AnimStack", 11);
  if (!text.starts_with("Kaydara FBX Binary")) return false;
  const std::size_t first = text.find(kOfFbx);
  return first == std::string_view::npos || text.find(kOfFbx, first + 1) == std::string_view::npos;
}

}  // namespace

std::vector<std::string> addresses_in(const std::string& path, const GivenLimits& limits,
                                      Diagnostics& notes) {
  PlainInputs inputs;
  inputs.limits = limits;
  inputs.jobs = 1;
  // Thousands of captures are not opened for it.
  const registry::Kind named = registry::kind_of_name(path);
  if (named != registry::Kind::unknown && !is_scene(named)) return {path};
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) return {path};  // pipes are read once
  const auto file = InputFile::open(path);
  if (!file) return {path};
  const Format& format = format_of(*file);
  if (format.read_scene == nullptr || has_one_animation(file->text())) return {path};
  const auto scene = read_scene(format, *file, inputs, false);
  if (!scene || scene->animations.size() < 2) return {path};
  const auto evaluator = nodes::Evaluator::create(*scene);
  if (!evaluator) return {path};
  const auto rig = character::find_rig(*scene, *evaluator, "", inputs.diagnostics);
  if (!rig) return {path};
  const std::vector<int> animations = moving(*scene, rig->joints.nodes);
  if (animations.size() < 2) return {path};
  std::string left_out;
  for (std::size_t i = 0; i < scene->animations.size(); ++i) {
    if (std::ranges::find(animations, static_cast<int>(i)) != animations.end()) continue;
    left_out += (left_out.empty() ? "" : ", ") + shown(animation_name(*scene, i));
  }
  if (!left_out.empty()) {
    notes.push_back(make_warning(
        "clip-still",
        fmt::format("{} of {} animations left out, which neither move nor pose joints: {}",
                    scene->animations.size() - animations.size(), scene->animations.size(),
                    left_out),
        "in quotes, 'FILE#NAME' is one of them all the same", path));
  }
  std::vector<std::string> addresses;
  const auto is = [&](const std::string& name, int animation) {
    const auto found = find_animation(*scene, name, path);
    return found && *found == animation;
  };
  for (const int animation : animations) {
    std::string name = animation_name(*scene, at(animation));
    name.erase(0, name.rfind('|') + 1);  // npos + 1 is 0
    if (!is(name, animation) || name.find('/') != std::string::npos) {
      name = std::to_string(animation);
      if (!is(name, animation)) name.insert(0, 1, '#');  // another one is called so
    }
    addresses.push_back(fmt::format("{}#{}", path, name));
  }
  return addresses;
}

}  // namespace krok::io
