#include "tools/krok-diff/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>

#include "core/file.h"
#include "core/text.h"
#include "formats/chart/chart_writer.h"
#include "tools/cli/command_options.h"
#include "tools/cli/option_kinds.h"
#include "tools/krok-diff/compare_files.h"

namespace krok::cli::diff {

namespace {

// Options for matching and tolerances.

using compare::Matching;

ValueKind<double> tolerance(ValueKind<double> kind) {
  auto read = [read = kind.read](const std::string& text) -> Result<double> {
    auto value = read(text);
    if (!value || *value >= 0) return value;
    return Error("quantity-range", fmt::format("'{}' is negative", shown(text)),
                 "a tolerance is at least 0");
  };
  kind.read = std::move(read);
  return kind;
}

// Codes of the values: usage, those of quantities, quantity-range.
void declare_tolerances(CommandOptions& command, Options& o) {
  command.add("--match HOW", o.matching,
              choice<Matching>({{"auto", Matching::automatic},
                                {"order", Matching::order},
                                {"name", Matching::name},
                                {"nearest", Matching::nearest}}),
              "How to match meshes and joints: order, by their index in the file, and a renamed "
              "animation or material is then no difference; name, by name, reporting those that "
              "only one has; auto, by name if all names are unique and the same, else by index; "
              "nearest, each vertex with the nearest point of the other surface, for meshes with "
              "different vertices, triangles or parts; skin weights and morph targets are then "
              "compared by their effect only",
              "auto");
  command.add("--tolerance", o.tolerance.length, tolerance(length_with_unit()),
              "Max distance that counts as the same: 0.1mm, 0.2cm, with a unit", "0.01mm");
  command.add("--angle", o.tolerance.angle, tolerance(angle()),
              "Max angle that counts as the same: 0.1deg, 0.002rad; a bare number is degrees",
              "0.01deg");
  command.add("--ratio NUMBER", o.tolerance.ratio, tolerance(number()),
              "Max difference of unitless values that counts as the same: weights, texture "
              "coordinates",
              "0.0001");
  command.add(
      "--normals", o.tolerance.normals, tolerance(angle()),
      "The same for normals and tangents only (default: that of --angle). A flipped tangent "
      "handedness is always a difference. Tangents that only one of two glTF files has are a "
      "difference if both have a normal texture, else they are only reported");
  command.add(
      "--joint-tolerance LENGTH[,ANGLE]", o.joints,
      numbers({tolerance(length_with_unit()), tolerance(angle())}, 1),
      "The same for joints only, 1mm or 1mm,0.5deg (default: those of --tolerance and --angle)");
  command.add("--times", o.tolerance.time, tolerance(seconds({})),
              "Max difference of times that count as equal: key times of glTF, and frames of "
              "motions with different rates: 1ms, 0.02s",
              "0.1ms");
  command.add_flag("--materials", o.materials,
                   "Count different materials, colours, textures, vertex colours or unused texture "
                   "coordinates as a difference; by default they are only reported; for glTF");
}

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

Result<int> run(const Options& given, ToolContext& context) {
  Options options = given;
  if (!options.joints.empty()) options.tolerance.joint_positions = options.joints[0];
  if (options.joints.size() > 1) options.tolerance.joint_orientations = options.joints[1];
  const auto folders = are_folders(options);
  if (!folders) return folders.error();
  if (*folders) return run_folders(options, context);
  const auto begin = std::chrono::steady_clock::now();
  const auto outcome = compare_files(options, context);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  FolderOutcome pair;
  FileResult& file = pair.files.emplace_back();
  file.path = base_name(options.second);
  file.seconds = taken.count();
  if (!outcome) {
    const Error& error = outcome.error();
    file.status = FileStatus::unreadable;
    file.what = fmt::format("{} [{}]", error.message, error.code);
    // A page of an earlier run, left as it is, would say that all is well.
    if (error.code != "usage") (void)write_summary(pair, {}, options, context);
    return error;
  }
  context.report.result = to_json(*outcome, options.tolerance);
  if (!context.quiet) context.print(to_text(*outcome, options.tolerance));
  if (!options.summaries.empty()) {
    file.status = outcome->same ? FileStatus::same : FileStatus::differs;
    file.what = worst_of(*outcome);
    file.detail = detail_of(*outcome, options.tolerance);
    if (Status status = write_summary(pair, {}, options, context); !status) return status.error();
  }
  return outcome->same ? kExitDone : kExitNo;
}

}  // namespace krok::cli::diff
