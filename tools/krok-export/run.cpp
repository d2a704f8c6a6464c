#include "tools/krok-export/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>

#include "capture/conventions.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/text.h"
#include "draw/joint_angles.h"
#include "formats/bvh/bvh_writer.h"
#include "formats/csv/csv_writer.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/gltf/joint_tracks.h"
#include "formats/io/formats.h"
#include "formats/io/open_character.h"
#include "formats/io/open_motion.h"
#include "formats/npy/npz_motion.h"
#include "formats/opensim/storage_writer.h"
#include "math/quaternion.h"
#include "retarget/stance.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "scene/motion_keys.h"
#include "skin/bind.h"
#include "tools/cli/output_set.h"
#include "tools/cli/paths.h"
#include "tools/cli/usage.h"
#include "tools/shared/keys_sidecar.h"

namespace krok::cli::exporting {

namespace {

using Values = std::vector<float>;

// Adds the values of a frame; frames come in order. The clip has the frames before and after, too,
// where there are any.
using AddFrame = std::function<void(const Clip& clip, int frame, Values& values)>;

// What `add` makes of each frame. The frames are read as the table is written.
csv::SeriesTable table_of(const FrameSource& frames, int jobs, std::string item_name,
                          std::vector<std::string> items, std::vector<std::string> quantities,
                          AddFrame add) {
  csv::SeriesTable table;
  table.rate = frames.rate;
  table.frames = frames.frame_count;
  table.item_name = std::move(item_name);
  table.items = std::move(items);
  table.quantities = std::move(quantities);
  table.values = [frames, jobs, add = std::move(add), columns = table.columns()](
                     int first, int count) -> Result<Values> {
    const int begin = std::max(first - 1, 0);
    const int end = std::min(first + count + 1, frames.frame_count);
    const auto clip = load(part_of(frames, begin, end - begin), jobs);
    if (!clip) return clip.error();
    if (frames.release) frames.release(first + count - 1);
    Values values;
    values.reserve(static_cast<std::size_t>(count) * columns);
    for (int f = 0; f < count; ++f) add(*clip, first + f - begin, values);
    return values;
  };
  return table;
}

void add(const Vec3f& vector, Values& values) {
  values.insert(values.end(), vector.data(), vector.data() + 3);
}

// In the hemisphere of the one before, of a joint; the first with w >= 0.
void add(Quat orientation, Quat& before, Values& values) {
  const bool first = before.coeffs().isZero(0);
  if (first ? orientation.w() < 0 : before.dot(orientation) < 0) orientation.coeffs() *= -1;
  before = orientation;
  for (int k = 0; k < 4; ++k) values.push_back(static_cast<float>(orientation.coeffs()[k]));
}

void add_velocities(const Clip& clip, int frame, Values& values) {
  const int before = std::max(frame - 1, 0), after = std::min(frame + 1, clip.frame_count() - 1);
  const auto from = clip.frame_positions(before), to = clip.frame_positions(after);
  const double per_second = after > before ? clip.rate / (after - before) : 0;
  for (std::size_t j = 0; j < from.size(); ++j) {
    const Vec3 way = to[j].cast<double>() - from[j].cast<double>();
    add(Vec3f((per_second * way).cast<float>()), values);
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
csv::SeriesTable joint_series(const FrameSource& frames, What what, int jobs) {
  const auto make = [&](std::vector<std::string> quantities, AddFrame add_frame) {
    return table_of(frames, jobs, "joint", frames.skeleton.names, std::move(quantities),
                    std::move(add_frame));
  };
  const std::size_t joints = frames.skeleton.names.size();
  const std::vector<Quat> none_before(joints, Quat(0, 0, 0, 0));
  switch (what) {
    case What::velocities:
      return make({"vx", "vy", "vz"}, add_velocities);
    case What::local:
      return make({"x", "y", "z", "qx", "qy", "qz", "qw"},
                  [before = none_before, world = std::vector<Transform>(joints),
                   local = std::vector<Transform>(joints)](const Clip& clip, int frame,
                                                           Values& values) mutable {
                    clip.get_pose(frame, world);
                    world_to_local(clip.skeleton.parents, world, local);
                    for (std::size_t j = 0; j < local.size(); ++j) {
                      add(Vec3f(local[j].position.cast<float>()), values);
                      add(normalized_or_identity(local[j].orientation), before[j], values);
                    }
                  });
    case What::quaternions:
      return make({"qx", "qy", "qz", "qw"}, [before = none_before](const Clip& clip, int frame,
                                                                   Values& values) mutable {
        const auto orientations = clip.frame_orientations(frame);
        for (std::size_t j = 0; j < orientations.size(); ++j) {
          add(normalized_or_identity(orientations[j].cast<double>()), before[j], values);
        }
      });
    case What::automatic:
    case What::positions:
    case What::angles:
    case What::contacts:
      break;
  }
  return make({"x", "y", "z"}, [](const Clip& clip, int frame, Values& values) {
    for (const Vec3f& place : clip.frame_positions(frame)) add(place, values);
  });
}

// Anatomical angles in degrees, as krok-plot draws them (draw::body_angle). With `coordinates` the
// names are those of OpenSim's full-body models where they have the angle: hip_flexion_r,
// knee_angle_r, ankle_angle_r, elbow_flex_r. Code export-angles if the skeleton has none.
Result<csv::SeriesTable> angle_series(const FrameSource& frames, const RoleMap& roles,
                                      bool coordinates, int jobs) {
  if (frames.frame_count == 0) return Error("export-angles", "the motion has no frames");
  auto looked_at = retarget::frames_looked_at(frames);
  if (!looked_at) return looked_at.error();
  std::vector<std::string> names;
  std::vector<std::pair<draw::BodyAngle, Side>> angles;
  for (const AngleName& angle : kAngles) {
    for (const Side side : {Side::left, Side::right}) {
      if (draw::body_angle(*looked_at, roles, angle.angle, side, {0, 0}).empty()) continue;
      names.push_back(fmt::format("{}_{}", coordinates ? angle.coordinate : angle.name,
                                  side == Side::left ? "l" : "r"));
      angles.emplace_back(angle.angle, side);
    }
  }
  if (names.empty()) {
    return Error("export-angles", "the skeleton has no joints with roles for body angles",
                 "--map assigns joint roles; --what local has the rotations of all joints");
  }
  return table_of(frames, jobs, "angle", std::move(names), {"degrees"},
                  [=, soles = draw::find_soles(*looked_at, roles)](const Clip& clip, int frame,
                                                                   Values& values) {
                    for (const auto& [angle, side] : angles) {
                      const draw::FrameRange one{frame, frame};
                      const auto value = draw::body_angle(clip, roles, angle, side, one, &soles);
                      values.push_back(static_cast<float>(value.front()));
                    }
                  });
}

// 1 for each joint in contact in a frame.
csv::SeriesTable contact_series(const FrameSource& frames, const std::vector<Contact>& contacts) {
  std::set<int> touching;
  for (const Contact& contact : contacts) touching.insert(contact.joint);
  csv::SeriesTable table;
  table.rate = frames.rate;
  table.frames = frames.frame_count;
  table.item_name = "joint";
  table.quantities = {"contact"};
  for (const int joint : touching) {
    table.items.push_back(frames.skeleton.names[static_cast<std::size_t>(joint)]);
  }
  table.values = [=, rate = frames.rate](int first, int count) -> Result<Values> {
    Values values(static_cast<std::size_t>(count) * touching.size(), 0.0F);
    for (const Contact& contact : contacts) {
      const auto column = std::distance(touching.begin(), touching.find(contact.joint));
      const double start = std::max<double>(first, contact.start * rate);
      for (int f = static_cast<int>(std::min<double>(start, first + count)); f < first + count;
           ++f) {
        if (f / rate > contact.end) break;
        if (f / rate < contact.start) continue;
        values[static_cast<std::size_t>(f - first) * touching.size() +
               static_cast<std::size_t>(column)] = 1;
      }
    }
    return values;
  };
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

// Reads the motion, writes it, and returns its summary. The keys of a long take are computed as
// they are written, before warnings of reading it are known.
Result<io::MotionSummary> export_gltf(bool binary, const Options& options, ToolContext& context,
                                      std::optional<Reduction>& reduction) {
  const auto input = context.open_input(options.input());
  if (!input) return input.error();
  std::optional<OutputSet> outputs;
  const bool streamed = input->bytes().size() >= kLongTake && !options.reduce;
  const auto write = [&](const Skeleton& skeleton, const gltf::JointTracks& tracks,
                         std::vector<std::string> conversions) {
    gltf::WriteOptions writing;
    writing.binary = binary;
    writing.provenance = context.provenance();
    writing.provenance.conversions = std::move(conversions);
    const bool bones = options.bones;
    writing.name = bones ? "bones" : "skeleton";
    writing.clip_name = clip_name_of(options.input());
    outputs.emplace(context);
    return outputs->add(context.output, [&](OutputFile& file) {
      return bones ? gltf::write_rig(bone_mesh(skeleton), tracks, writing, file)
                   : gltf::write_skeleton(skeleton, tracks, writing, file);
    });
  };
  Result<gltf::JointTracks> tracks = gltf::JointTracks();
  Stretches stretches;
  std::function<Provenance()> provenance;
  const auto use = [&](const FrameSource& frames) -> Status {
    if (frames.skeleton.empty()) return empty_error(options.input());
    Provenance before = provenance();
    tracks = !stretches.empty() ? stretched_tracks(frames, stretches, context)
             : streamed         ? gltf::streamed_tracks(frames.skeleton, frames, context.jobs)
                                : gltf::joint_tracks(frames.skeleton, frames, context.jobs);
    if (!tracks) return tracks.error();
    if (!tracks->read) return {};
    tracks->removed_root_motion = before.removed_root_motion;
    // Those of an .anim file are of how it was made.
    if (io::format_of(*input).open_capture == nullptr) before.conversions.clear();
    return write(frames.skeleton, *tracks, std::move(before.conversions));
  };
  auto facts =
      io::stream_motion(*input, context, use, {.stretches = &stretches, .provenance = &provenance});
  if (!facts) return facts;
  if (!tracks->read) {
    tracks->removed_root_motion = facts->removed_root_motion;
    auto reduced = reduce(options, facts->skeleton, context.jobs, *tracks);
    if (!reduced) return reduced.error();
    reduction = *std::move(reduced);
    if (Status status = write(facts->skeleton, *tracks, facts->conversions); !status) {
      return status.error();
    }
  }
  if (Status status = outputs->finish(); !status) return status.error();
  if (io::format_of(*input).read_scene != nullptr) {
    const auto actor =
        io::open_actor(*input, context, {.with_materials = false, .with_motions = false});
    // What this tool wrote has a mesh of its bones.
    const bool made =
        actor && actor->model.vertex_count() == bone_mesh(facts->skeleton).vertex_count();
    if (actor && actor->has_mesh() && !made) {
      context.diagnose_in(
          options.input(),
          {make_warning("export-mesh", "its mesh is not in the result",
                        "krok-skin CHARACTER CHARACTER -o OUT.glb keeps the mesh")});
    }
  }
  return facts;
}

// The contacts of the motion's sidecar, or as krok-keys detects them.
Result<std::vector<Contact>> contacts_of(const Options& options, std::size_t bytes,
                                         const FrameSource& frames, const Provenance& provenance,
                                         ToolContext& context) {
  const auto find_roles = io::open_role_map(options.map, context);
  if (!find_roles) return find_roles.error();
  auto keys = choose_keys(KeysChoice::automatic, options.input(), bytes, frames, provenance,
                          *find_roles, context, true);
  if (!keys) return keys.error();
  return *keys ? std::move((*keys)->contacts) : std::vector<Contact>();
}

// Writes frames as they are read, so that a long take is not held in memory. `write` is given
// contacts_of() the motion.
using FindContacts = std::function<Result<std::vector<Contact>>()>;
Result<io::MotionSummary> export_frames(
    const Options& options, ToolContext& context,
    const std::function<Status(const FrameSource& frames, const FindContacts& contacts,
                               OutputFile& file)>& write,
    const std::function<void(const Skeleton& skeleton)>& note = {}) {
  const auto input = context.open_long_input(options.input());
  if (!input) return input.error();
  const io::ChecksumAtEnd checksum(*input, context);
  std::optional<OutputSet> outputs;
  std::function<Provenance()> provenance;
  auto facts = io::stream_motion(
      *input, context,
      [&](const FrameSource& frames) -> Status {
        if (frames.skeleton.empty()) return empty_error(options.input());
        const auto contacts = [&] {
          return contacts_of(options, input->bytes().size(), frames, provenance(), context);
        };
        outputs.emplace(context);
        return outputs->add(context.output,
                            [&](OutputFile& file) { return write(frames, contacts, file); });
      },
      {.provenance = &provenance});
  if (!facts) return facts;
  if (note) note(facts->skeleton);
  if (Status status = outputs->finish(); !status) return status.error();
  return facts;
}

Result<csv::SeriesTable> series_of(What what, ExportFormat format, const Options& options,
                                   const FrameSource& frames, const FindContacts& find_contacts,
                                   ToolContext& context) {
  if (what == What::contacts) {
    const auto contacts = find_contacts();
    if (!contacts) return contacts.error();
    return contact_series(frames, *contacts);
  }
  const int jobs = thread_count(context.jobs);
  if (what != What::angles) return joint_series(frames, what, jobs);
  const auto find_roles = io::open_role_map(options.map, context);
  if (!find_roles) return find_roles.error();
  const auto roles = (*find_roles)(frames.skeleton);
  if (!roles) return roles.error();
  auto table = angle_series(frames, *roles, format != ExportFormat::csv, jobs);
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

Result<MotionTable> read_table(ExportFormat format, const FrameSource& frames,
                               const FindContacts& find_contacts, const Options& options,
                               ToolContext& context) {
  const What what = what_of(format, options);
  MotionTable table;
  if (format == ExportFormat::csv && what == What::contacts &&
      options.layout == Layout::long_rows) {
    auto contacts = find_contacts();
    if (!contacts) return contacts.error();
    table.contacts = *std::move(contacts);
    table.joints = frames.skeleton.names;
    return table;
  }
  auto series = series_of(what, format, options, frames, find_contacts, context);
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

Result<io::MotionSummary> export_table(ExportFormat format, const Options& options,
                                       ToolContext& context) {
  return export_frames(options, context,
                       [&](const FrameSource& frames, const FindContacts& find_contacts,
                           OutputFile& file) -> Status {
                         const What what = what_of(format, options);
                         if (format == ExportFormat::csv && what == What::positions &&
                             options.layout == Layout::long_rows) {
                           return csv::write(frames, file);
                         }
                         const auto table =
                             read_table(format, frames, find_contacts, options, context);
                         if (!table) return table.error();
                         if (!table->contacts)
                           context.report.result["columns"] = table->series.items;
                         if (format == ExportFormat::csv)
                           return write_rows(*table, options.layout, {}, file);
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
      Clip clip;
      const auto table = [&]() -> Result<MotionTable> {
        const HiddenProgress hidden(context);
        auto read = io::open_motion(path, context);
        if (!read) return read.error();
        clip = *std::move(read);
        if (clip.skeleton.empty()) return empty_error(path);
        const auto contacts = [&] {
          return contacts_of(one, 0, frames_of(clip), clip.provenance, context);
        };
        return read_table(ExportFormat::csv, frames_of(clip), contacts, one, context);
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

// Arrays of numpy, with the contacts of the sidecar or those detected; none for a skeleton without
// legs.
Result<io::MotionSummary> export_npz(const Options& options, ToolContext& context) {
  return export_frames(
      options, context,
      [&](const FrameSource& frames, const FindContacts& find_contacts, OutputFile& file) {
        const auto found = find_contacts();
        return found ? npy::write_motion(frames, *found, thread_count(context.jobs), file)
                     : Status(found.error());
      });
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

Result<io::MotionSummary> export_bvh(const Options& options, ToolContext& context) {
  bvh::WriteOptions writing;
  writing.unit_metres = options.unit.metres;
  writing.root_offset = options.root_offset;
  writing.decimals = options.digits;
  writing.order = order_of(options.order);
  writing.jobs = context.jobs;
  return export_frames(
      options, context,
      [&](const FrameSource& frames, const FindContacts&, OutputFile& file) {
        return bvh::write(frames, writing, file);
      },
      [&](const Skeleton& skeleton) { note_root(skeleton, options, context); });
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
                 "-o OUT.csv is one table of all; --format FORMAT --out-dir DIR writes a file of "
                 "each; krok-skin puts many clips into one .glb");
  }
  const bool is_glb = *format == ExportFormat::glb;
  std::optional<Reduction> reduction;
  const auto motion = is_glb || *format == ExportFormat::gltf
                          ? export_gltf(is_glb, options, context, reduction)
                      : *format == ExportFormat::bvh ? export_bvh(options, context)
                      : *format == ExportFormat::npz ? export_npz(options, context)
                                                     : export_table(*format, options, context);
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
