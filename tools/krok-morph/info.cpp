#include <fmt/format.h>

#include <optional>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/morph_exr/morph_exr.h"
#include "formats/registry/registry.h"
#include "tools/krok-morph/motion_file.h"
#include "tools/krok-morph/options.h"
#include "tools/krok-morph/shape_file.h"

// Describes an .exr of morph targets.

namespace krok::cli::morph {

Result<TargetFile> read_targets(const std::string& path, ToolContext& context) {
  auto file = context.open_input(path);
  if (!file) return file.error();
  auto morphs = morph_exr::read(file->bytes());
  if (!morphs) {
    Error error = std::move(morphs).error();
    if (extension(path) != ".exr" && error.code == "exr-header") {
      error.message = fmt::format("is {}, not an .exr of morph targets",
                                  registry::describe_content(file->bytes()));
      error.hint =
          "krok-morph pack BASE TARGET... -o face.exr writes one; krok-info describes meshes";
    }
    return std::move(error).in_file(path);
  }
  return TargetFile{*std::move(file), *std::move(morphs)};
}

Result<int> info(const Options& options, ToolContext& context) {
  const auto targets = read_targets(options.files[0], context);
  if (!targets) return targets.error();
  const MorphSet& morphs = targets->morphs;
  const auto size = morph_exr::image_size(targets->file.bytes());
  if (!size) return Error(size.error()).in_file(options.files[0]);
  std::optional<ShapeFile> base;
  if (options.files.size() > 1) {
    auto read = read_shape(options.files[1], options, context);
    if (!read) return read.error();
    if (Status status = check_vertices(*read, morphs, options.files[0]); !status)
      return status.error();
    base = *std::move(read);
  }

  const bool normals = !morphs.normals.empty();
  std::string text = fmt::format("{} of {}, {}\n", counted(morphs.target_count(), "target"),
                                 counted(morphs.vertex_count, "vertex", "vertices"),
                                 normals ? "with normals" : "without normals");
  text += fmt::format("image of {} x {} texels: positions in rows 0 to {}, {} in rows {} to {}\n",
                      size->width, size->height, size->height / 2 - 1,
                      normals ? "normals" : "zeros", size->height / 2, size->height - 1);
  Json list = Json::array();
  for (int t = 0; t < morphs.target_count(); ++t) {
    Json one;
    one["name"] = morphs.names[static_cast<std::size_t>(t)];
    one["first_texel"] = static_cast<std::int64_t>(t) * morphs.vertex_count;
    std::string line = "  " + shown(morphs.names[static_cast<std::size_t>(t)]);
    if (base) {
      const Movement movement = movement_of(base->model.positions, morphs.target_positions(t));
      one.update(to_json(movement));
      line += ": " + describe(movement);
    }
    list.push_back(std::move(one));
    text += line + "\n";
  }
  Json result;
  result["vertices"] = morphs.vertex_count;
  result["normals"] = normals;
  result["picture"] = {{"width", size->width}, {"height", size->height}};
  result["targets"] = std::move(list);
  context.report.result = std::move(result);
  context.print(text);
  return kExitDone;
}

}  // namespace krok::cli::morph
