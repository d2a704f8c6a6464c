#include "tools/krok-export/export.h"

#include <fmt/format.h>

#include <optional>

#include "capture/conventions.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/bvh/bvh_writer.h"
#include "formats/csv/csv_writer.h"
#include "formats/gltf/gltf_writer.h"
#include "skin/bone_mesh.h"
#include "tools/common/motion_input.h"

namespace krok {

namespace {

Result<ExportFormat> format_of(const ExportOptions& options, const std::string& output) {
  if (options.format != ExportFormat::from_extension) return options.format;
  const std::string end = extension(output);
  if (end == ".bvh") return ExportFormat::bvh;
  if (end == ".glb") return ExportFormat::glb;
  if (end == ".gltf") return ExportFormat::gltf;
  if (end == ".csv") return ExportFormat::csv;
  return Error("export-format",
               end.empty() ? fmt::format("{} has no extension to tell the format by", output)
                           : fmt::format("no format has the extension {}", end),
               "known are .bvh, .glb, .gltf and .csv; or say --format bvh, glb, gltf or csv")
      .in_file(output);
}

// "ZXY", in any case; the option's check has seen it.
EulerOrder order_of(const std::string& letters) {
  EulerOrder order{};
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i] = static_cast<Axis>(ascii_lower(letters.at(i)) - 'x');
  }
  return order;
}

Status write_as(ExportFormat format, const Clip& clip, const ExportOptions& options,
                double unit_metres, OutputFile& file) {
  if (format == ExportFormat::bvh) {
    bvh::WriteOptions writing;
    writing.unit_metres = unit_metres;
    if (options.digits) writing.decimals = *options.digits;
    if (!options.order.empty()) writing.order = order_of(options.order);
    return bvh::write(clip, writing, file);
  }
  return csv::write(clip, file);
}

Result<double> unit_of(const ExportOptions& options, ExportFormat format) {
  if (options.unit.empty()) return bvh::WriteOptions().unit_metres;
  if (format != ExportFormat::bvh) {
    return Error("export-unit", "--unit is for BVH; the other formats hold metres");
  }
  const auto unit = parse_unit(options.unit);
  if (!unit) return Error("usage", "--unit: " + unit.error().message, unit.error().hint);
  return unit->metres;
}

MotionFacts facts_of(const Clip& clip) {
  return {clip.skeleton, clip.rate, clip.frame_count(), clip.duration(), {}};
}

Error empty_error(const std::string& path) {
  return Error("export-empty", "the motion has no joints").in_file(path);
}

// Reads the motion, writes it, and tells what it was.
Result<MotionFacts> export_gltf(bool binary, const ExportOptions& options, ToolContext& context,
                                OutputFile& file) {
  std::optional<gltf::JointTracks> tracks;
  const auto facts = use_motion(options.input, context, [&](const FrameSource& frames) -> Status {
    if (frames.skeleton.empty()) return empty_error(options.input);
    auto made = gltf::joint_tracks(frames.skeleton, frames, context.jobs);
    if (!made) return made.error();
    tracks = *std::move(made);
    return {};
  });
  if (!facts) return facts.error();
  gltf::WriteOptions writing;
  writing.binary = binary;
  writing.provenance = context.provenance();
  writing.provenance.conversions = facts->conversions;
  const bool bones = options.bones.value_or(true);
  writing.name = bones ? "bones" : "skeleton";
  const Status written = bones ? gltf::write_rig(bone_mesh(facts->skeleton), *tracks, writing, file)
                               : gltf::write_skeleton(facts->skeleton, *tracks, writing, file);
  if (!written) return Error(written.error()).in_file(context.output);
  return facts;
}

Result<MotionFacts> export_others(ExportFormat format, const ExportOptions& options,
                                  double unit_metres, ToolContext& context, OutputFile& file) {
  const auto clip = read_motion(options.input, context);
  if (!clip) return clip.error();
  if (clip->skeleton.empty()) return empty_error(options.input);
  const Status written = write_as(format, *clip, options, unit_metres, file);
  if (!written) return Error(written.error()).in_file(context.output);
  return facts_of(*clip);
}

Json result_of(const MotionFacts& motion) {
  Json result;
  result["joints"] = motion.skeleton.joint_count();
  result["frames"] = motion.frame_count;
  result["rate"] = motion.rate;
  result["duration"] = motion.duration;
  return result;
}

}  // namespace

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
    case ExportFormat::from_extension:
      break;
  }
  return Error("usage", "no format is given for the results", "say --format bvh, glb, gltf or csv");
}

Result<int> run_export(const ExportOptions& options, ToolContext& context) {
  const auto format = format_of(options, context.output);
  if (!format) return format.error();
  const auto unit_metres = unit_of(options, *format);
  if (!unit_metres) return unit_metres.error();
  if (*format != ExportFormat::bvh && (options.digits || !options.order.empty())) {
    return Error("usage", "--digits and --order are for BVH");
  }
  if (options.bones && *format != ExportFormat::glb && *format != ExportFormat::gltf) {
    return Error("usage", "--bones and --no-bones are for glTF");
  }
  auto file = OutputFile::create(context.output, context.output_options());
  if (!file) return file.error();
  const bool is_glb = *format == ExportFormat::glb;
  const auto motion = is_glb || *format == ExportFormat::gltf
                          ? export_gltf(is_glb, options, context, *file)
                          : export_others(*format, options, *unit_metres, context, *file);
  if (!motion) return motion.error();
  if (Status done = file->commit(); !done) return done.error();
  context.wrote(context.output);
  context.report.result = result_of(*motion);
  context.say(fmt::format("{}: {}, {}, {} s", context.output,
                          counted(motion->skeleton.joint_count(), "joint"),
                          counted(motion->frame_count, "frame"), readable(motion->duration, 3)));
  return kExitDone;
}

}  // namespace krok
