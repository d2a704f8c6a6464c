#include "formats/chart/chart_writer.h"

#include <fmt/format.h>

#include <span>

#include "core/fed_program.h"

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

}  // namespace krok::chart
