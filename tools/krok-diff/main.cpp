#include <fmt/format.h>

#include "compare_files.h"
#include "core/numbers.h"
#include "core/quantity.h"
#include "difference_plot.h"
#include "tools/common/tool.h"

namespace krok::diff {

namespace {

// The options as they were typed.
struct Arguments {
  std::string first, second;
  std::string length = "0.01mm";
  std::string angle = "0.01deg";
  std::string ratio = "0.0001";
  SheetOptions sheet;
  std::string plot;
};

Result<double> not_negative(Result<double> value, const char* option, const std::string& text) {
  if (!value) {
    Error error = std::move(value).error();
    error.message = fmt::format("{}: {}", option, error.message);
    return error;
  }
  if (*value < 0) {
    return Error("quantity-range", fmt::format("{} {} is less than 0", option, text),
                 "a tolerance is 0 or more");
  }
  return value;
}

Result<double> parse_ratio(const std::string& text) {
  const auto value = parse_finite(text);
  if (!value) return Error("quantity-number", fmt::format("'{}' is not a number", text));
  return *value;
}

Result<Options> parse(const Arguments& arguments) {
  Options options;
  options.first = arguments.first;
  options.second = arguments.second;
  const auto length = not_negative(parse_length(arguments.length), "--tolerance", arguments.length);
  if (!length) return length.error();
  const auto angle = not_negative(parse_angle(arguments.angle), "--angle", arguments.angle);
  if (!angle) return angle.error();
  const auto ratio = not_negative(parse_ratio(arguments.ratio), "--ratio", arguments.ratio);
  if (!ratio) return ratio.error();
  options.tolerance = {*length, *angle, *ratio};
  options.sheet = arguments.sheet;
  options.plot = arguments.plot;
  if (Status fits = check_picture_name(options.sheet.path, "--sheet"); !fits) return fits.error();
  if (Status fits = check_plot_name(options.plot); !fits) return fits.error();
  return options;
}

void declare(CLI::App& app, Arguments& arguments) {
  app.add_option("A", arguments.first, "A .anim, .model, .cam, .glb or .gltf file")
      ->type_name("")
      ->required();
  app.add_option("B", arguments.second, "Another of the same kind")->type_name("")->required();
  app.add_option("--tolerance", arguments.length,
                 "Distances up to this are the same: 0.1mm, 0.2cm; a bare number is metres")
      ->type_name("LENGTH")
      ->default_str(arguments.length);
  app.add_option("--angle", arguments.angle,
                 "Angles up to this are the same: 0.1deg, 0.002rad; a bare number is degrees")
      ->type_name("ANGLE")
      ->default_str(arguments.angle);
  app.add_option("--ratio", arguments.ratio,
                 "Differences up to this are the same in what has no unit: weights, texture "
                 "coordinates")
      ->type_name("NUMBER")
      ->default_str(arguments.ratio);
  app.add_option("--sheet", arguments.sheet.path,
                 "A picture of both figures and of where they differ, as PNG; of motions, models "
                 "and glTF")
      ->type_name("OUT.png");
  declare_picture_options(app, arguments.sheet.picture, kDifferenceMoments);
  for (const char* name : {"--moments", "--sides", "--elevation", "--size"}) {
    app.get_option(name)->needs("--sheet");
  }
  app.add_option("--plot", arguments.plot,
                 "Charts of the distances and angles between two motions over time, as SVG")
      ->type_name("OUT.svg");
}

Result<int> run(const Arguments& arguments, ToolContext& context) {
  const auto options = parse(arguments);
  if (!options) return options.error();
  const auto outcome = compare_files(*options, context);
  if (!outcome) return outcome.error();
  context.report.result = to_json(*outcome, options->tolerance);
  if (!context.quiet) context.print(to_text(*outcome, options->tolerance));
  return outcome->same ? kExitDone : kExitNo;
}

}  // namespace

}  // namespace krok::diff

int main(int argc, char** argv) {
  krok::diff::Arguments arguments;
  krok::ToolSpec spec;
  spec.name = "krok-diff";
  spec.summary =
      "How far two motions, models, cameras or glTF files are apart, and where. glTF files are "
      "compared by what a viewer shows: vertices and joints in world space at the key times of "
      "both, whether skinned, morphed or moved by nodes";
  spec.inputs = "A B";
  spec.examples = {
      {"krok-diff walk.anim walk_again.anim --tolerance 0.1mm --angle 0.1deg",
       "Largest and RMS difference of joints, with joint and frame; exit code 1 if beyond."},
      {"krok-diff walk_rig.glb walk_clip.glb --json=diff.json",
       "A skinned rig against the same motion baked into morph targets; all figures as JSON."},
      {"krok-diff raw.anim clean.anim --sheet change.png --plot change.svg",
       "Both figures side by side and where they differ, and the distance over time."}};
  spec.exit_done = "the same within the tolerance";
  spec.exit_no = "the files differ: beyond tolerance, or in skeleton, topology, frames or rate";
  spec.has_output = false;
  spec.declare = [&](CLI::App& app) { krok::diff::declare(app, arguments); };
  spec.run = [&](krok::ToolContext& context) { return krok::diff::run(arguments, context); };
  return krok::run_tool(spec, argc, argv);
}
