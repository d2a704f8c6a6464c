#include "formats/io/open_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <new>

#include "core/file.h"
#include "core/hash.h"
#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/anim/anim.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/io/formats.h"
#include "formats/io/readers_internal.h"
#include "formats/npy/array_reader.h"
#include "formats/role_map/role_map.h"

namespace krok::io {

void rest_frame_as_note(Diagnostics& found) {
  for (Diagnostic& diagnostic : found) {
    if (diagnostic.severity == Severity::warning && diagnostic.code.ends_with("-rest-frame")) {
      diagnostic.severity = Severity::note;
    }
  }
}

namespace {

CaptureReading reading_for(const Inputs& inputs) {
  CaptureReading reading;
  reading.jobs = inputs.jobs;
  reading.progress = inputs.progress;
  return reading;
}

MotionSummary summary_of(const FrameSource& frames, std::vector<std::string> conversions) {
  return {frames.skeleton,        frames.rate, frames.frame_count, frames.duration(),
          std::move(conversions), {}};
}

Result<std::vector<Actor::Motion>> read_scene_motions(const Format& format, const InputFile& file,
                                                      Inputs& inputs, const ActorOptions& options) {
  auto actor = read_scene_actor(format, file, inputs, options);
  if (!actor) return actor.error();
  if (actor->motions.empty()) {
    return Error("motion-missing", "the file has no animation",
                 "krok-import --save-character writes its skeleton and mesh")
        .in_file(file.path());
  }
  return std::move(actor->motions);
}

Result<Clip> read_scene_motion(const Format& format, const InputFile& file, Inputs& inputs,
                               const MotionOptions& options) {
  ActorOptions how;
  how.with_mesh = false;
  how.with_stretches = options.stretches != nullptr;
  how.rest_frame_is_note = options.rest_frame_is_note;
  how.with_weights = options.weights != nullptr;
  auto motions = read_scene_motions(format, file, inputs, how);
  if (!motions) return motions.error();
  Actor::Motion& motion = motions->front();
  if (options.stretches != nullptr) *options.stretches = std::move(motion.stretches);
  if (options.weights != nullptr) *options.weights = std::move(motion.weights);
  return std::move(motion.clip);
}

}  // namespace

Result<Clip> read_anim(const InputFile& file, Inputs& inputs, const MotionOptions& options) {
  const auto release = [&file](std::size_t offset) { file.release_before(offset); };
  if (auto opened = anim::open(file.bytes(), release); opened && !opened->stretched) {
    auto clip = load(opened->frames, inputs.jobs);
    if (!clip) return std::move(clip.error()).in_file(file.path());
    clip->provenance = std::move(opened->provenance);
    if (options.stretches != nullptr) options.stretches->clear();
    return clip;
  }
  Stretches stretches;
  auto clip = anim::read(file.bytes(), &stretches);
  if (!clip) return std::move(clip.error()).in_file(file.path());
  if (options.stretches != nullptr) {
    *options.stretches = std::move(stretches);
  } else if (!stretches.empty()) {
    const LargestStretch worst = largest_stretch(stretches, clip->joint_count());
    Diagnostic dropped = make_warning(
        "anim-stretch",
        fmt::format("joints change scale, {} by up to {}% in frame {}; this is not supported here: "
                    "they are taken as rigid",
                    shown(clip->skeleton.names[at(worst.joint)]), readable(100 * worst.size, 3),
                    worst.frame),
        "krok-skin and krok-export to glTF keep the scale", file.path());
    dropped.joint = clip->skeleton.names[at(worst.joint)];
    dropped.frame = worst.frame;
    inputs.diagnose(std::move(dropped));
  }
  return clip;
}

ChecksumAtEnd::~ChecksumAtEnd() {
  try {
    inputs_.note_checksum(input_);
  } catch (const std::bad_alloc&) {  // the report is written without it
  }
}

Result<Clip> open_motion(const InputFile& file, Inputs& inputs, const MotionOptions& options) {
  const Format& format = format_of(file);
  if (format.read_scene != nullptr) return read_scene_motion(format, file, inputs, options);
  if (format.companion) {
    return Error("usage", "is a skeleton without a motion", "give the .amc file beside it")
        .in_file(file.path());
  }
  if (format.open_capture == nullptr) {
    return (format.read_motion != nullptr ? format.read_motion : read_anim)(file, inputs, options);
  }
  auto opened = format.open_capture(file, inputs, reading_for(inputs), false);
  if (!opened) return opened.error();
  Capture& capture = *opened->capture;
  if (options.rest_frame_is_note) rest_frame_as_note(capture.diagnostics);
  inputs.diagnose(capture.diagnostics);
  return std::move(capture.clip);
}

Result<std::vector<Actor::Motion>> open_motions(const InputFile& file, Inputs& inputs) {
  const Format& format = format_of(file);
  if (format.read_scene != nullptr) {
    return read_scene_motions(format, file, inputs, {.every_clip = true, .with_mesh = false});
  }
  auto clip = open_motion(file, inputs);
  if (!clip) return clip.error();
  std::vector<Actor::Motion> motions(1);
  motions[0].clip = *std::move(clip);
  return motions;
}

Result<Clip> open_motion(const std::string& path, Inputs& inputs, const MotionOptions& options) {
  const auto file = inputs.open_input(path);
  if (!file) return file.error();
  return open_motion(*file, inputs, options);
}

Result<MotionSummary> stream_motion(const std::string& path, Inputs& inputs,
                                    const std::function<Status(const FrameSource& frames)>& use,
                                    const MotionOptions& options) {
  const auto file = inputs.open_long_input(path);
  if (!file) return file.error();
  const ChecksumAtEnd checksum(*file, inputs);
  return stream_motion(*file, inputs, use, options);
}

Result<MotionSummary> stream_motion(const InputFile& file, Inputs& inputs,
                                    const std::function<Status(const FrameSource& frames)>& use,
                                    const MotionOptions& options) {
  const Format& format = format_of(file);
  const auto give = [&](std::function<Provenance()> provenance) {
    if (options.provenance != nullptr) *options.provenance = std::move(provenance);
  };
  if (format.open_capture != nullptr && !format.companion) {
    MotionSummary summary;
    std::shared_ptr<Capture> capture;
    const Status status =
        use_capture(file, inputs, reading_for(inputs), false, [&](const OpenedCapture& opened) {
          capture = opened.capture;
          summary = summary_of(opened.frames, capture->clip.provenance.conversions);
          give([capture] { return capture->clip.provenance; });
          return use(opened.frames);
        });
    if (!status) return status.error();
    inputs.diagnose(capture->diagnostics);
    return summary;
  }
  // A .anim file's own conversions are those of how it was made.
  if (format.kind == registry::Kind::anim) {
    auto opened =
        anim::open(file.bytes(), [&file](std::size_t offset) { file.release_before(offset); });
    if (!opened) return Error(opened.error()).in_file(file.path());
    if (!opened->stretched) {
      // Else an error would get the name of the output that is being written.
      opened->frames.read = [&file,
                             read = std::move(opened->frames.read)](auto... block) -> Status {
        Status status = read(block...);
        if (!status) return std::move(status).error().in_file(file.path());
        return status;
      };
      if (options.stretches != nullptr) options.stretches->clear();
      give([&opened] { return opened->provenance; });
      if (Status status = use(opened->frames); !status) {
        return std::move(status.error()).in_file(file.path());
      }
      MotionSummary summary = summary_of(opened->frames, {});
      summary.removed_root_motion = opened->provenance.removed_root_motion;
      return summary;
    }
  }
  const auto clip = open_motion(file, inputs, options);
  if (!clip) return clip.error();
  give([&clip] { return clip->provenance; });
  const FrameSource frames = frames_of(*clip);
  if (Status status = use(frames); !status) return status.error();
  MotionSummary summary =
      summary_of(frames, format.read_scene != nullptr ? clip->provenance.conversions
                                                      : std::vector<std::string>());
  summary.removed_root_motion = clip->provenance.removed_root_motion;
  return summary;
}

Result<FindRoles> open_role_map(const std::string& path, Inputs& inputs) {
  if (path.empty()) {
    return FindRoles(
        [](const Skeleton& skeleton) { return Result<RoleMap>(find_roles(skeleton)); });
  }
  auto opened = inputs.open_input(path);
  if (!opened) return opened.error();
  const auto file = std::make_shared<const InputFile>(std::move(*opened));
  return FindRoles([file](const Skeleton& skeleton) {
    return role_map::read(file->text(), file->path(), skeleton);
  });
}

namespace {

// Of the hierarchy without the root's OFFSET, which some programs take from the first frame.
std::uint64_t key_of(std::string_view text) {
  std::string hierarchy(text.substr(0, text.find("MOTION")));
  const std::size_t offset = hierarchy.find("OFFSET");
  if (offset != std::string::npos) {
    hierarchy.erase(offset, std::min(hierarchy.find('\n', offset), hierarchy.size()) - offset);
  }
  return xxh3(std::as_bytes(std::span(hierarchy)));
}

std::optional<Conventions> conventions_of(const std::string& path) {
  const auto file = InputFile::open(path);
  if (!file) return std::nullopt;
  bvh::ReadOptions options;
  options.jobs = 1;
  if (const auto opened = bvh::open(file->text(), path, options)) return opened->conventions;
  auto read = bvh::read(file->text(), path, options);
  return read ? std::optional(read->conventions) : std::nullopt;
}

std::optional<Takes::Axes> vote(const std::vector<std::string>& paths) {
  constexpr std::size_t kAsked = 8;
  constexpr std::array kWeights = {1, 4, 16};  // of a guess, a likely axis, a certain one
  struct Votes {
    Conventions conventions;
    int weight = 0, count = 0;
  };
  std::map<std::array<Direction, 4>, Votes> all;
  std::vector<std::string> from;
  const std::size_t asked = std::min(kAsked, paths.size());
  for (std::size_t i = 0; i < asked; ++i) {
    from.push_back(paths[i * (paths.size() - 1) / (asked - 1)]);
    const auto found = conventions_of(from.back());
    if (!found) continue;
    Votes& votes = all[{found->up, found->forward, found->reference_up, found->reference_forward}];
    votes.weight += kWeights[static_cast<std::size_t>(found->up_confidence)];
    ++votes.count;
    if (votes.count == 1 || found->up_confidence > votes.conventions.up_confidence) {
      votes.conventions = *found;
    }
  }
  if (all.empty()) return std::nullopt;
  const auto& most =
      std::ranges::max_element(all, {}, [](const auto& one) { return one.second.weight; })->second;
  const Conventions& found = most.conventions;
  return Takes::Axes{
      found.up,
      found.forward,
      found.reference_up,
      found.reference_forward,
      std::min(found.up_confidence, Confidence::likely),
      std::min(found.forward_confidence, Confidence::likely),
      fmt::format("{} of {} takes of this skeleton in the batch have up {}, forward "
                  "{}",
                  most.count, asked, direction_name(found.up), direction_name(found.forward)),
      from};
}

}  // namespace

void Takes::find_groups() {
  if (std::exchange(found_, true)) return;
  std::ranges::sort(paths_);
  for (const std::string& path : paths_) {
    const auto file = InputFile::open(path);
    if (file && file->text().find("HIERARCHY") < 1000)
      groups_[key_of(file->text())].paths.push_back(path);
  }
}

std::optional<Takes::Axes> Takes::axes_for(std::string_view text) {
  const std::lock_guard lock(mutex_);
  find_groups();
  const auto group = groups_.find(key_of(text));
  if (group == groups_.end() || group->second.paths.size() < 2) return std::nullopt;
  if (!group->second.axes) group->second.axes = vote(group->second.paths);
  return group->second.axes;
}

namespace {

// What --skeleton names: a published order, a list of columns, a model of SMPL, a motion.
Status take_skeleton(const std::string& name, Inputs& inputs, npy::ReadOptions& options,
                     std::shared_ptr<const InputFile>& body) {
  options.columns_name = name;
  options.columns = named_skeleton(name);
  if (options.columns) return {};
  if (extension(name).empty()) {
    const std::vector<std::string> names = skeleton_names();
    const std::string nearest = nearest_name(name, names);
    return Error("npy-skeleton", fmt::format("there is no skeleton {}", shown(name)),
                 nearest.empty() ? fmt::format("known are {}", fmt::join(names, ", "))
                                 : fmt::format("did you mean {}? known are {}", nearest,
                                               fmt::join(names, ", ")));
  }
  auto opened = inputs.open_input(name);
  if (!opened) return opened.error();
  body = std::make_shared<const InputFile>(*std::move(opened));
  if (npy::is_smpl_body(body->bytes())) {
    options.body = body->bytes();
    return {};
  }
  if (without_byte_order_mark(trimmed(body->text().substr(0, 64))).starts_with('{')) {
    auto columns = npy::read_columns(body->text());
    if (!columns) return std::move(columns.error()).in_file(name);
    options.columns = *std::move(columns);
    return {};
  }
  PlainInputs quiet;  // the skeleton alone is of interest
  auto clip = open_motion(*body, quiet);
  if (!clip) return std::move(clip.error()).in_file(name);
  options.skeleton = std::move(clip->skeleton);
  return {};
}

}  // namespace

Result<OpenedCapture> open_arrays(const InputFile& file, Inputs& inputs,
                                  const CaptureReading& reading, bool stream) {
  if (Status status = check_bvh_choices(reading); !status) return status.error();
  if (reading.rest_frame != RestFrame::keep) {
    return Error("usage", "--skip-rest-frame is for BVH and AMC");
  }
  npy::ReadOptions options;
  static_cast<CaptureOptions&>(options) = reading;
  options.motion = reading.motion;
  std::shared_ptr<const InputFile> skeleton;
  if (!reading.skeleton.empty()) {
    Status status = take_skeleton(reading.skeleton, inputs, options, skeleton);
    if (!status) return status.error();
  }
  constexpr std::size_t kLongTransforms = std::size_t{1} << 19;
  if (stream) {
    if (auto found = npy::open(file.bytes(), file.path(), options, kLongTransforms)) {
      OpenedCapture opened;
      opened.streamed = true;
      opened.details.motions = static_cast<int>(found->motions);
      auto capture = std::make_shared<npy::OpenedCapture>(*std::move(found));
      opened.frames = capture->frames;
      opened.capture = std::move(capture);
      return opened;
    }
  }
  auto read = npy::read(file.bytes(), file.path(), options);
  if (!read) return std::move(read).error();
  CaptureDetails details;
  details.motions = static_cast<int>(read->motions);
  auto capture = std::make_shared<npy::Capture>(*std::move(read));
  OpenedCapture opened;
  opened.frames = frames_of(capture->clip);
  opened.capture = std::move(capture);
  opened.details = std::move(details);
  return opened;
}

}  // namespace krok::io
