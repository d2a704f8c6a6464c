#include "tools/krok-view/files.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "body/body.h"
#include "core/glob.h"
#include "core/text.h"
#include "formats/cam/cam.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/gltf/pack_glb.h"
#include "formats/io/open_character.h"
#include "formats/io/open_motion.h"
#include "formats/registry/registry.h"
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

// The motions and characters in a folder and its sub-folders, by name.
Result<std::vector<std::string>> files_in(const std::string& folder) {
  auto found = find_files_below(folder);
  if (!found) return found.error();
  static constexpr std::array<std::string_view, 6> kEndings = {".anim", ".bvh",  ".amc",
                                                               ".glb",  ".gltf", ".character"};
  std::erase_if(*found, [](const std::string& path) {
    const std::string ending = ascii_lower(fs::path(path).extension().string());
    return std::find(kEndings.begin(), kEndings.end(), ending) == kEndings.end();
  });
  if (!found->empty()) return found;
  return Error("view-input", "the folder contains no motion or character",
               "supported: .anim, .bvh, .amc, .glb, .gltf and .character files")
      .in_file(folder);
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

Status add_file(const std::string& path, KeysChoice choice, ToolContext& context, Files& files) {
  auto input = context.open_input(path);
  if (!input) return input.error();
  const Kind kind = registry::identify(input->path(), input->bytes());
  if (io::is_shown_model(kind)) {
    auto shown = io::open_shown_model(*input, context);
    if (!shown) return shown.error();
    files.models.push_back({path, name_of_input(path), *std::move(shown), false});
    return {};
  }
  switch (kind) {
    case Kind::cam: {
      auto camera = cam::read(input->bytes());
      if (!camera) return std::move(camera).error().in_file(path);
      files.cameras.push_back({name_of_input(path), std::move(*camera)});
      return {};
    }
    case Kind::glb: {
      // Parsed only for its errors; the page contains the file itself.
      gltf::ReadOptions as_is;
      as_is.unpack = false;
      if (auto scene = gltf::read(input->bytes(), as_is); !scene) {
        return std::move(scene).error().in_file(path);
      }
      const auto bytes = input->bytes();
      files.glbs.push_back({name_of_input(path), {bytes.begin(), bytes.end()}});
      return {};
    }
    case Kind::gltf: {
      // A page cannot open external files, so buffers and images are packed.
      gltf::ReadOptions packing;
      packing.folder = folder_of(path);
      packing.unpack = false;
      auto packed = gltf::pack_glb(input->bytes(), packing);
      if (!packed) return std::move(packed).error().in_file(path);
      for (Diagnostic& diagnostic : packed->diagnostics) context.diagnose(std::move(diagnostic));
      for (const std::string& beside : packed->files) {
        if (auto opened = context.open_input(beside); !opened) return opened.error();
      }
      files.glbs.push_back({name_of_input(path), std::move(packed->bytes)});
      return {};
    }
    default: {
      auto clip = io::open_motion(*input, context);
      if (!clip) return std::move(clip).error().in_file(path);
      auto keys = keys_of(path, *clip, choice, context);
      if (!keys) return std::move(keys).error().in_file(path);
      files.motions.push_back(
          {path, name_of_input(path), std::move(*clip), nullptr, {}, std::move(*keys), {}});
      return {};
    }
  }
}

void share_models(Files& files) {
  for (Files::Character& character : files.models) {
    for (Files::Motion& motion : files.motions) {
      if (motion.body != nullptr || character.shown.model.triangles.empty()) continue;
      if (!difference_in_structure(motion.clip.skeleton, character.shown.model.skeleton).empty())
        continue;
      motion.body = &character.shown.model;
      motion.materials = character.shown.materials;
      character.used = true;
    }
  }
  for (Files::Character& character : files.models) {
    if (character.used) continue;
    Files::Motion still{character.path, character.name, {}, nullptr, {}, {}, {}};
    still.clip.skeleton = character.shown.model.skeleton;
    if (!character.shown.model.triangles.empty()) {
      still.body = &character.shown.model;
      still.materials = character.shown.materials;
    }
    files.motions.push_back(std::move(still));
  }
}

Status build_bodies(const Options& options, ToolContext& context, Files& files) {
  const auto bare = std::count_if(files.motions.begin(), files.motions.end(),
                                  [](const Files::Motion& motion) { return !motion.body; });
  BodyChoice choice = options.body;
  if (choice == BodyChoice::automatic) {
    choice = bare <= 2 ? BodyChoice::medium : bare <= 4 ? BodyChoice::low : BodyChoice::none;
  }
  if (choice == BodyChoice::none) return {};
  const BodyOptions how = body_options(choice, context);
  for (Files::Motion& motion : files.motions) {
    if (motion.body != nullptr) continue;
    auto body = make_body(motion.clip, how);
    if (!body) return std::move(body).error().in_file(motion.path);
    files.bodies.push_back(std::move(body->model));
    motion.body = &files.bodies.back();
  }
  return {};
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
    std::vector<std::string> paths = {path};
    std::error_code unknown;
    if (path != "-" && fs::is_directory(path, unknown)) {
      auto found = files_in(path);
      if (!found) return found.error();
      paths = std::move(*found);
    }
    for (const std::string& each : paths) {
      if (Status status = add_file(each, options.keys, context, files); !status)
        return status.error();
    }
  }
  share_models(files);
  if (Status status = show_ragdoll_bodies(options.bodies, context, files); !status) {
    return status.error();
  }
  if (Status status = build_bodies(options, context, files); !status) return status.error();
  if (Status status = add_goals(options, context, files); !status) return status.error();
  return files;
}

}  // namespace krok::cli::view
