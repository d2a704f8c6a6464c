#include "tools/cli/report.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>

#include "core/file.h"
#include "core/text.h"

namespace krok::cli {

const char* severity_name(Severity severity) {
  constexpr std::array kNames = {"note", "warning", "error"};  // [Severity]
  return kNames[static_cast<std::size_t>(severity)];
}

Json rounded(Json json) {
  if (json.is_structured()) {
    for (auto& [key, item] : json.items()) {
      if (key != "rate") item = rounded(std::move(item));
    }
  } else if (json.is_number_float()) {
    const double value = json.get<double>();
    if (std::isfinite(value)) json = *parse_finite(fmt::format("{:.9g}", value));
  }
  return json;
}

Json to_json(const Diagnostic& diagnostic) {
  const Location& where = diagnostic.where;
  Json json = object_for(10);
  json["code"] = diagnostic.code;
  json["severity"] = severity_name(diagnostic.severity);
  json["file"] = where.file.empty() ? Json() : Json(where.file);
  json["line"] = where.line > 0 ? Json(where.line) : Json();
  json["column"] = where.column > 0 ? Json(where.column) : Json();
  if (where.byte_offset >= 0) json["byte"] = where.byte_offset;
  json["joint"] = diagnostic.joint.empty() ? Json() : Json(diagnostic.joint);
  json["frame"] = diagnostic.frame >= 0 ? Json(diagnostic.frame) : Json();
  json["message"] = diagnostic.message;
  json["hint"] = diagnostic.hint.empty() ? Json() : Json(diagnostic.hint);
  return json;
}

Json to_json(const Diagnostics& diagnostics) {
  Json json = Json::array();
  for (const Diagnostic& diagnostic : diagnostics) json.push_back(to_json(diagnostic));
  return json;
}

Json to_json(const std::vector<Report::Input>& inputs) {
  Json json = Json::array();
  for (const auto& input : inputs) {
    Json& entry = json.emplace_back(object_for(2));
    entry["path"] = input.path;
    entry["xxh3"] = input.xxh3;
    if (!input.animation.empty()) entry["animation"] = input.animation;
  }
  return json;
}

Json Report::to_json() const {
  Json json = object_for(8);
  json["schema"] = "krok.report/1";
  json["tool"] = tool;
  json["version"] = version;
  json["inputs"] = krok::cli::to_json(inputs);
  json["options"] = options;
  json["outputs"] = outputs;
  json["issues"] = krok::cli::to_json(issues);
  json["result"] = rounded(result);
  return json;
}

bool only_a_report_stands_at(const std::string& path) {
  std::error_code missing;
  if (path == "-" || !std::filesystem::exists(path, missing)) return true;
  if (!std::filesystem::is_regular_file(path, missing)) return false;
  const auto file = InputFile::open(path);
  return file && file->text().substr(0, 100).find("\"schema\": \"krok.") != std::string::npos;
}

namespace {

// On one line, so that a name with a line end does not look like another message, and of a length
// that can be read: a parser may quote a number of a million digits.
std::string on_one_line(const std::string& text) {
  constexpr std::size_t kMax = 2000;
  if (text.size() <= kMax) return printable(text);
  std::size_t length = kMax;
  while (length > kMax - 4 && (static_cast<unsigned char>(text[length]) & 0xC0) == 0x80) --length;
  return printable(std::string_view(text).substr(0, length)) + "...";
}

}  // namespace

std::string to_text(const Diagnostic& diagnostic) {
  const Location& where = diagnostic.where;
  std::string text;
  if (!where.file.empty()) {
    text = on_one_line(where.file);
    if (where.line > 0) text += fmt::format(":{}", where.line);
    if (where.line > 0 && where.column > 0) text += fmt::format(":{}", where.column);
    text += ": ";
  }
  text +=
      fmt::format("{}: {}", severity_name(diagnostic.severity), on_one_line(diagnostic.message));
  if (where.byte_offset >= 0) text += fmt::format(" (at byte {})", where.byte_offset);
  if (!diagnostic.code.empty()) text += fmt::format(" [{}]", diagnostic.code);
  if (!diagnostic.hint.empty()) text += "\n  hint: " + on_one_line(diagnostic.hint);
  return text;
}

std::string message_of(const std::string& tool, const Diagnostic& diagnostic) {
  return (diagnostic.where.file.empty() ? tool + ": " : "") + to_text(diagnostic) + "\n";
}

}  // namespace krok::cli
