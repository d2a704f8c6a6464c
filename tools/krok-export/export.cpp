#include "tools/krok-export/export.h"

#include <fmt/format.h>

#include "capture/conventions.h"
#include "core/numbers.h"
#include "formats/anim/anim.h"
#include "formats/bvh/bvh_writer.h"
#include "formats/csv/csv_writer.h"
#include "formats/gltf/gltf_writer.h"
#include "skin/bone_mesh.h"

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

Status write_gltf(const Clip& clip, bool binary, const ExportOptions& options,
                  const ToolContext& context, OutputFile& file) {
  gltf::WriteOptions writing;
  writing.binary = binary;
  writing.provenance = context.provenance();
  writing.name = "skeleton";
  if (!options.bones.value_or(true)) return gltf::write_skeleton(clip, writing, file);
  writing.name = "bones";
  return gltf::write_rig(bone_mesh(clip.skeleton), clip, writing, file);
}

Status write_as(ExportFormat format, const Clip& clip, const ExportOptions& options,
                double unit_metres, const ToolContext& context, OutputFile& file) {
  if (format == ExportFormat::bvh) {
    bvh::WriteOptions writing;
    writing.unit_metres = unit_metres;
    return bvh::write(clip, writing, file);
  }
  if (format == ExportFormat::csv) return csv::write(clip, file);
  return write_gltf(clip, format == ExportFormat::glb, options, context, file);
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

Json result_of(const Clip& clip) {
  Json result;
  result["joints"] = clip.joint_count();
  result["frames"] = clip.frame_count();
  result["rate"] = clip.rate;
  result["duration"] = clip.duration();
  return result;
}

}  // namespace

Result<int> run_export(const ExportOptions& options, ToolContext& context) {
  const auto format = format_of(options, context.output);
  if (!format) return format.error();
  const auto unit_metres = unit_of(options, *format);
  if (!unit_metres) return unit_metres.error();
  if (options.bones && *format != ExportFormat::glb && *format != ExportFormat::gltf) {
    return Error("usage", "--bones and --no-bones are for glTF");
  }
  const auto input = context.open_input(options.input);
  if (!input) return input.error();
  auto clip = anim::read(input->bytes());
  if (!clip) return std::move(clip.error()).in_file(options.input);
  if (clip->skeleton.empty()) {
    return Error("export-empty", "the motion has no joints").in_file(options.input);
  }

  auto file = OutputFile::create(context.output, context.output_options());
  if (!file) return file.error();
  if (Status written = write_as(*format, *clip, options, *unit_metres, context, *file); !written) {
    return std::move(written.error()).in_file(context.output);
  }
  if (Status done = file->commit(); !done) return done.error();
  context.wrote(context.output);
  context.report.result = result_of(*clip);
  context.say(fmt::format("{}: {}, {}, {} s", context.output, counted(clip->joint_count(), "joint"),
                          counted(clip->frame_count(), "frame"), readable(clip->duration(), 3)));
  return kExitDone;
}

}  // namespace krok
