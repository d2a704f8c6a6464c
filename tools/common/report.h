#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "tools/common/json.h"

namespace krok {

// What a tool did, gathered while it runs; written as JSON (schema krok.report/1) for scripts.
// Nothing in it differs between two runs on the same input.
struct Report {
  std::string tool;
  std::string version;
  struct Input {
    std::string path;
    std::string xxh3;
  };
  std::vector<Input> inputs;
  // Where files were looked for in a folder; for the journal of a batch, not for the report.
  struct Choice {
    std::string folder;
    std::string ending;  // ".asf", or a whole name
  };
  std::vector<Choice> choices;
  Json options = Json::object();
  std::vector<std::string> outputs;
  Diagnostics issues;
  Json result = Json::object();

  Json to_json() const;
};

Json to_json(const Diagnostic& diagnostic);
Json to_json(const Diagnostics& diagnostics);
Json to_json(const std::vector<Report::Input>& inputs);

// Whether a report may be written to `path` though it is not known what else the name stands for,
// as when a command line could not be parsed: nothing or a report stands there.
bool only_a_report_stands_at(const std::string& path);

// "walk.bvh:214:61: error: what is wrong [code]", and where there is one a second line with the
// hint. Without a file the message stands alone after the severity.
std::string to_text(const Diagnostic& diagnostic);

// The same as a whole message, with line end; one about no file begins with the tool's name.
std::string message_of(const std::string& tool, const Diagnostic& diagnostic);

}  // namespace krok
