#include "tools/krok-export/options.h"

#include <fmt/format.h>

#include <memory>

#include "capture/conventions.h"
#include "core/quantity.h"
#include "formats/bvh/bvh_writer.h"
#include "formats/io/formats.h"
#include "tools/cli/one_of.h"
#include "tools/cli/option_kinds.h"
#include "tools/krok-export/run.h"
#include "tools/shared/role_input.h"

namespace krok::cli::exporting {

namespace {

Result<std::string> extension_of(ExportFormat format) {
  switch (format) {
    case ExportFormat::bvh:
      return std::string(".bvh");
    case ExportFormat::glb:
      return std::string(".glb");
    case ExportFormat::gltf:
      return std::string(".gltf");
    case ExportFormat::csv:
      return std::string(".csv");
    case ExportFormat::mot:
      return std::string(".mot");
    case ExportFormat::sto:
      return std::string(".sto");
    case ExportFormat::from_extension:
      break;
  }
  return Error("usage", "no output format given", "use --format bvh, glb, gltf, csv, mot or sto");
}

Status check(const Options& options) {
  // Without a format, the output's extension determines it.
  if (options.format == ExportFormat::from_extension) return {};
  return check_for(options.format, options);
}

}  // namespace

Result<double> unit_of(const Options& options, ExportFormat format) {
  if (options.unit.empty()) return bvh::WriteOptions().unit_metres;
  if (format != ExportFormat::bvh) {
    return Error("export-unit", "--unit is for BVH; the other formats are in metres");
  }
  const auto unit = parse_unit(options.unit);
  if (!unit) return Error("usage", "--unit: " + unit.error().message, unit.error().hint);
  return unit->metres;
}

Result<double> reduce_tolerance(const Options& options) {
  const auto tolerance = parse_length_with_unit(options.reduce);
  if (!tolerance)
    return Error("usage", "--reduce: " + tolerance.error().message, tolerance.error().hint);
  if (!(*tolerance > 0)) {
    return Error("usage", fmt::format("--reduce: {} is not a positive length", options.reduce),
                 "for example --reduce 1mm; without --reduce, all keys are kept");
  }
  return *tolerance;
}

// Checks that the options apply to this format.
Status check_for(ExportFormat format, const Options& options) {
  if (const auto unit = unit_of(options, format); !unit) return unit.error();
  const bool for_bvh = options.digits || !options.order.empty() || options.root_offset;
  if (format != ExportFormat::bvh && for_bvh) {
    return Error("usage", "--digits, --order and --root-offset are for BVH");
  }
  const bool opensim = format == ExportFormat::mot || format == ExportFormat::sto;
  if ((options.what != What::automatic || !options.map.empty()) && format != ExportFormat::csv &&
      !opensim) {
    return Error("usage", "--what and --map are for tables: .csv, .mot and .sto");
  }
  if (options.layout != Layout::automatic && format != ExportFormat::csv) {
    return Error("usage",
                 opensim ? "--layout is for CSV; OpenSim's files are wide" : "--layout is for CSV");
  }
  if (options.bones && format != ExportFormat::glb && format != ExportFormat::gltf) {
    return Error("usage", "--bones and --no-bones are for glTF");
  }
  if (!options.reduce.empty()) {
    if (format != ExportFormat::glb && format != ExportFormat::gltf) {
      return Error("usage", "--reduce is for glTF; the other formats store every frame");
    }
    if (const auto tolerance = reduce_tolerance(options); !tolerance) return tolerance.error();
  }
  return {};
}

namespace {

void declare(CommandOptions& command, Options& options) {
  command
      .add_option("input IN", options.input,
                  "Motion: a .anim file, or a capture (BVH; AMC with its ASF beside it), read as "
                  "by krok-import without options")
      .required();
  command
      .add_option(
          "--format FORMAT", options.format,
          "bvh, glb, gltf (text, embedded data), csv, or OpenSim's mot or sto; default: the "
          "output's extension")
      .transform(one_of<ExportFormat>({{"bvh", ExportFormat::bvh},
                                       {"glb", ExportFormat::glb},
                                       {"gltf", ExportFormat::gltf},
                                       {"csv", ExportFormat::csv},
                                       {"mot", ExportFormat::mot},
                                       {"sto", ExportFormat::sto}}));
  command
      .add_option("--what SERIES", options.what,
                  "Tables: positions (world, m), velocities (world, m/s), quaternions (world: qx, "
                  "qy, qz, qw), local (position in m and quaternion relative to the parent), "
                  "angles (of hips, knees, ankles, shoulders, elbows in degrees, those that "
                  "krok-plot draws, see docs/angles.md) or contacts (of the feet, from "
                  "NAME.keys.json or detected); default: positions, angles for mot and sto")
      .transform(one_of<What>({{"positions", What::positions},
                               {"local", What::local},
                               {"angles", What::angles},
                               {"quaternions", What::quaternions},
                               {"velocities", What::velocities},
                               {"contacts", What::contacts}}));
  command
      .add_option(
          "--layout LAYOUT", options.layout,
          "CSV: long, a row for each frame and joint (contacts: a row for each), or wide, a "
          "row for each frame")
      .transform(one_of<Layout>({{"long", Layout::long_rows}, {"wide", Layout::wide}}))
      .default_str("long");
  add_map_option(command, options.map);
  command.add_option("--unit UNIT", options.unit, "BVH: length unit: m, cm, mm, in, ft")
      .default_str("cm");
  add_whole(command, "--digits 1..15", options.digits,
            "BVH: decimal places of angles in degrees and lengths in centimetres; adjusted to the "
            "same precision for other units. With 6, joints come back within a few micrometres, "
            "as far as floats hold them; more than 8 print their rounding",
            1, 15)
      .default_str("6");
  command
      .add_option("--order ORDER", options.order,
                  "BVH: order of the rotation channels: XYZ, XZY, YXZ, YZX, ZXY or ZYX")
      .transform(one_of_words({"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"}))
      .default_str("ZXY");
  command.add_flag("--root-offset", options.root_offset,
                   "BVH: write the root's place in the reference pose as its OFFSET, as most "
                   "programs do. By default it is 0, since programs that add positions to OFFSETs, "
                   "such as three.js, would show the character at twice its height");
  command.add_option("--reduce LENGTH", options.reduce,
                     "glTF: reduce keys for a smaller file; joints, and points 3 cm around them, "
                     "move by at most this distance, such as 1mm. By default each frame is a key");
  command.add_flag_function(
      "--bones,!--no-bones", [&options](std::int64_t sign) { options.bones = sign > 0; },
      "glTF: add a thin mesh for each bone, so that viewers display the skeleton (default; "
      "--no-bones: joints only)");
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of("krok-export", options, declare, check, run);
  spec.summary = "Exports a motion as BVH, glTF or tables (CSV, OpenSim)";
  spec.details = "Tables have positions, angles, velocities, contacts and others.";
  spec.inputs = "IN";
  spec.examples = {
      {"krok-export walk.anim -o walk.glb", "the animated skeleton, for any glTF viewer"},
      {"krok-export walk.anim -o walk.csv",
       "frame,time,joint,x,y,z: one row per frame and joint, in metres"},
      {"krok-export walk.anim --what angles --layout wide -o angles.csv",
       "frame,time,hip_flexion_l,...: one row per frame, in degrees"},
      {"krok-export walk.anim -o walk.mot", "the same angles for OpenSim"},
      {"krok-export capture.bvh -o capture.glb",
       "directly from a capture; -v prints the detected conventions"},
      {"krok-export walk.anim --format csv -o - | head", "the first rows"}};
  spec.batch = {io::motion_endings(), [options] { return extension_of(options->format); }};
  return spec;
}

}  // namespace krok::cli::exporting
