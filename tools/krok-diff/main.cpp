#include <fmt/format.h>

#include "compare_files.h"
#include "difference_plot.h"
#include "heatmap.h"
#include "tolerance_options.h"
#include "tools/common/tool.h"

namespace krok::diff {

namespace {

// The options as they were typed.
struct Arguments {
  std::string first, second;
  ToleranceArguments tolerance;
  SheetOptions sheet;
  std::string plot;
  std::string heatmap;
  FolderOptions folders;
};

Result<Options> parse(const Arguments& arguments) {
  Options options;
  options.first = arguments.first;
  options.second = arguments.second;
  const auto tolerance = parse_tolerances(arguments.tolerance);
  if (!tolerance) return tolerance.error();
  options.tolerance = *tolerance;
  options.matching = arguments.tolerance.matching;
  options.materials = arguments.tolerance.materials;
  options.sheet = arguments.sheet;
  options.plot = arguments.plot;
  options.heatmap = arguments.heatmap;
  options.folders = arguments.folders;
  if (Status status = check_image_name(options.sheet.path, "--sheet"); !status)
    return status.error();
  if (Status status = check_plot_name(options.plot); !status) return status.error();
  if (Status status = check_heatmap_name(options.heatmap); !status) return status.error();
  if (Status status = check_summary_name(options.folders.summary); !status) return status.error();
  return options;
}

void declare(CommandOptions& command, Arguments& arguments) {
  command
      .add_option(
          "A", arguments.first,
          "A motion (.anim, .bvh, .amc), .model, .cam, .glb, .gltf, .pc2 or .exr file, or a folder")
      .type_name("")
      .required();
  command
      .add_option(
          "B", arguments.second,
          "Another of the same kind (glTF goes with motions, models and point caches too), or "
          "another folder")
      .type_name("")
      .required();
  declare_tolerances(command, arguments.tolerance);
  command
      .add_option("--sheet", arguments.sheet.path,
                  "A picture of both figures and of where they differ, as PNG; of motions, models "
                  "and glTF")
      .type_name("OUT.png");
  declare_image_options(command, arguments.sheet.image, kDifferenceMoments);
  for (const char* name : {"--moments", "--sides", "--elevation", "--size"}) {
    command.get_option(name).needs("--sheet");
  }
  command
      .add_option("--plot", arguments.plot,
                  "Charts of the distances and angles over time, as SVG; of motions and glTF")
      .type_name("OUT.svg");
  command
      .add_option("--heatmap", arguments.heatmap,
                  "A's mesh, where the difference is largest in time, each vertex coloured by its "
                  "largest distance of all times; of glTF and models")
      .type_name("OUT.glb");
  declare_folder_options(command, arguments.folders);
}

Result<int> run(const Arguments& arguments, ToolContext& context) {
  const auto options = parse(arguments);
  if (!options) return options.error();
  const auto folders = are_folders(*options);
  if (!folders) return folders.error();
  if (*folders) return run_folders(*options, context);
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
      {"krok-diff golden.glb new.glb --match nearest --tolerance 0.1mm --normals 1deg",
       "Meshes whose vertices stand in another order, or are split otherwise at seams."},
      {"krok-diff raw.anim clean.anim --sheet change.png --plot change.svg",
       "Both figures side by side and where they differ, and the distance over time."},
      {"krok-diff golden out --tolerance 0.1mm --keep-going --summary diff.html",
       "Each file in out against the one of its name in golden; --update makes them the golden "
       "ones."}};
  spec.exit_done = "the same within the tolerance";
  spec.exit_no =
      "the files differ: beyond tolerance, or in skeleton, topology, frames or rate; of folders, a "
      "file differs or is in one alone";
  spec.exit_partly =
      "of folders, with --keep-going: some files cannot be read, the others were compared";
  spec.has_output = false;
  spec.declare = [&](krok::CommandOptions& command) { krok::diff::declare(command, arguments); };
  spec.run = [&](krok::ToolContext& context) { return krok::diff::run(arguments, context); };
  return krok::run_tool(spec, argc, argv);
}
