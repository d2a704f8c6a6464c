#include "formats/io/open_capture.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <limits>

#include "core/numbers.h"
#include "formats/acclaim/acclaim_reader.h"
#include "formats/io/formats.h"
#include "formats/io/open_motion.h"
#include "formats/io/readers_internal.h"
#include "roles/body_frame.h"

namespace krok::io {

namespace {

CaptureDetails details_of(const bvh::Capture& capture) {
  CaptureDetails details;
  details.positions = capture.positions;
  if (!capture.exporter.choice.empty()) details.exporter = capture.exporter;
  details.frames_announced = capture.frames_announced;
  details.rest_frame = {capture.rest_frame_found, capture.rest_frame_dropped};
  return details;
}

CaptureDetails details_of(const acclaim::Capture& capture, bool has_motion) {
  CaptureDetails details;
  details.first_frame_number = capture.first_frame_number;
  if (has_motion) details.rest_frame = {capture.rest_frame_found, capture.rest_frame_dropped};
  return details;
}

template <typename FormatCapture>
OpenedCapture read_whole(FormatCapture read, CaptureDetails details) {
  auto capture = std::make_shared<FormatCapture>(std::move(read));
  OpenedCapture opened;
  opened.frames = frames_of(capture->clip);
  opened.capture = std::move(capture);
  opened.details = std::move(details);
  return opened;
}

using Companion = CaptureDetails::Companion;

// The skeleton beside a motion, with a note.
Result<Companion> find_companion(const InputFile& motion, Inputs& inputs) {
  if (motion.path() == "-") {
    return Error("acclaim-skeleton", "an Acclaim motion needs its skeleton",
                 "give the name of a file with its .asf beside it")
        .in_file(motion.path());
  }
  inputs.depends_on_neighbours(motion.path(), ".asf");
  auto found = acclaim::find_skeleton(motion.path());
  if (!found) {
    Error error = std::move(found).error();
    error.hint = "put its skeleton beside it";
    return error;
  }
  inputs.diagnose(
      make_diagnostic(Severity::note, "acclaim-skeleton",
                      fmt::format("{} is used as the skeleton: {}", found->path, found->reason),
                      "krok-import with --skeleton FILE.asf selects another", motion.path()));
  return Companion{found->path, found->reason};
}

Status check_no_skeleton(const InputFile& file, const CaptureReading& reading) {
  if (reading.skeleton.empty()) return {};
  return Error("usage",
               fmt::format("--skeleton is for an Acclaim motion (AMC) and for arrays (.npy, .npz), "
                           "which {} is not",
                           file.path()),
               "leave it out: other files have their skeleton, but tables of OpenSim (.mot, .sto), "
               "which are only written");
}

acclaim::ReadOptions acclaim_options(const CaptureReading& reading) {
  acclaim::ReadOptions options;
  static_cast<CaptureOptions&>(options) = reading;
  options.rest_frame = reading.rest_frame;
  return options;
}

// The same frames; `faulty` becomes true when one cannot be read, whatever their user makes of it.
FrameSource watched(const FrameSource& frames, std::atomic<bool>& faulty) {
  FrameSource watching = frames;
  watching.read = [&faulty, read = frames.read](int first, int count, std::span<Vec3f> positions,
                                                std::span<Quatf> orientations) {
    Status status = read(first, count, positions, orientations);
    if (!status) faulty = true;
    return status;
  };
  return watching;
}

Result<OpenedCapture> open_bvh_with(const InputFile& file, const CaptureReading& reading,
                                    bool stream) {
  bvh::ReadOptions options;
  static_cast<CaptureOptions&>(options) = reading;
  options.positions = reading.positions;
  options.angles = reading.angles;
  options.rest_frame = reading.rest_frame;
  if (stream) {
    auto streamed = bvh::open(file.text(), file.path(), options,
                              [&file](std::size_t offset) { file.release_before(offset); });
    if (streamed) {
      OpenedCapture opened;
      opened.details = details_of(*streamed);
      opened.streamed = true;
      auto capture = std::make_shared<bvh::OpenedCapture>(*std::move(streamed));
      opened.frames = capture->frames;
      opened.capture = std::move(capture);
      return opened;
    }
  }
  auto read = bvh::read(file.text(), file.path(), options);
  if (!read) return std::move(read).error();
  CaptureDetails details = details_of(*read);
  return read_whole(*std::move(read), std::move(details));
}

}  // namespace

Status check_bvh_choices(const CaptureReading& reading) {
  if (reading.positions != bvh::Positions::automatic) {
    return Error("usage", "--positions is for BVH; other formats have no such choice");
  }
  if (reading.angles != bvh::Angles::degrees) return Error("usage", "--angles is for BVH");
  return {};
}

Result<OpenedCapture> open_bvh(const InputFile& file, Inputs& inputs, const CaptureReading& reading,
                               bool stream) {
  if (Status status = check_no_skeleton(file, reading); !status) return status.error();
  auto opened = open_bvh_with(file, reading, stream);
  if (!opened || inputs.takes == nullptr || reading.up || reading.forward || reading.roles) {
    return opened;
  }
  const Conventions& alone = opened->capture->conventions;
  // What is no person shows no axes in other takes either.
  if (alone.up_confidence == Confidence::certain || !opened->capture->roles.humanoid) return opened;
  const auto axes = inputs.takes->axes_for(file.text());
  if (!axes) return opened;
  // The result depends on the takes asked, and on which takes there are.
  for (const std::string& path : axes->from) {
    if (path == file.path()) continue;
    if (const auto asked = inputs.open_input(path); !asked) return asked.error();
  }
  inputs.depends_on_neighbours(file.path(), ".bvh");
  const bool same = axes->up == alone.up && axes->forward == alone.forward &&
                    axes->reference_up == alone.reference_up &&
                    axes->reference_forward == alone.reference_forward;
  if (same && axes->confidence <= alone.up_confidence) return opened;
  CaptureReading agreed = reading;
  agreed.up = axes->up;
  agreed.forward = axes->forward;
  agreed.reference_up = axes->reference_up;
  agreed.reference_forward = axes->reference_forward;
  // A take that clearly shows other axes remains doubtful.
  const bool contrary = axes->up != alone.up && alone.up_confidence == Confidence::likely;
  agreed.axes_confidence = contrary ? Confidence::guess : axes->confidence;
  agreed.forward_confidence = std::min(agreed.axes_confidence, axes->forward_confidence);
  agreed.axes_reason =
      axes->reason + (axes->up == alone.up ? "" : "; by itself: " + alone.up_reason);
  return open_bvh_with(file, agreed, stream);
}

Result<OpenedCapture> open_amc(const InputFile& file, Inputs& inputs, const CaptureReading& reading,
                               bool /*stream*/) {
  if (Status status = check_bvh_choices(reading); !status) return status.error();
  std::optional<Companion> companion;
  if (reading.skeleton.empty()) {
    auto found = find_companion(file, inputs);
    if (!found) return found.error();
    companion = *std::move(found);
  } else if (const auto own = acclaim::find_skeleton(file.path());
             own && own->by_name && base_name(own->path) != base_name(reading.skeleton)) {
    inputs.diagnose(make_warning(
        "acclaim-skeleton",
        fmt::format("{} has the motion's name, and {} is used as its skeleton, as given", own->path,
                    reading.skeleton),
        "without --skeleton the motion's own is used", file.path()));
  }
  const auto skeleton = inputs.open_input(companion ? companion->path : reading.skeleton);
  if (!skeleton) return skeleton.error();
  auto read = acclaim::read(skeleton->text(), skeleton->path(), file.text(), file.path(),
                            acclaim_options(reading));
  if (!read) return std::move(read).error();
  CaptureDetails details = details_of(*read, true);
  details.skeleton = std::move(companion);
  return read_whole(*std::move(read), std::move(details));
}

Result<OpenedCapture> open_asf(const InputFile& file, Inputs& /*inputs*/,
                               const CaptureReading& reading, bool /*stream*/) {
  if (Status status = check_no_skeleton(file, reading); !status) return status.error();
  if (Status status = check_bvh_choices(reading); !status) return status.error();
  auto read = acclaim::read(file.text(), file.path(), {}, {}, acclaim_options(reading));
  if (!read) return std::move(read).error();
  CaptureDetails details = details_of(*read, false);
  return read_whole(*std::move(read), std::move(details));
}

namespace {

// A motion without conventions to choose, as a capture. Krok's own needs no import.
Result<OpenedCapture> open_as_capture(const Format& format, const InputFile& file, Inputs& inputs,
                                      const CaptureReading& reading) {
  if (Status status = check_no_skeleton(file, reading); !status) return status.error();
  if (Status status = check_bvh_choices(reading); !status) return status.error();
  auto clip = format.read_motion(file, inputs, {});
  if (!clip) return clip.error();
  auto roles = roles_of(clip->skeleton, reading);
  if (!roles) return roles.error();
  Capture capture;
  capture.clip = *std::move(clip);
  capture.roles = *std::move(roles);
  return read_whole(std::move(capture), {});
}

// The median of how long bones are in a pose, over their length in the skeleton.
double growth_of(const Skeleton& skeleton, std::span<const Vec3f> pose) {
  std::vector<double> ratios;
  for (std::size_t j = 0; j < pose.size(); ++j) {
    const int parent = skeleton.parents[j];
    if (parent < 0) continue;
    const auto above = static_cast<std::size_t>(parent);
    const double length =
        (skeleton.reference[j].position - skeleton.reference[above].position).norm();
    if (length > 0) {
      ratios.push_back(static_cast<double>((pose[j] - pose[above]).norm()) / length);
    }
  }
  if (ratios.empty()) return 1;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::ranges::nth_element(ratios, middle);
  return *middle;
}

// Warns of a motion in another unit than its skeleton: its bones are longer, or its body is over
// the ground all the time, by more than a person jumps or climbs.
void warn_of_another_unit(const OpenedCapture& opened) {
  const FrameSource& frames = opened.frames;
  const auto stature = stature_of(frames.skeleton, opened.capture->roles);
  if (!stature || frames.frame_count == 0) return;
  constexpr int kLooks = 32;
  constexpr double kHigh = 0.4;    // of the stature
  constexpr double kLonger = 1.5;  // than in the skeleton
  std::vector<Vec3f> places(frames.skeleton.names.size());
  std::vector<Quatf> turns(places.size());
  double lowest = std::numeric_limits<double>::infinity(), growth = 1;
  for (int look = 0; look < kLooks; ++look) {
    const long long frame = static_cast<long long>(look) * frames.frame_count / kLooks;
    if (!frames.read(static_cast<int>(frame), 1, places, turns)) return;
    if (look == 0) growth = growth_of(frames.skeleton, places);
    for (const Vec3f& place : places) {
      lowest = std::min(lowest, static_cast<double>(place.y()));
    }
  }
  Diagnostics& found = opened.capture->diagnostics;
  if (growth > kLonger || growth < 1 / kLonger) {
    found.push_back(make_warning(
        "motion-scale",
        fmt::format("bones are {} times as long as in the skeleton", readable(growth, 3)),
        "are the positions of joints in another unit than the skeleton?"));
  } else if (lowest > kHigh * stature->metres) {
    found.push_back(make_warning(
        "motion-height",
        fmt::format("the lowest joint is {} m or more above the ground, of a person of {} m",
                    readable(lowest, 3), readable(stature->metres, 3)),
        "are the positions of the root in another unit than the skeleton? krok-edit --on-ground "
        "lowers a motion"));
  }
}

}  // namespace

Status use_capture(const InputFile& file, Inputs& inputs, const CaptureReading& reading, bool whole,
                   const std::function<Status(const OpenedCapture& opened)>& use) {
  const Format& format = format_of(file);
  const auto open = [&](bool stream) {
    if (format.open_capture != nullptr) return format.open_capture(file, inputs, reading, stream);
    if (format.read_motion != nullptr && format.kind != registry::Kind::anim) {
      return open_as_capture(format, file, inputs, reading);
    }
    return open_bvh(file, inputs, reading, stream);
  };
  auto opened = open(!whole);
  if (!opened) return opened.error();
  warn_of_another_unit(*opened);
  if (opened->streamed) {
    std::atomic<bool> faulty = false;
    opened->frames = watched(opened->frames, faulty);
    Status status = use(*opened);
    if (!faulty) return status;
    opened = open(false);
    if (!opened) return opened.error();
  }
  return use(*opened);
}

}  // namespace krok::io
