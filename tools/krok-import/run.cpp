#include "tools/krok-import/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "character/space.h"
#include "contacts/long_take.h"
#include "core/file.h"
#include "core/numbers.h"
#include "core/result.h"
#include "core/text.h"
#include "formats/anim/anim.h"
#include "formats/io/formats.h"
#include "formats/io/open_capture.h"
#include "formats/io/open_motion.h"
#include "formats/io/open_scene.h"
#include "formats/model/model_format.h"
#include "formats/registry/registry.h"
#include "motion/sample.h"
#include "nodes/evaluate.h"
#include "scene/model.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/output_set.h"
#include "tools/cli/tool.h"
#include "tools/cli/usage.h"
#include "tools/krok-import/facts.h"
#include "tools/krok-import/repeats.h"
#include "tools/krok-import/scene_importer.h"
#include "tools/shared/keys_sidecar.h"

namespace krok::cli::import {

namespace {

Status check_options(const Options& options) {
  const auto for_captures = [](const char* option) {
    return Error("usage", fmt::format("{} is for captures (BVH, AMC)", option));
  };
  if (!options.skeleton.empty()) return for_captures("--skeleton");
  if (options.positions != bvh::Positions::automatic) return for_captures("--positions");
  if (options.angles != bvh::Angles::degrees) return for_captures("--angles");
  if (options.rest_frame != RestFrame::keep) return for_captures("--skip-rest-frame");
  if (options.repair) return for_captures("--repair");
  return {};
}

// With --strict, reader warnings are errors.
Status check_strict(const Options& options, const nodes::Scene& scene) {
  if (!options.strict) return {};
  for (const Diagnostic& diagnostic : scene.diagnostics) {
    if (diagnostic.severity != Severity::warning) continue;
    Error error(diagnostic);
    error.severity = Severity::error;
    error.hint = "without --strict this is a warning";
    return error;
  }
  return {};
}

// Reads a scene and writes the requested parts: the motion of one or all of its animations, the
// character as a model, a camera, morph targets and their weights. All files appear or none. Fails
// (code import-missing) for parts that the file does not have.
Result<int> import_scene(const InputFile& input, const Options& options, ToolContext& context) {
  if (Status status = check_options(options); !status) return status.error();
  auto how = read_options(options);
  auto scene = io::open_scene(input, context, !options.character.empty());
  if (!scene) return scene.error();
  if (Status status = check_strict(options, *scene); !status) {
    return std::move(status.error()).in_file(input.path());
  }
  if (!options.model.empty() || !options.character.empty()) {
    for (Diagnostic& diagnostic : scene->diagnostics) {
      if (diagnostic.code == "gltf-unread") diagnostic.severity = Severity::warning;
    }
    // Such as a VRM's expressions, which are not its morph targets.
    std::vector<std::string> extensions;
    std::ranges::copy_if(scene->not_shown, std::back_inserter(extensions),
                         [](const std::string& one) { return one.starts_with("extension "); });
    if (!extensions.empty()) {
      context.diagnose_in(input.path(),
                          {make_warning("import-extension",
                                        fmt::format("not read: {}", fmt::join(extensions, ", ")))});
    }
  }
  context.diagnose(scene->diagnostics);
  // Axes from the user replace a rotation given by the file.
  if ((how.up || how.forward) && character::rotation_to_apply(scene->space) != Mat4::Identity()) {
    scene->space.file_to_krok.reset();
  }
  // Without an animation, -o takes the pose that the file shows, as a motion of one frame.
  if (scene->animations.empty() && !scene->skins.empty() && context.one_of_many == nullptr &&
      !context.output.empty() && options.clip.empty()) {
    scene->animations.emplace_back().name = "pose";
    context.diagnose_in(input.path(),
                        {make_diagnostic(Severity::note, "import-pose",
                                         "the file has no animation: the pose that it shows "
                                         "is written as one frame")});
  }
  auto evaluator = nodes::Evaluator::create(*scene);
  if (!evaluator) return std::move(evaluator.error()).in_file(input.path());
  return SceneImporter(input, options, how, *scene, *evaluator, context).run();
}

// Rejects options that are only for characters.
Status check_capture_options(const Options& options, const std::string& path) {
  const auto missing = [&](const char* what, const char* option) {
    return Error("import-missing",
                 fmt::format("a capture has no {}: {} cannot be used", what, option))
        .in_file(path);
  };
  if (!options.character.empty()) return missing("materials", "--save-character");
  if (!options.cam.empty()) return missing("camera", "--save-cam");
  if (!options.camera.empty()) return missing("camera", "--camera");
  if (!options.morphs.empty()) return missing("morph targets", "--save-morphs");
  if (!options.weights.empty()) return missing("morph targets", "--morph-weights");
  if (!options.skin.empty()) return missing("skin", "--skin");
  return {};
}

// Whether --clip chooses among the motions of an array.
Result<std::optional<int>> motion_of_array(const Options& options, const InputFile& input) {
  if (options.clip.empty() || options.clip == "all") return std::optional<int>();
  const auto number = parse_integer(options.clip);
  if (number && *number >= 0 && *number < 1'000'000) {
    return std::optional(static_cast<int>(*number));
  }
  return Error("usage", fmt::format("--clip {}: an array's motions have numbers, from 0",
                                    shown(options.clip)))
      .in_file(input.path());
}

// Writes the outputs and reports what was imported.
Status write_capture(const io::OpenedCapture& opened, const InputFile& input,
                     const std::string& output, const Options& options, ToolContext& context) {
  Capture& capture = *opened.capture;
  if (options.unit) {
    character::check_size(opened.frames.skeleton, capture.roles, capture.diagnostics);
  }
  std::optional<Clip> resampled;
  if (opened.frames.frame_count == 0 && !io::format_of(input).companion) {
    context.warn("import-empty", "the file has no frames: the motion is empty",
                 "--save-model writes its skeleton alone");
  }
  FrameSource frames = opened.frames;
  if (options.resample > 0) {
    auto made = resample(capture.clip, options.resample);
    if (!made) return made.error();
    resampled = *std::move(made);
    capture.clip.provenance.conversions.push_back(
        fmt::format("resampled from {} to {} frames per second", readable(frames.rate),
                    readable(options.resample)));
    frames = frames_of(*resampled);
  }
  Repeats repeats;
  frames = repeats.watched(frames);
  // The diagnostics and the checksum are complete once all frames were read.
  Provenance provenance;
  const auto complete = [&] {
    if (auto warning = repeats.warning()) {
      warning->where.file = input.path();
      capture.diagnostics.push_back(*std::move(warning));
    }
    context.diagnose(capture.diagnostics);
    context.note_checksum(input);
    provenance = context.provenance();
    provenance.conversions = capture.clip.provenance.conversions;
    return provenance;
  };
  OutputSet outputs(context);
  if (output.empty()) {
    complete();
  } else {
    const anim::WriteOptions writing{.orientation = options.orientation, .jobs = context.jobs};
    Status status = outputs.add(
        output, [&](OutputFile& file) { return anim::write(frames, complete, writing, file); });
    if (!status) return status;
  }
  Status status = outputs.add(options.model, [&](OutputFile& file) {
    Model model;
    model.skeleton = frames.skeleton;
    model.provenance = provenance;
    return model::write(model, {.orientation = options.orientation}, file);
  });
  if (status) {
    // What reads keytimes beside a motion would take a file of contacts alone for one without
    // steps.
    if (capture.keys.keytimes.empty() && !capture.keys.contacts.empty()) {
      auto found = find_in_long_take(frames, capture.roles, context.jobs, context.progress);
      if (found) capture.keys.keytimes = std::move(found->keys.keytimes);
    }
    status = add_keys(capture.keys, frames.skeleton, frames.duration(), output, outputs);
  }
  if (status) status = outputs.finish();
  if (!status) return status;

  context.report.result = result_of(opened, frames);
  context.log(
      fmt::format("{} -> {}", line_about(options.input, frames, capture.roles), outputs.names()));
  log_roles(frames.skeleton, capture.roles, context);
  return {};
}

// The axes of another capture become those given for this one.
Status take_axes(const Options& options, io::CaptureReading& reading, ToolContext& context) {
  if (options.axes_from.empty()) return {};
  const auto file = context.open_input(options.axes_from);
  if (!file) return file.error();
  if (io::is_scene(registry::identify(file->path(), file->bytes()))) {
    return Error("usage", "--axes-from takes a capture").in_file(options.axes_from);
  }
  return io::use_capture(*file, context, reading, false, [&](const io::OpenedCapture& opened) {
    const Conventions& found = opened.capture->conventions;
    reading.up = found.up;
    reading.forward = found.forward;
    reading.reference_up = found.reference_up;
    reading.reference_forward = found.reference_forward;
    return Status();
  });
}

Result<int> import_capture(const InputFile& input, const Options& options, ToolContext& context) {
  if (Status status = check_capture_options(options, input.path()); !status) return status.error();
  auto reading = read_options(options);
  if (Status status = take_axes(options, reading, context); !status) return status.error();
  reading.jobs = context.jobs;
  reading.progress = context.progress;
  const registry::Kind kind = registry::identify(input.path(), input.bytes());
  const bool arrays = kind == registry::Kind::npy || kind == registry::Kind::npz;
  if (!arrays && !options.clip.empty()) {
    return Error("import-missing",
                 "a capture has no animations to choose from: --clip cannot be used")
        .in_file(input.path());
  }
  if (kind == registry::Kind::bvh && !options.skeleton.empty()) {
    return usage("--skeleton is for Acclaim motions and arrays: a BVH file has its skeleton");
  }
  const auto motion = motion_of_array(options, input);
  if (!motion) return motion.error();
  reading.motion = *motion;
  const bool whole = context.output.empty() || options.resample > 0;
  const bool all = arrays && options.clip == "all";
  Json results = Json::array();
  Status status;
  for (int number = 0, count = 1; status && number < count; ++number) {
    if (all) reading.motion = number;
    status = io::use_capture(input, context, reading, whole, [&](const io::OpenedCapture& opened) {
      if (all) count = opened.details.motions;
      const std::string name = std::to_string(number);
      const auto output = all ? clip_path(context.output, "-o", {number, name, name, "as given"},
                                          count > 1, ".anim")
                              : Result<std::string>(context.output);
      if (!output) return Status(output.error());
      if (Status fits = check_output_kind(*output, "-o", registry::Kind::anim); !fits) return fits;
      return write_capture(opened, input, *output, options, context);
    });
    if (all && status) results.push_back(std::move(context.report.result));
  }
  if (all) context.report.result = Json{{"motions", std::move(results)}};
  if (!status) {
    Error error = std::move(status).error();
    if (error.code == "acclaim-skeleton") error.hint = "use --skeleton FILE.asf";
    return error;
  }
  return kExitDone;
}

}  // namespace

Result<int> run(const Options& given, ToolContext& context) {
  Options options = given;
  if (context.output.empty() && options.model.empty() && options.cam.empty() &&
      options.character.empty() && options.morphs.empty() && options.weights.empty()) {
    std::error_code unknown;
    const bool is_folder = std::filesystem::is_directory(options.input, unknown);
    return Error("usage",
                 "nothing to write: none of -o, --save-model, --save-character, --save-cam, "
                 "--save-morphs is given",
                 is_folder ? "write a motion for each file of the folder with --out-dir DIR"
                           : "write the motion with -o OUTPUT.anim");
  }
  if (!options.model.empty() && options.model == context.output) {
    return Error("usage", "-o and --save-model name the same file");
  }
  const auto input = context.open_long_input(options.input);
  if (!input) return input.error();
  const io::ChecksumAtEnd noted(*input, context);
  auto roles = io::open_role_map(options.map, context);
  if (!roles) return roles.error();
  if (!options.map.empty()) options.roles = *std::move(roles);
  const registry::Kind kind = registry::identify(input->path(), input->bytes());
  if (!io::is_scene(kind)) return import_capture(*input, options, context);
  context.note_checksum(*input);
  return import_scene(*input, options, context);
}

}  // namespace krok::cli::import
