#include "tools/krok-import/stream.h"

#include <fmt/format.h>

#include <atomic>

#include "formats/anim/anim.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/io/open_motion.h"
#include "formats/model/model_format.h"
#include "scene/model.h"
#include "tools/common/output_kind.h"
#include "tools/common/output_set.h"
#include "tools/krok-import/facts.h"
#include "tools/krok-import/source.h"

namespace krok::import {

std::optional<Result<int>> stream_capture(const InputFile& input, registry::Kind kind,
                                          const Options& options, ToolContext& context) {
  using registry::Kind;
  if (kind != Kind::bvh || context.output.empty() || options.resample > 0 ||
      !options.skeleton.empty() || !check_output_kind(context.output, "-o", Kind::anim)) {
    return std::nullopt;
  }
  auto how = read_options(options);
  if (!how) return std::nullopt;
  how->jobs = context.jobs;
  how->progress = context.progress;
  auto capture = bvh::open(input.text(), input.path(), bvh_options(options, *how),
                           [&](std::size_t offset) { input.release_before(offset); });
  if (!capture) return std::nullopt;

  std::atomic<bool> faulty = false;
  HeightWatch height(capture->frames);
  const FrameSource frames = height.watched(io::watched(capture->frames, faulty));
  Provenance provenance;
  const auto last_words = [&] {
    context.diagnose(capture->diagnostics);
    context.note_checksum(input);
    provenance = context.provenance();
    provenance.conversions = capture->clip.provenance.conversions;
    return provenance;
  };
  const anim::WriteOptions writing{.orientation = options.orientation, .jobs = context.jobs};
  OutputSet outputs(context);
  Status status = outputs.add(context.output, [&](OutputFile& file) {
    return anim::write(frames, last_words, writing, file);
  });
  if (faulty) return std::nullopt;
  if (status) {
    status = outputs.add(options.model, [&](OutputFile& file) {
      Model model;
      model.skeleton = capture->clip.skeleton;
      model.provenance = provenance;
      return model::write(model, {.orientation = options.orientation}, file);
    });
  }
  if (status) status = outputs.finish();
  if (!status) return Result<int>(status.error());

  context.report.result = result_of(*capture, frames, height.height(), details_of(*capture));
  context.log(
      fmt::format("{} -> {}", line_about(options.input, frames, height.height()), outputs.names()));
  log_roles(frames.skeleton, capture->roles, context);
  return Result<int>(kExitDone);
}

}  // namespace krok::import
