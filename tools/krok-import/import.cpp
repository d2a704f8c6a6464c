#include "tools/krok-import/import.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/numbers.h"
#include "formats/anim/anim.h"
#include "formats/model/model_format.h"
#include "motion/sample.h"
#include "scene/model.h"
#include "tools/common/output_kind.h"
#include "tools/krok-import/source.h"

namespace krok::import {

namespace {

// The median of how high the figure reaches from its lowest joint, over up to a hundred frames; the
// reference pose where there are none.
double height_of(const Clip& clip) {
  const auto extent = [](const auto& positions) {
    auto low = positions.front().y();
    auto high = low;
    for (const auto& position : positions) {
      low = std::min(low, position.y());
      high = std::max(high, position.y());
    }
    return static_cast<double>(high - low);
  };
  const int frames = clip.frame_count();
  if (frames == 0) {
    std::vector<Vec3> positions;
    for (const Transform& joint : clip.skeleton.reference) positions.push_back(joint.position);
    return extent(positions);
  }
  std::vector<double> heights;
  const int step = std::max(1, frames / 100);
  for (int frame = 0; frame < frames; frame += step) {
    heights.push_back(extent(clip.frame_positions(frame)));
  }
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  return *middle;
}

Json to_json(const std::string& choice, Confidence confidence, const std::string& reason) {
  return {{"choice", choice}, {"confidence", confidence_name(confidence)}, {"reason", reason}};
}

Json result_of(const Source& source, const Clip& clip) {
  const Capture& capture = source.capture;
  const Conventions& c = capture.conventions;
  Json result;
  result["joints"] = clip.joint_count();
  result["frames"] = clip.frame_count();
  result["rate"] = clip.rate;
  result["duration"] = clip.duration();
  result["height"] = height_of(clip);
  result["unit"] = {{"name", c.unit.name},
                    {"metres", c.unit.metres},
                    {"confidence", confidence_name(c.unit_confidence)},
                    {"reason", c.unit_reason}};
  result["up"] = to_json(std::string(direction_name(c.up)), c.up_confidence, c.up_reason);
  result["forward"] =
      to_json(std::string(direction_name(c.forward)), c.forward_confidence, c.forward_reason);
  result["reference_axes"] = {{"up", direction_name(c.reference_up)},
                              {"forward", direction_name(c.reference_forward)}};
  result["source_rate"] =
      to_json(capture.rate.choice, capture.rate.confidence, capture.rate.reason);
  result.update(source.details);
  result["repairs"] = capture.repairs;
  return result;
}

Status write_outputs(const Options& options, ToolContext& context, const Clip& clip) {
  auto motion = OutputFile::create(context.output, context.output_options());
  if (!motion) return motion.error();
  const anim::WriteOptions anim_options{.orientation = options.orientation, .jobs = context.jobs};
  if (Status written = anim::write(clip, anim_options, *motion); !written) return written;
  if (options.model.empty()) {
    if (Status done = motion->commit(); !done) return done;
    context.wrote(context.output);
    return {};
  }
  Model model;
  model.skeleton = clip.skeleton;
  model.provenance = clip.provenance;
  auto file = OutputFile::create(options.model, context.output_options());
  if (!file) return file.error();
  const model::WriteOptions model_options{.orientation = options.orientation};
  if (Status written = model::write(model, model_options, *file); !written) return written;
  // Both are safe on the disk before either is put in place.
  if (Status done = motion->sync(); !done) return done;
  if (Status done = file->sync(); !done) return done;
  if (Status done = file->commit(); !done) return done;
  if (Status done = motion->commit(); !done) return done;
  context.wrote(context.output);
  context.wrote(options.model);
  return {};
}

void say_what_was_done(const Options& options, ToolContext& context, const Clip& clip) {
  const std::string name = options.input == "-" ? "standard input" : base_name(options.input);
  const auto plural = [](int count, const char* what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
  };
  context.say(fmt::format("{}: {}, {} at {} /s ({} s), height {} m -> {}{}", name,
                          plural(clip.joint_count(), "joint"), plural(clip.frame_count(), "frame"),
                          readable(clip.rate), readable(clip.duration(), 2),
                          readable(height_of(clip), 3), context.output,
                          options.model.empty() ? "" : ", " + options.model));
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  if (!options.model.empty() && options.model == context.output) {
    return Error("usage", "-o and --model name the same file");
  }
  auto source = read_source(options, context);
  if (!source) return source.error();
  using registry::Kind;
  if (Status fits = check_output_kind(context.output, "-o", Kind::anim); !fits) return fits.error();
  if (Status fits = check_output_kind(options.model, "--model", Kind::model); !fits) {
    return fits.error();
  }
  context.tell(source->capture.diagnostics);

  Clip& clip = source->capture.clip;
  auto conversions = std::move(clip.provenance.conversions);
  if (options.resample > 0) {
    auto resampled = resample(clip, options.resample);
    if (!resampled) return resampled.error();
    conversions.push_back(fmt::format("resampled from {} to {} frames a second",
                                      readable(clip.rate), readable(options.resample)));
    clip = std::move(*resampled);
  }
  clip.provenance = context.provenance();
  clip.provenance.conversions = std::move(conversions);

  if (Status written = write_outputs(options, context, clip); !written) return written.error();
  context.report.result = result_of(*source, clip);
  say_what_was_done(options, context, clip);
  return kExitDone;
}

}  // namespace krok::import
