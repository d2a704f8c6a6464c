#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/result.h"

namespace krok {

using Json = nlohmann::ordered_json;

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
  Json options = Json::object();
  std::vector<std::string> outputs;
  Diagnostics issues;
  Json result = Json::object();

  Json to_json() const;
};

// "walk.bvh:214:61: error: what is wrong [code]", and where there is one a second line with the
// hint. Without a file the message stands alone after the severity.
std::string to_text(const Diagnostic& diagnostic);

}  // namespace krok
