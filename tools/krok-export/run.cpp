#include "tools/krok-export/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>

#include "capture/conventions.h"
#include "contacts/long_take.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "core/quantity.h"
#include "core/result.h"
#include "core/text.h"
#include "draw/joint_angles.h"
#include "formats/bvh/bvh_writer.h"
#include "formats/csv/csv_writer.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/gltf/joint_tracks.h"
#include "formats/io/open_motion.h"
#include "formats/npy/npz_motion.h"
#include "formats/opensim/storage_writer.h"
#include "math/quaternion.h"
#include "motion/local_motion.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"
#include "skin/bind.h"
#include "tools/cli/file_name.h"
#include "tools/cli/output_set.h"
#include "tools/shared/keys_sidecar.h"

namespace krok::cli::exporting {

namespace {

csv::SeriesTable table_of(const Clip& clip, std::string item_name, std::vector<std::string> items,
                          std::vector<std::string> quantities) {
  csv::SeriesTable table;
  table.rate = clip.rate;
  table.frames = clip.frame_count();
  table.item_name = std::move(item_name);
  table.items = std::move(items);
  table.quantities = std::move(quantities);
  table.values.reserve(static_cast<std::size_t>(table.frames) * table.columns());
  return table;
}

void add(const Vec3f& vector, csv::SeriesTable& table) {
  table.values.insert(table.values.end(), vector.data(), vector.data() + 3);
}

// In the hemisphere of the one before, of a joint; the first with w >= 0.
void add(Quat orientation, Quat& before, csv::SeriesTable& table) {
  const bool first = before.coeffs().isZero(0);
  if (first ? orientation.w() < 0 : before.dot(orientation) < 0) orientation.coeffs() *= -1;
  before = orientation;
  for (int k = 0; k < 4; ++k) {
    table.values.push_back(static_cast<float>(orientation.coeffs()[k]));
  }
}

std::vector<Quat> none_before(const Clip& clip) {
  return std::vector<Quat>(static_cast<std::size_t>(clip.joint_count()), Quat(0, 0, 0, 0));
}

void add_velocities(const Clip& clip, csv::SeriesTable& table) {
  const int last = clip.frame_count() - 1;
  for (int f = 0; f <= last; ++f) {
    const int before = std::max(f - 1, 0), after = std::min(f + 1, last);
    const auto from = clip.frame_positions(before), to = clip.frame_positions(after);
    const double per_second = after > before ? clip.rate / (after - before) : 0;
    for (std::size_t j = 0; j < from.size(); ++j) {
      const Vec3 way = to[j].cast<double>() - from[j].cast<double>();
      add(Vec3f((per_second * way).cast<float>()), table);
    }
  }
}

void add_locals(const Clip& clip, csv::SeriesTable& table) {
  const LocalMotion local = local_motion(clip);
  std::vector<Quat> before = none_before(clip);
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (int j = 0; j < clip.joint_count(); ++j) {
      const Transform at = local.at(j, f);
      add(Vec3f(at.position.cast<float>()), table);
      add(normalized_or_identity(at.orientation), before[static_cast<std::size_t>(j)], table);
    }
  }
}

struct AngleName {
  draw::BodyAngle angle;
  const char* name;
  const char* coordinate;  // of OpenSim
};
constexpr std::array kAngles = {
    AngleName{draw::BodyAngle::hip, "hip_flexion", "hip_flexion"},
    AngleName{draw::BodyAngle::knee, "knee_flexion", "knee_angle"},
    AngleName{draw::BodyAngle::ankle, "ankle_dorsiflexion", "ankle_angle"},
    AngleName{draw::BodyAngle::shoulder, "shoulder_elevation", "shoulder_elevation"},
    AngleName{draw::BodyAngle::elbow, "elbow_flexion", "elbow_flex"}};

// positions, velocities: world, metres and metres per second. local: position and orientation
// relative to the parent. quaternions: world orientations. Velocities are central differences,
// one-sided at both ends.
csv::SeriesTable joint_series(const Clip& clip, What what) {
  const auto make = [&](std::vector<std::string> quantities) {
    return table_of(clip, "joint", clip.skeleton.names, std::move(quantities));
  };
  csv::SeriesTable table;
  switch (what) {
    case What::velocities:
      table = make({"vx", "vy", "vz"});
      add_velocities(clip, table);
      break;
    case What::local:
      table = make({"x", "y", "z", "qx", "qy", "qz", "qw"});
      add_locals(clip, table);
      break;
    case What::quaternions: {
      table = make({"qx", "qy", "qz", "qw"});
      std::vector<Quat> before = none_before(clip);
      for (int f = 0; f < clip.frame_count(); ++f) {
        const auto orientations = clip.frame_orientations(f);
        for (std::size_t j = 0; j < orientations.size(); ++j) {
          add(normalized_or_identity(orientations[j].cast<double>()), before[j], table);
        }
      }
      break;
    }
    case What::automatic:
    case What::positions:
    case What::angles:
    case What::contacts:
      table = make({"x", "y", "z"});
      for (int f = 0; f < clip.frame_count(); ++f) {
        for (const Vec3f& place : clip.frame_positions(f)) add(place, table);
      }
      break;
  }
  return table;
}

// Anatomical angles in degrees, as krok-plot draws them (draw::body_angle). With `coordinates` the
// names are those of OpenSim's full-body models where they have the angle: hip_flexion_r,
// knee_angle_r, ankle_angle_r, elbow_flex_r. Code export-angles if the skeleton has none.
Result<csv::SeriesTable> angle_series(const Clip& clip, const RoleMap& roles, bool coordinates) {
  if (clip.frame_count() == 0) return Error("export-angles", "the motion has no frames");
  std::vector<std::string> names;
  std::vector<std::vector<double>> series;
  const draw::FrameRange frames{0, clip.frame_count() - 1};
  for (const AngleName& angle : kAngles) {
    for (const Side side : {Side::left, Side::right}) {
      auto values = draw::body_angle(clip, roles, angle.angle, side, frames);
      if (values.empty()) continue;
      names.push_back(fmt::format("{}_{}", coordinates ? angle.coordinate : angle.name,
                                  side == Side::left ? "l" : "r"));
      series.push_back(std::move(values));
    }
  }
  if (names.empty()) {
    return Error("export-angles", "the skeleton has no joints with roles for body angles",
                 "--map assigns joint roles; --what local has the rotations of all joints");
  }
  csv::SeriesTable table = table_of(clip, "angle", std::move(names), {"degrees"});
  for (std::size_t f = 0; f < static_cast<std::size_t>(table.frames); ++f) {
    for (const auto& values : series) table.values.push_back(static_cast<float>(values[f]));
  }
  return table;
}

// 1 for each joint in contact in a frame.
csv::SeriesTable contact_series(const Clip& clip, std::span<const Contact> contacts) {
  std::set<int> touching;
  for (const Contact& contact : contacts) touching.insert(contact.joint);
  std::vector<std::string> names;
  for (const int joint : touching) {
    names.push_back(clip.skeleton.names[static_cast<std::size_t>(joint)]);
  }
  csv::SeriesTable table = table_of(clip, "joint", std::move(names), {"contact"});
  table.values.assign(static_cast<std::size_t>(table.frames) * touching.size(), 0.0F);
  for (const Contact& contact : contacts) {
    const auto column = std::distance(touching.begin(), touching.find(contact.joint));
    for (int f = static_cast<int>(std::max(0.0, contact.start * clip.rate)); f < table.frames;
         ++f) {
      if (f / clip.rate > contact.end) break;
      if (f / clip.rate < contact.start) continue;
      table.values[static_cast<std::size_t>(f) * touching.size() +
                   static_cast<std::size_t>(column)] = 1;
    }
  }
  return table;
}

// "ZXY", in any case; validated by the option's check.
EulerOrder order_of(const std::string& letters) {
  EulerOrder order{};
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i] = static_cast<Axis>(ascii_lower(letters.at(i)) - 'x');
  }
  return order;
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
  if (!options.reduce) return std::optional<Reduction>();
  auto reduction = gltf::reduce_tracks(skeleton, {.tolerance = *options.reduce}, jobs, tracks);
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
      options.input(), context,
      [&](const FrameSource& frames) -> Status {
        if (frames.skeleton.empty()) return empty_error(options.input());
        auto made = stretches.empty() ? gltf::joint_tracks(frames.skeleton, frames, context.jobs)
                                      : stretched_tracks(frames, stretches, context);
        if (!made) return made.error();
        tracks = *std::move(made);
        return {};
      },
      {.stretches = &stretches});
  if (!facts) return facts.error();
  tracks->removed_root_motion = facts->removed_root_motion;
  auto reduced = reduce(options, facts->skeleton, context.jobs, *tracks);
  if (!reduced) return reduced.error();
  reduction = *std::move(reduced);
  gltf::WriteOptions writing;
  writing.binary = binary;
  writing.provenance = context.provenance();
  writing.provenance.conversions = facts->conversions;
  const bool bones = options.bones;
  writing.name = bones ? "bones" : "skeleton";
  writing.clip_name = clip_name_of(options.input());
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
  auto keys = choose_keys(KeysChoice::automatic, options.input(), name_of_input(options.input()),
                          clip, *find_roles, context);
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
  if (!table) return std::move(table.error()).in_file(options.input());
  return table;
}

// The table of a motion.
struct MotionTable {
  std::optional<std::vector<Contact>> contacts;  // a row for each, or
  csv::SeriesTable series;
  std::vector<std::string> joints;
};

// Without --what, CSV has positions and OpenSim's files have angles.
What what_of(ExportFormat format, const Options& options) {
  if (options.what != What::automatic) return options.what;
  return format == ExportFormat::csv ? What::positions : What::angles;
}

Result<MotionTable> read_table(ExportFormat format, const Clip& clip, const Options& options,
                               ToolContext& context) {
  const What what = what_of(format, options);
  MotionTable table;
  if (format == ExportFormat::csv && what == What::contacts &&
      options.layout == Layout::long_rows) {
    auto contacts = contacts_of(options, clip, context);
    if (!contacts) return contacts.error();
    table.contacts = *std::move(contacts);
    table.joints = clip.skeleton.names;
    return table;
  }
  auto series = series_of(what, format, options, clip, context);
  if (!series) return series.error();
  table.series = *std::move(series);
  return table;
}

Status write_rows(const MotionTable& table, Layout layout, const csv::FileColumn& motion,
                  OutputFile& file) {
  if (table.contacts) return csv::write(*table.contacts, table.joints, motion, file);
  return layout == Layout::wide ? csv::write_wide(table.series, motion, file)
                                : csv::write_long(table.series, motion, file);
}

Status write_table(ExportFormat format, const Clip& clip, const Options& options,
                   ToolContext& context) {
  const auto table = read_table(format, clip, options, context);
  if (!table) return table.error();
  if (!table->contacts) context.report.result["columns"] = table->series.items;
  return write_output(context, context.output, [&](OutputFile& file) {
    if (format == ExportFormat::csv) return write_rows(*table, options.layout, {}, file);
    const What what = what_of(format, options);
    return opensim::write(table->series, clip_name_of(options.input()),
                          what == What::angles || what == What::local, file);
  });
}

// One table of all motions, in their order. Motions that cannot be read are reported and left out.
Result<int> export_table_of_all(const Options& options, ToolContext& context) {
  std::size_t motions = 0;
  std::vector<std::string> columns;  // of the wide layout
  OutputSet outputs(context);
  context.progress->begin("exporting", options.inputs.size());
  const Status status = outputs.add(context.output, [&](OutputFile& file) -> Status {
    for (const std::string& path : options.inputs) {
      Options one = options;
      one.inputs = {path};
      const auto table = [&]() -> Result<MotionTable> {
        const HiddenProgress hidden(context);
        const auto clip = io::open_motion(path, context);
        if (!clip) return clip.error();
        if (clip->skeleton.empty()) return empty_error(path);
        return read_table(ExportFormat::csv, *clip, one, context);
      }();
      context.progress->advance(1);
      if (!table) {
        Error error = table.error();
        if (error.where.file.empty()) error.where.file = path;
        context.diagnose(std::move(error));
        continue;
      }
      if (options.layout == Layout::wide) {
        if (motions == 0) columns = table->series.items;
        if (columns != table->series.items) {
          return Error("export-columns", "has other joints than the motions before it",
                       "--layout long has a row for each joint, whatever the skeleton")
              .in_file(path);
        }
      }
      Status written =
          write_rows(*table, options.layout, {.name = path, .with_header = motions == 0}, file);
      if (!written) return written;
      ++motions;
    }
    if (motions == 0) return Error("export-none", "none of the motions can be read");
    return {};
  });
  context.progress->end();
  if (!status) return status.error();
  if (Status put = outputs.finish(); !put) return put.error();
  context.report.result["motions"] = motions;
  context.log(fmt::format("{}: {} of {} motions", context.output, motions, options.inputs.size()));
  return motions == options.inputs.size() ? kExitDone : kExitPartly;
}

// The same of a long take, as krok-keys detects them in parts.
Result<std::vector<Contact>> contacts_in_parts(const Options& options, const FrameSource& frames,
                                               ToolContext& context) {
  auto keys = read_keys_beside(options.input(), frames, context);
  if (!keys) return keys.error();
  if (*keys) return std::move((*keys)->keys.contacts);
  const auto find_roles = io::open_role_map(options.map, context);
  if (!find_roles) return find_roles.error();
  const auto roles = (*find_roles)(frames.skeleton);
  if (!roles) return roles.error();
  auto take =
      find_in_long_take(frames, *roles, context.jobs, context.progress, {.contacts_alone = true});
  if (!take) return take.error();
  context.diagnose_in(options.input(), take->warnings);
  return std::move(take->keys.contacts);
}

// Arrays of numpy, with the contacts of the sidecar or those detected; none for a skeleton without
// legs. A long take is not held in memory.
Result<io::MotionSummary> export_npz(const Options& options, ToolContext& context) {
  const auto input = context.open_long_input(options.input());
  if (!input) return input.error();
  const io::ChecksumAtEnd checksum(*input, context);
  std::optional<OutputSet> outputs;
  const auto write = [&](const FrameSource& frames, Result<std::vector<Contact>> contacts) {
    if (!contacts && contacts.error().code != "contacts-feet") return Status(contacts.error());
    const auto found = contacts ? *std::move(contacts) : std::vector<Contact>();
    outputs.emplace(context);
    return outputs->add(context.output, [&](OutputFile& file) {
      return npy::write_motion(frames, found, thread_count(context.jobs), file);
    });
  };
  std::function<Provenance()> provenance;
  auto facts = io::stream_motion(
      *input, context,
      [&](const FrameSource& frames) -> Status {
        if (frames.skeleton.empty()) return empty_error(options.input());
        // Contacts of a motion in place are found in the motion as it travels.
        if (input->bytes().size() >= kLongTake && !provenance().removed_root_motion) {
          return write(frames, contacts_in_parts(options, frames, context));
        }
        auto clip = load(frames, context.jobs);
        if (!clip) return clip.error();
        clip->provenance = provenance();
        return write(frames_of(*clip), contacts_of(options, *clip, context));
      },
      {.provenance = &provenance});
  if (!facts) return facts;
  if (Status status = outputs->finish(); !status) return status.error();
  return facts;
}

// The place of the root at rest moves nothing, so it is left out, but another reference pose comes
// back.
void note_root(const Skeleton& skeleton, const Options& options, ToolContext& context) {
  const Vec3& root = skeleton.reference[0].position;
  if (options.root_offset || root.norm() < 1e-5) return;
  context.diagnose(make_diagnostic(
      Severity::note, "export-root-offset",
      fmt::format("the root's place in the reference pose, ({}, {}, {}) m, is left out",
                  readable(root.x(), 3), readable(root.y(), 3), readable(root.z(), 3)),
      "--root-offset keeps it as the root's OFFSET"));
}

// Writes frames as they are read; `note` is called with the skeleton before the output is kept.
Result<io::MotionSummary> export_frames(
    const Options& options, ToolContext& context,
    const std::function<Status(const FrameSource& frames, OutputFile& file)>& write,
    const std::function<void(const Skeleton& skeleton)>& note) {
  std::optional<OutputSet> outputs;
  auto facts =
      io::stream_motion(options.input(), context, [&](const FrameSource& frames) -> Status {
        if (frames.skeleton.empty()) return empty_error(options.input());
        outputs.emplace(context);
        return outputs->add(context.output, [&](OutputFile& file) { return write(frames, file); });
      });
  if (!facts) return facts;
  note(facts->skeleton);
  if (Status status = outputs->finish(); !status) return status.error();
  return facts;
}

Result<io::MotionSummary> export_bvh(const Options& options, ToolContext& context) {
  bvh::WriteOptions writing;
  writing.unit_metres = options.unit.metres;
  writing.root_offset = options.root_offset;
  writing.decimals = options.digits;
  writing.order = order_of(options.order);
  writing.jobs = context.jobs;
  return export_frames(
      options, context,
      [&](const FrameSource& frames, OutputFile& file) {
        return bvh::write(frames, writing, file);
      },
      [&](const Skeleton& skeleton) { note_root(skeleton, options, context); });
}

Result<io::MotionSummary> export_others(ExportFormat format, const Options& options,
                                        ToolContext& context) {
  const bool positions = options.what == What::automatic || options.what == What::positions;
  if (format == ExportFormat::csv && positions && options.layout == Layout::long_rows) {
    return export_frames(
        options, context,
        [](const FrameSource& frames, OutputFile& file) { return csv::write(frames, file); },
        [](const Skeleton&) {});
  }
  auto clip = io::open_motion(options.input(), context);
  if (!clip) return clip.error();
  if (clip->skeleton.empty()) return empty_error(options.input());
  io::MotionSummary facts = facts_of(*clip);
  if (Status status = write_table(format, *clip, options, context); !status) return status.error();
  return facts;
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
  return fmt::format(", {} of {}, max error {} mm", grouped(reduction.keys_after),
                     counted(reduction.keys_before, "key"),
                     readable(1e3 * reduction.largest_error, 3));
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  const auto format = format_of(options, context.output);
  if (!format) {
    // A file without a motion is the larger mistake.
    const auto motion = io::open_motion(options.input(), context);
    return motion ? format.error() : motion.error();
  }
  if (Status status = check_for(*format, options); !status) return status.error();
  if (options.inputs.size() > 1 || context.of_folder) {
    if (*format == ExportFormat::csv) return export_table_of_all(options, context);
    return usage("several motions are given for one file",
                 "-o OUT.csv is one table of all; --out-dir DIR writes a file of each; krok-skin "
                 "puts many clips into one .glb");
  }
  const bool is_glb = *format == ExportFormat::glb;
  std::optional<Reduction> reduction;
  const auto motion = is_glb || *format == ExportFormat::gltf
                          ? export_gltf(is_glb, options, context, reduction)
                      : *format == ExportFormat::bvh ? export_bvh(options, context)
                      : *format == ExportFormat::npz ? export_npz(options, context)
                                                     : export_others(*format, options, context);
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
