#include "tools/krok-view/files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "body/body.h"
#include "character/sampling.h"
#include "core/text.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/gltf/pack_glb.h"
#include "formats/io/open_character.h"
#include "formats/registry/registry.h"
#include "nodes/animation_choice.h"
#include "tools/cli/file_name.h"
#include "tools/krok-view/goals.h"
#include "tools/krok-view/ragdoll_bodies.h"
#include "tools/shared/keys_sidecar.h"

namespace krok::cli::view {

namespace {

namespace fs = std::filesystem;
using registry::Kind;

// Empty for standard input.
std::string folder_of(const std::string& path) {
  if (path == "-") return {};
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

// Contacts and keytimes: from the sidecar of the motion, or detected.
Result<MotionKeys> keys_of(const std::string& path, const Clip& clip, KeysChoice choice,
                           ToolContext& context) {
  if (choice == KeysChoice::none) return MotionKeys();
  if (choice == KeysChoice::automatic) {
    auto sidecar = read_keys_beside(path, clip, context);
    if (!sidecar) return std::move(sidecar).error();
    return *sidecar ? std::move((*sidecar)->keys) : MotionKeys();
  }
  return find_keys(clip, find_roles(clip.skeleton), context);
}

// The page contains the file itself; it is parsed for its errors and for what its keys tell of its
// animations.
Status add_glb(const std::string& path, std::vector<std::byte> bytes, Files& files) {
  gltf::ReadOptions as_is;
  as_is.draco = false;
  const auto scene = gltf::read(bytes, as_is);
  if (!scene) return Error(scene.error()).in_file(path);
  Files::Glb glb{path, name_of_input(path), std::move(bytes), {}, {}, 0};
  for (const nodes::Animation& animation : scene->animations) {
    Diagnostics notes;
    const auto chosen = character::choose_sampling(animation, {}, notes);
    if (!chosen) return Error(chosen.error()).in_file(path);
    glb.animations.push_back(animation.name);
    glb.rates.push_back(chosen->sampling.rate);
  }
  glb.animation = std::max(0, best_animation(*scene).animation);
  files.glbs.push_back(std::move(glb));
  return {};
}

Status add_file(const std::string& path, KeysChoice choice, ToolContext& context, Files& files) {
  auto input = context.open_input(path);
  if (!input) return input.error();
  const Kind kind = registry::identify(input->path(), input->bytes());
  switch (kind) {
    case Kind::glb: {
      const auto bytes = input->bytes();
      return add_glb(path, {bytes.begin(), bytes.end()}, files);
    }
    case Kind::gltf: {
      // A page cannot open external files, so buffers and images are packed.
      gltf::ReadOptions packing;
      packing.folder = folder_of(path);
      packing.draco = false;
      auto packed = gltf::pack_glb(input->bytes(), packing);
      if (!packed) return std::move(packed).error().in_file(path);
      for (Diagnostic& diagnostic : packed->diagnostics) context.diagnose(std::move(diagnostic));
      for (const std::string& beside : packed->files) {
        if (auto opened = context.open_input(beside); !opened) return opened.error();
      }
      return add_glb(path, std::move(packed->bytes), files);
    }
    default:
      break;
  }
  auto actor = io::open_actor(*input, context, {.with_camera = true});
  if (!actor) return std::move(actor).error().in_file(path);
  for (Actor::Camera& camera : actor->cameras) {
    files.cameras.push_back({name_of_input(path), std::move(camera.track)});
  }
  if (actor->skeleton().empty()) return {};
  if (actor->motions.empty()) {
    files.models.push_back({path, name_of_input(path), *std::move(actor), false});
    return {};
  }
  Clip clip = std::move(actor->motions[0].clip);
  auto keys = keys_of(path, clip, choice, context);
  if (!keys) return std::move(keys).error().in_file(path);
  Files::Motion& motion = files.motions.emplace_back(
      Files::Motion{path, name_of_input(path), std::move(clip), nullptr, {}, *std::move(keys), {}});
  if (!actor->has_mesh()) return {};
  files.models.push_back({path, motion.name, *std::move(actor), true});
  motion.body = &files.models.back().actor.model;
  motion.materials = files.models.back().actor.materials;
  return {};
}

void share_models(Files& files) {
  for (Files::Character& character : files.models) {
    for (Files::Motion& motion : files.motions) {
      if (motion.body != nullptr || !character.actor.has_mesh()) continue;
      if (!difference_in_structure(motion.clip.skeleton, character.actor.model.skeleton).empty())
        continue;
      motion.body = &character.actor.model;
      motion.materials = character.actor.materials;
      character.used = true;
    }
  }
  for (Files::Character& character : files.models) {
    if (character.used) continue;
    Files::Motion still{character.path, character.name, {}, nullptr, {}, {}, {}};
    still.clip.skeleton = character.actor.model.skeleton;
    if (character.actor.has_mesh()) {
      still.body = &character.actor.model;
      still.materials = character.actor.materials;
    }
    files.motions.push_back(std::move(still));
  }
}

bool same_reference(const Skeleton& a, const Skeleton& b) {
  static constexpr double kSame = 1e-6;  // metres, and of quaternions
  if (a.end_sites != b.end_sites || !difference_in_structure(a, b).empty()) return false;
  return std::ranges::equal(
      a.reference, b.reference, [](const Transform& one, const Transform& other) {
        return (one.position - other.position).norm() < kSame &&
               (one.orientation.coeffs() - other.orientation.coeffs()).norm() < kSame;
      });
}

// Motions of one skeleton, such as takes of one actor, share a body.
Status build_bodies(const Options& options, ToolContext& context, Files& files) {
  if (options.body == BodyChoice::none) return {};
  std::vector<std::vector<Files::Motion*>> actors;
  for (Files::Motion& motion : files.motions) {
    if (motion.body != nullptr) continue;
    const auto known = std::ranges::find_if(actors, [&](const auto& actor) {
      return same_reference(actor.front()->clip.skeleton, motion.clip.skeleton);
    });
    if (known != actors.end()) {
      known->push_back(&motion);
    } else {
      actors.push_back({&motion});
    }
  }
  BodyChoice choice = options.body;
  if (choice == BodyChoice::automatic) {
    choice = actors.size() <= 2 ? BodyChoice::medium : BodyChoice::low;
  }
  BodyOptions how = body_options(choice, context);
  const bool many = actors.size() > 2;
  // Of many the number is shown, not the steps of each.
  if (many) {
    how.progress = nullptr;
    context.progress->begin("making bodies", actors.size());
  }
  for (const auto& actor : actors) {
    auto body = make_body(actor.front()->clip, how);
    if (!body) return std::move(body).error().in_file(actor.front()->path);
    if (many) context.progress->advance(1);
    files.bodies.push_back(std::move(body->model));
    for (Files::Motion* motion : actor) motion->body = &files.bodies.back();
  }
  if (many) context.progress->end();
  return {};
}

// --clip, in all glTF files that have it.
Status choose_animation(const Options& options, Files& files) {
  if (options.clip.empty()) return {};
  bool found = false;
  std::vector<std::string> names;
  for (Files::Glb& glb : files.glbs) {
    const auto place = std::ranges::find(glb.animations, options.clip);
    names.insert(names.end(), glb.animations.begin(), glb.animations.end());
    if (place == glb.animations.end()) continue;
    glb.animation = static_cast<int>(place - glb.animations.begin());
    found = true;
  }
  if (found) return {};
  return Error("view-clip", fmt::format("no glTF file has an animation '{}'", options.clip),
               names.empty() ? "the files have no animation"
                             : fmt::format("animations: {}", fmt::join(names, ", ")));
}

Status add_goals(const Options& options, ToolContext& context, Files& files) {
  if (options.goals.empty()) return {};
  if (files.motions.empty()) {
    return Error("usage", "--goals needs a motion", "give the .anim that krok-ik wrote");
  }
  for (Files::Motion& motion : files.motions) {
    auto goals = viewed_goals(options.goals, motion.clip, context);
    if (!goals) return goals.error();
    motion.goals = std::move(*goals);
  }
  return {};
}

}  // namespace

Result<Files> read_files(const Options& options, ToolContext& context) {
  Files files;
  for (const std::string& path : options.inputs) {
    if (Status status = add_file(path, options.keys, context, files); !status) {
      return status.error();
    }
  }
  share_models(files);
  if (Status status = show_ragdoll_bodies(options.bodies, context, files); !status) {
    return status.error();
  }
  if (Status status = build_bodies(options, context, files); !status) return status.error();
  if (Status status = add_goals(options, context, files); !status) return status.error();
  if (Status status = choose_animation(options, files); !status) return status.error();
  return files;
}

}  // namespace krok::cli::view
