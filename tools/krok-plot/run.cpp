#include "tools/krok-plot/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/file.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/chart/chart_writer.h"
#include "tools/cli/output_set.h"
#include "tools/cli/paths.h"
#include "tools/krok-plot/charts.h"

namespace krok::cli::plot {

namespace {

// Sizes at which text is legible on A4 paper with two panels per row.
constexpr double kPanelWidth = 340, kPanelHeight = 170;
constexpr double kSingleWidth = 640, kSingleHeight = 260;

void lay_out(const Options& options, draw::Chart& chart) {
  const bool single = chart.panels.size() == 1;
  chart.columns = options.columns.value_or(single ? 1 : 2);
  chart.panel_width = single ? kSingleWidth : kPanelWidth;
  chart.panel_height = single ? kSingleHeight : kPanelHeight;
  if (options.panel) {
    chart.panel_width = (*options.panel)[0];
    chart.panel_height = (*options.panel)[1];
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

// The chart's contents for the report: for each line, the number of values, their range, mean and
// unit.
Json summary_of(const draw::Chart& chart) {
  Json panels = Json::array();
  for (const draw::Panel& panel : chart.panels) {
    Json lines = Json::array();
    for (const draw::Series& series : panel.series) {
      if (series.name.empty()) continue;
      double low = INFINITY, high = -INFINITY, sum = 0;
      std::size_t values = 0;
      for (const double value : series.y) {
        if (!std::isfinite(value)) continue;
        low = std::min(low, value);
        high = std::max(high, value);
        sum += value;
        ++values;
      }
      Json line;
      line["name"] = to_utf8(series.name);
      line["values"] = values;
      line["smallest"] = values > 0 ? Json(low) : Json();
      line["largest"] = values > 0 ? Json(high) : Json();
      line["mean"] = values > 0 ? Json(sum / static_cast<double>(values)) : Json();
      line["unit"] = to_utf8(panel.y.unit);
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
  if (options.plots_tables()) return chart_tables(options, context);
  const auto motions = read_motions(options.inputs, options.motion, context);
  if (!motions) return motions.error();
  return chart_motions(*motions, options, context);
}

Status add_charts(const Options& options, ToolContext& context, OutputSet& outputs,
                  std::vector<std::string>& done) {
  auto chart = make_chart(options, context);
  if (!chart) return chart.error();
  // What is there says what the chart is of.
  if (!chart->title.empty() && options.inputs.size() == 1) {
    chart->title = usual_title(options.inputs) + ": " + chart->title;
  }
  if (chart->title.empty()) chart->title = usual_title(options.inputs);
  if (!options.title.empty()) chart->title = options.title;
  lay_out(options, *chart);
  const auto svg = draw::to_svg(*chart);
  if (!svg) return svg.error();
  const Status status = outputs.add(context.output, [&](OutputFile& file) {
    return extension(context.output) == ".csv" ? file.write(chart::csv_of(*chart))
                                               : chart::write(context.output, *svg, file);
  });
  if (!status) return status;
  context.report.result["panels"] = summary_of(*chart);
  done.push_back(fmt::format("{}: {}", context.output == "-" ? "standard output" : context.output,
                             counted(chart->panels.size(), "panel")));
  return {};
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  if (Status status = check_inputs(options); !status) return status.error();
  const bool images = options.sheet.wanted();
  if (context.output.empty() && !images) {
    return no_output("add -o OUTPUT, --sheet or --strip");
  }
  // In batch mode -o is given by the batch; images replace the charts.
  const bool charts = !context.output.empty() && !(images && context.one_of_many != nullptr);
  OutputSet outputs(context);
  std::vector<std::string> done;
  if (images) {
    SheetOptions sheet = options.sheet;
    sheet.columns = options.columns;
    sheet.size_given = options.given("--actor-size");
    sheet.from = options.motion.from;
    sheet.to = options.motion.to;
    sheet.ground = options.motion.ground;
    sheet.prints = options.motion.prints;
    Status status = make_sheets(options.inputs, sheet, context, outputs, done);
    if (!status) return status.error();
  }
  if (charts) {
    if (Status status = add_charts(options, context, outputs, done); !status) return status.error();
  }
  if (Status status = outputs.finish(); !status) return status.error();
  for (const std::string& line : done) context.log(line);
  if (charts && !options.plots_tables() && !images && extension(context.output) == ".png" &&
      !options.given("--show")) {
    context.log("these are charts; --sheet OUT.png shows the actors");
  }
  return kExitDone;
}

}  // namespace krok::cli::plot
