#include "tools/krok-import/import.h"

#include <fmt/format.h>

#include "core/numbers.h"
#include "formats/anim/anim.h"
#include "formats/io/open_motion.h"
#include "formats/io/open_scene.h"
#include "formats/model/model_format.h"
#include "motion/sample.h"
#include "scene/model.h"
#include "tools/common/output_kind.h"
#include "tools/common/output_set.h"
#include "tools/krok-import/facts.h"
#include "tools/krok-import/scene_import.h"
#include "tools/krok-import/source.h"
#include "tools/krok-import/stream.h"

namespace krok::import {

namespace {

Status write_outputs(const Options& options, ToolContext& context, const Clip& clip) {
  OutputSet outputs(context);
  const anim::WriteOptions anim_options{.orientation = options.orientation, .jobs = context.jobs};
  Status status = outputs.add(
      context.output, [&](OutputFile& file) { return anim::write(clip, anim_options, file); });
  if (!status) return status;
  status = outputs.add(options.model, [&](OutputFile& file) {
    Model model;
    model.skeleton = clip.skeleton;
    model.provenance = clip.provenance;
    return model::write(model, {.orientation = options.orientation}, file);
  });
  return status ? outputs.finish() : status;
}

// Rejects options that are only for characters.
Status check_capture_options(const Options& options, const std::string& path) {
  const auto missing = [&](const char* what, const char* option) {
    return Error("import-missing",
                 fmt::format("a capture has no {}: {} cannot be used", what, option))
        .in_file(path);
  };
  if (!options.character.empty()) return missing("materials", "--character");
  if (!options.cam.empty()) return missing("camera", "--cam");
  if (!options.camera.empty()) return missing("camera", "--camera");
  if (!options.morphs.empty()) return missing("morph targets", "--morphs");
  if (!options.weights.empty()) return missing("morph targets", "--morph-weights");
  if (!options.skin.empty()) return missing("skin", "--skin");
  if (!options.clip.empty()) return missing("animations to choose from", "--clip");
  return {};
}

Result<int> import_capture(const InputFile& input, registry::Kind kind, const Options& options,
                           ToolContext& context) {
  if (Status status = check_capture_options(options, input.path()); !status) return status.error();
  if (auto streamed = stream_capture(input, kind, options, context)) return *std::move(streamed);
  auto source = read_source(input, kind, options, context);
  if (!source) return source.error();
  if (Status status = check_output_kind(context.output, "-o", registry::Kind::anim); !status) {
    return status.error();
  }
  context.diagnose(source->capture.diagnostics);

  Clip& clip = source->capture.clip;
  auto conversions = std::move(clip.provenance.conversions);
  if (options.resample > 0) {
    auto resampled = resample(clip, options.resample);
    if (!resampled) return resampled.error();
    conversions.push_back(fmt::format("resampled from {} to {} frames per second",
                                      readable(clip.rate), readable(options.resample)));
    clip = std::move(*resampled);
  }
  context.note_checksum(input);
  clip.provenance = context.provenance();
  clip.provenance.conversions = std::move(conversions);

  if (Status status = write_outputs(options, context, clip); !status) return status.error();
  const FrameSource frames = frames_of(clip);
  const double height = height_of(clip);
  context.report.result = result_of(source->capture, frames, height, source->details);
  std::string outputs = context.output;
  if (!options.model.empty()) outputs += (outputs.empty() ? "" : ", ") + options.model;
  context.log(fmt::format("{} -> {}", line_about(options.input, frames, height), outputs));
  log_roles(clip.skeleton, source->capture.roles, context);
  return kExitDone;
}

}  // namespace

Status check(const Options& options) {
  if (const auto how = read_options(options); !how) return how.error();
  if (!options.character.empty() && !(options.model.empty() && options.morphs.empty())) {
    return Error("usage", "--character already writes model and morph targets",
                 "remove --model and --morphs");
  }
  if (Status status =
          check_output_kind(options.character, "--character", registry::Kind::character);
      !status) {
    return status;
  }
  if (options.character == "-") {
    return Error("usage", "--character -: several files cannot go to standard output");
  }
  return check_output_kind(options.model, "--model", registry::Kind::model);
}

Result<int> run(const Options& given, ToolContext& context) {
  Options options = given;
  if (context.output.empty() && options.model.empty() && options.cam.empty() &&
      options.character.empty() && options.morphs.empty() && options.weights.empty()) {
    return Error("usage",
                 "nothing to write: none of -o, --model, --character, --cam, --morphs is given",
                 "write the motion with -o OUTPUT.anim");
  }
  if (!options.model.empty() && options.model == context.output) {
    return Error("usage", "-o and --model name the same file");
  }
  const auto input = context.open_long_input(options.input);
  if (!input) return input.error();
  const io::ChecksumAtEnd noted(*input, context);
  auto roles = io::open_role_map(options.map, context);
  if (!roles) return roles.error();
  if (!options.map.empty()) options.roles = *std::move(roles);
  const registry::Kind kind = registry::identify(input->path(), input->bytes());
  if (!io::is_scene(kind)) return import_capture(*input, kind, options, context);
  context.note_checksum(*input);
  return import_scene(*input, options, context);
}

}  // namespace krok::import
