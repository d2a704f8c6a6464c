#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "render/sheet.h"
#include "tools/common/tool.h"

// What tools that make pictures of figures have in common: which moments, from which sides, how
// large.

namespace krok {

struct ImageOptions {
  std::string moments;  // "8", or "0s,1.5s,120f"; empty: the tool's own number
  std::string sides = "front,left";
  std::string elevation = "0deg";
  int size = 280;  // pixels
};

// --moments, --sides, --elevation, --size. `by_default` is the number of moments, for the help.
void declare_image_options(CommandOptions& command, ImageOptions& options, int by_default);

// A moment of a figure; `frame` is -1 where it has no frames.
struct ImageMoment {
  double time = 0;
  int frame = -1;

  std::string label() const;  // "frame 24", or "0.40 s" without frames
  std::string note() const;   // "0.40 s", or empty
};

// What there is to choose from: with frames, those from `first` to `last`, at frame / rate;
// without (rate 0) the seconds from `start` to `end`.
struct ImageSpan {
  double rate = 0;
  int first = 0, last = 0;
  double start = 0, end = 0;
};

// The moments that `moments` names (see PictureOptions; empty: `by_default` of them, spread evenly
// from the first to the last; fewer where there are not as many frames), each once, in order.
// Code usage for a text that names none, or one beyond the span.
Result<std::vector<ImageMoment>> choose_moments(const std::string& moments, int by_default,
                                                const ImageSpan& span);

// A side to look from: `yaw` is added to where the figure faces.
struct ImageSide {
  std::string name;
  double yaw = 0, elevation = 0;  // radians
};

// front, left, back, right, front-left, front-right, back-left, back-right, top; separated by
// commas. Code usage.
Result<std::vector<ImageSide>> parse_sides(const ImageOptions& options);

// Whether a picture may be called `path`: Error usage where the name promises another kind of file.
Status check_image_name(const std::string& path, const std::string& option);

// Writes the picture as PNG to `path` and notes it in the report.
Status write_image(const render::Image& image, const std::string& path, ToolContext& context);

// Where cells are and what camera shows them, for the report: whoever measures in a picture needs
// it.
Json to_json(const render::CellLayout& cell);

}  // namespace krok
