#include "tools/krok-import/source.h"

#include <fmt/format.h>

#include "formats/acclaim/acclaim_reader.h"
#include "formats/acclaim/find_skeleton.h"
#include "tools/common/json_object.h"
#include "tools/krok-import/facts.h"

namespace krok::import {

namespace {

using registry::Kind;

Result<Source> read_bvh(const InputFile& input, const Options& options, const CaptureOptions& how) {
  auto read = bvh::read(input.text(), input.path(), bvh_options(options, how));
  if (!read) return std::move(read).error();
  Source source;
  source.details = details_of(*read);
  source.capture = std::move(*read);
  return source;
}

// Report entry for a first frame that may not be part of the motion.
template <typename Capture>
Json rest_frame_of(const Capture& capture) {
  return {{"found", capture.rest_frame_found}, {"left_out", capture.rest_frame_dropped}};
}

Result<Source> read_acclaim(const InputFile& skeleton, const InputFile* motion,
                            const Options& options, const CaptureOptions& how) {
  acclaim::ReadOptions reading;
  static_cast<CaptureOptions&>(reading) = how;
  reading.rest_frame = options.rest_frame;
  auto read = motion == nullptr ? acclaim::read(skeleton.text(), skeleton.path(), {}, {}, reading)
                                : acclaim::read(skeleton.text(), skeleton.path(), motion->text(),
                                                motion->path(), reading);
  if (!read) return std::move(read).error();
  Source source;
  source.details["first_frame_number"] = read->first_frame_number;
  if (motion != nullptr) source.details["rest_frame"] = rest_frame_of(*read);
  source.capture = std::move(*read);
  return source;
}

// Path of a motion's skeleton: as given, or found beside it, with a note.
Result<std::string> skeleton_for(const std::string& motion, const Options& options,
                                 ToolContext& context) {
  if (!options.skeleton.empty()) return options.skeleton;
  constexpr const char* kHint = "use --skeleton FILE.asf";
  if (options.input == "-") {
    return Error("acclaim-skeleton", "an Acclaim motion needs its skeleton", kHint).in_file(motion);
  }
  context.depends_on_neighbours(motion, ".asf");
  auto found = acclaim::find_skeleton(motion);
  if (!found) {
    Error error = std::move(found).error();
    error.hint = kHint;
    return error;
  }
  Diagnostic note;
  note.severity = Severity::note;
  note.code = "acclaim-skeleton";
  note.message = fmt::format("{} is used as the skeleton: {}", found->path, found->reason);
  note.hint = "select another with --skeleton FILE.asf";
  note.where.file = motion;
  context.diagnose(std::move(note));
  return found->path;
}

Status check_options(const Options& options, bool is_bvh, bool is_motion) {
  if (!is_motion && !options.skeleton.empty()) {
    return Error("usage", fmt::format("--skeleton is for an Acclaim motion (AMC), which {} is not",
                                      options.input));
  }
  if (is_bvh) return {};
  if (options.positions != bvh::Positions::automatic) {
    return Error("usage", "--positions is for BVH; the Acclaim format has no such choice");
  }
  if (options.angles != bvh::Angles::degrees) return Error("usage", "--angles is for BVH");
  return {};
}

}  // namespace

Json details_of(const bvh::Capture& capture) {
  Json details = object_for(4);
  details["positions"] = to_json(capture.positions);
  if (!capture.exporter.choice.empty()) details["exporter"] = to_json(capture.exporter);
  details["frames_announced"] = capture.frames_announced;
  details["rest_frame"] = rest_frame_of(capture);
  return details;
}

bvh::ReadOptions bvh_options(const Options& options, const CaptureOptions& how) {
  bvh::ReadOptions result;
  static_cast<CaptureOptions&>(result) = how;
  result.positions = options.positions;
  result.angles = options.angles;
  result.rest_frame = options.rest_frame;
  return result;
}

Result<Source> read_source(const InputFile& input, Kind kind, const Options& options,
                           ToolContext& context) {
  auto how = read_options(options);
  if (!how) return how.error();
  how->jobs = context.jobs;
  how->progress = context.progress;
  const bool is_motion = kind == Kind::amc;
  const bool is_bvh = !is_motion && kind != Kind::asf;  // the BVH reader rejects unknown formats
  if (Status status = check_options(options, is_bvh, is_motion); !status) return status.error();
  if (is_bvh) return read_bvh(input, options, *how);
  if (!is_motion) return read_acclaim(input, nullptr, options, *how);
  const auto path = skeleton_for(input.path(), options, context);
  if (!path) return path.error();
  const auto skeleton = context.open_input(*path);
  if (!skeleton) return skeleton.error();
  return read_acclaim(*skeleton, &input, options, *how);
}

}  // namespace krok::import
