#include "formats/chart/chart_writer.h"

#include <fmt/format.h>

#include <cmath>
#include <span>

#include "core/fed_program.h"
#include "formats/csv/csv_writer.h"

namespace krok::chart {

std::vector<std::string> endings() {
  return {".svg", ".pdf", ".png"};
}

Status write(const std::string& path, const std::string& svg, OutputFile& file) {
  const std::string ending = extension(path);
  if (ending != ".pdf" && ending != ".png") return file.write(svg);
  const auto converter = find_program("rsvg-convert");
  // Sets the time that a PDF says it was made at.
  const auto env = find_program("env");
  if (!converter || !env) {
    return Error("chart-program",
                 fmt::format("charts become {} by rsvg-convert, which is not installed",
                             ending == ".pdf" ? "PDF" : "PNG"),
                 "apt-get install librsvg2-bin; or write SVG, which needs nothing: -o chart.svg");
  }
  std::vector<std::string> words = {"SOURCE_DATE_EPOCH=0", *converter, "--format",
                                    ending.substr(1)};
  if (ending == ".png") {
    for (const char* word : {"--zoom", "2", "--background-color", "white"})
      words.emplace_back(word);
  }
  words.insert(words.end(), {"--output", FedProgram::kResult});
  auto program = FedProgram::start(*env, words);
  if (!program) return program.error();
  if (Status status = program->feed(std::as_bytes(std::span(svg))); !status) return status.error();
  const auto bytes = program->finish();
  if (!bytes) return bytes.error();
  return file.write(*bytes);
}

std::string csv_of(const draw::Chart& chart) {
  std::string text = "panel,line,x,y,deviation,x_axis,y_axis\n";
  const auto axis = [](const draw::Axis& one) {
    return csv::field(one.unit.empty() ? one.label : one.label + " [" + one.unit + "]");
  };
  const auto number = [](double value) {
    return std::isfinite(value) ? fmt::format("{}", value) : std::string();
  };
  for (const draw::Panel& panel : chart.panels) {
    const draw::Series* band = nullptr;
    for (const draw::Series& line : panel.series) {
      const std::size_t count = line.x.size();
      if (line.name.empty()) {
        band = line.filled ? &line : nullptr;
        continue;
      }
      // It goes along the upper edge and back along the lower one.
      const bool has_band = band != nullptr && band->y.size() == 2 * count;
      for (std::size_t i = 0; i < count; ++i) {
        const double around =
            has_band ? 0.5 * (band->y[i] - band->y[2 * count - 1 - i]) : std::nan("");
        text += fmt::format("{},{},{},{},{},{},{}\n", csv::field(panel.title),
                            csv::field(line.name), number(line.x[i]), number(line.y[i]),
                            number(around), axis(panel.x), axis(panel.y));
      }
      band = nullptr;
    }
  }
  return text;
}

}  // namespace krok::chart
