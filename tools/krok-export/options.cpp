#include "tools/krok-export/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>

#include "formats/io/formats.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/paths.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::exporting {

namespace {

const std::vector<std::pair<std::string, ExportFormat>> kFormats = {
    {"bvh", ExportFormat::bvh}, {"glb", ExportFormat::glb}, {"gltf", ExportFormat::gltf},
    {"csv", ExportFormat::csv}, {"npz", ExportFormat::npz}, {"mot", ExportFormat::mot},
    {"sto", ExportFormat::sto}};

Result<std::string> extension_of(ExportFormat format) {
  for (const auto& [word, value] : kFormats) {
    if (value == format) return "." + word;
  }
  return Error("usage", "no output format given",
               "use --format bvh, glb, gltf, csv, npz, mot or sto");
}

// Words that one tries first have other homes.
constexpr std::array<std::string_view, 7> kElsewhere = {"speed", "gait",   "rotations", "rotation",
                                                        "euler", "eulers", "events"};
ValueKind<What> series_kind() {
  ValueKind<What> kind = choice<What>({{"positions", What::positions},
                                       {"local", What::local},
                                       {"angles", What::angles},
                                       {"quaternions", What::quaternions},
                                       {"velocities", What::velocities},
                                       {"contacts", What::contacts}});
  kind.read = [known = kind.read](const std::string& text) -> Result<What> {
    auto read = known(text);
    if (read) return read;
    Error error = std::move(read).error();
    const bool known_elsewhere = std::ranges::find(kElsewhere, text) != kElsewhere.end();
    if (known_elsewhere)
      error.message = error.message.substr(0, error.message.find("; did you mean"));
    if (text == "speed" || text == "gait")
      error.hint = "krok-keys --table OUT.csv has speed and gait";
    if (text.starts_with("rotation") || text.starts_with("euler")) {
      error.hint =
          "quaternions has rotations in the world, local relative to the parent, angles those of "
          "hips, knees and others in degrees; -o OUT.bvh has Euler angles of all joints";
    }
    if (text.find(',') != std::string::npos) error.hint = "a table has one of them: write several";
    if (text.starts_with("accel")) error.hint = "velocities has what to differentiate";
    if (text == "com" || text.starts_with("center") || text.starts_with("centre")) {
      error.hint = "no centre of mass is computed; positions has the hips, which are near it";
    }
    if (text == "events") error.hint = "krok-keys -o NAME.keys.json has gait events";
    return error;
  };
  return kind;
}

Status check(const Options& options) {
  // Without a format, the output's extension determines it.
  if (options.format == ExportFormat::from_extension) return {};
  return check_for(options.format, options);
}

}  // namespace

Result<ExportFormat> format_of(const Options& options, const std::string& output) {
  if (options.format != ExportFormat::from_extension) return options.format;
  const std::string end = extension(output);
  for (const auto& [word, format] : kFormats) {
    if (end == "." + word) return format;
  }
  const std::string maker = maker_of(end);
  return Error("export-format",
               end.empty() ? fmt::format("{} has no extension; cannot determine the format", output)
                           : fmt::format("unknown extension {}", end),
               "use .bvh, .glb, .gltf, .csv, .npz, .mot or .sto; or --format" +
                   (maker.empty() ? "" : "; " + maker))
      .in_file(output);
}

Status check_for(ExportFormat format, const Options& options) {
  using enum ExportFormat;
  const bool opensim = format == mot || format == sto;
  const char* const for_bvh =
      "--digits, --order and --root-offset are for BVH; tables have quaternions qx, qy, qz, qw";
  const char* const for_tables = "--what is for tables: .csv, .mot and .sto";
  const struct {
    const char* option;
    std::vector<ExportFormat> formats;
    const char* message;
  } uses[] = {
      {"--unit", {bvh}, "--unit is for BVH; the other formats are in metres"},
      {"--digits", {bvh}, for_bvh},
      {"--order", {bvh}, for_bvh},
      {"--root-offset", {bvh}, for_bvh},
      {"--what", {csv, mot, sto}, for_tables},
      {"--map",
       {csv, npz, mot, sto},
       "--map is for tables and for arrays: .csv, .mot, .sto and .npz"},
      {"--layout",
       {csv},
       opensim ? "--layout is for CSV; OpenSim's files are wide" : "--layout is for CSV"},
      {"--bones", {glb, gltf}, "--bones and --no-bones are for glTF"},
      {"--reduce", {glb, gltf}, "--reduce is for glTF; the other formats store every frame"}};
  for (const auto& use : uses) {
    if (std::ranges::find(use.formats, format) != use.formats.end()) continue;
    if (!options.given(use.option)) continue;
    return Error(use.option == std::string_view("--unit") ? "export-unit" : "usage", use.message);
  }
  return {};
}

namespace {

void declare(CommandOptions& command, Options& options) {
  command
      .add_option("inputs IN", options.inputs,
                  "Motion: a .anim file, or a capture (BVH; AMC with its ASF beside it), read as "
                  "by krok-import without options; for one table in CSV several, or folders")
      .required();
  command.add(
      "--format FORMAT", options.format, choice<ExportFormat>(kFormats),
      "bvh, glb, gltf (text, embedded data), csv, npz (arrays of numpy), or OpenSim's mot or "
      "sto; default: the "
      "output's extension");
  command.add(
      "--what SERIES", options.what, series_kind(),
      "Tables: positions (world, m), velocities (world, m/s), quaternions (world: qx, qy, "
      "qz, qw), local (position in m and quaternion relative to the parent), angles (of "
      "hips, knees, ankles, shoulders, elbows in degrees, those that krok-plot draws, see "
      "docs/angles.md) or contacts (of the feet, from NAME.keys.json or detected); default: "
      "positions, angles for mot and sto");
  command.add("--layout LAYOUT", options.layout,
              choice<Layout>({{"long", Layout::long_rows}, {"wide", Layout::wide}}),
              "CSV: long, a row for each frame and joint (contacts: a row for each), or wide, a "
              "row for each frame",
              "long");
  add_map_option(command, options.map);
  command.add("--unit", options.unit, length_unit(), "BVH: length unit: m, cm, mm, in, ft", "cm");
  command.add("--digits 1..15", options.digits, whole(1, 15),
              "BVH: decimal places of angles in degrees and lengths in centimetres; adjusted to "
              "the same precision for other units. With 6, joints come back within a few "
              "micrometres, as far as floats hold them; more than 8 print their rounding",
              "6");
  command.add("--order ORDER", options.order, words({"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"}),
              "BVH: order of the rotation channels: XYZ, XZY, YXZ, YZX, ZXY or ZYX", "ZXY");
  command.add_flag("--root-offset", options.root_offset,
                   "BVH: write the root's place in the reference pose as its OFFSET, as most "
                   "programs do. By default it is 0, since programs that add positions to OFFSETs, "
                   "such as three.js, would show the character at twice its height");
  command.add("--reduce", options.reduce, length_with_unit(kPositive),
              "glTF: reduce keys for a smaller file; joints, and points 3 cm around them, move by "
              "at most this distance, such as 1mm. By default each frame is a key");
  command.add_flag_function(
      "--bones,!--no-bones", [&options](std::int64_t sign) { options.bones = sign > 0; },
      "glTF: add a thin mesh for each bone, so that viewers display the skeleton (default; "
      "--no-bones: joints only)");
  options.given = [&command](const char* option) { return command.count(option) > 0; };
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of("krok-export", options, declare, check, run);
  spec.summary = "Exports a motion as BVH, glTF, arrays of numpy or tables (CSV, OpenSim)";
  spec.details = "Tables have positions, angles, velocities, contacts and others.";
  spec.inputs = "IN...";
  spec.examples = {
      {"krok-export walk.anim -o walk.glb", "the animated skeleton, for any glTF viewer"},
      {"krok-export walk.anim -o walk.csv",
       "frame,time,joint,x,y,z: one row per frame and joint, in metres"},
      {"krok-export walk.anim --what angles --layout wide -o angles.csv",
       "frame,time,hip_flexion_l,...: one row per frame, in degrees"},
      {"krok-export motions --what angles -o all.csv",
       "of all motions of a folder: file,frame,time,angle,degrees"},
      {"krok-export walk.anim -o walk.npz",
       "positions, quaternions, names, parents and contacts for numpy.load"},
      {"krok-export walk.anim -o walk.mot", "the same angles for OpenSim"},
      {"krok-export capture.bvh -o capture.glb",
       "directly from a capture; -v prints the detected conventions"},
      {"krok-export walk.anim --format csv -o - | head", "the first rows"}};
  spec.default_output = [options] {
    const auto ending = extension_of(options->format);
    return ending && options->inputs.size() == 1 ? beside(options->input(), *ending)
                                                 : std::string();
  };
  spec.folder_endings = io::motion_endings();
  spec.each_animation = [options](const std::string& output) {
    const auto format = format_of(*options, output);
    return format && *format == ExportFormat::csv;
  };
  spec.batch = {io::motion_endings(), [options] { return extension_of(options->format); }};
  return spec;
}

}  // namespace krok::cli::exporting
