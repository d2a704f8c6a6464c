#include "tools/common/motion_input.h"

#include <fmt/format.h>

#include <new>

#include "formats/acclaim/acclaim_reader.h"
#include "formats/acclaim/find_skeleton.h"
#include "formats/anim/anim.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/registry/registry.h"

namespace krok {

namespace {

using registry::Kind;

template <typename Options>
Options default_options(const ToolContext& context) {
  Options options;
  options.jobs = context.jobs;
  options.progress = context.progress;
  return options;
}

template <typename Capture>
Result<Clip> told(Result<Capture> capture, RestFrameTold rest_frame, ToolContext& context) {
  if (!capture) return std::move(capture).error();
  for (Diagnostic& diagnostic : capture->diagnostics) {
    if (rest_frame == RestFrameTold::note && diagnostic.severity == Severity::warning &&
        diagnostic.code.ends_with("-rest-frame")) {
      diagnostic.severity = Severity::note;
    }
  }
  context.tell(capture->diagnostics);
  return std::move(capture->clip);
}

Result<Clip> read_acclaim(const InputFile& motion, RestFrameTold rest_frame, ToolContext& context) {
  context.chose_beside(motion.path(), ".asf");
  const auto found = acclaim::find_skeleton(motion.path());
  if (!found) return found.error();
  const auto skeleton = context.open_input(found->path);
  if (!skeleton) return skeleton.error();
  Diagnostic note;
  note.severity = Severity::note;
  note.code = "acclaim-skeleton";
  note.message = fmt::format("{} is taken as its skeleton: {}", found->path, found->reason);
  note.hint = "krok-import with --skeleton takes another";
  note.where.file = motion.path();
  context.tell(std::move(note));
  return told(acclaim::read(skeleton->text(), skeleton->path(), motion.text(), motion.path(),
                            default_options<acclaim::ReadOptions>(context)),
              rest_frame, context);
}

bool is_capture(const InputFile& input) {
  const Kind kind = registry::identify(input.path(), input.bytes());
  return kind == Kind::bvh || kind == Kind::amc;
}

MotionFacts facts_of(const FrameSource& frames, std::vector<std::string> conversions) {
  return {frames.skeleton, frames.rate, frames.frame_count, frames.duration(),
          std::move(conversions)};
}

}  // namespace

ChecksumNoted::~ChecksumNoted() {
  try {
    context_.note_checksum(input_);
  } catch (const std::bad_alloc&) {  // the report goes without it
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

Result<Clip> read_motion(const InputFile& input, ToolContext& context, RestFrameTold rest_frame) {
  switch (registry::identify(input.path(), input.bytes())) {
    case Kind::bvh:
      return told(bvh::read(input.text(), input.path(), default_options<bvh::ReadOptions>(context)),
                  rest_frame, context);
    case Kind::amc:
      return read_acclaim(input, rest_frame, context);
    case Kind::asf:
      return Error("usage", "is a skeleton without a motion", "give the .amc file beside it")
          .in_file(input.path());
    default:
      break;
  }
  auto clip = anim::read(input.bytes());
  if (!clip) return std::move(clip.error()).in_file(input.path());
  return clip;
}

Result<Clip> read_motion(const std::string& path, ToolContext& context, RestFrameTold rest_frame) {
  const auto input = context.open_input(path);
  if (!input) return input.error();
  return read_motion(*input, context, rest_frame);
}

Result<MotionFacts> use_motion(const std::string& path, ToolContext& context,
                               const std::function<Status(const FrameSource& frames)>& use) {
  const auto input = context.open_long_input(path);
  if (!input) return input.error();
  const ChecksumNoted noted(*input, context);
  if (registry::identify(input->path(), input->bytes()) == Kind::bvh) {
    auto opened =
        bvh::open(input->text(), input->path(), default_options<bvh::ReadOptions>(context),
                  [&](std::size_t offset) { input->release_before(offset); });
    if (opened) {
      std::atomic<bool> faulty = false;
      const FrameSource frames = watched(opened->frames, faulty);
      const Status status = use(frames);
      if (!faulty) {
        if (!status) return status.error();
        context.tell(opened->diagnostics);
        return facts_of(frames, std::move(opened->clip.provenance.conversions));
      }
    }
  }
  const auto clip = read_motion(*input, context);
  if (!clip) return clip.error();
  const FrameSource frames = frames_of(*clip);
  if (Status status = use(frames); !status) return status.error();
  return facts_of(frames,
                  is_capture(*input) ? clip->provenance.conversions : std::vector<std::string>());
}

}  // namespace krok
