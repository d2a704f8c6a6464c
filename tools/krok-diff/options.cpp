#include "tools/krok-diff/options.h"

#include <memory>

#include "core/file.h"
#include "tools/krok-diff/difference_plot.h"
#include "tools/krok-diff/heatmap.h"
#include "tools/krok-diff/run.h"
#include "tools/krok-diff/summary_page.h"
#include "tools/krok-diff/tolerance_options.h"

namespace krok::cli::diff {

namespace {

// The options as given on the command line.
struct Arguments {
  std::string first, second;
  ToleranceArguments tolerance;
  SheetOptions sheet;
  std::string plot;
  std::string heatmap;
  std::string summary;
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
  options.summary = arguments.summary;
  options.folders = arguments.folders;
  if (Status status = check_image_name(options.sheet.path, "--sheet"); !status)
    return status.error();
  if (Status status = check_plot_name(options.plot); !status) return status.error();
  if (Status status = check_heatmap_name(options.heatmap); !status) return status.error();
  if (Status status = check_summary_name(options.summary); !status) return status.error();
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
      .add_option("B", arguments.second,
                  "A file of the same type (glTF can be compared with motions, models and point "
                  "caches too), or a folder")
      .type_name("")
      .required();
  declare_tolerances(command, arguments.tolerance);
  command.add_option(
      "--sheet OUT.png", arguments.sheet.path,
      "PNG image of both characters and of their difference; for motions, models and glTF");
  declare_image_options(command, arguments.sheet.image, kDifferenceMoments);
  for (const char* name : {"--moments", "--sides", "--elevation", "--size"}) {
    command.get_option(name).needs("--sheet");
  }
  command.add_option("--plot OUT.svg", arguments.plot,
                     "Charts of the distances and angles over time, as SVG; for motions and glTF");
  command.add_option("--heatmap OUT.glb", arguments.heatmap,
                     "A's mesh in the pose of the max difference, with each vertex coloured by its "
                     "max distance over all times; for glTF and models");
  command.add_option("--summary OUT.html", arguments.summary,
                     "A page of the files that are not the same, the worst first, with pictures "
                     "of both and of their difference; Markdown without pictures if called .md; "
                     "for CI servers a test case for each file "
                     "(JUnit) if called .xml");
  declare_folder_options(command, arguments.folders);
}

}  // namespace

bool Options::has_page() const {
  return !summary.empty() && extension(summary) != ".md" && extension(summary) != ".xml";
}

ToolSpec make_spec() {
  const auto arguments = std::make_shared<Arguments>();
  ToolSpec spec = spec_of("krok-diff", arguments, declare, parse, run);
  spec.summary = "Measures the differences of two motions, models, cameras or glTF files";
  spec.details =
      "glTF files are compared as displayed: vertices and joints in world space at the key times "
      "of both (and between them where there are steps or splines), whether skinned, morphed or "
      "moved by nodes.";
  spec.inputs = "A B";
  spec.examples = {
      {"krok-diff walk.anim walk_again.anim --tolerance 0.1mm --angle 0.1deg",
       "Max and RMS difference of joints, with joint and frame; exit code 1 if beyond "
       "tolerance."},
      {"krok-diff walk_rig.glb walk_clip.glb --json=diff.json",
       "A skinned rig against the same motion baked into morph targets; all metrics "
       "as JSON."},
      {"krok-diff golden.glb new.glb --match nearest --tolerance 0.1mm --normals 1deg",
       "Meshes with a different vertex order, or with different seams."},
      {"krok-diff raw.anim clean.anim --sheet change.png --plot change.svg",
       "Both characters side by side with their difference, and the distance over "
       "time."},
      {"krok-diff golden out --tolerance 0.1mm --keep-going --summary diff.html",
       "Compare each file in out with its namesake in golden, with a page of pictures; "
       "--update replaces the golden files."}};
  spec.exit_done = "the same within the tolerance";
  spec.exit_no =
      "the files differ: beyond tolerance, or in skeleton, topology, frames or rate; "
      "for folders, a file differs or is in only one";
  spec.exit_partly =
      "for folders, with --keep-going: some files cannot be read, the others were "
      "compared";
  spec.has_output = false;
  return spec;
}

}  // namespace krok::cli::diff
