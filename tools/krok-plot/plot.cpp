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

// Sizes at which text is legible on A4 paper, two panels side by side.
constexpr double kPanelWidth = 340, kPanelHeight = 170;
constexpr double kSingleWidth = 640, kSingleHeight = 260;

Status check_output(const std::string& path) {
  const std::string ending = extension(path);
  const bool other = registry::kind_of_name(path) != registry::Kind::unknown || ending == ".png" ||
                     ending == ".pdf" || ending == ".csv" || ending == ".html";
  if (!other) return {};
  return Error("usage", fmt::format("-o {}: what is written there is an SVG, not {}", path, ending),
               "call it .svg");
}

void lay_out(const Options& options, draw::Actor& actor) {
  const bool single = actor.panels.size() == 1;
  actor.columns = options.columns.value_or(single ? 1 : 2);
  actor.panel_width = single ? kSingleWidth : kPanelWidth;
  actor.panel_height = single ? kSingleHeight : kPanelHeight;
  if (options.panel) {
    actor.panel_width = options.panel->first;
    actor.panel_height = options.panel->second;
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

// What can be read from the figure: for each line how many values it has and between which limits.
Json summary_of(const draw::Actor& actor) {
  Json panels = Json::array();
  for (const draw::Panel& panel : actor.panels) {
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

Result<draw::Actor> make_actor(const Options& options, ToolContext& context) {
  if (options.table) return chart_tables(options, context);
  const auto motions = read_motions(options.inputs, options.motion, context);
  if (!motions) return motions.error();
  return chart_motions(*motions, options, context);
}

Status write_charts(const Options& options, ToolContext& context) {
  if (Status status = check_output(context.output); !status) return status;
  auto actor = make_actor(options, context);
  if (!actor) return actor.error();
  actor->title = options.title.empty() ? usual_title(options.inputs) : options.title;
  lay_out(options, *actor);
  const auto svg = draw::to_svg(*actor);
  if (!svg) return svg.error();
  const Status status =
      write_output(context, context.output, [&](OutputFile& file) { return file.write(*svg); });
  if (!status) return status;
  context.report.result["panels"] = summary_of(*actor);
  context.say(fmt::format("{}: {}", context.output == "-" ? "standard output" : context.output,
                          counted(static_cast<long long>(actor->panels.size()), "panel")));
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
    return Error("usage", "-o is missing: where shall the charts go?", "see krok-plot --help");
  }
  if (images && context.kept_messages != nullptr) {
    return Error("usage", "--sheet and --strip make one picture, not one of each of many files");
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
  spec.summary = "Draws motions and tables of numbers as charts, in one SVG";
  spec.inputs = "IN...";
  spec.examples = {
      {"krok-plot walk.bvh -o walk.svg",
       "path from above, heights and speeds of the feet, angles of legs and arms"},
      {"krok-plot raw.anim clean.anim --show angles,difference --from 1s --to 3s -o clean.svg",
       "two motions in the same panels, and how far apart they are"},
      {"krok-plot take.bvh --joint LeftHand --euler ZXY -o hand.svg",
       "where a joint is, and how it is turned"},
      {"krok-plot walk.csv --where joint=LeftFoot --where joint=RightFoot --y y -o heights.svg",
       "one column of a table, a line for each of two joints"},
      {"krok-plot fit.csv --x examples --y error_mm --log-y --style both -o fit.svg",
       "any table of numbers; the unit is read from the column's name"},
      {"krok-plot walk.bvh --sheet walk.png", "pictures of the figure at eight moments"},
      {"krok-plot hero.character walk.anim --strip hero.png",
       "a character with the colours and textures of its materials, moved; without a motion it "
       "stands"}};
  spec.needs_output = false;  // --sheet and --strip name files of their own
  spec.batch = {{".anim", ".bvh", ".amc"}, always(".svg")};
  spec.declare = [arguments](CommandOptions& command) { declare(command, *arguments); };
  spec.check = [arguments] { return check(*arguments); };
  spec.run = [arguments](ToolContext& context) { return run_typed(*arguments, context); };
  return spec;
}

}  // namespace krok::plot
