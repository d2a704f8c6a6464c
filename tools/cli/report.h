#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/json_internal.h"
#include "core/numbers.h"
#include "core/result.h"
#include "math/transform.h"

namespace krok::cli {

// JSON of reports and journals: members keep insertion order.
using Json = nlohmann::ordered_json;

// An empty object with memory reserved for this many members; growing an object copies all its
// members.
inline Json object_for(std::size_t members) {
  Json object = Json::object();
  object.get_ref<Json::object_t&>().reserve(members);
  return object;
}

// The report of a run, written as JSON (schema krok.report/1) for scripts. Identical for two runs
// on the same input.
struct Report {
  std::string tool;
  std::string version;
  struct Input {
    std::string path;
    std::string xxh3;
    std::string animation = {};  // the one of the file that is meant; may be empty
  };
  std::vector<Input> inputs;
  // Folders that were searched for files; for the journal of a batch, not for the report.
  struct Choice {
    std::string folder;
    std::string ending;  // ".asf", or a full file name
  };
  std::vector<Choice> choices;
  Json options = Json::object();
  std::vector<std::string> outputs;
  Diagnostics issues;
  Json result = Json::object();

  Json to_json() const;
};

// A length as text: "0.25 mm".
inline std::string millimetres(double metres) {
  return readable(1e3 * metres, 3) + " mm";
}

// Angles of reports are in degrees.
inline double to_degrees(double radians) {
  return radians / kRadiansPerDegree;
}
// A value in `unit`, and the unit, as reports have them: degrees in place of "rad".
inline double reported(double value, std::string_view unit) {
  return unit == "rad" ? to_degrees(value) : value;
}
inline std::string reported_unit(std::string_view unit) {
  return unit == "rad" ? "deg" : std::string(unit);
}

// The same with all numbers but frame rates rounded to nine significant digits, which hold what a
// float holds.
Json rounded(Json json);

// "note", "warning", "error".
const char* severity_name(Severity severity);

Json to_json(const Diagnostic& diagnostic);
Json to_json(const Diagnostics& diagnostics);
Json to_json(const std::vector<Report::Input>& inputs);

// Whether `path` is free or holds a report. Only then may a report be written to it when the
// command line could not be parsed, as `path` might be an input.
bool only_a_report_stands_at(const std::string& path);

// "walk.bvh:214:61: error: message [code]", with a second line for the hint if any. Without a file
// it starts at the severity.
std::string to_text(const Diagnostic& diagnostic);

// The same with a line end, and with the tool's name first if there is no file.
std::string message_of(const std::string& tool, const Diagnostic& diagnostic);

}  // namespace krok::cli
