#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "core/file.h"
#include "core/result.h"
#include "tools/cli/tool.h"
#include "tools/krok-diff/difference_sheet.h"
#include "tools/krok-diff/options.h"
#include "tools/krok-diff/outcome.h"

namespace krok::cli::diff {

// File types that can be compared.
enum class InputKind {
  motion,  // .anim, or a capture
  model,
  mesh,  // .obj
  camera,
  gltf,    // .gltf and .glb
  points,  // a point cache, .pc2
  morphs,  // morph targets in an OpenEXR file
};

// "a motion"
std::string description(InputKind kind);

// The type's name in reports: "anim", "model", "obj", "cam", "gltf", "pc2", "morphs".
const char* word_of(InputKind kind);

// Detected from the content, or else from the file name. Code diff-kind.
Result<InputKind> kind_of(const InputFile& file);

// Compares both files and writes the requested plots and images. Codes diff-kind (a file type that
// cannot be compared), diff-kinds (two different types), and those of the readers.
Result<Outcome> compare_files(const Options& options, ToolContext& context);

// Reads both files with the same reader; errors carry the file's path.
template <typename T, typename Read>
Result<std::pair<T, T>> read_both(const InputFile& first, const InputFile& second, Read read) {
  Result<T> a = read(first);
  if (!a) return std::move(a.error()).in_file(first.path());
  Result<T> b = read(second);
  if (!b) return std::move(b.error()).in_file(second.path());
  return std::pair<T, T>(std::move(*a), std::move(*b));
}

// Display names of the two files: the base names, preceded by the folder if these are equal.
inline std::pair<std::string, std::string> image_names(const Options& options) {
  const auto name = [](const std::string& path) {
    const std::string folder = std::filesystem::path(path).parent_path().filename().string();
    return (folder.empty() ? "" : folder + "/") + base_name(path);
  };
  std::pair<std::string, std::string> names(base_name(options.first), base_name(options.second));
  if (names.first == names.second) names = {name(options.first), name(options.second)};
  return names;
}

// Draws the sheet, if requested, and the pictures for the page of a summary. Files whose pictures
// cannot be drawn have none.
inline Status draw(const Options& options, ToolContext& context, bool same,
                   const std::function<DifferenceSheet()>& make,
                   std::optional<Pictures>& pictures) {
  const bool on_page = options.has_page() && !same;
  if (options.sheet.path.empty() && !on_page) return {};
  DifferenceSheet sheet = make();
  if (on_page) {
    if (auto made = make_pictures(sheet, context.jobs)) pictures = *std::move(made);
  }
  if (options.sheet.path.empty()) return {};
  std::tie(sheet.first_name, sheet.second_name) = image_names(options);
  return write_sheet(sheet, options.sheet, context);
}

// Writes the plot, if requested, and makes the chart for the page of a summary.
inline Status plot(const Options& options, ToolContext& context, bool same,
                   const std::function<Result<Plot>()>& make, std::string& chart) {
  const bool on_page = options.has_page() && !same;
  if (options.plot.empty() && !on_page) return {};
  const auto made = make();
  if (made && on_page) chart = made->svg;
  if (options.plot.empty()) return {};
  return write_plot(made, options.plot, context);
}

// The comparisons that compare_files() selects by file type. They write the requested plots and
// images.

// Compares two motions, each a .anim file or a capture.
Result<Outcome> compare_motions(const InputFile& first, const InputFile& second,
                                const Options& options, ToolContext& context);

Result<Outcome> compare_models(const InputFile& first, const InputFile& second,
                               const Options& options, ToolContext& context);

Result<Outcome> compare_cameras(const InputFile& first, const InputFile& second,
                                const Options& options);

Result<Outcome> compare_morphs(const InputFile& first, const InputFile& second,
                               const Options& options);

// Compares files that can be read as scenes: glTF, models, motions, point caches.
Result<Outcome> compare_scenes(const InputFile& first, InputKind first_kind,
                               const InputFile& second, InputKind second_kind,
                               const Options& options, ToolContext& context);

}  // namespace krok::cli::diff
