#include <fmt/format.h>

#include <algorithm>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/morph_exr/morph_exr.h"
#include "formats/textgrid/textgrid.h"
#include "tools/krok-info/describe.h"

// Morph targets and labels over time.

namespace krok::cli::info {

Result<Description> describe_morphs(const InputFile& file, ToolContext&) {
  const auto morphs = morph_exr::read(file.bytes());
  if (!morphs) return morphs.error();
  Description out;
  out.what = "morph targets (.exr)";
  out.json["kind"] = "morphs";
  out.add("vertices", fmt::format("{}, of the model", grouped(morphs->vertex_count)));
  out.json["vertices"] = morphs->vertex_count;
  out.json["normals"] = !morphs->normals.empty();
  out.json["targets"] = morphs->names;
  std::vector<std::string> names;
  for (const std::string& name : morphs->names) names.push_back(shown(name));
  out.add("targets", grouped(morphs->target_count()));
  out.add("", std::move(names));
  add_provenance(morphs->provenance, out);
  return out;
}

Result<Description> describe_textgrid(const InputFile& file, ToolContext&) {
  const auto grid = textgrid::read(file.text(), file.path());
  if (!grid) return grid.error();
  Description out;
  out.what = "labels over time (TextGrid)";
  out.json["kind"] = "textgrid";
  out.add("duration", readable(grid->end - grid->start, 4) + " s");
  out.json["duration"] = grid->end - grid->start;
  std::vector<std::string> lines;
  for (const textgrid::Tier& tier : grid->tiers) {
    const auto labelled = std::ranges::count_if(
        tier.intervals, [](const textgrid::Interval& one) { return !one.label.empty(); });
    lines.push_back(fmt::format(
        "{}: {}, {} with a label", shown(tier.name),
        counted(std::ssize(tier.intervals), tier.points ? "point" : "interval"), labelled));
    out.json["tiers"].push_back({{"name", tier.name},
                                 {"points", tier.points},
                                 {"intervals", tier.intervals.size()},
                                 {"labelled", labelled}});
  }
  out.add("tiers", std::move(lines));
  return out;
}

}  // namespace krok::cli::info
