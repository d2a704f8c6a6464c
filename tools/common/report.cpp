#include "tools/common/report.h"

#include <fmt/format.h>

namespace krok {

namespace {

const char* severity_name(Severity severity) {
  switch (severity) {
    case Severity::note:
      return "note";
    case Severity::warning:
      return "warning";
    case Severity::error:
      break;
  }
  return "error";
}

Json to_json(const Diagnostic& diagnostic) {
  const Location& where = diagnostic.where;
  Json json;
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

}  // namespace

Json Report::to_json() const {
  Json json;
  json["schema"] = "krok.report/1";
  json["tool"] = tool;
  json["version"] = version;
  json["inputs"] = Json::array();
  for (const Input& input : inputs) {
    json["inputs"].push_back({{"path", input.path}, {"xxh3", input.xxh3}});
  }
  json["options"] = options;
  json["outputs"] = outputs;
  json["issues"] = Json::array();
  for (const Diagnostic& issue : issues) json["issues"].push_back(krok::to_json(issue));
  json["result"] = result;
  return json;
}

std::string to_text(const Diagnostic& diagnostic) {
  const Location& where = diagnostic.where;
  std::string text;
  if (!where.file.empty()) {
    text = where.file;
    if (where.line > 0) text += fmt::format(":{}", where.line);
    if (where.line > 0 && where.column > 0) text += fmt::format(":{}", where.column);
    text += ": ";
  }
  text += fmt::format("{}: {}", severity_name(diagnostic.severity), diagnostic.message);
  if (where.byte_offset >= 0) text += fmt::format(" (at byte {})", where.byte_offset);
  if (!diagnostic.code.empty()) text += fmt::format(" [{}]", diagnostic.code);
  if (!diagnostic.hint.empty()) text += fmt::format("\n  hint: {}", diagnostic.hint);
  return text;
}

}  // namespace krok
