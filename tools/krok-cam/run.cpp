#include "tools/krok-cam/options.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "camera/keyed_camera.h"
#include "character/motion.h"
#include "character/sampling.h"
#include "core/file.h"
#include "core/numbers.h"
#include "core/result.h"
#include "core/text.h"
#include "formats/cam/cam.h"
#include "formats/camera_keys/camera_keys.h"
#include "formats/gltf/add_camera.h"
#include "formats/goals/goals.h"
#include "formats/io/formats.h"
#include "formats/io/open_motion.h"
#include "formats/io/open_scene.h"
#include "formats/registry/registry.h"
#include "motion/hips_root.h"
#include "nodes/animation_choice.h"
#include "nodes/evaluate.h"
#include "scene/camera_track.h"
#include "scene/frame_source.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/output_set.h"
#include "tools/cli/tool.h"
#include "tools/shared/camera_choice.h"

namespace krok::cli::cam {

namespace {

// The animation that moves the camera most; -1 if none does.
int find_animation(const nodes::Scene& scene, int camera, Diagnostics& found) {
  const nodes::ChosenAnimation best =
      best_animation(scene, "camera channel", [&](const nodes::Animation& animation) {
        return nodes::camera_count(scene, animation, camera);
      });
  if (best.count == 0) return -1;
  if (best.moving > 1) {
    const std::string name = animation_name(scene, static_cast<std::size_t>(best.animation));
    found.push_back(make_warning("cam-animations",
                                 fmt::format("using {}, {}", shown(name), best.why),
                                 "krok-import --save-cam selects another with --clip"));
  }
  return best.animation;
}

// A camera of a glTF file in the animation that moves it most (nodes::camera_count), at the
// rate of the keys or at `rate`; one frame if no animation does. `wanted` as in choose_camera.
// Codes: cam-missing, import-camera, and those of reading and sampling.
Result<CameraTrack> read_scene_camera(const InputFile& file, const std::string& wanted,
                                      std::optional<double> rate, ToolContext& context) {
  const auto scene = io::open_scene(file, context);
  if (!scene) return scene.error();
  Diagnostics found = scene->diagnostics;
  const auto evaluator = nodes::Evaluator::create(*scene);
  if (!evaluator) return Error(evaluator.error()).in_file(file.path());
  const std::vector<int> cameras = character::camera_nodes(*scene, *evaluator);
  if (cameras.empty()) {
    return Error("cam-missing", "the scene has no camera",
                 "in glTF a camera must be attached to a node of the scene")
        .in_file(file.path());
  }
  const auto camera = choose_camera(*scene, cameras, wanted, file.path(), context);
  if (!camera) return Error(camera.error()).in_file(file.path());
  const int animation = find_animation(*scene, *camera, found);
  character::Sampling sampling;
  if (animation >= 0) {
    character::SamplingOptions how;
    how.rate = rate;
    const auto chosen = character::choose_sampling(
        scene->animations[static_cast<std::size_t>(animation)], how, found);
    if (!chosen) return Error(chosen.error()).in_file(file.path());
    sampling = chosen->sampling;
  }
  // glTF uses the same units and axes as Krok.
  auto track = character::make_camera(*scene, *evaluator, *camera, Conversion(), Mat4::Identity(),
                                      animation, sampling, found);
  if (!track) return Error(track.error()).in_file(file.path());
  context.diagnose_in(file.path(), found);
  return track;
}

using registry::Kind;

// A camera, and a summary of how it was made.
struct Shot {
  CameraTrack track;
  std::vector<std::string> conversions;
  Json facts = Json::object();
  std::string words;
};

bool is_keys(const InputFile& file, Kind kind) {
  if (kind != Kind::unknown) return false;
  const std::string_view text = trimmed(without_byte_order_mark(file.text()));
  return text.starts_with('{') || extension(file.path()) == ".json";
}

Status refuse_film(const Options& options, const char* what) {
  if (!film_of(options)) return {};
  return Error("usage",
               fmt::format("--follow, --orbit and --still need a motion; this is {}", what))
      .in_file(options.input);
}

Status refuse_camera(const Options& options) {
  if (options.camera.empty()) return {};
  return Error("usage", "--camera is for scenes").in_file(options.input);
}

Status refuse_interpolation(const Options& options) {
  if (!options.interpolation) return {};
  return Error("usage", "--interpolation is for keys").in_file(options.input);
}

Result<Shot> from_keys(const Options& options, const InputFile& file) {
  if (Status status = refuse_film(options, "keys"); !status) return status.error();
  if (Status status = refuse_camera(options); !status) return status.error();
  auto keys = camera_keys::read(file.text());
  if (!keys) return std::move(keys).error().in_file(file.path());
  if (options.interpolation) {
    for (CameraKey& key : keys->camera.keys) {
      key.between = options.interpolation->hermite ? Between::smooth : Between::linear;
      key.tension = options.interpolation->tension;
    }
  }
  auto track = make_track(keys->camera, options.rate.value_or(keys->rate));
  if (!track) return std::move(track).error().in_file(file.path());
  Shot shot;
  shot.track = *std::move(track);
  const auto count = keys->camera.keys.size();
  shot.facts["keys"] = count;
  shot.words = fmt::format("from {}", counted(count, "key"));
  return shot;
}

Result<Shot> from_cam(const Options& options, const InputFile& file) {
  if (Status status = refuse_film(options, "a camera"); !status) return status.error();
  if (Status status = refuse_camera(options); !status) return status.error();
  if (options.rate) return Error("usage", "--rate is for keys and scenes").in_file(options.input);
  if (Status status = refuse_interpolation(options); !status) return status.error();
  auto track = krok::cam::read(file.bytes());
  if (!track) return std::move(track).error().in_file(file.path());
  Shot shot;
  shot.conversions = track->provenance.conversions;
  shot.track = *std::move(track);
  return shot;
}

Result<Shot> from_scene(const Options& options, const InputFile& file, ToolContext& context) {
  if (Status status = refuse_interpolation(options); !status) return status.error();
  if (Status status = refuse_film(options, "a scene"); !status) return status.error();
  auto track = read_scene_camera(file, options.camera, options.rate, context);
  if (!track) return std::move(track).error();
  Shot shot;
  shot.track = *std::move(track);
  return shot;
}

// Finds a joint by name or role.
Result<int> followed_joint(const std::string& name, const Skeleton& skeleton,
                           const RoleMap& roles) {
  const int joint = find_joint(skeleton, roles, name);
  if (joint >= 0) return joint;
  const auto role = parse_role(name);
  std::vector<std::string> known = skeleton.names;
  for (const Role one : roles.roles) known.emplace_back(role_name(one));
  const std::string near = role ? std::string() : nearest_name(name, known);
  return Error("cam-joint",
               role ? fmt::format("--follow {}: no joint has that role", shown(name))
                    : fmt::format("--follow {}: the motion has no joint of that name", shown(name)),
               near.empty() ? "krok-info -v lists the joints and their roles; --map assigns roles"
                            : fmt::format("did you mean '{}'?", near));
}

void warn(ToolContext& context, const std::string& path, const char* code, std::string message,
          std::string hint, int frame) {
  Diagnostic diagnostic = make_warning(code, std::move(message), std::move(hint), path);
  diagnostic.frame = frame;
  context.diagnose(std::move(diagnostic));
}

void report_faults(const ActorShot& shot, const std::string& path, ToolContext& context) {
  const int frames = shot.track.frame_count();
  if (shot.frames_shown < frames) {
    warn(context, path, "cam-cut",
         fmt::format("in {} of {} frames, joints to be framed are outside the image, first in "
                     "frame {}",
                     frames - shot.frames_shown, frames, shot.first_not_shown),
         "omit --distance to choose it automatically", shot.first_not_shown);
  }
  if (shot.frames_inside > 0) {
    warn(context, path, "cam-inside",
         fmt::format("in {} of {} frames the camera is inside the body or closer to it than {} m, "
                     "first in frame {}",
                     shot.frames_inside, frames, readable(kClearance), shot.first_inside),
         "omit --distance or increase it", shot.first_inside);
  }
}

std::string_view part_name(Framing framing) {
  switch (framing) {
    case Framing::upper:
      return "upper body";
    case Framing::head:
      return "head";
    case Framing::joint:
      return "joint";
    default:
      return "full body";
  }
}

Result<Shot> from_motion(const Options& options, const InputFile& file, ToolContext& context) {
  const auto filming = film_of(options);
  if (!filming) {
    return Error("usage", "no camera mode given", "use --follow hips, --orbit 20s or --still")
        .in_file(file.path());
  }
  const auto find_roles = io::open_role_map(options.map, context);
  if (!find_roles) return find_roles.error();
  ActorCamera camera = filming->camera;
  std::optional<ActorShot> filmed;
  int carrier = -1;
  Shot shot;
  std::function<Provenance()> provenance;
  const auto use = [&](const FrameSource& frames) -> Status {
    // Those of a short take are read once.
    std::optional<Clip> clip;
    if (file.bytes().size() < kLongTake) {
      auto loaded = load(frames, context.jobs);
      if (!loaded) return loaded.error();
      clip = *std::move(loaded);
    }
    const FrameSource source = clip ? frames_of(*clip) : frames;
    const auto roles = (*find_roles)(source.skeleton);
    if (!roles) return roles.error();
    if (source.skeleton.empty()) {
      return Error("camera-empty", "the motion has no joints").in_file(file.path());
    }
    carrier = carrying_joint(*roles);
    if (filming->moving_centre) {
      const auto joint = filming->follow.empty()
                             ? Result<int>(carrier)
                             : followed_joint(filming->follow, source.skeleton, *roles);
      if (!joint) return Error(joint.error()).in_file(file.path());
      camera.joint = *joint;
    }
    if (filming->turns != 0 && source.duration() > 0) {
      camera.turning = filming->turns * 2 * kPi / source.duration();
    }
    auto made = film(source, *roles, camera, context.jobs);
    if (!made) return std::move(made).error().in_file(file.path());
    filmed = *std::move(made);
    shot.conversions = provenance().conversions;
    shot.facts["framed"] = part_name(camera.framing);
    shot.facts["follows"] =
        camera.joint < 0 ? Json()
                         : Json(source.skeleton.names[static_cast<std::size_t>(camera.joint)]);
    return {};
  };
  const auto motion = io::stream_motion(file, context, use, {.provenance = &provenance});
  if (!motion) return motion.error();
  report_faults(*filmed, file.path(), context);
  shot.facts["distance"] = filmed->distance;
  shot.facts["frames_shown"] = filmed->frames_shown;
  shot.facts["frames_inside"] = filmed->frames_inside;
  const int frames = filmed->track.frame_count();
  shot.words =
      fmt::format("{} in {} from {} m", part_name(camera.framing),
                  filmed->frames_shown == frames
                      ? "all frames"
                      : fmt::format("{} of {}", filmed->frames_shown, counted(frames, "frame")),
                  readable(filmed->distance, 3));
  if (options.orbit) {
    shot.words +=
        fmt::format("; orbits by {} degrees",
                    readable(std::abs(camera.turning) * motion->duration / kRadiansPerDegree, 3));
  }
  if (!filming->follow.empty() && !options.given("--frame") && !options.given("--distance") &&
      camera.joint != carrier) {
    shot.words += " (--frame joint: a close-up)";
  }
  shot.track = std::move(filmed->track);
  return shot;
}

Result<Shot> make_shot(const Options& options, ToolContext& context) {
  const auto file = context.open_input(options.input);
  if (!file) return file.error();
  const Kind kind = registry::identify(file->path(), file->bytes());
  if (io::is_motion(*file) || (film_of(options) && io::format_of(*file).reads_motion())) {
    return from_motion(options, *file, context);
  }
  if (is_keys(*file, kind)) return from_keys(options, *file);
  switch (kind) {
    case Kind::cam:
      return from_cam(options, *file);
    case Kind::glb:
    case Kind::gltf:
      return from_scene(options, *file, context);
    default:
      break;
  }
  return Error("cam-input",
               fmt::format("this is {}, expected keys, a camera, a scene with one, or a motion",
                           registry::describe_content(file->bytes())),
               registry::is_read_through_assimp(kind)
                   ? "krok-import --save-cam shot.cam extracts a camera from such scenes"
                   : "keys are JSON, see formats/camera_keys/SPEC.md")
      .in_file(file->path());
}

// The format of the output at `path`.
Result<Format> format_of(const Options& options, const std::string& path) {
  const std::string end = extension(path);
  if (!options.into.empty() || options.format == Format::glb || end == ".glb") {
    if (options.format == Format::cam) return Format::cam;
    if (Status status = check_output_kind(path, "-o", Kind::glb); !status) return status.error();
    return Format::glb;
  }
  if (Status status = check_output_kind(path, "-o", Kind::cam); !status) return status.error();
  return Format::cam;
}

// The GLB file with the camera added.
Result<gltf::WithCamera> glb_of(const Options& options, const CameraTrack& track,
                                ToolContext& context) {
  gltf::CameraOptions how;
  how.name = options.name;
  how.animation = options.clip;
  if (options.given("--aspect") || film_of(options)) how.aspect = options.aspect;
  if (options.into.empty()) return gltf::camera_alone(track, how);
  const auto file = context.open_input(options.into);
  if (!file) return file.error();
  gltf::ReadOptions reading;
  if (options.into != "-") {
    const std::string folder = std::filesystem::path(options.into).parent_path().string();
    reading.folder = folder.empty() ? "." : folder;
  }
  auto made = gltf::add_camera(file->bytes(), track, how, reading);
  if (!made) return std::move(made).error().in_file(options.into);
  for (const std::string& path : made->files) {
    if (const auto other = context.open_input(path); !other) return other.error();
  }
  return made;
}

Status write(const Options& options, Format format, CameraTrack& track, ToolContext& context) {
  if (format == Format::cam) {
    return write_output(context, context.output, [&](OutputFile& file) {
      return krok::cam::write(track, {.orientation = options.orientation}, file);
    });
  }
  auto made = glb_of(options, track, context);
  if (!made) return std::move(made).error();
  for (Diagnostic& diagnostic : made->diagnostics) {
    if (diagnostic.where.file.empty()) diagnostic.where.file = options.input;
    context.diagnose(std::move(diagnostic));
  }
  return write_output(context, context.output, made->bytes);
}

void report(const Shot& shot, ToolContext& context) {
  const CameraTrack& track = shot.track;
  const CameraMotion motion = camera_motion(track);
  const double duration = track.frame_count() < 2 ? 0 : (track.frame_count() - 1) / track.rate;
  Json result;
  result["frames"] = track.frame_count();
  result["rate"] = track.rate;
  result["duration"] = duration;
  result.update(shot.facts);
  result["way"] = motion.length;
  result["largest_speed"] = {{"speed", motion.largest_speed}, {"frame", motion.fastest_frame}};
  result["largest_turning"] = {{"angular_velocity", to_degrees(motion.largest_turning)},
                               {"frame", motion.fastest_turning_frame}};
  result["field_of_view"] = {{"smallest", to_degrees(motion.least_field_of_view)},
                             {"largest", to_degrees(motion.most_field_of_view)}};
  context.report.result = std::move(result);
  context.log(fmt::format("{}: {}, {} s{}{}; max {} m/s and {} degrees/s", context.output,
                          counted(track.frame_count(), "frame"), readable(duration, 4),
                          shot.words.empty() ? "" : "; ", shot.words,
                          readable(motion.largest_speed, 3),
                          readable(motion.largest_turning / kRadiansPerDegree, 3)));
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  const auto format = format_of(options, context.output);
  if (!format) return format.error();
  if (*format == Format::cam && options.given("--aspect") && !film_of(options)) {
    return Error("usage",
                 "--aspect is for glTF and for filming a motion; a .cam file does not store it",
                 "leave it out; krok-render --size WIDTHxHEIGHT gives the picture its shape");
  }
  auto shot = make_shot(options, context);
  if (!shot) return shot.error();
  shot->track.provenance = context.provenance();
  shot->track.provenance.conversions = shot->conversions;
  if (Status status = write(options, *format, shot->track, context); !status) {
    return status.error();
  }
  report(*shot, context);
  return kExitDone;
}

}  // namespace krok::cli::cam
