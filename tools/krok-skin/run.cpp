#include "tools/krok-skin/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <system_error>

#include "core/file.h"
#include "core/numbers.h"
#include "formats/io/open_motion.h"
#include "formats/io/open_scene.h"
#include "formats/registry/registry.h"
#include "tools/cli/paths.h"
#include "tools/cli/usage.h"
#include "tools/krok-skin/outputs.h"
#include "tools/krok-skin/subject.h"

namespace krok::cli::skin {

namespace {

// The file of the first motion, or of the mesh, for messages.
const std::string& motion_of(const Options& options) {
  return options.motions.empty() ? options.subject : options.motions.front();
}

Json clip_json(const std::string& name, double rate, int frames, double duration) {
  Json json;
  json["name"] = name;
  json["frames"] = frames;
  json["rate"] = rate;
  json["duration"] = duration;
  return json;
}

Json result_of(const Subject& subject, int frames) {
  Json result;
  result["vertices"] = subject.model.vertex_count();
  result["triangles"] = subject.model.triangles.size();
  result["joints"] = subject.model.skeleton.joint_count();
  result["frames"] = frames;
  result["rate"] = subject.clip.rate;
  result["clips"] = Json::array();
  if (!subject.clip_name.empty()) {
    result["clips"].push_back(
        clip_json(subject.clip_name, subject.clip.rate, subject.frame_count(), subject.duration()));
  }
  for (const Subject::Motion& other : subject.others) {
    const Clip& clip = other.clip;
    result["clips"].push_back(
        clip_json(other.name, clip.rate, clip.frame_count(), clip.duration()));
  }
  for (const Subject::Thing& thing : subject.things) {
    result["attached"].push_back(
        {{"name", thing.name},
         {"joint", subject.model.skeleton.names[static_cast<std::size_t>(thing.joint)]},
         {"vertices", thing.model.vertex_count()}});
  }
  if (subject.morphs.target_count() > 0) result["morph_targets"] = subject.morphs.names;
  return result;
}

// "; clips: walk (120), run (80) frames", of many "; 30 clips: ... and 25 more"; nothing for one.
std::string clips_text(const Subject& subject) {
  if (subject.others.empty()) return {};
  constexpr std::size_t kNamed = 5;
  const std::size_t count = 1 + subject.others.size();
  std::string text = count > kNamed ? fmt::format("; {} clips", count) : "; clips";
  text += fmt::format(": {} ({})", subject.clip_name, subject.clip.frame_count());
  for (std::size_t i = 0; i < std::min(kNamed, count) - 1; ++i) {
    const Subject::Motion& other = subject.others[i];
    text += fmt::format(", {} ({})", other.name, other.clip.frame_count());
  }
  text += " frames";
  return count > kNamed ? text + fmt::format(" and {} more", count - kNamed) : text;
}

struct Written {
  std::string names;  // for display
  int exit_code = kExitDone;
};

Result<Written> write(As as, const Options& options, const Subject& subject, ToolContext& context) {
  if (as == As::rig || as == As::motion) {
    if (subject.frame_count() == 0) {
      context.warn("skin-no-frames", "the motion has no frames; the rig is not animated");
    }
    if (as == As::motion) {
      if (Status status = write_motion(subject, context); !status) return status.error();
      return Written{context.output};
    }
    const auto kept = write_rig(options, subject, context);
    if (!kept) return kept.error();
    return Written{context.output, *kept ? kExitDone : kExitNo};
  }
  const SkinBinding binding(subject.model, options.method);
  if (as == As::frames) {
    auto names = write_frames(subject, binding, context);
    if (!names) return names.error();
    return Written{*std::move(names)};
  }
  if (as == As::baked) {
    Status status = write_baked(subject, binding, options.up, context);
    if (!status) return std::move(status.error()).in_file(motion_of(options));
    return Written{context.output};
  }
  const auto seconds = pose_time(options, subject.clip);
  if (!seconds) return seconds.error();
  if (Status status = write_pose(subject, binding, *seconds, context); !status)
    return status.error();
  return Written{context.output};
}

// Whether frames are written as they are read: --as rig and motion of one motion, with all keys.
bool is_streamed(As as, const Options& options) {
  return (as == As::rig || as == As::motion) && options.motions.size() == 1 && !options.retarget &&
         options.correctives.empty() && options.twist.bones.empty() &&
         options.influences == Influences::all && options.every == 1 && !options.reduce &&
         !options.quantize && !options.compress && !options.minify;
}

Result<int> run(As as, Options options, ToolContext& context, const LongTake* take) {
  auto subject = load(options, context, take);
  if (!subject) return subject.error();
  const bool every_frame = as == As::baked || as == As::frames;
  if (subject->frame_count() == 0 && every_frame) {
    return Error("skin-no-frames", "the motion has no frames",
                 "use --as pose for the reference pose")
        .in_file(motion_of(options));
  }
  const int frames = as == As::pose ? 1 : subject->frame_count();
  context.report.result = result_of(*subject, frames);
  apply_influence_limit(options, *subject, context);
  const auto written = write(as, options, *subject, context);
  if (!written) return written.error();
  context.log(as == As::frames
                  ? fmt::format("{}: {}", written->names, counted(frames, "file"))
                  : fmt::format("{}: {}, {}{}", written->names,
                                as == As::motion
                                    ? counted(subject->model.skeleton.joint_count(), "joint")
                                    : counted(subject->model.vertex_count(), "vertex", "vertices"),
                                counted(frames, "frame"), clips_text(*subject)));
  return written->exit_code;
}

}  // namespace

Result<int> run(const Options& given, ToolContext& context) {
  Options options = given;
  for (std::string& motion : options.motions) {
    NamedPath named = named_path(motion);
    options.clip_names.push_back(std::move(named.name));
    motion = std::move(named.path);
  }
  const As as = what_to_write(options, context.output);
  if (Status status = check_for(as, options); !status) return status.error();
  if (options.up == pc2::Up::z && extension(context.output) != ".pc2") {
    return usage("--up z is for a point cache", "OBJ and glTF have y up; write OUT.pc2");
  }
  if (Status status = check_output(as, context.output); !status) return status.error();
  std::error_code unknown;
  const bool streamed =
      is_streamed(as, options) && !io::is_scene(registry::kind_of_name(options.motions[0])) &&
      std::filesystem::file_size(options.motions[0], unknown) >= kLongTake && !unknown;
  if (!streamed) return run(as, options, context, nullptr);
  const auto subject = context.open_input(options.subject);
  if (!subject) return subject.error();
  const auto input = context.open_input(options.motions[0]);
  if (!input) return input.error();
  Result<int> result = kExitDone;
  Stretches stretches;
  std::function<Provenance()> provenance;
  const auto use = [&](const FrameSource& frames) -> Status {
    LongTake take{*subject, {}, frames};
    take.clip.skeleton = frames.skeleton;
    take.clip.rate = frames.rate;
    take.clip.provenance = provenance();
    result = run(as, options, context, stretches.empty() ? &take : nullptr);
    return result ? Status() : result.error();
  };
  const auto read =
      io::stream_motion(*input, context, use, {.stretches = &stretches, .provenance = &provenance});
  return read ? result : read.error();
}

}  // namespace krok::cli::skin
