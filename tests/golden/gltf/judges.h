#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "formats/anim/anim.h"
#include "formats/model/model_format.h"
#include "support/this_build.h"

// Tests that write files and have others judge them: the Khronos validator and three.js.

namespace krok {

namespace fs = std::filesystem;

struct Outcome {
  int exit_code = -1;
  std::string text;  // both streams
};

inline Outcome run_command(const std::string& command, const fs::path& folder) {
  const fs::path log = folder / "log.txt";
  const int status = std::system(fmt::format("{} > '{}' 2>&1", command, log.string()).c_str());
  std::ostringstream text;
  text << std::ifstream(log).rdbuf();
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text.str()};
}

class GltfJudges : public testing::Test {
 protected:
  void SetUp() override {
    const fs::path modules = fs::path(test::source_folder()) / "tests/node_modules";
    for (const char* needed : {"gltf-validator", "three"}) {
      if (!fs::exists(modules / needed)) {
        GTEST_SKIP() << "skipped: no " << (modules / needed).string() << "; run npm ci in tests/";
      }
    }
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / fmt::format("krok_{}_{}", info->name(), getpid());
    fs::create_directories(folder_);
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  void write_clip(const Clip& clip, OrientationEncoding encoding = OrientationEncoding::xyz) {
    auto file = OutputFile::create(path("in.anim"));
    ASSERT_TRUE(file.ok());
    anim::WriteOptions options;
    options.orientation = encoding;
    ASSERT_TRUE(anim::write(clip, options, *file).ok());
    ASSERT_TRUE(file->commit().ok());
  }
  void write_model(const Model& model) {
    auto file = OutputFile::create(path("in.model"));
    ASSERT_TRUE(file.ok());
    ASSERT_TRUE(model::write(model, {}, *file).ok());
    ASSERT_TRUE(file->commit().ok());
  }

  std::string content(const std::string& name) const {
    std::ostringstream bytes;
    bytes << std::ifstream(path(name), std::ios::binary).rdbuf();
    return bytes.str();
  }

  // Copies a file with one piece of text changed.
  void replace_in(const std::string& from, const std::string& to, const std::string& what,
                  const std::string& with) {
    std::string bytes = content(from);
    const auto at = bytes.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    bytes.replace(at, what.size(), with);
    std::ofstream(path(to), std::ios::binary) << bytes;
  }

  void tool(const std::string& arguments, int exit_code = 0) {
    const auto outcome = run_command(
        fmt::format("cd '{}' && {}/{}", folder_.string(), test::tools_folder(), arguments),
        folder_);
    EXPECT_EQ(outcome.exit_code, exit_code) << arguments << "\n" << outcome.text;
  }
  void judge(const std::string& script, const std::string& arguments, int exit_code = 0) {
    const auto outcome =
        run_command(fmt::format("cd '{}' && node '{}/tests/golden/{}' {}", folder_.string(),
                                test::source_folder(), script, arguments),
                    folder_);
    EXPECT_EQ(outcome.exit_code, exit_code) << arguments << "\n" << outcome.text;
  }
  void valid(const std::string& files) { judge("validate_gltf.mjs", files); }

  fs::path folder_;
};

}  // namespace krok
