#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "tools/cli/command_options.h"
#include "tools/cli/tool.h"
#include "tools/shared/image.h"
#include "tools/shared/moving_actor.h"

namespace krok::cli::film {

enum class Format : unsigned char { from_extension, mp4, gif, webp, png };

// The options as given.
struct Arguments {
  std::vector<std::string> inputs;
  std::string model;  // moved by the motions; empty: a generated body
  Format format = Format::from_extension;
  std::string from, to;
  std::optional<double> fps;
  std::string size;
  bool together = false, difference = false, no_labels = false;
  std::string sides = "front-left", elevation = "15deg";
  bool still = false;
  std::string camera;  // a .cam file
  std::string ground, prints;
  ActorOptions actors;
};

struct Options {
  std::vector<std::string> inputs;
  std::string model;
  Format format = Format::from_extension;
  std::string from, to;
  std::optional<double> fps;
  std::optional<std::pair<int, int>> size;  // pixels
  bool together = false, difference = false, labels = true;
  std::vector<ImageSide> sides;
  bool still = false;
  std::string camera;
  std::string ground, prints;
  ActorOptions actors;
};

void declare(CommandOptions& command, Arguments& arguments);

// Errors name the option. Code usage.
Result<Options> understand(const Arguments& arguments);

// What is written: by --format, else by the extension of the output. Code usage.
Result<Format> format_of(const Options& options, const std::string& output);

// The tool. Each call has options of its own.
ToolSpec make_spec();

}  // namespace krok::cli::film
