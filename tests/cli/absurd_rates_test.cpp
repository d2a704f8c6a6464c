// If these fail, a file with a rate that no motion has makes tools loop over its seconds for ever,
// take memory without end, or write `inf` into what they export.

#include <algorithm>
#include <array>
#include <bit>

#include "cli/motion_fixture.h"
#include "golden/samples/samples.h"

namespace krok::test {
namespace {

class AbsurdRates : public MotionTest {
 protected:
  // walk.anim with another rate, and its checksum made right again.
  void put_with_rate(const std::string& name, double rate) const {
    const auto file = InputFile::open(path("walk.anim"));
    ASSERT_TRUE(file.ok());
    std::vector<std::byte> bytes(file->bytes().begin(), file->bytes().end());
    using Double = std::array<std::byte, sizeof(double)>;
    const auto usual = std::bit_cast<Double>(60.0);
    const auto found = std::search(bytes.begin(), bytes.end(), usual.begin(), usual.end());
    ASSERT_NE(found, bytes.end());
    std::ranges::copy(std::bit_cast<Double>(rate), found);
    samples::repair_header(bytes);
    put(name, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
};

TEST_F(AbsurdRates, AreRefusedByEveryTool) {
  write_walk(2);
  for (const double rate : {1e300, 1e-17, 1e-158, 5e-324, 1.1e5, 0.0, -30.0}) {
    put_with_rate("bad.anim", rate);
    const std::vector<std::vector<std::string>> runs = {
        {"krok-plot", "bad.anim", "-o", "bad.svg"},
        {"krok-plot", "bad.anim", "--strip", "bad.png"},
        {"krok-keys", "bad.anim"},
        {"krok-blend", "bad.anim:0.5", "walk.anim:0.5", "-o", "out.anim"},
        {"krok-export", "bad.anim", "-o", "out.bvh"},
        {"krok-export", "bad.anim", "-o", "out.glb"},
        {"krok-edit", "bad.anim", "-o", "out.anim", "--playback-speed", "2"},
        {"krok-info", "bad.anim", "--json"}};
    for (const auto& words : runs) {
      const ToolRun run = run_here(words[0], {words.begin() + 1, words.end()});
      EXPECT_EQ(run.exit_code, 2) << words[0] << " " << rate << run.err;
      EXPECT_NE(run.err.find("0.001 to 100000 frames per second"), std::string::npos)
          << words[0] << " " << rate << run.err;
      EXPECT_EQ(run.out.find(": inf"), std::string::npos) << words[0];
    }
  }
  EXPECT_FALSE(std::filesystem::exists(path("out.bvh")));
}

// A capture says so at its frame time.
TEST_F(AbsurdRates, OfCapturesAreRefused) {
  for (const char* time : {"1e-300", "1e-9", "1e300", "5000"}) {
    put("bad.bvh", std::string("HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition "
                               "Zposition\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\nMOTION\nFrames: 2\n"
                               "Frame Time: ") +
                       time + "\n0 0 0\n0 0 1\n");
    const ToolRun run = run_here("krok-import", {"bad.bvh", "-o", "out.anim"});
    EXPECT_EQ(run.exit_code, 2) << time << run.err;
    EXPECT_FALSE(std::filesystem::exists(path("out.anim"))) << time;
    const ToolRun keys = run_here("krok-keys", {"bad.bvh"});
    EXPECT_EQ(keys.exit_code, 2) << time << keys.err;
  }
}

// Positions whose squares are infinite: what is made of them could not be read again.
TEST_F(AbsurdRates, AndPositionsBeyondAllPlacesAreRefused) {
  for (const char* place : {"1e30", "-3.3e38", "1e12"}) {
    put("far.bvh", std::string("HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition "
                               "Zposition\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\nMOTION\nFrames: 2\n"
                               "Frame Time: 0.01\n0 0 0\n0 0 ") +
                       place + "\n");
    for (const std::string tool : {"krok-import", "krok-export"}) {
      const ToolRun run =
          run_here(tool, {"far.bvh", "-o", tool == "krok-import" ? "out.anim" : "out.glb"});
      EXPECT_EQ(run.exit_code, 2) << tool << place << run.err;
    }
  }
  EXPECT_FALSE(std::filesystem::exists(path("out.anim")));
  EXPECT_FALSE(std::filesystem::exists(path("out.glb")));
}

// Nor are they taken from a JSON file beside the motion.
TEST_F(AbsurdRates, OfJsonFilesAreRefused) {
  write_walk(2);
  put("sequences.json",
      R"({"schema": "krok.sequences/1", "rate": 1e300,
          "sequences": [{"name": "a", "first": 0, "last": 10}]})");
  put("goals.json",
      R"({"schema": "krok.goals/1", "rate": 200000,
          "goals": [{"joint": "RightHand", "keys": [{"time": "5f", "target": [0, 1, 0]}]}]})");
  put("mix.json",
      R"({"schema": "krok.timeline/1", "rate": 200000, "sources": {"a": "walk.anim"},
          "base": [{"source": "a"}]})");
  put("camera.json",
      R"({"schema": "krok.camera-keys/1", "rate": 200000,
          "keys": [{"time": 0, "position": [0, 1, 4], "target": [0, 1, 0]}]})");
  put("library.json",
      R"({"schema": "krok.library/1", "rate": 1e-17, "steps": "auto",
          "parameters": [{"measures": "step.length"}], "examples": [{"clip": "walk.anim"}]})");
  const std::vector<std::vector<std::string>> runs = {
      {"krok-edit", "walk.anim", "--sequences", "sequences.json", "-o", "{sequence}.anim"},
      {"krok-ik", "walk.anim", "--goals", "goals.json", "-o", "out.anim"},
      {"krok-mix", "mix.json", "-o", "out.anim"},
      {"krok-cam", "camera.json", "-o", "out.cam"},
      {"krok-fit", "library.json", "-o", "out.steps"}};
  for (const auto& words : runs) {
    const ToolRun run = run_here(words[0], {words.begin() + 1, words.end()});
    EXPECT_EQ(run.exit_code, 2) << words[0] << run.err;
    EXPECT_NE(run.err.find("100000"), std::string::npos) << words[0] << run.err;
  }
}

}  // namespace
}  // namespace krok::test
