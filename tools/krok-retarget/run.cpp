#include "tools/krok-retarget/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/file.h"
#include "core/glob.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/alignment/alignment_format.h"
#include "formats/anim/anim.h"
#include "formats/io/formats.h"
#include "formats/io/open_character.h"
#include "formats/io/open_motion.h"
#include "gait/shown_prints.h"
#include "plant/follow_feet.h"
#include "retarget/limb_ends.h"
#include "retarget/stance.h"
#include "retarget/take_pool.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/output_set.h"
#include "tools/cli/paths.h"
#include "tools/cli/usage.h"
#include "tools/shared/keys_sidecar.h"
#include "tools/shared/planting.h"
#include "tools/shared/retarget_outcome.h"

namespace krok::cli::retarget {

namespace {

constexpr double kSunk = 0.05;  // metres: steeper ground than that which its feet stood on

struct Target {
  Clip clip;      // without frames if it is a model
  Model mesh;     // without vertices if it is a motion
  int added = 0;  // joints of `clip` behind those of the mesh, for its limbs' ends
};

Result<Target> read_target(const std::string& path, ToolContext& context) {
  auto actor = io::open_actor(path, context, {.with_motions = false});
  if (!actor) {
    Error error = actor.error();
    if (error.code == "container-magic") {
      error.hint = "--onto takes what has joints: a .model, .character, .glb, .fbx, .anim or .bvh";
    }
    return error;
  }
  Target target;
  if (!actor->motions.empty()) {
    target.clip = std::move(actor->motions[0].clip);
    return target;
  }
  target.mesh = std::move(actor->model);
  target.clip.skeleton = krok::retarget::with_limb_ends(target.mesh);
  target.added = target.clip.skeleton.joint_count() - target.mesh.skeleton.joint_count();
  return target;
}

Result<RoleMap> roles_of(const Skeleton& skeleton, const std::string& map_path,
                         ToolContext& context) {
  const auto roles = io::open_role_map(map_path, context);
  if (!roles) return roles.error();
  return (*roles)(skeleton);
}

// All files, each once.
Result<std::vector<std::string>> files_of(const std::vector<std::string>& takes,
                                          ToolContext& context) {
  std::vector<std::string> files;
  for (const std::string& given : takes) {
    std::error_code ignored;
    const bool is_folder = std::filesystem::is_directory(given, ignored);
    const bool is_pattern = has_wildcards(given) && !std::filesystem::exists(given, ignored);
    Result<std::vector<std::string>> found = std::vector{given};
    if (is_folder) found = find_files_below(given);
    if (is_pattern) found = find_files(given);
    if (!found) return found.error();
    if (is_folder) context.diagnose(keep_inputs(given, io::motion_endings(), *found));
    if (found->empty()) {
      return Error("usage", fmt::format("--takes: no {} there", is_folder ? "motion" : "file"))
          .in_file(given);
    }
    files.insert(files.end(), found->begin(), found->end());
  }
  std::ranges::sort(files);
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

// The pose that --takes gives a motion: a T-pose built from it and from all takes of the same
// joints in files, folders and patterns. Others are left out with a warning. Empty if the
// skeleton's reference pose stands, which then is the pose.
Result<std::vector<Transform>> pose_of_takes(const std::vector<std::string>& takes,
                                             const Clip& source, const RoleMap& roles,
                                             ToolContext& context) {
  const std::vector<Transform>& reference = source.skeleton.reference;
  if (!roles.humanoid || krok::retarget::stands({source.skeleton, roles, reference})) {
    return std::vector<Transform>();
  }
  const auto files = files_of(takes, context);
  if (!files) return files.error();
  krok::retarget::TakePool pool(1 + files->size(), roles);
  pool.add(source);
  std::string stranger, difference;
  std::size_t left_out = 0;
  for (const std::string& path : *files) {
    const auto take = io::open_motion(path, context);
    if (!take) return take.error();
    const std::string other = difference_in_structure(source.skeleton, take->skeleton);
    if (other.empty()) {
      pool.add(*take);
    } else if (++left_out == 1) {
      stranger = path;
      difference = other;
    }
  }
  if (left_out > 0) {
    context.warn("retarget-takes",
                 fmt::format("{} of {} takes have another skeleton and are left out, first {}: {}",
                             left_out, files->size(), shown(stranger), difference));
  }
  auto stance = krok::retarget::find_stance(pool.clip(), roles, std::nullopt);
  if (!stance) return stance.error();
  return std::move(stance->pose);
}

// The pose that an option takes from another motion of the skeleton; none for other values.
Status take_pose(const char* option, const MatchingPose& given, const Skeleton& skeleton,
                 std::vector<Transform>& pose, ToolContext& context) {
  if (given.path.empty()) return {};
  const auto clip = io::open_motion(given.path, context);
  if (!clip) return clip.error();
  const std::string difference = difference_in_structure(clip->skeleton, skeleton);
  if (!difference.empty()) {
    return Error("retarget-pose", fmt::format("{}: another skeleton: {}", option, difference))
        .in_file(given.path);
  }
  if (*given.frame >= clip->frame_count()) {
    return Error("retarget-frame",
                 fmt::format("{}: no frame {}; the motion has {} frames, numbered "
                             "from 0",
                             option, *given.frame, clip->frame_count()))
        .in_file(given.path);
  }
  pose.resize(skeleton.names.size());
  clip->get_pose(*given.frame, pose);
  return {};
}

Result<FollowedFeet> stand_on_ground(const Options& options, const Clip& source,
                                     const RoleMap& source_roles, const RoleMap& target_roles,
                                     const krok::retarget::RetargetedFrames& retargeted,
                                     ToolContext& context) {
  const auto clip = load(retargeted.frames, context.jobs);
  if (!clip) return clip.error();
  const auto ground = options.ground.open(context);
  if (!ground) return ground.error();
  const auto contacts =
      read_planting_contacts(options.contacts, options.input, frames_of(source), context);
  if (!contacts) return contacts.error();
  std::optional<std::span<const Contact>> given;
  if (*contacts) given = **contacts;
  const GroundBelow below = {gait::height_of(**ground), gait::up_of(**ground)};
  auto followed = follow_feet(source, source_roles, *clip, target_roles, retargeted.report->scale,
                              below, given);
  if (followed && retargeted.measure_contacts) {
    Status measured = retargeted.measure_contacts(frames_of(followed->clip), below.height);
    if (!measured) return measured.error();
  }
  if (followed && followed->out_of_reach > 0) {
    context.warn("plant-reach", fmt::format("in {} of {} frames a leg is too short for its place",
                                            followed->out_of_reach, source.frame_count()));
  }
  if (followed && followed->sunk > kSunk && followed->source_sunk < 0.5 * kSunk) {
    context.warn(
        "retarget-ground",
        fmt::format("a foot that is over the ground goes {} mm into it, the input's {} mm: "
                    "the target's feet do not take its steps there",
                    readable(1e3 * followed->sunk, 3), readable(1e3 * followed->source_sunk, 3)));
  } else if (followed && followed->sunk > kSunk) {
    context.warn(
        "retarget-ground",
        fmt::format("a foot that is over the ground goes {} mm into it: the input does not "
                    "walk on this ground",
                    readable(1e3 * followed->sunk, 3)),
        "--ground is that of the input; krok-walk makes a walk on another, krok-edit "
        "--settle --ground lays other motions on it");
  }
  return followed;
}

Json ground_json(const FollowedFeet& feet) {
  return {{"drift", feet.drift},
          {"off_ground", feet.off_ground},
          {"sunk", feet.sunk},
          {"pelvis_lowered", feet.pelvis_lowered},
          {"frames_out_of_reach", feet.out_of_reach}};
}

std::string ground_line(const FollowedFeet& feet) {
  return fmt::format("feet on the ground within {} mm, drift {} mm, pelvis lowered by up to {} mm",
                     readable(1e3 * feet.off_ground, 2), readable(1e3 * feet.drift, 2),
                     readable(1e3 * feet.pelvis_lowered, 2));
}

// The motion and, on a ground, the contacts of its feet beside it.
Status write_all(const FrameSource& frames, const std::function<Provenance()>& provenance,
                 const FollowedFeet* followed, const anim::WriteOptions& writing,
                 const std::string& alignment_path, const Outcome& outcome, ToolContext& context) {
  OutputSet outputs(context);
  Status status = outputs.add(context.output, [&](OutputFile& file) {
    return anim::write(frames, provenance, writing, file);
  });
  if (status && followed != nullptr) {
    MotionKeys keys;
    keys.contacts = followed->contacts;
    status = add_keys(keys, frames.skeleton, frames.duration(), context.output, outputs);
  }
  if (status && !alignment_path.empty()) {
    const alignment::AlignedPoses poses{outcome.report.source_pose, outcome.report.target_pose};
    status = outputs.add(alignment_path, alignment::write(poses, outcome.source, outcome.target));
  }
  if (!status) return status;
  return outputs.finish();
}

// Both poses from a file.
Status take_alignment(const std::string& path, const Skeleton& source, const Skeleton& target,
                      krok::retarget::Options& how, ToolContext& context) {
  if (path.empty()) return {};
  const auto file = context.open_input(path);
  if (!file) return file.error();
  auto poses = alignment::read(file->text(), source, target);
  if (!poses) return std::move(poses).error().in_file(path);
  how.source_pose = std::move(poses->source);
  how.target_pose = std::move(poses->target);
  return {};
}

// What needs more than the options to be found out.
Status check_outputs(const Options& options, const ToolContext& context) {
  if (context.one_of_many != nullptr && !options.takes.empty()) {
    return Error("usage", "--takes is for one input: each file of a batch would read all takes",
                 "write their alignment with --takes and --save-alignment first, and give it to "
                 "the batch with --alignment");
  }
  if (!context.output.empty()) return {};
  if (options.save_alignment.empty()) return no_output("add -o OUTPUT, or --save-alignment");
  if (options.ground.empty()) return {};
  return Error("usage", "--ground is for a motion that is written", "give its name with -o");
}

// A scale that no body has: per cent, or centimetres in a metre.
void warn_of_scale(const Options& options, const krok::retarget::Report& report,
                   ToolContext& context) {
  constexpr double kFar = 3;  // metres
  double most = 0;
  for (const auto& foot : {report.left_foot, report.right_foot}) {
    if (foot) most = std::max(most, foot->largest_correction);
  }
  if (!options.scale || most < kFar) return;
  context.warn("retarget-scale",
               fmt::format("--scale {} moves the feet by up to {} m from where the legs reach",
                           readable(*options.scale), readable(most, 3)),
               "it is a factor, 1.1 for 110 %; without it, the length of the legs decides");
}

constexpr const char* kOrder = "IN is whose motion is wanted, --onto whose body";

// `whole` is the same as `source`, or null for a long take.
Status retarget(const Options& options, const FrameSource& source, const Clip* whole,
                const std::function<Provenance()>& provenance, ToolContext& context) {
  krok::retarget::Options how;
  how.feet = options.feet;
  how.touches = options.touches;
  how.scale = options.scale;
  if (options.reference_pose.path.empty()) how.source_frame = options.reference_pose.frame;
  if (options.onto_reference_pose.path.empty())
    how.target_frame = options.onto_reference_pose.frame;
  how.jobs = context.jobs;
  how.progress = context.progress;
  const auto target = read_target(options.onto, context);
  if (!target) return target.error();
  if (source.frame_count < 2 && target->clip.frame_count() > 1) {
    context.warn(
        "retarget-still",
        fmt::format("{} has no motion, --onto has {}: the result is a still",
                    base_name(options.input), counted(target->clip.frame_count(), "frame")),
        kOrder);
  }
  const auto source_roles = roles_of(source.skeleton, options.map, context);
  if (!source_roles) {
    Error error = source_roles.error();
    if (error.code == "role-map-joint" && options.onto_map.empty() &&
        roles_of(target->clip.skeleton, options.map, context)) {
      error.hint = "it names joints of the target: --onto-map is for those, --map for the input's";
    }
    return error;
  }
  const auto target_roles = roles_of(target->clip.skeleton, options.onto_map, context);
  if (!target_roles) return target_roles.error();
  if (!options.ground.empty()) how.feet = krok::retarget::Feet::free;
  how.target_floor = floor_below(target->mesh.positions, target->clip.skeleton, *target_roles);
  if (how.target_floor) {
    how.target_feet =
        krok::retarget::points_of_feet(target->mesh, target->clip.skeleton, *target_roles);
  }
  Status posed = take_pose("--reference-pose", options.reference_pose, source.skeleton,
                           how.source_pose, context);
  if (posed) {
    posed = take_pose("--onto-reference-pose", options.onto_reference_pose, target->clip.skeleton,
                      how.target_pose, context);
  }
  if (posed) {
    posed = take_alignment(options.alignment, source.skeleton, target->clip.skeleton, how, context);
  }
  if (!posed) return posed;
  if (!options.takes.empty()) {
    auto pose = pose_of_takes(options.takes, *whole, *source_roles, context);
    if (!pose) return pose.error();
    how.source_pose = *std::move(pose);
  }

  auto result = krok::retarget::transfer(source, *source_roles, target->clip, *target_roles, how);
  if (!result) {
    Error error = std::move(result).error();
    if (error.code == "retarget-roles" && target->clip.skeleton.joint_count() < 3) {
      error.hint =
          shown(options.onto) + " has no skeleton: --onto needs a mesh that is bound to one";
    }
    return std::move(error).in_file(options.input);
  }
  std::optional<FollowedFeet> followed;
  if (!options.ground.empty()) {
    auto standing =
        stand_on_ground(options, *whole, *source_roles, *target_roles, *result, context);
    if (!standing) return std::move(standing).error().in_file(options.input);
    followed = *std::move(standing);
    krok::retarget::give_to_parents(target->clip.skeleton, target->added, followed->contacts);
    result->frames = frames_of(followed->clip);
  } else if (context.output.empty()) {
    if (Status status = read_through(result->frames, context.jobs); !status) return status;
  }
  result->frames = krok::retarget::without_last_joints(std::move(result->frames), target->added);
  const Outcome outcome{source.skeleton, *source_roles, target->clip.skeleton, *target_roles,
                        *result->report};

  const auto made_by = [&] {
    Provenance before = provenance();
    Provenance made = context.provenance();
    made.conversions = std::move(before.conversions);
    made.removed_root_motion = before.removed_root_motion;
    if (made.removed_root_motion) made.removed_root_motion->velocity *= outcome.report.path_scale;
    made.conversions.push_back("retargeted: " + summary(outcome));
    return made;
  };
  anim::WriteOptions writing;
  writing.orientation = options.orientation;
  writing.jobs = context.jobs;
  const FollowedFeet* feet = followed ? &*followed : nullptr;
  if (Status status = write_all(result->frames, made_by, feet, writing, options.save_alignment,
                                outcome, context);
      !status)
    return status;
  // Contacts are known once all frames were read.
  const bool pose_is_given = how.source_frame || !how.source_pose.empty();
  for (Diagnostic& choice : choices_of(outcome, pose_is_given)) context.diagnose(std::move(choice));
  warn_of_scale(options, outcome.report, context);

  context.report.result = to_json(outcome);
  if (followed) context.report.result["ground"] = ground_json(*followed);
  context.log(fmt::format("{}: {}",
                          context.output.empty() ? options.save_alignment : context.output,
                          summary(outcome)));
  if (followed) context.log("  " + ground_line(*followed));
  if (context.verbose) context.log(table(outcome));
  return {};
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  constexpr std::size_t kLongBytes = std::size_t{16} << 20;
  if (Status status = check_outputs(options, context); !status) return status.error();
  const auto input = context.open_long_input(options.input);
  if (!input) return input.error();
  if (input->bytes().size() < kLongBytes || !options.takes.empty() || !options.ground.empty()) {
    context.note_checksum(*input);
    auto clip = io::open_motion(*input, context);
    if (!clip && clip.error().code == "motion-missing") clip.error().hint = kOrder;
    if (!clip) return clip.error();
    const auto provenance = [&] { return clip->provenance; };
    Status status = retarget(options, frames_of(*clip), &*clip, provenance, context);
    return status ? Result<int>(kExitDone) : status.error();
  }
  const io::ChecksumAtEnd checksum(*input, context);
  std::function<Provenance()> of_input;
  const auto provenance = [&] {
    context.note_checksum(*input);
    return of_input();
  };
  const auto use = [&](const FrameSource& frames) {
    return retarget(options, frames, nullptr, provenance, context);
  };
  const auto read = io::stream_motion(*input, context, use, {.provenance = &of_input});
  if (!read) return read.error();
  return kExitDone;
}

}  // namespace krok::cli::retarget
