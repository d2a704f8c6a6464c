#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "support/run_tool.h"

namespace krok::test {

// A new folder for each test, and captures to put there.
class CliTest : public testing::Test {
 protected:
  CliTest() {
    std::string name = (std::filesystem::temp_directory_path() / "krok-cli-test-XXXXXX").string();
    EXPECT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  ~CliTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::string put(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }
  static std::string get(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  // All names in the folder, hidden temporary files included.
  std::vector<std::string> listing() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
      names.push_back(entry.path().filename());
    }
    std::sort(names.begin(), names.end());
    return names;
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

  std::filesystem::path folder_;
};

// The end of a message as all tools give it: "[code]".
inline bool has_code(const std::string& text, const std::string& code) {
  return text.find("[" + code + "]") != std::string::npos;
}

}  // namespace krok::test
