#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/quantity.h"
#include "core/result.h"
#include "draw/plot.h"
#include "math/euler.h"
#include "tools/common/command_options.h"
#include "tools/krok-plot/sheet.h"

namespace krok::plot {

enum class ChartKind : unsigned char { path, feet, angles, positions, difference };

// The options as they were typed.
struct Arguments {
  std::vector<std::string> inputs;
  // motions
  std::vector<std::string> show;
  std::vector<std::string> joints;
  std::string euler;
  std::string from, to;
  bool difference = false;
  std::string keys = "auto";
  std::string map;
  // tables
  bool table = false;
  std::string x;
  std::vector<std::string> y;
  std::string by;
  std::vector<std::string> where;
  draw::SeriesStyle style = draw::SeriesStyle::line;
  bool log_x = false;
  // the figure
  bool log_y = false;
  std::string title;
  std::optional<int> columns;
  std::string panel;
  // pictures
  SheetOptions sheet;
};

// What is asked of motions.
struct MotionOptions {
  std::vector<ChartKind> charts;    // in order, each once; empty for those that fit the motion
  std::vector<std::string> joints;  // patterns
  std::optional<EulerOrder> euler;
  std::optional<ClipTime> from, to;
  std::string keys;  // "auto", "none" or a file
  std::string map;
};

// What is asked of tables.
struct TableOptions {
  std::string x;
  std::vector<std::string> y;  // one panel each: a column, or several between commas
  std::string by;
  std::vector<std::pair<std::string, std::string>> where;  // column, value
  draw::SeriesStyle style = draw::SeriesStyle::line;
  draw::Scale x_scale = draw::Scale::linear, y_scale = draw::Scale::linear;
};

struct Options {
  std::vector<std::string> inputs;
  bool table = false;
  MotionOptions motion;
  TableOptions columns_of_table;
  draw::Scale magnitude_scale = draw::Scale::linear;  // of speeds and distances
  std::string title;
  std::optional<int> columns;
  std::optional<std::pair<double, double>> panel;  // pixels
  SheetOptions sheet;
};

void declare(CommandOptions& command, Arguments& arguments);

// What can be said of the options alone, whatever the inputs are.
Status check(const Arguments& arguments);

// Errors carry the option's name. Code usage for options that do not go together.
Result<Options> understand(const Arguments& arguments);

}  // namespace krok::plot
