// Captures of six exporters on one sheet, measured in the picture as who looks at it would:
// upright, on the ground, facing the camera, the right size. If it fails, captures of that exporter
// come out lying, floating, turned away or as giants.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/fixture.h"
#include "support/image.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

using nlohmann::json;

const std::string kCorpus = test::corpus_folder() + "/bvh/";

struct Capture {
  const char* exporter;
  const char* file;
};

constexpr Capture kCaptures[] = {
    {"iPi", "ipi_smartbody/Center.bvh"},
    {"iClone", "iclone_cmu/002_01.bvh"},
    {"OptiTrack", "optitrack_arena_bvh-matlab/walk.bvh"},
    {"Rokoko", "animated_drawings/rokoko_jesse_dance.bvh"},
    {"CMU by MotionBuilder", "pybvh/cmu_12_01_walk.bvh"},
    {"Vicon", "pymo/AV_8Walk_Meredith_HVHA_Rep1.bvh"},
};

class SixExporters : public CliTest {};

TEST_F(SixExporters, StandUprightOnTheGroundFacingTheCameraAtTheRightSize) {
  std::vector<std::string> arguments;
  for (const Capture& capture : kCaptures) {
    arguments.push_back(kCorpus + capture.file);
    if (!std::filesystem::exists(arguments.back())) GTEST_SKIP() << "no corpus here";
  }
  for (const char* argument : {"--body", "none", "--view", "front", "--moments", "0f"}) {
    arguments.emplace_back(argument);
  }
  arguments.insert(arguments.end(), {"--sheet", path("six.png"), "--json=" + path("report.json")});
  const ToolRun run = run_tool("krok-plot", arguments);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json sheet = json::parse(get(path("report.json")))["result"]["sheet"];
  const auto image = image_of(get(path("six.png")));
  ASSERT_TRUE(image.ok());
  ASSERT_EQ(sheet["cells"].size(), std::size(kCaptures));
  const double per_metre = sheet["pixels_per_metre"];
  for (std::size_t i = 0; i < std::size(kCaptures); ++i) {
    const json& cell = sheet["cells"][i];
    // Limbs are blue and orange, head and spine grey: feet to shoulders.
    const Silhouette actor = silhouette(*image, cell);
    const double ground = cell["target_pixel"][1];
    const char* who = kCaptures[i].exporter;
    EXPECT_NEAR((ground - actor.bottom) / per_metre, 0.0, 0.12) << who << ": on the ground";
    EXPECT_GT((ground - actor.top) / per_metre, 1.15) << who << ": shoulders of an adult, upright";
    EXPECT_LT((ground - actor.top) / per_metre, 1.9) << who;
    EXPECT_GT(actor.blue_x, actor.orange_x + 4) << who << ": its left is to our right";
  }
}

}  // namespace
}  // namespace krok::test
