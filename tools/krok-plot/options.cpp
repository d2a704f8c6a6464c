#include "tools/krok-plot/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>

#include "core/file.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/io/formats.h"
#include "tools/cli/one_of.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/usage.h"
#include "tools/krok-plot/run.h"
#include "tools/shared/ground_option.h"
#include "tools/shared/role_input.h"
#include "tools/shared/shown_ground.h"

namespace krok::cli::plot {

namespace {

struct ChartName {
  std::string_view name;
  ChartKind chart;
};
constexpr std::array kCharts = {
    ChartName{"path", ChartKind::path}, ChartName{"feet", ChartKind::feet},
    ChartName{"angles", ChartKind::angles}, ChartName{"positions", ChartKind::positions},
    ChartName{"difference", ChartKind::difference}};

CommandOption add_list(CommandOptions& command, const std::string& name,
                       std::vector<std::string>& values, const std::string& description) {
  return command.add_option(name, values, description).one_each_time();
}

void declare_motions(CommandOptions& command, Arguments& a) {
  command.group("Motions");
  add_list(command, "--show CHARTS", a.show,
           "Charts to draw, in order: path (from above), feet (height, speed), angles (of hips, "
           "knees, ankles, shoulders, elbows), positions, difference; comma-separated. Default: "
           "path, feet and angles, as far as the skeleton has them");
  add_list(command, "--joint NAME", a.joints,
           "Show this joint: its position, and its rotation from the reference pose relative to "
           "its parent; with --show positions or angles, one of the two. * matches any characters; "
           "repeatable");
  command.add_option("--euler ORDER", a.euler,
                     "Show joint rotations as Euler angles in this order: ZXY is R = Rz Rx Ry");
  command.add_option("--from TIME", a.from,
                     "Start time: 1.5s, 250ms, or 120f for a frame; a bare number is seconds");
  command.add_option("--to TIME", a.to, "End time");
  command.add_flag("--difference", a.difference,
                   "Distances between the joints of two motions: the same as --show difference");
  command
      .add_option("--keys IN.json|auto|none", a.keys,
                  "Contacts and keytimes to draw: a file, none, or auto, which uses NAME.keys.json "
                  "next to the motion if it exists")
      .default_str(a.keys);
  add_map_option(command, a.map);
  add_prints_option(command, a.prints,
                    "Footprints (formats/prints/SPEC.md) to draw in the path from above and, on "
                    "the ground of --ground, in images");
}

void declare_tables(CommandOptions& command, Arguments& a) {
  command.group("Tables");
  command.add_flag("--table", a.table,
                   "The inputs are tables (CSV); implied for .csv and .tsv files. Units are read "
                   "from column names: time [s], time (s), time_s");
  command.add_option("--x COLUMN", a.x, "The x column; default: the time column, or the first");
  add_list(command, "--y COLUMNS", a.y,
           "Columns to draw: one, or several for one panel, comma-separated; repeat for more "
           "panels. Default: all numeric columns, a panel per unit");
  command.add_option(
      "--by COLUMN", a.by,
      "Draw a line per value of this column; default: the only text column, if there is one");
  add_list(command, "--where COLUMN=VALUE", a.where,
           "Use only rows with this value in the column; repeat for another column, or for "
           "alternative values of the same column");
  command.add_option("--style STYLE", a.style, "line, points or both")
      .transform(one_of<draw::SeriesStyle>({{"line", draw::SeriesStyle::line},
                                            {"points", draw::SeriesStyle::points},
                                            {"both", draw::SeriesStyle::line_and_points}}))
      .default_str("line");
  command.add_flag("--log-x", a.log_x, "Logarithmic x axis");
}

Result<std::vector<ChartKind>> parse_charts(const std::vector<std::string>& lists) {
  std::vector<ChartKind> charts;
  for (const std::string& list : lists) {
    for (std::size_t begin = 0; begin <= list.size();) {
      const std::size_t end = std::min(list.find(',', begin), list.size());
      const std::string_view word = trimmed(std::string_view(list).substr(begin, end - begin));
      begin = end + 1;
      const auto found = std::find_if(kCharts.begin(), kCharts.end(),
                                      [&](const ChartName& name) { return name.name == word; });
      if (found == kCharts.end()) {
        std::vector<std::string> names;
        for (const ChartName& name : kCharts) names.emplace_back(name.name);
        return usage("--show: " + not_one_of(shown(word), names));
      }
      if (std::find(charts.begin(), charts.end(), found->chart) == charts.end()) {
        charts.push_back(found->chart);
      }
    }
  }
  return charts;
}

Result<EulerOrder> parse_order(const std::string& text) {
  EulerOrder order = {};
  std::array<bool, 3> seen = {};
  bool good = text.size() == 3;
  for (std::size_t i = 0; good && i < 3; ++i) {
    const int axis = ascii_lower(text[i]) - 'x';
    good = axis >= 0 && axis < 3 && !seen[static_cast<std::size_t>(axis)];
    if (!good) break;
    seen[static_cast<std::size_t>(axis)] = true;
    order[i] = static_cast<krok::Axis>(axis);
  }
  if (good) return order;
  return usage(fmt::format("--euler: '{}' is not an axis order such as ZXY", shown(text)));
}

Result<std::optional<ClipTime>> parse_moment(const std::string& text, const char* option) {
  if (text.empty()) return std::optional<ClipTime>();
  auto time = parse_clip_time(text);
  if (!time) {
    time.error().message = fmt::format("{}: {}", option, time.error().message);
    return time.error();
  }
  if (time->value < 0) return usage(fmt::format("{} {} is negative", option, text));
  return std::optional<ClipTime>(*time);
}

Result<MotionOptions> understand_motions(const Arguments& a) {
  MotionOptions options;
  auto charts = parse_charts(a.show);
  if (!charts) return charts.error();
  options.charts = std::move(*charts);
  const auto found = std::find(options.charts.begin(), options.charts.end(), ChartKind::difference);
  if (a.difference && found == options.charts.end())
    options.charts.push_back(ChartKind::difference);
  options.joints = a.joints;
  if (!a.euler.empty()) {
    if (a.joints.empty()) return usage("--euler needs --joint");
    auto order = parse_order(a.euler);
    if (!order) return order.error();
    options.euler = *order;
  }
  auto from = parse_moment(a.from, "--from");
  if (!from) return from.error();
  auto to = parse_moment(a.to, "--to");
  if (!to) return to.error();
  options.from = *from;
  options.to = *to;
  options.keys = a.keys;
  options.map = a.map;
  options.ground = a.sheet.ground;
  options.prints = a.prints;
  return options;
}

Result<TableOptions> understand_tables(const Arguments& a) {
  TableOptions options;
  options.x = a.x;
  options.y = a.y;
  options.by = a.by;
  for (const std::string& condition : a.where) {
    const std::size_t equals = condition.find('=');
    if (equals == std::string::npos || equals == 0) {
      return usage(
          fmt::format("--where {}: expected COLUMN=VALUE, such as joint=Hips", shown(condition)));
    }
    options.where.emplace_back(condition.substr(0, equals), condition.substr(equals + 1));
  }
  options.style = a.style;
  if (a.log_x) options.x_scale = draw::Scale::logarithmic;
  if (a.log_y) options.y_scale = draw::Scale::logarithmic;
  return options;
}

// A panel length in pixels; 0 if invalid.
double parse_pixels(std::string_view text) {
  const double length = parse_finite(text).value_or(0);
  return length >= 80 && length <= 10000 ? length : 0;
}

Result<std::pair<double, double>> parse_panel(const std::string& text) {
  const std::string_view whole = text;
  const std::size_t middle = std::min(whole.find('x'), whole.size() - 1);
  const double width = parse_pixels(whole.substr(0, middle));
  const double height = parse_pixels(whole.substr(middle + 1));
  if (width > 0 && height > 0) return std::pair(width, height);
  return usage(
      fmt::format("--panel {}: expected width and height from 80 to 10000 pixels, "
                  "such as 340x170",
                  shown(text)));
}

// Whether all inputs are tables; an Error if only some are.
Result<bool> are_tables(const Arguments& a) {
  const auto is_table = [&](const std::string& path) {
    const std::string ending = extension(path);
    return a.table || ending == ".csv" || ending == ".tsv";
  };
  const auto count = std::count_if(a.inputs.begin(), a.inputs.end(), is_table);
  if (count == 0) return false;
  if (static_cast<std::size_t>(count) == a.inputs.size()) return true;
  return usage("motions and tables cannot share a chart", "plot them separately");
}

// Options for the other kind of input are errors.
Status check_fit(const Arguments& a, bool table) {
  const char* wrong = nullptr;
  if (table) {
    wrong = !a.show.empty()           ? "--show"
            : !a.joints.empty()       ? "--joint"
            : !a.euler.empty()        ? "--euler"
            : !a.from.empty()         ? "--from"
            : !a.to.empty()           ? "--to"
            : a.difference            ? "--difference"
            : a.keys != "auto"        ? "--keys"
            : !a.map.empty()          ? "--map"
            : !a.prints.empty()       ? "--prints"
            : !a.sheet.ground.empty() ? "--ground"
                                      : nullptr;
  } else {
    wrong = !a.x.empty()                         ? "--x"
            : !a.y.empty()                       ? "--y"
            : !a.by.empty()                      ? "--by"
            : !a.where.empty()                   ? "--where"
            : a.log_x                            ? "--log-x"
            : a.style != draw::SeriesStyle::line ? "--style"
                                                 : nullptr;
  }
  if (wrong == nullptr) return {};
  return usage(fmt::format("{} is for {}, but the input is {}", wrong, table ? "motions" : "tables",
                           table ? "a table" : "a motion"),
               table ? "see krok-plot --help" : "--table reads the input as a table");
}

void declare_images(CommandOptions& command, Arguments& a) {
  command.group("Images");
  declare_sheet(command, a.sheet);
}

}  // namespace

void declare(CommandOptions& command, Arguments& arguments) {
  command
      .add_option("inputs IN", arguments.inputs,
                  "Motions (.anim, or a capture such as BVH) or tables (.csv); several share the "
                  "same panels. For images also models and characters (.model, .character, "
                  "animated by the motions of their skeleton) and glTF")
      .required();
  declare_motions(command, arguments);
  declare_tables(command, arguments);
  command.group("Chart");
  command.add_flag("--log-y", arguments.log_y,
                   "Logarithmic y axis; for motions, of speeds and differences");
  command.add_option("--title WORDS", arguments.title, "Title; default: the name of the input");
  add_whole(command, "--columns", arguments.columns, "Number of panels per row; default: 2", 1, 20);
  command.add_option("--panel WIDTHxHEIGHT", arguments.panel,
                     "Size of each panel in pixels, at 96 dpi [340x170, a single one 640x260]");
  declare_images(command, arguments);
}

Status check(const Arguments& arguments) {
  if (const auto motion = understand_motions(arguments); !motion) return motion.error();
  if (const auto columns = understand_tables(arguments); !columns) return columns.error();
  if (Status status = check_ground_text(arguments.sheet.ground); !status) return status;
  if (arguments.panel.empty()) return {};
  const auto panel = parse_panel(arguments.panel);
  return panel ? Status() : panel.error();
}

Result<Options> understand(const Arguments& arguments) {
  Options options;
  options.inputs = arguments.inputs;
  const auto table = are_tables(arguments);
  if (!table) return table.error();
  options.table = *table;
  if (Status status = check_fit(arguments, *table); !status) return status.error();
  auto motion = understand_motions(arguments);
  if (!motion) return motion.error();
  options.motion = std::move(*motion);
  auto columns = understand_tables(arguments);
  if (!columns) return columns.error();
  options.columns_of_table = std::move(*columns);
  if (arguments.log_y) options.magnitude_scale = draw::Scale::logarithmic;
  options.title = arguments.title;
  options.columns = arguments.columns;
  if (!arguments.panel.empty()) {
    const auto panel = parse_panel(arguments.panel);
    if (!panel) return panel.error();
    options.panel = *panel;
  }
  options.sheet = arguments.sheet;
  options.sheet.from = arguments.from;
  options.sheet.to = arguments.to;
  options.sheet.prints = arguments.prints;
  if (!options.sheet.wanted() && has_image_options(options.sheet)) {
    return usage(
        "--moments, --sides, --elevation, --size, --whole-ground, --front, --body, --clip and "
        "--method are "
        "for --sheet and "
        "--strip");
  }
  if (options.sheet.whole_ground && options.sheet.ground.empty()) {
    return usage("--whole-ground is for --ground");
  }
  if (options.table && options.sheet.wanted()) {
    return usage("--sheet and --strip show characters, but the input is a table");
  }
  return options;
}

ToolSpec make_spec() {
  const auto arguments = std::make_shared<Arguments>();
  ToolSpec spec = spec_of("krok-plot", arguments, declare, understand, run);
  spec.summary = "Plots motions and numeric tables as charts in one SVG";
  spec.details = "Contact sheets and strips of a motion are PNG.";
  spec.inputs = "IN...";
  spec.examples = {
      {"krok-plot walk.bvh -o walk.svg",
       "path from above, foot heights and speeds, leg and arm angles"},
      {"krok-plot raw.anim clean.anim --show angles,difference --from 1s --to 3s -o clean.svg",
       "two motions in the same panels, and the distance between them"},
      {"krok-plot take.bvh --joint LeftHand --euler ZXY -o hand.svg",
       "position and rotation of a joint"},
      {"krok-plot walk.csv --where joint=LeftFoot --where joint=RightFoot --y y -o heights.svg",
       "one column of a table, with a line for each of two joints"},
      {"krok-plot fit.csv --x examples --y error_mm --log-y --style both -o fit.svg",
       "any table of numbers; the unit is read from the column's name"},
      {"krok-plot walk.anim --show path,feet --ground hills.exr --prints prints.csv -o ways.svg",
       "a walk on its ground from above, with its footprints, and how high the soles are over it"},
      {"krok-plot walk.bvh --sheet walk.png", "images of the character at eight times"},
      {"krok-plot hero.character walk.anim --strip hero.png",
       "an animated character with the colours and textures of its materials; without "
       "a motion, in its reference pose"}};
  spec.needs_output = false;  // --sheet and --strip have their own output files
  spec.batch = {io::motion_endings(), always(".svg")};
  spec.check = [arguments] { return check(*arguments); };
  return spec;
}

}  // namespace krok::cli::plot
