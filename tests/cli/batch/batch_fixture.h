#pragma once

#include <map>
#include <nlohmann/json.hpp>

#include "cli/fixture.h"

namespace krok::test {

using Json = nlohmann::ordered_json;
using Names = std::vector<std::string>;

// Runs tools inside the test's folder, so that paths are short and relative.
class BatchTest : public CliTest {
 protected:
  ToolRun tool(const std::string& name, std::vector<std::string> arguments,
               ToolOptions options = {}) const {
    options.folder = folder_.string();
    return run_tool(name, std::move(arguments), options);
  }
  ToolRun import(std::vector<std::string> arguments, const ToolOptions& options = {}) const {
    return tool("krok-import", std::move(arguments), options);
  }

  // A capture in a folder that is made for it. Each has its own motion.
  void put_capture(const std::string& name, int frames = 5) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    put(name, capture(frames));
  }
  void put_broken(const std::string& name) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    put(name, capture(5, "nan"));
  }

  // All files below a folder, temporary ones included, without journals.
  Names files_below(const std::string& name) const {
    Names names;
    if (!std::filesystem::exists(path(name))) return names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path(name))) {
      const std::string file = entry.path().lexically_relative(path(name)).string();
      if (!entry.is_directory() && file.find(".journal.jsonl") == std::string::npos) {
        names.push_back(file);
      }
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  // The bytes of all files below a folder, journals too.
  std::map<std::string, std::string> contents(const std::string& name) const {
    std::map<std::string, std::string> bytes;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path(name))) {
      if (!entry.is_regular_file()) continue;
      bytes[entry.path().lexically_relative(path(name)).string()] = get(entry.path().string());
    }
    return bytes;
  }

  // How many of each status a report counts: {"done": 2, ...} without those that are 0.
  static std::map<std::string, int> counts(const std::string& report) {
    std::map<std::string, int> result;
    const Json parsed = Json::parse(report);
    for (const auto& file : parsed["files"]) {
      ++result[file["status"].get<std::string>()];
    }
    return result;
  }
};

using Counts = std::map<std::string, int>;

}  // namespace krok::test
