#include "tools/krok-plot/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string_view>

#include "core/file.h"
#include "core/text.h"
#include "formats/chart/chart_writer.h"
#include "formats/io/formats.h"
#include "tools/cli/paths.h"

namespace krok::cli::plot {

namespace {

// Words that one tries first have other names.
Error with_home(Error error, const std::string& text) {
  static constexpr std::pair<std::string_view, const char*> kHomes[] = {
      {"gait speed cadence stance events steps",
       "krok-keys --table OUT.csv has gait and speed; "
       "cycles draws angles over the gait cycle"},
      {"mean average deviation sd std cycle", "cycles draws mean and standard deviation"},
      {"hip hips knee knees ankle ankles shoulder elbow joint joints",
       "angles draws hips, knees, ankles, shoulders and elbows, cycles their mean over the gait "
       "cycle; --joint NAME another joint; krok-export --what angles is a table"},
      {"emg force forces moment moments torque power grf com",
       "none of a motion's charts; krok-plot TABLE.csv draws columns of a table"},
      {"sheet poses actor", "--sheet OUT.png shows the actors"}};
  const std::string word = text.substr(0, text.find('_'));  // of hip_flexion_l, knee_angle_r
  for (const auto& [words, home] : kHomes) {
    if ((" " + std::string(words) + " ").find(" " + word + " ") != std::string::npos) {
      error.hint = home;
    }
  }
  return error;
}

// A list of charts, separated by commas.
ValueKind<std::vector<ChartKind>> charts() {
  const auto one = choice<ChartKind>({{"path", ChartKind::path},
                                      {"feet", ChartKind::feet},
                                      {"angles", ChartKind::angles},
                                      {"cycles", ChartKind::cycles},
                                      {"positions", ChartKind::positions},
                                      {"difference", ChartKind::difference}});
  return {"charts",
          "CHARTS",
          [one](const std::string& text) -> Result<std::vector<ChartKind>> {
            std::vector<ChartKind> charts;
            for (std::size_t begin = 0; begin <= text.size();) {
              const std::size_t end = std::min(text.find(',', begin), text.size());
              const auto chart =
                  one.read(std::string(trimmed(std::string_view(text).substr(begin, end - begin))));
              if (!chart) return with_home(chart.error(), text);
              charts.push_back(*chart);
              begin = end + 1;
            }
            return charts;
          },
          {}};
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
  return usage(fmt::format("'{}' is not an axis order such as ZXY", shown(text)));
}

Result<std::array<double, 2>> parse_panel(const std::string& text) {
  const ValueKind<double> side = number({80, 10000});
  auto sides = numbers_as<std::array<double, 2>>({side, side}, 2, 'x').read(text);
  if (sides) return sides;
  return usage(
      fmt::format("'{}': expected width and height from 80 to 10000 pixels, such as "
                  "340x170",
                  shown(text)));
}

Result<std::pair<std::string, std::string>> parse_condition(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals != std::string::npos && equals > 0) {
    return std::pair(text.substr(0, equals), text.substr(equals + 1));
  }
  return usage(fmt::format("'{}': expected COLUMN=VALUE, such as joint=Hips", shown(text)));
}

void declare_motions(CommandOptions& command, MotionOptions& o) {
  command.group("Motions");
  command.add(
      "--show", o.shown, charts(),
      "Charts to draw, in order: path (from above), feet (height, speed), angles (of hips, "
      "knees, ankles, shoulders, elbows), cycles (these angles over the gait cycle, mean and "
      "standard deviation over all cycles of all motions), positions, difference; "
      "comma-separated. Default: path, feet and angles, as far as the skeleton has them");
  command
      .add_option("--joint NAME", o.joints,
                  "Show this joint: its position, and its rotation from the reference pose "
                  "relative to its parent; with --show positions or angles, one of the two. * "
                  "matches any characters; repeatable")
      .one_each_time();
  command
      .add("--euler", o.euler, ValueKind<EulerOrder>{"axes", "ORDER", parse_order, {}},
           "Show joint rotations as Euler angles in this order: ZXY is R = Rz Rx Ry")
      .only_with("--joint");
  command.add("--from", o.from, clip_time(),
              "Start time: 1.5s, 250ms, or 120f for a frame; a bare number is seconds");
  command.add("--to", o.to, clip_time(), "End time");
  command.add_flag("--difference", o.difference,
                   "Distances between the joints of two motions: the same as --show difference");
  command
      .add("--contacts", o.keys, contacts_file("IN.json|auto|none"),
           "Contacts and keytimes to draw: a file, none, or auto, which uses NAME.keys.json "
           "next to the motion if it exists")
      .default_str("auto");
  add_map_option(command, o.map);
  add_prints_option(command, o.prints,
                    "Footprints (formats/prints/SPEC.md) to draw in the path from above and, on "
                    "the ground of --ground, in images");
}

void declare_tables(CommandOptions& command, Options& o) {
  TableOptions& table = o.columns_of_table;
  command.group("Tables");
  command.add_flag(
      "--as-table", o.table,
      "The inputs are tables (CSV); implied for .csv, .tsv, .mot and .sto files. Units are read "
      "from column names: time [s], time (s), time_s");
  command.add_option("--x COLUMN", table.x, "The x column; default: the time column, or the first");
  command
      .add_option("--y COLUMNS", table.y,
                  "Columns to draw: one, or several for one panel, comma-separated; repeat for "
                  "more panels. Default: all numeric columns, a panel per unit")
      .one_each_time();
  command.add_option(
      "--by COLUMN", table.by,
      "Draw a line per value of this column; default: the columns of text, such as joint and file");
  command.add("--where", table.where,
              ValueKind<std::pair<std::string, std::string>>{
                  "condition", "COLUMN=VALUE", parse_condition, {}},
              "Use only rows with this value in the column; repeat for another column, or for "
              "alternative values of the same column");
  command.add("--draw MARKS", table.style,
              choice<draw::SeriesStyle>({{"line", draw::SeriesStyle::line},
                                         {"points", draw::SeriesStyle::points},
                                         {"both", draw::SeriesStyle::line_and_points}}),
              "line, points or both", "line");
  command.add_flag("--log-x", table.log_x, "Logarithmic x axis");
}

bool is_table(const std::string& path) {
  const std::string ending = extension(path);
  return ending == ".csv" || ending == ".tsv" || ending == ".mot" || ending == ".sto";
}

void declare(CommandOptions& command, Options& o) {
  command
      .add_option("inputs IN", o.inputs,
                  "Motions (.anim, or a capture such as BVH) or tables (.csv); several share the "
                  "same panels. For images also models and characters (.model, .character, "
                  "animated by the motions of their skeleton) and glTF")
      .required();
  declare_motions(command, o.motion);
  declare_tables(command, o);
  command.group("Chart");
  command.add_flag("--log-y", o.log_y,
                   "Logarithmic y axis; for motions, of speeds and differences");
  command.add_option("--title WORDS", o.title, "Title; default: the name of the input");
  command.add(
      "--columns", o.columns, whole(1, 20),
      "Number of panels per row; default: 2. With --sheet: of motions side by side; default: 1 for "
      "up to 12, then as many as keep the sheet about as high as wide");
  command.add("--panel WIDTHxHEIGHT", o.panel,
              ValueKind<std::array<double, 2>>{"pixels", "WIDTHxHEIGHT", parse_panel, {}},
              "Size of each panel in pixels, at 96 dpi [340x170, a single one 640x260]");
  command.group("Images");
  declare_sheet(command, o.sheet, o.motion.ground);
  o.given = [&command](const char* option) { return command.count(option) > 0; };
}

}  // namespace

Status check_inputs(const Options& o) {
  const auto tables = std::ranges::count_if(o.inputs, is_table);
  if (!o.table && tables > 0 && static_cast<std::size_t>(tables) < o.inputs.size()) {
    return usage("motions and tables cannot share a chart", "plot them separately");
  }
  const bool table = o.plots_tables();
  const auto of_others =
      table ? std::vector{"--show",     "--joint", "--euler",  "--from",   "--to",
                          "--contacts", "--map",   "--prints", "--ground", "--difference"}
            : std::vector{"--x", "--y", "--by", "--where", "--log-x", "--draw"};
  for (const char* option : of_others) {
    if (!o.given(option)) continue;
    return usage(fmt::format("{} is for {}, but the input is {}", option,
                             table ? "motions" : "tables", table ? "a table" : "a motion"),
                 table ? "see krok-plot --help" : "--as-table reads the input as a table");
  }
  const auto draws_joints = [](const std::vector<ChartKind>& charts) {
    return std::ranges::any_of(charts, [](ChartKind chart) {
      return chart == ChartKind::positions || chart == ChartKind::angles ||
             chart == ChartKind::difference;
    });
  };
  if (o.given("--joint") && o.given("--show") &&
      std::ranges::none_of(o.motion.shown, draws_joints)) {
    return usage("--joint is for --show positions or angles", "leave out --show, or add angles");
  }
  if (o.sheet.wanted() && !o.given("--output")) {
    for (const char* option :
         {"--show", "--joint", "--euler", "--difference", "--log-y", "--panel"}) {
      if (!o.given(option)) continue;
      return usage(fmt::format("{} is for a chart, and none is written", option),
                   "add -o OUT.svg, beside --sheet or --strip");
    }
  }
  if (table && o.sheet.wanted()) {
    return usage("--sheet and --strip show characters, but the input is a table");
  }
  return {};
}

std::vector<ChartKind> MotionOptions::charts() const {
  std::vector<ChartKind> charts;
  const auto add = [&](ChartKind chart) {
    if (std::ranges::find(charts, chart) == charts.end()) charts.push_back(chart);
  };
  for (const std::vector<ChartKind>& list : shown) std::ranges::for_each(list, add);
  if (difference) add(ChartKind::difference);
  return charts;
}

bool Options::plots_tables() const {
  return table || (!inputs.empty() && std::ranges::all_of(inputs, is_table));
}

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of<Options>("krok-plot", options, declare, nullptr, run);
  spec.keeps_going = true;
  spec.summary = "Plots motions and numeric tables as charts: SVG, PDF, PNG";
  spec.details =
      "Contact sheets and strips of a motion are PNG. As .csv a chart is the points of its lines.";
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
      {"krok-plot fit.csv --x examples --y error_mm --log-y --draw both -o fit.svg",
       "any table of numbers; the unit is read from the column's name"},
      {"krok-plot walk.anim --show path,feet --ground hills.exr --prints prints.csv -o ways.svg",
       "a walk on its ground from above, with its footprints, and how high the soles are over it"},
      {"krok-plot walks --show cycles -o cycles.pdf",
       "joint angles over the gait cycle: mean and deviation of all walks of a folder"},
      {"krok-plot walks --show cycles -o cycles.csv",
       "the same as numbers: mean and deviation of each angle at each percent of the cycle"},
      {"krok-plot walk.bvh --sheet walk.png", "images of the character at eight times"},
      {"krok-plot hero.character walk.anim --strip hero.png",
       "an animated character with the colours and textures of its materials; without "
       "a motion, in its reference pose"}};
  spec.needs_output = false;  // --sheet and --strip have their own output files
  spec.folder_endings = io::motion_endings();
  spec.each_animation = [options](const std::string&) {
    const std::vector<ChartKind> charts = options->motion.charts();
    return std::ranges::find(charts, ChartKind::cycles) != charts.end();
  };
  spec.output_endings = chart::endings();
  spec.output_endings.emplace_back(".csv");
  spec.default_output = [options] {
    return options->sheet.wanted() ? "" : beside(options->inputs.front(), ".svg");
  };
  spec.batch = {io::motion_endings(), always(".svg"),
                [options] { return options->sheet.clip.empty(); }};
  return spec;
}

}  // namespace krok::cli::plot
