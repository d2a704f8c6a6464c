#include "info.h"

#include "describe.h"
#include "formats/registry/registry.h"

namespace krok::info {

namespace {

Result<Description> describe(const InputFile& file, ToolContext& context) {
  using registry::Kind;
  switch (registry::identify(file.path(), file.bytes())) {
    case Kind::anim:
      return describe_anim(file, context);
    case Kind::model:
      return describe_model(file, context);
    case Kind::cam:
      return describe_cam(file, context);
    case Kind::bvh:
      return describe_bvh(file, context);
    case Kind::asf:
    case Kind::amc:
      return describe_acclaim(file, context);
    case Kind::glb:
    case Kind::gltf:
      return describe_gltf(file, context);
    case Kind::unknown:
      break;
  }
  return Error("info-kind",
               "is " + std::string(registry::describe_content(file.bytes())) +
                   ", which krok-info does not read",
               "it reads .anim, .model, .cam, .bvh, .asf, .amc, .glb and .gltf files");
}

Result<Description> describe_path(const std::string& path, ToolContext& context) {
  const auto file = context.open_input(path);
  if (!file) return file.error();
  auto description = describe(*file, context);
  if (!description) return std::move(description).error().in_file(path);
  description->json["bytes"] = file->bytes().size();
  return description;
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  Json files = Json::array();
  bool failed = false;
  bool first = true;
  for (const std::string& path : options.files) {
    auto description = describe_path(path, context);
    Json entry = {{"path", path}};
    if (description) {
      entry.update(description->json);
      if (!context.quiet) context.print((first ? "" : "\n") + to_text(path, *description));
      first = false;
    } else {
      failed = true;
      entry["error"] = description.error().code;
      context.tell(std::move(description).error());
    }
    files.push_back(std::move(entry));
  }
  context.report.result["files"] = std::move(files);
  return failed ? kExitTrouble : kExitDone;
}

}  // namespace krok::info
