#include "tools/krok-export/run.h"

#include <fmt/format.h>

#include <optional>

#include "capture/conventions.h"
#include "core/numbers.h"
#include "core/quantity.h"
#include "core/text.h"
#include "formats/bvh/bvh_writer.h"
#include "formats/csv/csv_writer.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/gltf/reduce_tracks.h"
#include "formats/io/open_motion.h"
#include "formats/io/open_role_map.h"
#include "formats/opensim/storage_writer.h"
#include "skin/bone_mesh.h"
#include "tools/cli/file_name.h"
#include "tools/cli/output_set.h"
#include "tools/krok-export/series.h"
#include "tools/shared/keys_choice.h"

namespace krok::cli::exporting {

namespace {

Result<ExportFormat> format_of(const Options& options, const std::string& output) {
  if (options.format != ExportFormat::from_extension) return options.format;
  const std::string end = extension(output);
  if (end == ".bvh") return ExportFormat::bvh;
  if (end == ".glb") return ExportFormat::glb;
  if (end == ".gltf") return ExportFormat::gltf;
  if (end == ".csv") return ExportFormat::csv;
  if (end == ".mot") return ExportFormat::mot;
  if (end == ".sto") return ExportFormat::sto;
  return Error("export-format",
               end.empty() ? fmt::format("{} has no extension; cannot determine the format", output)
                           : fmt::format("unknown extension {}", end),
               "use .bvh, .glb, .gltf, .csv, .mot or .sto; or --format")
      .in_file(output);
}

// "ZXY", in any case; validated by the option's check.
EulerOrder order_of(const std::string& letters) {
  EulerOrder order{};
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i] = static_cast<Axis>(ascii_lower(letters.at(i)) - 'x');
  }
  return order;
}

Status write_bvh(const Clip& clip, const Options& options, double unit_metres, OutputFile& file) {
  bvh::WriteOptions writing;
  writing.unit_metres = unit_metres;
  writing.root_offset = options.root_offset;
  if (options.digits) writing.decimals = *options.digits;
  if (!options.order.empty()) writing.order = order_of(options.order);
  return bvh::write(clip, writing, file);
}

io::MotionSummary facts_of(const Clip& clip) {
  return {clip.skeleton, clip.rate, clip.frame_count(), clip.duration(), {}};
}

Error empty_error(const std::string& path) {
  return Error("export-empty", "the motion has no joints").in_file(path);
}

// Reduces keys if requested.
Result<std::optional<Reduction>> reduce(const Options& options, const Skeleton& skeleton, int jobs,
                                        gltf::JointTracks& tracks) {
  if (options.reduce.empty()) return std::optional<Reduction>();
  const auto tolerance = reduce_tolerance(options);
  if (!tolerance) return tolerance.error();
  auto reduction = gltf::reduce_tracks(skeleton, {.tolerance = *tolerance}, jobs, tracks);
  if (!reduction) return reduction.error();
  return std::optional(*std::move(reduction));
}

Result<gltf::JointTracks> stretched_tracks(const FrameSource& frames, const Stretches& stretches,
                                           ToolContext& context) {
  const auto clip = load(frames, context.jobs);
  if (!clip) return clip.error();
  double largest_error = 0;
  auto tracks = gltf::joint_tracks(frames.skeleton, *clip, stretches, largest_error);
  if (tracks && largest_error > 2e-4) {
    context.warn("export-stretch",
                 fmt::format("joints below one that is flattened stand apart from it, which nodes "
                             "cannot have: they are up to {} mm off",
                             readable(1e3 * largest_error, 3)));
  }
  return tracks;
}

// Reads the motion, writes it, and returns its summary.
Result<io::MotionSummary> export_gltf(bool binary, const Options& options, ToolContext& context,
                                      std::optional<Reduction>& reduction) {
  std::optional<gltf::JointTracks> tracks;
  Stretches stretches;
  const auto facts = io::stream_motion(
      options.input, context,
      [&](const FrameSource& frames) -> Status {
        if (frames.skeleton.empty()) return empty_error(options.input);
        auto made = stretches.empty() ? gltf::joint_tracks(frames.skeleton, frames, context.jobs)
                                      : stretched_tracks(frames, stretches, context);
        if (!made) return made.error();
        tracks = *std::move(made);
        return {};
      },
      {.stretches = &stretches});
  if (!facts) return facts.error();
  auto reduced = reduce(options, facts->skeleton, context.jobs, *tracks);
  if (!reduced) return reduced.error();
  reduction = *std::move(reduced);
  gltf::WriteOptions writing;
  writing.binary = binary;
  writing.provenance = context.provenance();
  writing.provenance.conversions = facts->conversions;
  const bool bones = options.bones.value_or(true);
  writing.name = bones ? "bones" : "skeleton";
  writing.clip_name = clip_name_of(options.input);
  const Status status = write_output(context, context.output, [&](OutputFile& file) {
    return bones ? gltf::write_rig(bone_mesh(facts->skeleton), *tracks, writing, file)
                 : gltf::write_skeleton(facts->skeleton, *tracks, writing, file);
  });
  if (!status) return status.error();
  return facts;
}

// The contacts of the motion's sidecar, or as krok-keys detects them.
Result<std::vector<Contact>> contacts_of(const Options& options, const Clip& clip,
                                         ToolContext& context) {
  const auto find_roles = io::open_role_map(options.map, context);
  if (!find_roles) return find_roles.error();
  auto keys = choose_keys(KeysChoice::automatic, options.input, name_of_input(options.input), clip,
                          *find_roles, context);
  if (!keys) return keys.error();
  return *keys ? std::move((*keys)->contacts) : std::vector<Contact>();
}

Result<csv::SeriesTable> series_of(What what, ExportFormat format, const Options& options,
                                   const Clip& clip, ToolContext& context) {
  if (what == What::contacts) {
    const auto contacts = contacts_of(options, clip, context);
    if (!contacts) return contacts.error();
    return contact_series(clip, *contacts);
  }
  if (what != What::angles) return joint_series(clip, what);
  const auto find_roles = io::open_role_map(options.map, context);
  if (!find_roles) return find_roles.error();
  const auto roles = (*find_roles)(clip.skeleton);
  if (!roles) return roles.error();
  auto table = angle_series(clip, *roles, format != ExportFormat::csv);
  if (!table) return std::move(table.error()).in_file(options.input);
  return table;
}

// Tables. Without --what, CSV has positions and OpenSim's files have angles.
Status write_table(ExportFormat format, const Clip& clip, const Options& options,
                   ToolContext& context) {
  const bool opensim = format != ExportFormat::csv;
  const What usual = opensim ? What::angles : What::positions;
  const What what = options.what == What::automatic ? usual : options.what;
  const Layout layout = options.layout == Layout::wide ? Layout::wide : Layout::long_rows;
  if (!opensim && what == What::contacts && layout == Layout::long_rows) {
    const auto contacts = contacts_of(options, clip, context);
    if (!contacts) return contacts.error();
    return write_output(context, context.output, [&](OutputFile& file) {
      return csv::write(*contacts, clip.skeleton.names, file);
    });
  }
  if (!opensim && what == What::positions && layout == Layout::long_rows) {
    return write_output(context, context.output,
                        [&](OutputFile& file) { return csv::write(clip, file); });
  }
  const bool is_angle = what == What::angles || what == What::local;
  const auto table = series_of(what, format, options, clip, context);
  if (!table) return table.error();
  context.report.result["columns"] = table->items;
  return write_output(context, context.output, [&](OutputFile& file) {
    if (opensim) return opensim::write(*table, clip_name_of(options.input), is_angle, file);
    return layout == Layout::wide ? csv::write_wide(*table, file) : csv::write_long(*table, file);
  });
}

Result<io::MotionSummary> export_others(ExportFormat format, const Options& options,
                                        double unit_metres, ToolContext& context) {
  const auto clip = io::open_motion(options.input, context);
  if (!clip) return clip.error();
  if (clip->skeleton.empty()) return empty_error(options.input);
  const Status status = format == ExportFormat::bvh
                            ? write_output(context, context.output,
                                           [&](OutputFile& file) {
                                             return write_bvh(*clip, options, unit_metres, file);
                                           })
                            : write_table(format, *clip, options, context);
  if (!status) return status.error();
  return facts_of(*clip);
}

Json result_of(const io::MotionSummary& motion, const std::optional<Reduction>& reduction) {
  Json result;
  result["joints"] = motion.skeleton.joint_count();
  result["frames"] = motion.frame_count;
  result["rate"] = motion.rate;
  result["duration"] = motion.duration;
  if (reduction) {
    result["keys"] = reduction->keys_after;
    result["keys_before"] = reduction->keys_before;
    result["largest_error"] = reduction->largest_error;
  }
  return result;
}

std::string words_for(const Reduction& reduction) {
  return fmt::format(", {} of {}, max error {} mm",
                     grouped(static_cast<long long>(reduction.keys_after)),
                     counted(static_cast<long long>(reduction.keys_before), "key"),
                     readable(1e3 * reduction.largest_error, 3));
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  const auto format = format_of(options, context.output);
  if (!format) return format.error();
  if (Status status = check_for(*format, options); !status) return status.error();
  const auto unit_metres = unit_of(options, *format);
  if (!unit_metres) return unit_metres.error();
  const bool is_glb = *format == ExportFormat::glb;
  std::optional<Reduction> reduction;
  const auto motion = is_glb || *format == ExportFormat::gltf
                          ? export_gltf(is_glb, options, context, reduction)
                          : export_others(*format, options, *unit_metres, context);
  if (!motion) return motion.error();
  Json columns = std::move(context.report.result["columns"]);
  context.report.result = result_of(*motion, reduction);
  if (!columns.is_null()) context.report.result["columns"] = std::move(columns);
  context.log(fmt::format("{}: {}, {}, {} s{}", context.output,
                          counted(motion->skeleton.joint_count(), "joint"),
                          counted(motion->frame_count, "frame"), readable(motion->duration, 4),
                          reduction ? words_for(*reduction) : ""));
  return kExitDone;
}

}  // namespace krok::cli::exporting
