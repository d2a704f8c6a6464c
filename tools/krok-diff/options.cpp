#include "tools/krok-diff/options.h"

#include <algorithm>
#include <memory>

#include "core/file.h"
#include "formats/chart/chart_writer.h"
#include "tools/krok-diff/tolerance_options.h"

namespace krok::cli::diff {

namespace {

void declare(CommandOptions& command, Options& o) {
  command
      .add_option(
          "A", o.first,
          "A motion (.anim, .bvh, .amc), .model, .cam, .glb, .gltf, .obj, .pc2 or .exr file, or "
          "a folder")
      .type_name("")
      .required();
  command
      .add_option("B", o.second,
                  "A file of the same type (glTF can be compared with motions, models and point "
                  "caches too), or a folder")
      .type_name("")
      .required();
  declare_tolerances(command, o);
  command.add("--sheet OUT.png", o.sheet.path, output({".png"}),
              "PNG image of both characters and of their difference; for motions, models and glTF");
  command.only_with({"--sheet"});
  declare_image_options(command, o.sheet.image, kDifferenceMoments);
  command.only_with({});
  command.add("--plot OUT.svg", o.plot, output(chart::endings()),
              "Charts of the distances and angles over time, as SVG, PDF or PNG; for motions and "
              "glTF");
  command.add("--heatmap OUT.glb", o.heatmap, output({".glb", ".gltf"}),
              "A's mesh in the pose of the max difference, with each vertex coloured by its max "
              "distance over all times; for glTF and models");
  command
      .add("--summary OUT.html", o.summaries, output({".html", ".htm", ".md", ".xml"}),
           "A page of the files that are not the same, the worst first, with pictures of both and "
           "of their difference; Markdown without pictures if called .md or without an ending, as "
           "$GITHUB_STEP_SUMMARY is; for CI servers a test case for each file (JUnit) if called "
           ".xml. May be repeated")
      .one_each_time();
  declare_folder_options(command, o.folders);
}

}  // namespace

bool is_page(const std::string& summary) {
  return summary == "-" || extension(summary) == ".html" || extension(summary) == ".htm";
}

bool Options::has_page() const {
  return std::ranges::any_of(summaries, is_page);
}

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of<Options>("krok-diff", options, declare, nullptr, run);
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
