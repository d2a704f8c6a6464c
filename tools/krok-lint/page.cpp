#include "tools/krok-lint/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "core/base64.h"
#include "core/markup.h"
#include "core/parallel.h"
#include "core/text.h"
#include "render/png.h"
#include "render/sheet.h"
#include "tools/shared/moving_actor.h"

namespace krok::cli::lint {

namespace {

using krok::lint::facts_of;
using krok::lint::Finding;
using krok::lint::Rule;

constexpr std::size_t kMaxStrips = 100;
constexpr int kRowHeight = 170;  // pixels
constexpr const char* kStyle =
    ":root{color-scheme:light dark;--line:#ccd;--bad:#a01c1c;--doubtful:#7a5200}"
    "@media(prefers-color-scheme:dark){:root{--line:#39424d;--bad:#ff9a8a;--doubtful:#e5b567}"
    "body{color:#dce1e7;background:#15181c}}"
    "body{font:15px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:75rem;padding:0 1rem}"
    "table{border-collapse:collapse;margin:.5rem 0}"
    "td,th{text-align:left;padding:.2rem .8rem;border-bottom:1px solid var(--line)}"
    "td:first-child{white-space:nowrap}@media(max-width:40rem){td,th{padding:.2rem .4rem}}"
    ".error{color:var(--bad);font-weight:600}.warning{color:var(--doubtful)}img{max-width:100%}"
    "h2{font-size:1.05rem;margin:1.6rem 0 "
    ".2rem;overflow-wrap:anywhere}code{overflow-wrap:anywhere}";

// The times around a fault: frame by frame for what happens within one, else over its length.
std::array<double, 5> moments_of(const Finding& finding, const LintedFile& file) {
  const bool sudden = finding.rule == Rule::pop || finding.rule == Rule::flip;
  const double length = file.seconds(finding.last - finding.first);
  const double step = sudden ? 1 / file.rate : std::clamp(length / 4, 1 / file.rate, 0.25);
  const double latest = file.seconds(std::max(0, file.frames - 1));
  std::array<double, 5> times{};
  for (int i = 0; i < 5; ++i) {
    times[static_cast<std::size_t>(i)] =
        std::clamp(file.seconds(finding.worst) + (i - 2) * step, 0.0, latest);
  }
  return times;
}

Result<std::string> strip_of(const LintedFile& file, const Finding& finding, ToolContext& context) {
  // Its warnings are known from the first reading.
  ToolContext own;
  own.quiet = true;
  own.jobs = context.jobs;
  auto actors = read_actors({file.path}, {BodyChoice::none, SkinMethod::linear, ""}, own);
  if (!actors) return actors.error();
  const MovingActor& actor = actors->front();
  const auto times = moments_of(finding, file);
  std::array<render::Actor, 5> shown;
  render::Sheet sheet;
  render::SheetRow row;
  row.yaw = actor.heading(times[2]) + kPi / 5;
  row.elevation = 8 * kRadiansPerDegree;
  for (std::size_t i = 0; i < times.size(); ++i) {
    shown[i] = actor.at(times[i]);
    render::SheetCell cell;
    cell.layers = {{&shown[i]}};
    cell.centre = shown[i].centre;
    cell.label = fmt::format("{:.2f} s", times[i]);
    cell.marked = i == 2;
    row.cells.push_back(std::move(cell));
  }
  sheet.rows.push_back(std::move(row));
  const auto image = render::make_sheet(sheet, {kRowHeight, kRowHeight, context.jobs});
  if (!image) return image.error();
  const auto png = render::write_png(image->image);
  if (!png) return png.error();
  return to_base64(std::as_bytes(std::span(*png)));
}

}  // namespace

Result<std::string> page_of(LintedFiles files, ToolContext& context) {
  std::string body;
  std::size_t strips = 0, faulty = 0;
  for (const LintedFile* file : files) {
    if (file->error) {
      body += fmt::format("<h2>{}</h2><p class=\"error\">{}</p>\n", to_markup(to_utf8(file->path)),
                          to_markup(file->error->message));
      continue;
    }
    if (file->findings.empty()) continue;
    ++faulty;
    const Finding& worst = file->findings.front();
    body += fmt::format("<h2>{}</h2>\n", to_markup(to_utf8(file->path)));
    if (strips < kMaxStrips) {
      const auto strip = strip_of(*file, worst, context);
      if (!strip) return strip.error();
      body += fmt::format("<img alt=\"{} at {:.2f} s\" src=\"data:image/png;base64,{}\">\n",
                          facts_of(worst.rule).id, file->seconds(worst.worst), *strip);
      ++strips;
    }
    body += "<table><tr><th>time</th><th>rule</th><th>what</th></tr>\n";
    for (const Finding& finding : file->findings) {
      const auto& facts = facts_of(finding.rule);
      body += fmt::format(
          "<tr><td>{:.2f} s</td><td class=\"{}\" title=\"{}\">{}</td><td>{}</td></tr>\n",
          file->seconds(finding.worst), name_of(facts.severity), to_markup(facts.meaning), facts.id,
          to_markup(text_of(finding, *file)));
    }
    body +=
        fmt::format("</table><p><code>krok view {}</code></p>\n", to_markup(to_utf8(file->path)));
  }
  return fmt::format(
      "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width\"><title>Faults of motions</title>"
      "<style>{}</style><main><h1>{} of {} motions have faults</h1>\n{}</main></html>\n",
      kStyle, faulty, files.size(), body);
}

}  // namespace krok::cli::lint
