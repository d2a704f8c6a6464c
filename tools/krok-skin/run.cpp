#include "tools/krok-skin/run.h"

#include <fmt/format.h>

#include "core/numbers.h"
#include "tools/krok-skin/outputs.h"
#include "tools/krok-skin/small_rig.h"
#include "tools/krok-skin/subject.h"

namespace krok::cli::skin {

namespace {

Json result_of(const Subject& subject, int frames) {
  Json result;
  result["vertices"] = subject.model.vertex_count();
  result["triangles"] = subject.model.triangles.size();
  result["joints"] = subject.model.skeleton.joint_count();
  result["frames"] = frames;
  result["rate"] = subject.clip.rate;
  if (subject.morphs.target_count() > 0) result["morph_targets"] = subject.morphs.names;
  return result;
}

// Writes the output; returns its names for display.
Result<std::string> write(const Options& options, const Subject& subject, ToolContext& context) {
  if (options.as == As::rig) {
    if (subject.clip.frame_count() == 0) {
      context.warn("skin-no-frames", "the motion has no frames; the rig is not animated");
    }
    if (Status status = write_rig(options, subject, context); !status) return status.error();
    return context.output;
  }
  const SkinBinding binding(subject.model, options.method);
  if (options.as == As::frames) return write_frames(subject, binding, context);
  if (options.as == As::clip) {
    Status status = write_clip(subject, binding, options.up, context);
    if (!status) return std::move(status.error()).in_file(options.motion);
    return context.output;
  }
  const auto seconds = pose_time(options, subject.clip);
  if (!seconds) return seconds.error();
  if (Status status = write_pose(subject, binding, *seconds, context); !status)
    return status.error();
  return context.output;
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  if (Status status = check(options); !status) return status.error();
  if (Status status = check_output(options.as, context.output); !status) return status.error();
  auto subject = load(options, context);
  if (!subject) return subject.error();
  const bool every_frame = options.as == As::clip || options.as == As::frames;
  if (subject->clip.frame_count() == 0 && every_frame) {
    return Error("skin-no-frames", "the motion has no frames",
                 "use --as pose for the reference pose")
        .in_file(options.motion);
  }
  const int frames = options.as == As::pose ? 1 : subject->clip.frame_count();
  context.report.result = result_of(*subject, frames);
  apply_influence_limit(options, *subject, context);
  const auto written = write(options, *subject, context);
  if (!written) return written.error();
  context.log(options.as == As::frames
                  ? fmt::format("{}: {}", *written, counted(frames, "file"))
                  : fmt::format("{}: {}, {}", *written,
                                counted(subject->model.vertex_count(), "vertex", "vertices"),
                                counted(frames, "frame")));
  return kExitDone;
}

}  // namespace krok::cli::skin
