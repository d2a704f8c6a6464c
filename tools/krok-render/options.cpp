#include "tools/krok-render/options.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "core/file.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/io/formats.h"
#include "tools/cli/paths.h"

namespace krok::cli::film {

namespace {

const std::vector<std::pair<std::string, Format>> kFormats = {
    {"mp4", Format::mp4}, {"gif", Format::gif}, {"webp", Format::webp}, {"png", Format::png}};

constexpr int kMinSize = 32, kMaxSize = 4096;

Result<std::pair<int, int>> parse_size(const std::string& text) {
  const auto sides =
      numbers({number({kMinSize, kMaxSize}), number({kMinSize, kMaxSize})}, 2, 'x').read(text);
  const auto even = [](double side) { return std::fmod(side, 2) == 0; };
  if (sides && even((*sides)[0]) && even((*sides)[1])) {
    return std::pair(static_cast<int>((*sides)[0]), static_cast<int>((*sides)[1]));
  }
  return usage(
      fmt::format("'{}': expected an even width and height from {} to {} pixels, such as "
                  "1280x720",
                  shown(text), kMinSize, kMaxSize));
}

void declare_film(CommandOptions& command, Options& o) {
  command.group("Film");
  command.add(
      "--format FORMAT", o.format, choice<Format>(kFormats),
      "mp4 (H.264), gif, webp (animated) or png (without ffmpeg; a file per frame for a name "
      "with a number such as 'frame_%04d.png', else the frame of --from alone); default: "
      "from the output's extension, mp4 in batch mode");
  command.add("--from", o.from, clip_time(),
              "Start: 1.5s, 250ms, or 120f for a frame; a bare number is seconds");
  command.add("--to", o.to, clip_time(), "End");
  command.add("--rate", o.fps, rate(),
              "Frames per second of the film; default: the motion's rate or a whole part of it, up "
              "to 30, for gif up to 25");
  command.add("--size", o.size,
              ValueKind<std::pair<int, int>>{"pixels", "WIDTHxHEIGHT", parse_size, {}},
              "Size in pixels, even numbers [960x540; gif and webp 480x270]");
  command.add("--layout HOW", o.together, choice<bool>({{"apart", false}, {"together", true}}),
              "apart: motions side by side; together: all in one view, where they are", "apart");
  command
      .add_flag("--difference", o.difference,
                "Two motions and, beside them, the second coloured by its distance from the first")
      .not_with("--layout together");
  command.add_no_flag("--no-labels", o.labels, "Leave out names and times");
}

void declare_camera(CommandOptions& command, Options& o) {
  command.group("Camera");
  add_sides_option(command, o.image.sides, "view", "front-left");
  add_elevation_option(command, o.image.elevation,
                       "Camera elevation; at 0 the ground is a line, above a grid with shadows",
                       "15deg");
  command.add_flag("--still", o.still,
                   "Show the whole way from one place; by default, the camera follows");
  command.add_option("--cam IN.cam", o.camera, "Film with this camera (krok-cam), in perspective")
      .not_with("--still");
}

void declare(CommandOptions& command, Options& o) {
  command
      .add_option("inputs IN", o.inputs,
                  "Motions (.anim, or a capture such as BVH), models and characters (.model, "
                  ".character, moved by the motions of their skeleton) and glTF; several are shown "
                  "side by side")
      .required();
  command.add_option("--model IN", o.model,
                     "Model or character that each motion moves, for many motions in batch mode");
  declare_film(command, o);
  declare_camera(command, o);
  command.group("Characters and ground");
  add_body_option(command, o.actors.body, kShownBody);
  add_clip_option(command, o.actors.clip);
  add_skin_method(command, o.actors.method, kShownMethod);
  add_ground_option(command, o.ground, "Ground to show below each actor, as for krok-plot");
  add_prints_option(command, o.prints, "Footprints to draw on the ground of --ground")
      .only_with("--ground");
}

// Of an output that is not named.
std::string ending_of(Format format) {
  if (format == Format::png) return "_%04d.png";
  const auto named = std::ranges::find(kFormats, format, &decltype(kFormats)::value_type::second);
  return "." + (named == kFormats.end() ? "mp4" : named->first);
}

Status check(const Options& o) {
  if (o.camera.empty() || o.image.sides.size() == 1) return {};
  return usage("--cam is one view; give one side");
}

}  // namespace

Result<Format> format_of(const Options& options, const std::string& output) {
  const std::string ending = extension(output);
  if (options.format != Format::from_extension) {
    const std::string own = extension("film" + ending_of(options.format));
    if (ending.empty() || ending == own) return options.format;
    return usage(fmt::format("-o {} is not {}, as --format says", output, own),
                 "leave out --format, or write -o NAME" + own);
  }
  for (const auto& [word, format] : kFormats) {
    if (ending == "." + word) return format;
  }
  if (ending == ".html" || ending == ".svg") {
    return usage(fmt::format("-o {}: {} is no film", output, ending),
                 ending == ".svg" ? "krok-plot draws charts and sheets" : "krok-view writes pages");
  }
  return usage(
      ending.empty() ? fmt::format("-o {}: no extension to choose a format by", output)
                     : fmt::format("-o {}: {} is no film", output, shown(ending)),
      "use .mp4, .gif or .webp, .png for one frame, or 'frame_%04d.png' for a file per frame");
}

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of("krok-render", options, declare, check, run);
  spec.keeps_going = true;
  spec.summary = "Renders films of motions and characters: mp4, gif, webp, PNG frames";
  spec.details = "ffmpeg makes mp4, gif and webp.";
  spec.inputs = "IN...";
  spec.folder_endings = io::motion_endings();
  spec.default_output = [options] {
    return beside(options->inputs.front(), ending_of(options->format));
  };
  spec.examples = {
      {"krok-render walk.anim -o walk.mp4", "a generated body, followed by the camera"},
      {"krok-render hero.character walk.anim --view front,left -o walk.gif",
       "a character from two sides"},
      {"krok-render raw.anim clean.anim --difference -o clean.mp4",
       "both, and the second coloured by its distance from the first"},
      {"krok-render walk.anim --from 1.5s -o pose.png", "a single frame"},
      {"krok-render walk.anim --cam shot.cam --size 1920x1080 -o 'frame_%04d.png'",
       "a file per frame, filmed by a camera of krok-cam; needs no ffmpeg"},
      {"krok-render captures --out-dir films --format webp --keep-going",
       "a film of each capture in a folder"}};
  spec.batch = {io::motion_endings(),
                [options]() -> Result<std::string> { return ending_of(options->format); },
                [options] { return options->actors.clip.empty(); }};
  return spec;
}

}  // namespace krok::cli::film
