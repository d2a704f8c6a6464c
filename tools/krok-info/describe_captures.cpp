#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/parallel.h"
#include "core/text.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/io/open_capture.h"
#include "formats/io/open_motion.h"
#include "tools/krok-info/describe.h"

namespace krok::cli::info {

namespace {

// Facts common to all captures. `measured` names the pose that the size is measured in.
Status add_capture(const Capture& capture, const std::string& measured, const SkeletonOptions& how,
                   Description& out) {
  const Clip& clip = capture.clip;
  if (Status status = add_skeleton(clip.skeleton, how, out); !status) return status.error();
  std::vector<Vec3> positions;
  for (const Transform& joint : clip.skeleton.reference) positions.push_back(joint.position);
  add_size<Vec3>(positions, measured, out);
  add_conventions(capture.conventions, out);
  return {};
}

// Without its frames, if they need not be in memory to find faults.
Result<bvh::Capture> read_bvh(const InputFile& file, const bvh::ReadOptions& options,
                              int& frame_count) {
  if (auto opened = bvh::open(file.text(), file.path(), options,
                              [&](std::size_t offset) { file.release_before(offset); })) {
    frame_count = opened->frames.frame_count;
    if (read_through(opened->frames, options.jobs)) return static_cast<bvh::Capture&>(*opened);
  }
  auto capture = bvh::read(file.text(), file.path(), options);
  if (capture) frame_count = capture->clip.frame_count();
  return capture;
}

}  // namespace

Result<Description> describe_bvh(const InputFile& file, const SkeletonOptions& how,
                                 ToolContext& context) {
  bvh::ReadOptions options;
  options.jobs = context.jobs;
  options.progress = context.progress;
  int frame_count = 0;
  const auto capture = read_bvh(file, options, frame_count);
  if (!capture) return capture.error();
  context.diagnose(capture->diagnostics);
  Description out;
  out.what = "a capture (BVH), as read by krok-import";
  out.json["kind"] = "bvh";
  add_timing(frame_count, capture->clip.rate, out);
  out.json["frames_announced"] = capture->frames_announced;
  out.json["frame_time"] = capture->frame_time;
  if (Status status = add_capture(*capture, "joints with all rotations 0", how, out); !status)
    return status.error();
  add_choice("positions", capture->positions, out);
  out.json["rest_frame"] = capture->rest_frame_found;
  if (capture->rest_frame_found) out.add("rest pose", "frame 0, not part of the motion");
  return out;
}

Result<Description> describe_acclaim(const InputFile& file, const SkeletonOptions& how,
                                     ToolContext& context) {
  io::CaptureReading reading;
  reading.jobs = context.jobs;
  reading.progress = context.progress;
  Description out;
  const Status status =
      io::use_capture(file, context, reading, true, [&](const io::OpenedCapture& opened) -> Status {
        const Capture& capture = *opened.capture;
        const bool is_motion = opened.details.skeleton.has_value();
        out.what = is_motion ? "a capture (AMC), as read by krok-import"
                             : "a skeleton (ASF), as read by krok-import";
        out.json["kind"] = is_motion ? "amc" : "asf";
        if (is_motion) {
          out.add("skeleton", fmt::format("{} ({})", opened.details.skeleton->path,
                                          opened.details.skeleton->reason));
          out.json["skeleton_file"] = opened.details.skeleton->path;
        }
        context.diagnose(capture.diagnostics);
        if (is_motion) add_timing(capture.clip.frame_count(), capture.clip.rate, out);
        return add_capture(capture, "joints in the reference pose", how, out);
      });
  if (!status) return status.error();
  return out;
}

Result<Description> describe_motion(const InputFile& file, const SkeletonOptions& how,
                                    ToolContext& context) {
  const auto clip = io::open_motion(file, context);
  if (!clip) return clip.error();
  const std::string ending = extension(file.path());
  Description out;
  out.what = fmt::format("a motion ({})", ending);
  out.json["kind"] = ending.empty() ? ending : ending.substr(1);
  add_timing(clip->frame_count(), clip->rate, out);
  if (Status status = add_skeleton(clip->skeleton, how, out); !status) return status.error();
  std::vector<Vec3> positions;
  for (const Transform& joint : clip->skeleton.reference) positions.push_back(joint.position);
  add_size<Vec3>(positions, "joints in the reference pose", out);
  return out;
}

}  // namespace krok::cli::info
