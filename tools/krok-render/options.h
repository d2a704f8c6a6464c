#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "tools/cli/tool.h"
#include "tools/shared/image.h"
#include "tools/shared/moving_actor.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::film {

enum class Format : unsigned char { from_extension, mp4, gif, webp, png };

struct Options {
  std::vector<std::string> inputs;
  std::string model;  // moved by the motions; empty: a generated body
  Format format = Format::from_extension;
  std::optional<ClipTime> from, to;
  std::optional<double> fps;
  std::optional<std::pair<int, int>> size;  // pixels
  bool together = false, difference = false, labels = true;
  ImageOptions image;  // its sides and elevation
  bool still = false;
  std::string camera;
  GroundChoice ground;
  std::string prints;
  ActorOptions actors;
};

// What is written: by --format, else by the extension of the output. Code usage.
Result<Format> format_of(const Options& options, const std::string& output);

// The tool. Each call has options of its own.
ToolSpec make_spec();

// Renders and writes the film. Returns an exit code.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::film
