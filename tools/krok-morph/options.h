#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "capture/conventions.h"
#include "core/numbers.h"
#include "core/result.h"
#include "tools/cli/command_options.h"
#include "tools/cli/tool.h"

namespace krok::cli::morph {

enum class Action { pack, unpack, info, bake, frames };
enum class As { clip, targets };
enum class ShapeFormat { as_base, obj, glb, model };
enum class Up { y, z };
enum class Between { as_given, linear, hermite };

// Command-line options.
struct Options {
  Action action = Action::info;
  std::vector<std::string> files;

  // OBJ conventions.
  Unit unit;
  Up up = Up::y;
  bool by_order = false;  // triangles need not match

  std::vector<std::string> names;  // pack
  std::string out_dir;             // unpack
  ShapeFormat format = ShapeFormat::as_base;
  std::vector<std::string> targets;  // to unpack; empty: all
  std::string weights;               // bake
  As as = As::clip;                  // bake, frames
  std::optional<double> rate;
  Between between = Between::as_given;  // frames
  std::optional<double> tension;
  std::optional<ClipTime> spacing;  // time between shapes of a folder
  std::string save_weights;

  // Whether an option, "--rate", was given; set by declare().
  std::function<bool(const char* option)> given;
};

// The tool. Each call has options of its own.
ToolSpec make_spec();

// Runs the chosen action.
Result<int> run(const Options& options, ToolContext& context);

// One function per action; the options have been checked. Codes, besides those of readers and
// writers: morph-input, morph-empty, morph-vertices, morph-triangles, morph-name, morph-target,
// morph-format, morph-clip-too-long, morph-too-large.
Result<int> pack(const Options& options, ToolContext& context);
Result<int> unpack(const Options& options, ToolContext& context);
Result<int> info(const Options& options, ToolContext& context);
Result<int> bake(const Options& options, ToolContext& context);
Result<int> frames(const Options& options, ToolContext& context);

}  // namespace krok::cli::morph
