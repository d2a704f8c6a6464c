#include "tools/krok-plot/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/file.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/registry/registry.h"
#include "tools/common/file_name.h"
#include "tools/common/output_set.h"
#include "tools/krok-plot/charts.h"
#include "tools/krok-plot/motions.h"
#include "tools/krok-plot/table_charts.h"

namespace krok::plot {

namespace {

// Sizes at which text is legible on A4 paper with two panels per row.
constexpr double kPanelWidth = 340, kPanelHeight = 170;
constexpr double kSingleWidth = 640, kSingleHeight = 260;

Status check_output(const std::string& path) {
  const std::string ending = extension(path);
  const bool other = registry::kind_of_name(path) != registry::Kind::unknown || ending == ".png" ||
                     ending == ".pdf" || ending == ".csv" || ending == ".html";
  if (!other) return {};
  return Error("usage", fmt::format("-o {}: the output is SVG, not {}", path, ending),
               "use the extension .svg");
}

void lay_out(const Options& options, draw::Chart& chart) {
  const bool single = chart.panels.size() == 1;
  chart.columns = options.columns.value_or(single ? 1 : 2);
  chart.panel_width = single ? kSingleWidth : kPanelWidth;
  chart.panel_height = single ? kSingleHeight : kPanelHeight;
  if (options.panel) {
    chart.panel_width = options.panel->first;
    chart.panel_height = options.panel->second;
  }
}

std::string usual_title(const std::vector<std::string>& inputs) {
  std::string title = name_of_input(inputs[0]);
  if (inputs.size() == 2) title += " and " + name_of_input(inputs[1]);
  if (inputs.size() > 2) title += fmt::format(" and {} more", inputs.size() - 1);
  return title;
}

Json axis_json(const draw::Axis& axis) {
  Json json;
  json["label"] = to_utf8(axis.label);
  json["unit"] = to_utf8(axis.unit);
  return json;
}

// The chart's contents for the report: for each line, the number of values and their range.
Json summary_of(const draw::Chart& chart) {
  Json panels = Json::array();
  for (const draw::Panel& panel : chart.panels) {
    Json lines = Json::array();
    for (const draw::Series& series : panel.series) {
      if (series.name.empty()) continue;
      double low = INFINITY, high = -INFINITY;
      std::size_t values = 0;
      for (const double value : series.y) {
        if (!std::isfinite(value)) continue;
        low = std::min(low, value);
        high = std::max(high, value);
        ++values;
      }
      Json line;
      line["name"] = to_utf8(series.name);
      line["values"] = values;
      line["low"] = values > 0 ? Json(low) : Json();
      line["high"] = values > 0 ? Json(high) : Json();
      lines.push_back(std::move(line));
    }
    Json entry;
    entry["title"] = to_utf8(panel.title);
    entry["x"] = axis_json(panel.x);
    entry["y"] = axis_json(panel.y);
    entry["lines"] = std::move(lines);
    panels.push_back(std::move(entry));
  }
  return panels;
}

Result<draw::Chart> make_chart(const Options& options, ToolContext& context) {
  if (options.table) return chart_tables(options, context);
  const auto motions = read_motions(options.inputs, options.motion, context);
  if (!motions) return motions.error();
  return chart_motions(*motions, options, context);
}

Status write_charts(const Options& options, ToolContext& context) {
  if (Status status = check_output(context.output); !status) return status;
  auto chart = make_chart(options, context);
  if (!chart) return chart.error();
  chart->title = options.title.empty() ? usual_title(options.inputs) : options.title;
  lay_out(options, *chart);
  const auto svg = draw::to_svg(*chart);
  if (!svg) return svg.error();
  const Status status =
      write_output(context, context.output, [&](OutputFile& file) { return file.write(*svg); });
  if (!status) return status;
  context.report.result["panels"] = summary_of(*chart);
  context.log(fmt::format("{}: {}", context.output == "-" ? "standard output" : context.output,
                          counted(static_cast<long long>(chart->panels.size()), "panel")));
  return {};
}

Result<int> run_typed(const Arguments& arguments, ToolContext& context) {
  const auto options = understand(arguments);
  if (!options) return options.error();
  return run(*options, context);
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  const bool images = options.sheet.wanted();
  if (context.output.empty() && !images) {
    return Error("usage", "-o is missing", "see krok-plot --help");
  }
  if (images && context.kept_messages != nullptr) {
    return Error("usage", "--sheet and --strip cannot be used in batch mode");
  }
  if (images) {
    if (Status status = make_sheets(options.inputs, options.sheet, context); !status) {
      return status.error();
    }
  }
  if (context.output.empty()) return kExitDone;
  if (Status status = write_charts(options, context); !status) return status.error();
  return kExitDone;
}

ToolSpec make_spec() {
  const auto arguments = std::make_shared<Arguments>();
  ToolSpec spec;
  spec.name = "krok-plot";
  spec.summary = "Plots motions and numeric tables as charts in one SVG";
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
      {"krok-plot walk.bvh --sheet walk.png", "images of the character at eight times"},
      {"krok-plot hero.character walk.anim --strip hero.png",
       "an animated character with the colours and textures of its materials; without "
       "a motion, in its reference pose"}};
  spec.needs_output = false;  // --sheet and --strip have their own output files
  spec.batch = {{".anim", ".bvh", ".amc"}, always(".svg")};
  spec.declare = [arguments](CommandOptions& command) { declare(command, *arguments); };
  spec.check = [arguments] { return check(*arguments); };
  spec.run = [arguments](ToolContext& context) { return run_typed(*arguments, context); };
  return spec;
}

}  // namespace krok::plot
