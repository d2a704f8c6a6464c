#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/index.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "core/text.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/io/open_capture.h"
#include "formats/io/open_motion.h"
#include "tools/krok-info/describe.h"
#include "tools/shared/role_report.h"

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

std::vector<int> depths_of(const Skeleton& skeleton) {
  std::vector<int> depths;
  for (const int parent : skeleton.parents) {
    depths.push_back(parent < 0 ? 0 : depths[at(parent)] + 1);
  }
  return depths;
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
  Description out("a capture (BVH), as read by krok-import", "bvh");
  add_timing(frame_count, capture->clip.rate, out);
  out.json["frames_announced"] = capture->frames_announced;
  out.json["frame_time"] = capture->frame_time;
  if (Status status = add_capture(*capture, "joints with all rotations 0", how, out); !status)
    return status.error();
  add_choice("positions", capture->positions, out);
  out.json["rest_frame"] = capture->rest_frame_found;
  if (capture->rest_frame_found)
    out.add("rest pose", "frame 0; it is kept, --skip-rest-frame auto of krok-import drops it");
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
  Description out(fmt::format("a motion ({})", ending), ending.empty() ? ending : ending.substr(1));
  add_timing(clip->frame_count(), clip->rate, out);
  if (Status status = add_skeleton(clip->skeleton, how, out); !status) return status.error();
  std::vector<Vec3> positions;
  for (const Transform& joint : clip->skeleton.reference) positions.push_back(joint.position);
  add_size<Vec3>(positions, "joints in the reference pose", out);
  return out;
}

void add_skeleton(const Skeleton& skeleton, const RoleMap& map, bool verbose, double metres,
                  Description& out) {
  const auto ends = std::count(skeleton.end_sites.begin(), skeleton.end_sites.end(), 1);
  std::string joints = grouped(skeleton.joint_count());
  if (ends > 0) joints += fmt::format(", {} of them end sites", ends);
  out.add("joints", joints);
  for (RoleRow& row : role_rows(skeleton, map)) out.add(std::move(row.label), std::move(row.text));

  auto stature = stature_of(skeleton, map);
  if (stature) {
    stature->metres *= metres;
    stature->uncertainty *= metres;
    out.add("stature",
            fmt::format("{} m, within {} m, by the lengths of legs, spine and arms",
                        readable(stature->metres, 3), readable(stature->uncertainty, 2)));
  }
  out.json["stature"] = stature_json(stature);
  out.json["joints"] = skeleton.joint_count();
  out.json["end_sites"] = ends;
  out.json.update(roles_json(skeleton, map));
  out.json["skeleton"] = Json::array();
  std::vector<std::string> lines;
  const std::vector<int> depths = depths_of(skeleton);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const std::string label = role_label(map, j);
    lines.push_back(fmt::format("{:<23} {:>{}}{}", label == "none" ? "-" : label, "",
                                2 * std::min(depths[at(j)], 40), skeleton.names[at(j)]));
    const int parent = skeleton.parents[at(j)];
    const Vec3 place = metres * skeleton.reference[at(j)].position;
    const Quat& turn = skeleton.reference[at(j)].orientation;
    out.json["skeleton"].push_back(
        {{"joint", skeleton.names[at(j)]},
         {"parent", parent < 0 ? Json() : Json(skeleton.names[at(parent)])},
         {"role", label == "none" ? Json() : Json(label)},
         {"position", {place.x(), place.y(), place.z()}},
         {"orientation", {turn.x(), turn.y(), turn.z(), turn.w()}}});
  }
  if (verbose) out.add("roles", std::move(lines));
}

Status add_skeleton(const Skeleton& skeleton, const SkeletonOptions& options, Description& out) {
  const auto map = options.roles(skeleton);
  if (!map) return map.error();
  add_skeleton(skeleton, *map, options.verbose, 1, out);
  return {};
}

}  // namespace krok::cli::info
