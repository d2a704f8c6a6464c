#include "formats/io/open_motion.h"

#include <fmt/format.h>

#include <new>

#include "formats/acclaim/acclaim_reader.h"
#include "formats/acclaim/find_skeleton.h"
#include "formats/anim/anim.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/io/readers_internal.h"

namespace krok::io {

namespace {

template <typename Options>
Options options_for(const Inputs& inputs) {
  Options options;
  options.jobs = inputs.jobs;
  options.progress = inputs.progress;
  return options;
}

// The clip of a capture, with what its reader reported passed on.
template <typename Capture>
Result<Clip> clip_of(Result<Capture> capture, Inputs& inputs, const MotionOptions& options) {
  if (!capture) return std::move(capture).error();
  for (Diagnostic& diagnostic : capture->diagnostics) {
    if (options.rest_frame_is_note && diagnostic.severity == Severity::warning &&
        diagnostic.code.ends_with("-rest-frame")) {
      diagnostic.severity = Severity::note;
    }
  }
  inputs.diagnose(capture->diagnostics);
  return std::move(capture->clip);
}

MotionSummary summary_of(const FrameSource& frames, std::vector<std::string> conversions) {
  return {frames.skeleton, frames.rate, frames.frame_count, frames.duration(),
          std::move(conversions)};
}

}  // namespace

Result<Clip> read_anim(const InputFile& file, Inputs& /*inputs*/,
                       const MotionOptions& /*options*/) {
  auto clip = anim::read(file.bytes());
  if (!clip) return std::move(clip.error()).in_file(file.path());
  return clip;
}

Result<Clip> read_bvh(const InputFile& file, Inputs& inputs, const MotionOptions& options) {
  return clip_of(bvh::read(file.text(), file.path(), options_for<bvh::ReadOptions>(inputs)), inputs,
                 options);
}

std::optional<MotionStream> stream_bvh(const InputFile& file, Inputs& inputs) {
  auto opened = bvh::open(file.text(), file.path(), options_for<bvh::ReadOptions>(inputs),
                          [&file](std::size_t offset) { file.release_before(offset); });
  if (!opened) return std::nullopt;
  return MotionStream{std::move(opened->frames), std::move(opened->clip.provenance.conversions),
                      std::move(opened->diagnostics)};
}

Result<Clip> read_amc(const InputFile& file, Inputs& inputs, const MotionOptions& options) {
  inputs.depends_on_neighbours(file.path(), ".asf");
  const auto found = acclaim::find_skeleton(file.path());
  if (!found) return found.error();
  const auto skeleton = inputs.open_input(found->path);
  if (!skeleton) return skeleton.error();
  Diagnostic note;
  note.severity = Severity::note;
  note.code = "acclaim-skeleton";
  note.message = fmt::format("{} is taken as its skeleton: {}", found->path, found->reason);
  note.hint = "krok-import with --skeleton takes another";
  note.where.file = file.path();
  inputs.diagnose(std::move(note));
  return clip_of(acclaim::read(skeleton->text(), skeleton->path(), file.text(), file.path(),
                               options_for<acclaim::ReadOptions>(inputs)),
                 inputs, options);
}

ChecksumAtEnd::~ChecksumAtEnd() {
  try {
    inputs_.note_checksum(input_);
  } catch (const std::bad_alloc&) {  // the report is written without it
  }
}

FrameSource watched(const FrameSource& frames, std::atomic<bool>& faulty) {
  FrameSource watching = frames;
  watching.read = [&](int first, int count, std::span<Vec3f> positions,
                      std::span<Quatf> orientations) {
    Status status = frames.read(first, count, positions, orientations);
    if (!status) faulty = true;
    return status;
  };
  return watching;
}

Result<Clip> open_motion(const InputFile& file, Inputs& inputs, const MotionOptions& options) {
  const registry::Kind kind = registry::identify(file.path(), file.bytes());
  if (kind == registry::Kind::asf) {
    return Error("usage", "is a skeleton without a motion", "give the .amc file beside it")
        .in_file(file.path());
  }
  const Format& format = format_of(kind);
  return (format.read_motion != nullptr ? format.read_motion : read_anim)(file, inputs, options);
}

Result<Clip> open_motion(const std::string& path, Inputs& inputs, const MotionOptions& options) {
  const auto file = inputs.open_input(path);
  if (!file) return file.error();
  return open_motion(*file, inputs, options);
}

Result<MotionSummary> stream_motion(const std::string& path, Inputs& inputs,
                                    const std::function<Status(const FrameSource& frames)>& use) {
  const auto file = inputs.open_long_input(path);
  if (!file) return file.error();
  const ChecksumAtEnd checksum(*file, inputs);
  const Format& format = format_of(*file);
  if (format.stream_motion != nullptr) {
    if (auto stream = format.stream_motion(*file, inputs)) {
      std::atomic<bool> faulty = false;
      const FrameSource frames = watched(stream->frames, faulty);
      const Status status = use(frames);
      if (!faulty) {
        if (!status) return status.error();
        inputs.diagnose(stream->diagnostics);
        return summary_of(frames, std::move(stream->conversions));
      }
    }
  }
  auto clip = open_motion(*file, inputs);
  if (!clip) return clip.error();
  const FrameSource frames = frames_of(*clip);
  if (Status status = use(frames); !status) return status.error();
  // A .anim file's own conversions are those of how it was made.
  const bool is_capture = format.kind != registry::Kind::anim;
  return summary_of(
      frames, is_capture ? std::move(clip->provenance.conversions) : std::vector<std::string>());
}

}  // namespace krok::io
