#pragma once

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "support/folder_test.h"
#include "support/run_tool.h"

namespace krok::test {

// What tests of tools look into reports and messages with.
using nlohmann::json;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;
using testing::UnorderedElementsAre;

// A new folder for each test, and captures to put there.
class CliTest : public FolderTest {
 protected:
  // Runs a tool in the folder.
  ToolRun run_here(const std::string& tool, std::vector<std::string> arguments) const {
    ToolOptions options;
    options.folder = folder_.string();
    return run_tool(tool, std::move(arguments), options);
  }

  // Makes a BVH file that Krok wrote one of another program, whose unit and axes are detected.
  void take_mark_from(const std::string& name) const {
    std::string text = get(path(name));
    const std::size_t time = text.find("Frame Time");
    const std::size_t end = text.find('\n', time);
    const std::size_t last = text.find_last_not_of(" \t", end - 1);
    text.erase(last + 1, end - last - 1);
    put(name, text);
  }

  // A chain of three joints that swings, metres, y-up. `third_value` replaces the third number of
  // the second row.
  static std::string capture(int frames, const std::string& third_value = "0") {
    std::string text =
        "HIERARCHY\nROOT Hips\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition "
        "Zrotation "
        "Xrotation Yrotation\n JOINT Spine\n {\n  OFFSET 0 0.4 0\n  CHANNELS 3 Zrotation Xrotation "
        "Yrotation\n  JOINT Head\n  {\n   OFFSET 0 0.3 0\n   CHANNELS 3 Zrotation Xrotation "
        "Yrotation\n   End Site\n   {\n    OFFSET 0 0.2 0\n   }\n  }\n }\n}\nMOTION\n";
    text += "Frames: " + std::to_string(frames) + "\nFrame Time: 0.0333333\n";
    for (int f = 0; f < frames; ++f) {
      text += "0 1 " + (f == 1 ? third_value : std::string("0"));
      text += " " + std::to_string(f % 90) + " 0 0 5 " + std::to_string(f % 45) + " 0 0 0 10\n";
    }
    return text;
  }
};

// The end of a message as all tools give it: "[code]".
inline bool has_code(const std::string& text, const std::string& code) {
  return text.find("[" + code + "]") != std::string::npos;
}

}  // namespace krok::test
