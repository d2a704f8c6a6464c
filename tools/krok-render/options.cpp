#include "tools/krok-render/options.h"

#include <fmt/format.h>

#include <memory>
#include <string_view>

#include "core/file.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/io/formats.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/usage.h"
#include "tools/krok-render/run.h"
#include "tools/shared/ground_option.h"
#include "tools/shared/shown_ground.h"
#include "tools/shared/skin_method_option.h"

namespace krok::cli::film {

namespace {

constexpr int kMinSize = 32, kMaxSize = 4096;

Result<std::pair<int, int>> parse_size(const std::string& text) {
  const std::size_t middle = text.find('x');
  if (middle != std::string::npos) {
    const auto width = parse_integer(std::string_view(text).substr(0, middle));
    const auto height = parse_integer(std::string_view(text).substr(middle + 1));
    const auto fits = [](const auto& length) {
      return length && *length >= kMinSize && *length <= kMaxSize && *length % 2 == 0;
    };
    if (fits(width) && fits(height)) {
      return std::pair(static_cast<int>(*width), static_cast<int>(*height));
    }
  }
  return usage(
      fmt::format("--size {}: expected an even width and height from {} to {} pixels, "
                  "such as 1280x720",
                  shown(text), kMinSize, kMaxSize));
}

void declare_film(CommandOptions& command, Arguments& a) {
  command.group("Film");
  add_choice(
      command, "--format", a.format,
      {{"mp4", Format::mp4}, {"gif", Format::gif}, {"webp", Format::webp}, {"png", Format::png}},
      "mp4 (H.264), gif, webp (animated) or png (a file per frame, without ffmpeg); default: "
      "from the output's extension, mp4 in batch mode",
      "FORMAT", "");
  command.add_option("--from TIME", a.from,
                     "Start: 1.5s, 250ms, or 120f for a frame; a bare number is seconds");
  command.add_option("--to TIME", a.to, "End");
  add_rate(command, "--fps", a.fps,
           "Frames per second of the film; default: the motion's rate or a whole part of it, up to "
           "30, for gif up to 25");
  command.add_option("--size WIDTHxHEIGHT", a.size,
                     "Size in pixels, even numbers [960x540; gif and webp 480x270]");
  command.add_flag("--together", a.together,
                   "Show all motions in one view, where they are; default: side by side");
  command.add_flag("--difference", a.difference,
                   "Two motions and, beside them, the second coloured by its distance from the "
                   "first");
  command.add_flag("--no-labels", a.no_labels, "Leave out names and times");
}

void declare_camera(CommandOptions& command, Arguments& a) {
  command.group("Camera");
  command
      .add_option("--sides LIST", a.sides,
                  "View directions, one view each: front, left, back, right, front-left, ..., top")
      .default_str(a.sides);
  command
      .add_option("--elevation ANGLE", a.elevation,
                  "Camera elevation; at 0 the ground is a line, above a grid with shadows")
      .default_str(a.elevation);
  command.add_flag("--still", a.still,
                   "Show the whole way from one place; by default, the camera follows");
  command.add_option("--cam IN.cam", a.camera, "Film with this camera (krok-cam), in perspective");
}

}  // namespace

void declare(CommandOptions& command, Arguments& arguments) {
  command
      .add_option("inputs IN", arguments.inputs,
                  "Motions (.anim, or a capture such as BVH), models and characters (.model, "
                  ".character, moved by the motions of their skeleton) and glTF; several are shown "
                  "side by side")
      .required();
  command.add_option("--model IN", arguments.model,
                     "Model or character that each motion moves, for many motions in batch mode");
  declare_film(command, arguments);
  declare_camera(command, arguments);
  command.group("Characters and ground");
  add_body_option(command, arguments.actors.body,
                  "Body for motions without a model: low (2,500 vertices), medium (10,000), high "
                  "(40,000), auto: low for more than two files, else medium; none: bones only");
  add_clip_option(command, arguments.actors.clip);
  add_skin_method(command, arguments.actors.method,
                  "Skinning method: linear, as viewers use it, dual-quaternion, which keeps the "
                  "volume of twisted joints, or rigid; not for glTF files");
  command.add_option("--ground IN", arguments.ground,
                     "Ground to show below each actor, as for krok-plot");
  add_prints_option(command, arguments.prints, "Footprints to draw on the ground of --ground");
}

Result<Options> understand(const Arguments& a) {
  Options options;
  options.inputs = a.inputs;
  options.model = a.model;
  options.format = a.format;
  options.from = a.from;
  options.to = a.to;
  options.fps = a.fps;
  options.together = a.together;
  options.difference = a.difference;
  options.labels = !a.no_labels;
  options.still = a.still;
  options.camera = a.camera;
  options.ground = a.ground;
  options.prints = a.prints;
  options.actors = a.actors;
  if (!a.size.empty()) {
    const auto size = parse_size(a.size);
    if (!size) return size.error();
    options.size = *size;
  }
  ImageOptions sides;
  sides.sides = a.sides;
  sides.elevation = a.elevation;
  auto parsed = parse_sides(sides);
  if (!parsed) return parsed.error();
  options.sides = *std::move(parsed);
  if (Status status = check_ground_text(a.ground); !status) return status.error();
  if (!a.prints.empty() && a.ground.empty()) return usage("--prints needs --ground");
  if (a.difference && a.together) return usage("--difference and --together exclude each other");
  if (!a.camera.empty() && a.still) return usage("--cam and --still exclude each other");
  if (!a.camera.empty() && options.sides.size() > 1)
    return usage("--cam is one view; give one side");
  return options;
}

Result<Format> format_of(const Options& options, const std::string& output) {
  if (options.format != Format::from_extension) return options.format;
  const std::string ending = extension(output);
  if (ending == ".mp4") return Format::mp4;
  if (ending == ".gif") return Format::gif;
  if (ending == ".webp") return Format::webp;
  if (ending == ".png") return Format::png;
  return usage(ending.empty() ? fmt::format("-o {}: no extension to choose a format by", output)
                              : fmt::format("-o {}: {} is no film", output, shown(ending)),
               "use .mp4, .gif or .webp, or 'frame_%04d.png' for a file per frame");
}

ToolSpec make_spec() {
  const auto arguments = std::make_shared<Arguments>();
  ToolSpec spec = spec_of("krok-render", arguments, declare, understand, run);
  spec.summary = "Renders films of motions and characters: mp4, gif, webp, PNG frames";
  spec.details = "ffmpeg makes mp4, gif and webp.";
  spec.inputs = "IN...";
  spec.examples = {
      {"krok-render walk.anim -o walk.mp4", "a generated body, followed by the camera"},
      {"krok-render hero.character walk.anim --sides front,left -o walk.gif",
       "a character from two sides"},
      {"krok-render raw.anim clean.anim --difference -o clean.mp4",
       "both, and the second coloured by its distance from the first"},
      {"krok-render walk.anim --cam shot.cam --size 1920x1080 -o 'frame_%04d.png'",
       "a file per frame, filmed by a camera of krok-cam; needs no ffmpeg"},
      {"krok-render captures --out-dir films --format webp --keep-going",
       "a film of each capture in a folder"}};
  spec.batch = {io::motion_endings(), [arguments]() -> Result<std::string> {
                  switch (arguments->format) {
                    case Format::gif:
                      return std::string(".gif");
                    case Format::webp:
                      return std::string(".webp");
                    case Format::png:
                      return std::string("_%04d.png");
                    case Format::mp4:
                    case Format::from_extension:
                      break;
                  }
                  return std::string(".mp4");
                }};
  return spec;
}

}  // namespace krok::cli::film
