#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "render/sheet.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/output_set.h"
#include "tools/cli/tool.h"

// Options of tools that render images of actors: times, sides and size.

namespace krok::cli {

// A view direction: `yaw` is relative to the actor's heading.
struct ImageSide {
  std::string name;
  double yaw = 0, elevation = 0;  // radians

  bool operator==(const ImageSide&) const = default;
};

struct ImageOptions {
  std::string moments;  // "8", or "0s,1.5s,120f"; empty: the tool's default
  std::vector<ImageSide> sides;
  double elevation = 0;  // radians
  int size = 0;          // pixels
};

// --view: front, left, back, right, front-left, front-right, back-left, back-right, top; separated
// by commas. `each` is what there is one of for each: "row".
CommandOption add_sides_option(CommandOptions& command, std::vector<ImageSide>& sides,
                               const std::string& each, const std::string& preset);
CommandOption add_elevation_option(CommandOptions& command, double& elevation,
                                   const std::string& help, const std::string& preset);

// --moments, --view, --elevation, --actor-size. `by_default` is the default
// number of moments, for the help.
void declare_image_options(CommandOptions& command, ImageOptions& options, int by_default);

// Whether these are the sides that are shown where none are asked for.
bool are_usual_sides(const std::vector<ImageSide>& sides);

// A time in an actor's motion; `frame` is -1 without frames.
struct ImageMoment {
  double time = 0;
  int frame = -1;

  std::string label() const;  // "frame 24", or "0.40 s" without frames
  std::string note() const;   // "0.40 s", or empty
};

// The range to choose from: frames `first` to `last`, at frame / rate seconds; without frames (rate
// 0), `start` to `end` seconds.
struct ImageSpan {
  double rate = 0;
  int first = 0, last = 0;
  double start = 0, end = 0;
};

// Parses `moments` (see ImageOptions) into times, sorted and without duplicates. Empty:
// `by_default` of them, evenly spaced from the first to the last, or fewer if there are fewer
// frames. Code usage for invalid text and for times outside the span.
Result<std::vector<ImageMoment>> choose_moments(const std::string& moments, int by_default,
                                                const ImageSpan& span);

// The sides, from the elevation that is asked for; top stays above.
std::vector<ImageSide> sides_seen(const ImageOptions& options);

// Adds the image as PNG to the outputs.
Status add_image(const render::Image& image, const std::string& path, OutputSet& outputs);

// Position and camera of a cell, for the report; needed for measuring in images.
Json to_json(const render::CellLayout& cell);

}  // namespace krok::cli
