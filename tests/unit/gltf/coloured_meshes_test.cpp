// If these fail, a heatmap shows colours at the wrong vertices, or viewers refuse it.

#include "formats/gltf/gltf_writer.h"

#include <gmock/gmock.h>

#include <limits>

#include "unit/gltf/glb.h"

namespace krok::gltf {
namespace {

using test::Glb;
using testing::ElementsAre;

const std::vector<Vec3f> kCorners = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}};
const std::vector<Vec3f> kNormals = {{0, 0, 2}, {0, 0, 1}, {0, 0, 0}};
const std::vector<Vec3f> kColours = {{1, 0, 0}, {0, 0.5F, 0}, {0.25F, -1, 2}};
const std::vector<std::array<std::uint32_t, 3>> kTriangles = {{0, 1, 2}};

Glb glb_of(const std::vector<ColouredMesh>& meshes) {
  return test::written([&](OutputFile& file) {
    WriteOptions options;
    return write_coloured(meshes, "a legend", options, file);
  });
}

Status status_of(const std::vector<ColouredMesh>& meshes) {
  Status status;
  test::bytes_of(
      [&](OutputFile& file) {
        WriteOptions options;
        return write_coloured(meshes, "a legend", options, file);
      },
      status);
  return status;
}

TEST(ColouredMeshes, KeepsEachVertexWithItsColour) {
  const Glb glb = glb_of({{"Body", kCorners, kNormals, kColours, kTriangles}});
  const auto& primitive = glb.json["meshes"][0]["primitives"][0];
  const auto& attributes = primitive["attributes"];
  EXPECT_THAT(glb.values<float>(attributes["POSITION"]), ElementsAre(0, 0, 0, 2, 0, 0, 0, 3, 0));
  EXPECT_THAT(glb.values<float>(attributes["COLOR_0"]),
              ElementsAre(1, 0, 0, 0, 0.5F, 0, 0.25F, 0, 1))
      << "within 0 and 1, which glTF asks for";
  EXPECT_THAT(glb.values<float>(attributes["NORMAL"]), ElementsAre(0, 0, 1, 0, 0, 1, 0, 1, 0))
      << "of length 1, one that vanishes too";
  EXPECT_THAT(glb.values<std::uint16_t>(primitive["indices"]), ElementsAre(0, 1, 2));
  EXPECT_EQ(glb.json["materials"][0]["name"], "a legend");
  EXPECT_EQ(glb.json["nodes"][0]["name"], "Body");
}

TEST(ColouredMeshes, PointsAndSeveralMeshes) {
  const std::vector<Vec3f> none;
  const Glb glb = glb_of({{"Body", kCorners, {}, kColours, {}},
                          {"nothing", none, {}, none, {}},
                          {"Body", kCorners, {}, kColours, kTriangles}});
  ASSERT_EQ(glb.json["meshes"].size(), 2U);
  EXPECT_EQ(glb.json["meshes"][0]["primitives"][0]["mode"], 0) << "points";
  EXPECT_FALSE(glb.json["meshes"][0]["primitives"][0].contains("indices"));
  EXPECT_FALSE(glb.json["meshes"][0]["primitives"][0]["attributes"].contains("NORMAL"));
  EXPECT_NE(glb.json["nodes"][0]["name"], glb.json["nodes"][1]["name"]);
}

TEST(ColouredMeshes, RefusesWhatGltfHasNoPlaceFor) {
  EXPECT_EQ(status_of({}).error().code, "gltf-empty-mesh");
  std::vector<Vec3f> odd = kCorners;
  odd[1].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(status_of({{"Body", odd, {}, kColours, {}}}).error().code, "gltf-value");
  EXPECT_EQ(status_of({{"Body", kCorners, {}, odd, {}}}).error().code, "gltf-value");
  EXPECT_EQ(status_of({{"\xFF", kCorners, {}, kColours, {}}}).error().code, "gltf-name");
}

}  // namespace
}  // namespace krok::gltf
