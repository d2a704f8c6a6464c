#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "core/numbers.h"
#include "core/text.h"
#include "draw/viewer_page.h"
#include "formats/csv/csv_writer.h"
#include "formats/io/open_character.h"
#include "render/image.h"
#include "render/sheet.h"
#include "tools/cli/paths.h"
#include "tools/krok-lint/linted_file.h"
#include "tools/shared/moving_actor.h"

namespace krok::cli::lint {

namespace {

using krok::lint::facts_of;
using krok::lint::Finding;
using krok::lint::Rule;

constexpr std::size_t kMaxSarifResults = 25'000;  // GitHub's limit for a run

std::string shown_name(const LintedFile& file) {
  return printable(file.name());
}

// Meshes have their faults at any time.
std::string when(const Finding& finding, const LintedFile& file) {
  return finding.mesh.empty() ? fmt::format("{:.2f} s: ", file.seconds(finding.worst)) : "";
}

Json sarif_rules() {
  Json list = Json::array();
  for (const auto& facts : krok::lint::rules()) {
    list.push_back({{"id", facts.id},
                    {"shortDescription", {{"text", facts.meaning}}},
                    {"defaultConfiguration", {{"level", severity_name(facts.severity)}}}});
  }
  return list;
}

Json sarif_result(const LintedFile& file, std::string_view rule, Severity severity,
                  const std::string& text, const std::string& fingerprint) {
  Json location = {{"artifactLocation",
                    {{"uri", uri_of(to_utf8(std::filesystem::path(file.path).generic_string()))}}},
                   {"region", {{"startLine", 1}}}};
  Json physical = {{"physicalLocation", std::move(location)}};
  return {{"ruleId", rule},
          {"level", severity_name(severity)},
          {"message", {{"text", text}}},
          {"locations", Json::array({std::move(physical)})},
          {"partialFingerprints", {{"krokLint/v1", fingerprint}}}};
}

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
  OneOfMany messages;
  ToolContext own = context.beside(messages, context.jobs);
  auto actors = read_actors({file.path}, {.body = BodyChoice::none, .clip = file.animation}, own);
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

std::string rules_text() {
  std::string text;
  for (const auto& facts : krok::lint::rules()) {
    text += fmt::format(
        "{:<22}{:<9}{:>9}  {}\n", facts.id, severity_name(facts.severity),
        facts.threshold > 0 ? quantity_text(facts.threshold, std::string(facts.unit)) : "",
        facts.meaning);
  }
  return text;
}

std::string console_text(const LintedFile& file, bool errors_only) {
  if (file.error) {
    // That of NAME.lint.json is not the motion's.
    const std::string& place = file.error->where.file;
    const bool is_other = !place.empty() && place != file.path;
    return fmt::format(
        "{}: error: {} [unreadable]\n{}", shown_name(file),
        is_other ? printable(base_name(place)) + " has a fault" : printable(file.error->message),
        is_other ? to_text(*file.error) + "\n" : "");
  }
  std::string text;
  for (const Finding& finding : file.findings) {
    const auto& facts = facts_of(finding.rule);
    if (errors_only && facts.severity != Severity::error) continue;
    text += fmt::format("{}: {}{}: {} [{}]\n", shown_name(file), when(finding, file),
                        severity_name(facts.severity), text_of(finding, file), facts.id);
  }
  return text;
}

std::string table_of(LintedFiles files) {
  std::string text =
      "file,animation,rule,kind,severity,time [s],frame,joint,joints,value,limit,unit,from [s],to "
      "[s],"
      "detail\n";
  for (const LintedFile* file : files) {
    const std::string path = csv::field(to_utf8(file->path)) + "," + csv::field(file->animation);
    if (file->error) {
      text +=
          fmt::format("{},unreadable,,error,,,,,,,,,,{}\n", path, csv::field(file->error->message));
    }
    for (const Finding& f : file->findings) {
      const auto& facts = facts_of(f.rule);
      text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", path, facts.id, f.kind,
                          severity_name(facts.severity), readable(file->seconds(f.worst), 6),
                          f.worst, csv::field(file->joint_of(f)), f.joints, readable(f.value, 4),
                          readable(f.threshold, 4), f.unit, readable(file->seconds(f.first), 6),
                          readable(file->seconds(f.last), 6), csv::field(f.detail));
    }
  }
  return text;
}

Json json_of(const LintedFile& file) {
  Json json = {{"path", to_utf8(file.path)}};
  if (!file.animation.empty()) json["animation"] = file.animation;
  if (file.error) {
    json["error"] = {{"code", file.error->code}, {"message", file.error->message}};
    return json;
  }
  Json faults = Json::array();
  const auto prints = fingerprints_of(file);
  for (std::size_t i = 0; i < file.findings.size(); ++i) {
    const Finding& f = file.findings[i];
    const auto& facts = facts_of(f.rule);
    Json fault = {{"rule", facts.id}, {"severity", severity_name(facts.severity)}};
    if (!f.kind.empty()) fault["kind"] = f.kind;
    if (f.joint >= 0) fault["joint"] = file.joint_of(f);
    if (!f.mesh.empty()) fault["mesh"] = f.mesh;
    fault["joints"] = f.joints;
    fault["time"] = file.seconds(f.worst);
    fault["frame"] = f.worst;
    fault["from"] = file.seconds(f.first);
    fault["to"] = file.seconds(f.last);
    fault["value"] = f.value;
    fault["limit"] = f.threshold;
    fault["unit"] = f.unit;
    if (!f.detail.empty()) fault["detail"] = f.detail;
    fault["fingerprint"] = prints[i];
    faults.push_back(std::move(fault));
  }
  json["frames"] = file.frames;
  json["rate"] = file.rate;
  json["faults"] = std::move(faults);
  if (file.suppressed > 0) json["suppressed"] = file.suppressed;
  if (file.known > 0) json["known"] = file.known;
  json["notes"] = file.notes;
  return json;
}

std::string sarif_of(LintedFiles files, const std::string& version) {
  Json results = Json::array();
  std::size_t left_out = 0;
  for (const LintedFile* file : files) {
    const auto add = [&](Json result) {
      if (results.size() < kMaxSarifResults) {
        results.push_back(std::move(result));
      } else {
        ++left_out;
      }
    };
    if (file->error) {
      add(sarif_result(*file, "unreadable", Severity::error, file->error->message,
                       fingerprint_of(*file, "unreadable", 0)));
    }
    const auto prints = fingerprints_of(*file);
    const std::string of_animation = file->animation.empty() ? "" : file->animation + ": ";
    for (std::size_t i = 0; i < file->findings.size(); ++i) {
      const Finding& f = file->findings[i];
      const auto& facts = facts_of(f.rule);
      add(sarif_result(*file, facts.id, facts.severity,
                       fmt::format("{}. {}{}{}{}", facts.meaning, of_animation,
                                   f.mesh.empty() ? "At " : "", when(f, *file), text_of(f, *file)),
                       prints[i]));
    }
  }
  Json driver = {{"name", "krok-lint"}, {"version", version}, {"rules", sarif_rules()}};
  Json run;
  run["tool"]["driver"] = std::move(driver);
  run["results"] = std::move(results);
  if (left_out > 0) run["properties"]["leftOut"] = left_out;
  Json sarif = {{"$schema", "https://json.schemastore.org/sarif-2.1.0.json"}, {"version", "2.1.0"}};
  sarif["runs"] = Json::array({std::move(run)});
  return sarif.dump(1) + "\n";
}

std::string junit_of(LintedFiles files, const krok::lint::Settings& settings) {
  std::string suites;
  std::size_t tests = 0, failures = 0, errors = 0;
  for (const LintedFile* file : files) {
    const std::string path = to_markup(file->name());
    if (file->error) {
      suites += fmt::format(
          "  <testsuite name=\"{0}\" tests=\"1\" failures=\"0\" errors=\"1\">\n"
          "    <testcase classname=\"{0}\" name=\"unreadable\"><error "
          "message=\"{1}\"/></testcase>\n"
          "  </testsuite>\n",
          path, to_markup(file->error->message));
      ++tests, ++errors;
      continue;
    }
    std::string cases;
    std::size_t here = 0, failed = 0, left_out = 0;
    for (const auto& facts : krok::lint::rules()) {
      if (facts.rule == krok::lint::Rule::unreadable) continue;
      ++here;
      std::string text;
      for (const Finding& f : file->findings) {
        if (f.rule == facts.rule) {
          text += fmt::format("{}{}\n", when(f, *file), text_of(f, *file));
        }
      }
      cases += fmt::format("    <testcase classname=\"{}\" name=\"{}\"", path, facts.id);
      if (!settings.has(facts.rule)) {
        ++left_out;
        cases += "><skipped message=\"not among the rules of this run\"/></testcase>\n";
        continue;
      }
      if (text.empty()) {
        cases += "/>\n";
        continue;
      }
      ++failed;
      cases +=
          fmt::format("><failure type=\"{}\" message=\"{}\">{}</failure></testcase>\n",
                      severity_name(facts.severity), to_markup(facts.meaning), to_markup(text));
    }
    suites += fmt::format(
        "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"{}\">\n{}  "
        "</testsuite>\n",
        path, here, failed, left_out, cases);
    tests += here, failures += failed;
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<testsuites name=\"krok-lint\" tests=\"{}\" failures=\"{}\" "
      "errors=\"{}\">\n{}</testsuites>\n",
      tests, failures, errors, suites);
}

Result<std::string> player_of(const LintedFile& file) {
  io::PlainInputs inputs;
  const auto actor = io::open_actor(file.path, inputs, {.clip = file.animation});
  if (!actor) return actor.error();
  draw::ViewedMotion motion;
  motion.name = to_utf8(name_of_input(file.path));
  if (!file.animation.empty()) motion.name += ": " + file.animation;
  motion.clip = &actor->motions.front().clip;
  if (actor->has_mesh()) motion.body = &actor->model, motion.materials = actor->materials;
  draw::ViewerPage page;
  page.title = motion.name;
  page.motions.push_back(std::move(motion));
  return draw::write_viewer_page(page);
}

Result<std::string> page_of(LintedFiles files, const PlayerLinks& players, ToolContext& context) {
  std::string body;
  std::size_t strips = 0, faulty = 0, motions = 0;
  for (const LintedFile* file : files) {
    motions += file->frames > 0 || file->error ? 1 : 0;
    if (file->error) {
      body += fmt::format("<h2>{}</h2><p class=\"error\">{}</p>\n", to_markup(file->name()),
                          to_markup(file->error->message));
      continue;
    }
    if (file->findings.empty()) continue;
    faulty += file->frames > 0 ? 1 : 0;
    const Finding& worst = file->findings.front();
    body += fmt::format("<h2>{}</h2>\n", to_markup(file->name()));
    if (strips < kMaxStrips && file->frames > 0) {
      const auto strip = strip_of(*file, worst, context);
      if (!strip) return strip.error();
      body += fmt::format("<img alt=\"{} at {:.2f} s\" src=\"data:image/png;base64,{}\">\n",
                          facts_of(worst.rule).id, file->seconds(worst.worst), *strip);
      ++strips;
    }
    const auto player = players.find(file);
    const auto time_of = [&](const Finding& finding) -> std::string {
      if (!finding.mesh.empty()) return "";
      const double seconds = file->seconds(finding.worst);
      if (player == players.end()) return fmt::format("{:.2f} s", seconds);
      const std::string joint = finding.joint < 0 ? "" : fmt::format("&joint=0,{}", finding.joint);
      return fmt::format("<a href=\"{}\">{:.2f} s</a>",
                         to_markup(fmt::format("{}#t={:.4f}{}", player->second, seconds, joint)),
                         seconds);
    };
    body += "<table><tr><th>time</th><th>rule</th><th>what</th></tr>\n";
    for (const Finding& finding : file->findings) {
      const auto& facts = facts_of(finding.rule);
      body += fmt::format("<tr><td>{}</td><td class=\"{}\" title=\"{}\">{}</td><td>{}</td></tr>\n",
                          time_of(finding), severity_name(facts.severity), to_markup(facts.meaning),
                          facts.id, to_markup(text_of(finding, *file)));
    }
    body +=
        fmt::format("</table><p><code>krok view {}</code></p>\n", to_markup(to_utf8(file->path)));
  }
  return fmt::format(
      "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width\"><title>Faults of motions</title>"
      "<style>{}</style><main><h1>{} of {} motions have faults</h1>\n{}</main></html>\n",
      kStyle, faulty, motions, body);
}

}  // namespace krok::cli::lint
