// If these fail, a tool walks on another ground than the file or the text that the user named.
#include "formats/io/open_terrain.h"

#include <gtest/gtest.h>

#include "support/folder_test.h"
#include "support/glb_builder.h"
#include "support/height_images.h"

namespace krok::io {
namespace {

class OpenTerrain : public test::FolderTest {
 protected:
  Result<std::unique_ptr<Terrain>> open(const std::string& name,
                                        const height_field::Placement& placement = {}) {
    return open_terrain(name, placement, inputs_);
  }
  std::string code(const std::string& name, const height_field::Placement& placement = {}) {
    const auto ground = open(name, placement);
    return ground ? "none" : ground.error().code;
  }

  PlainInputs inputs_;
};

// Would fail if the sidecar were not found, or won over what the user gives.
TEST_F(OpenTerrain, TakesHeightFieldsWithTheirSidecar) {
  const std::string image = put("hill.exr", test::exr_image(2, 2, {{"Y", {0, 4, 0, 4}}}));
  EXPECT_EQ(code(image), "height-placement");
  put("hill.ground.json", R"({"schema": "krok.ground/1", "size": [4, 4]})");
  const auto beside = open(image);
  ASSERT_TRUE(beside) << beside.error().message;
  EXPECT_DOUBLE_EQ((*beside)->at(1, 0)->height, 3);
  height_field::Placement given;
  given.size = {8, 4};
  EXPECT_DOUBLE_EQ((*open(image, given))->at(1, 0)->height, 2.5);
  put("hill.ground.json", "{]");
  const auto wrong = open(image);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().where.file, path("hill.ground.json"));
  EXPECT_EQ(wrong.error().where.line, 1);
}

// Would fail if slopes were stairs of centimetres without a word.
TEST_F(OpenTerrain, AnImageOfFewLevelsIsWarnedOf) {
  const std::string fine = put("fine.png", test::png_image(2, 2, 0, {0, 9, 0, 9}));
  const std::string coarse = put("coarse.png", test::png_image(2, 2, 0, {0, 9, 0, 9}, 0, 0, 8));
  height_field::Placement placement{{{4, 4}}, {{0, 0.5}}, {}};
  EXPECT_EQ(code(fine, placement), "none");
  EXPECT_EQ(code(coarse, placement), "none");
  EXPECT_TRUE(inputs_.diagnostics.empty()) << "steps of 2 mm";
  placement.range = {0, 5.1};
  EXPECT_EQ(code(fine, placement), "none");
  EXPECT_EQ(code(coarse, placement), "none");
  ASSERT_EQ(inputs_.diagnostics.size(), 1U);
  EXPECT_EQ(inputs_.diagnostics[0].code, "ground-levels");
  EXPECT_NE(inputs_.diagnostics[0].message.find("steps of 20 mm"), std::string::npos);
}

// Would fail if a mesh lost its node's place, or a mirrored node its ground.
TEST_F(OpenTerrain, TakesMeshesAtTheirNodes) {
  test::GlbBuilder builder = test::square();
  // The square in z = 0 that faces +Z is laid down to face +Y, twice as large and 0.5 m up.
  const double half = std::sqrt(0.5);
  builder.json["nodes"][0]["rotation"] = {-half, 0, 0, half};
  builder.json["nodes"][0]["translation"] = {0, 0.5, 3};
  builder.json["nodes"][0]["scale"] = {2, 2, 2};
  const auto bytes = builder.glb();
  const std::string name =
      put("ground.glb", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  const auto ground = open(name);
  ASSERT_TRUE(ground) << ground.error().message;
  ASSERT_TRUE((*ground)->at(1.9, 1.1));
  EXPECT_NEAR((*ground)->at(1.9, 1.1)->height, 0.5, 1e-6);
  EXPECT_FALSE((*ground)->at(1.9, 0.9));
  EXPECT_FALSE((*ground)->at(1.9, 3.1));
  EXPECT_TRUE(inputs_.diagnostics.empty());
  builder.json["nodes"][0]["scale"] = {-2, 2, 2};
  const auto mirrored = builder.glb();
  put("ground.glb", {reinterpret_cast<const char*>(mirrored.data()), mirrored.size()});
  EXPECT_TRUE((*open(name))->at(-1.9, 1.1));
  EXPECT_TRUE(inputs_.diagnostics.empty());
}

TEST_F(OpenTerrain, TakesObj) {
  const std::string name = put("ramp.obj", "v 0 0 0\nv 0 1 2\nv 2 1 2\nv 2 0 0\nf 1 2 3 4\n");
  const auto ground = open(name);
  ASSERT_TRUE(ground) << ground.error().message;
  EXPECT_NEAR((*ground)->at(1, 1)->height, 0.5, 1e-9);
}

// Would fail if a missing file were taken for a kind of ground, or the other way round.
TEST_F(OpenTerrain, TellsFilesFromTexts) {
  EXPECT_EQ((*open("stairs:rise=20cm,run=30cm"))->at(0, 1.1)->height, 0.2);
  EXPECT_EQ(code(path("none.exr")), "file-missing");
  EXPECT_EQ(code("hils.exr"), "file-missing");
  EXPECT_EQ(code("stars"), "ground-kind");
  EXPECT_EQ(code("slope:80deg"), "ground-value");
  EXPECT_EQ(code(put("walk.bvh", "HIERARCHY\n")), "ground-kind");
  height_field::Placement size;
  size.size = {1, 1};
  EXPECT_EQ(code("level", size), "usage");
  EXPECT_EQ(code(put("ramp.obj", "v 0 0 0\n"), size), "usage");
  EXPECT_EQ(code(put("point.obj", "v 0 0 0\n")), "ground-empty");
  EXPECT_EQ(code(put("dot.png", test::png_image(1, 1, 0, {7})), {size.size, {{0, 1}}, {}}),
            "ground-size");
}

}  // namespace
}  // namespace krok::io
