#include "tools/krok-info/options.h"

#include <fmt/format.h>

#include <optional>

#include "core/hash.h"
#include "core/text.h"
#include "formats/io/formats.h"
#include "formats/io/open_role_map.h"
#include "formats/io/open_scene.h"
#include "formats/registry/registry.h"
#include "tools/krok-info/describe.h"
#include "tools/krok-info/textconv.h"

namespace krok::cli::info {

namespace {

Result<Description> describe(const InputFile& file, const SkeletonOptions& how,
                             ToolContext& context) {
  using registry::Kind;
  const Kind kind = registry::identify(file.path(), file.bytes());
  if (io::is_scene(kind)) return describe_scene(file, kind, how, context);
  switch (kind) {
    case Kind::anim:
      return describe_anim(file, how, context);
    case Kind::model:
      return describe_model(file, how, context);
    case Kind::cam:
      return describe_cam(file, context);
    case Kind::steps:
      return describe_steps(file, context);
    case Kind::material:
      return describe_material(file, context);
    case Kind::character:
      return describe_character(file, how, context);
    case Kind::ragdoll:
      return describe_ragdoll(file, context);
    case Kind::correctives:
      return describe_correctives(file, context);
    case Kind::bvh:
      return describe_bvh(file, how, context);
    case Kind::asf:
    case Kind::amc:
      return describe_acclaim(file, how, context);
    default:
      break;
  }
  if (io::is_motion(file)) return describe_motion(file, how, context);
  const std::string ending = extension(file.path());
  if (ending == ".exr") return describe_morphs(file, context);
  if (ending == ".textgrid") return describe_textgrid(file, context);
  return Error(
      "info-kind",
      "is " + std::string(registry::describe_content(file.bytes())) +
          ", which krok-info cannot read",
      "supported are .anim, .model, .cam, .steps, .material, .character, .ragdoll.json, "
      ".correctives, .exr, .TextGrid, .bvh, .asf, .amc, .glb and .gltf files, and characters in "
      ".fbx, .dae, .smd, .ms3d, .3ds, .ase, .md5mesh and .md5anim files");
}

Result<Description> describe_path(const std::string& path, const SkeletonOptions& how,
                                  ToolContext& context) {
  const auto file = context.open_input(path);
  if (!file) return file.error();
  auto description = describe(*file, how, context);
  if (!description) return std::move(description).error().in_file(path);
  description->json["bytes"] = file->bytes().size();
  return description;
}

}  // namespace

namespace {

// A line for what is no motion or cannot be read: git stops at a text conversion that fails.
Result<int> print_for_git(const Options& options, ToolContext& context) {
  for (const std::string& path : options.files) {
    const auto file = InputFile::open(path);
    const auto text = file ? textconv(*file) : std::optional<std::string>("cannot be opened\n");
    context.print(text ? *text
                       : fmt::format("{}, {} bytes, #{}\n",
                                     registry::describe_content(file->bytes()),
                                     file->bytes().size(), hex(xxh3(file->bytes()))));
  }
  return kExitDone;
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  if (options.textconv) return print_for_git(options, context);
  auto roles = io::open_role_map(options.map, context);
  if (!roles) return roles.error();
  const SkeletonOptions how{*std::move(roles), !options.map.empty(), context.verbose};
  Json files = Json::array();
  bool failed = false;
  bool first = true;
  for (const std::string& path : options.files) {
    auto description = describe_path(path, how, context);
    Json entry = {{"path", path}};
    if (description) {
      entry.update(description->json);
      if (!context.quiet) context.print((first ? "" : "\n") + to_text(path, *description));
      first = false;
    } else {
      failed = true;
      entry["error"] = description.error().code;
      context.diagnose(std::move(description).error());
    }
    files.push_back(std::move(entry));
  }
  context.report.result["files"] = std::move(files);
  return failed ? kExitTrouble : kExitDone;
}

}  // namespace krok::cli::info
