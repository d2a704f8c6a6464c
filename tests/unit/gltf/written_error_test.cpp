// If these fail, the error that krok-skin prints is not that of the file: a vertex that is written
// elsewhere, or a key that is lost, passes unseen.

#include "formats/gltf/reduce_for_mesh.h"

#include <gtest/gtest.h>

#include "support/folder_test.h"
#include "support/human_skeleton.h"
#include "support/test_scenes.h"

namespace krok::test {
namespace {

class WrittenErrors : public FolderTest {
 protected:
  WrittenErrors()
      : model_(tube_model(human_skeleton(), 1, 12, 12)),
        clip_(swinging_clip(model_.skeleton, 20, 30)),
        tracks_(*gltf::joint_tracks(model_.skeleton, clip_)) {
    model_.parts = {{"a", "", 0, 100, "a"},
                    {"b", "", 100, static_cast<std::uint32_t>(model_.triangles.size()) - 100, "b"}};
  }

  gltf::WrittenError error_of(const Model& written, const gltf::JointTracks& keys, bool compressed,
                              std::span<const std::uint32_t> places = {}) {
    const std::vector<gltf::NamedTracks> clips = {{"still", &still_}, {"swing", &keys}};
    auto file = OutputFile::create(path("rig.glb"));
    gltf::WriteOptions options;
    options.compressed = compressed;
    EXPECT_TRUE(gltf::write_rig(written, clips, options, *file).ok());
    EXPECT_TRUE(file->commit().ok());
    const std::vector<gltf::NamedTracks> all = {{"still", &still_}, {"swing", &tracks_}};
    const auto found =
        gltf::written_error(path("rig.glb"), {model_, {}, all}, {written, places}, 2);
    EXPECT_TRUE(found.ok());
    return found.ok() ? *found : gltf::WrittenError{{1e9, -1, -1}, 0};
  }

  Model model_;
  Clip clip_;
  gltf::JointTracks tracks_;
  gltf::JointTracks still_ = gltf::rest_tracks(model_.skeleton);  // a clip that the file has not
};

TEST_F(WrittenErrors, AnExactFileHasNone) {
  EXPECT_LT(error_of(model_, tracks_, false).error.largest, 2e-6);
}

TEST_F(WrittenErrors, AVertexThatIsElsewhereIsFoundInEveryOrder) {
  const int moved = static_cast<int>(model_.triangles[150][1]);
  for (const bool compressed : {false, true}) {
    Model other = model_;
    other.positions[static_cast<std::size_t>(moved)].x() += 0.005f;
    MorphSet none;
    std::vector<std::uint32_t> places;
    if (compressed) places = gltf::order_for_compression(other, none, {});
    const auto found = error_of(other, tracks_, compressed, places);
    EXPECT_NEAR(found.error.largest, 0.005, 2e-6);
    EXPECT_EQ(found.error.vertex, moved);
  }
}

TEST_F(WrittenErrors, AKeyThatIsLostIsFoundInItsClip) {
  gltf::JointTracks other = tracks_;
  for (gltf::JointTrack& track : other.joints) {
    if (!track.rotations.empty()) track.rotations[7] = track.rotations[6];
  }
  const auto found = error_of(model_, other, false);
  EXPECT_EQ(found.clip, 1u);
  EXPECT_EQ(found.error.moment, 14);
  const auto memory = gltf::mesh_error({model_}, tracks_, {model_}, other, 1);
  EXPECT_NEAR(found.error.largest, memory.largest, 1e-5);
  EXPECT_GT(found.error.largest, 1e-3);
}

TEST_F(WrittenErrors, AFileOfAnotherMeshIsAnError) {
  error_of(model_, tracks_, false);
  Model other = model_;
  other.triangles.pop_back();
  --other.parts[1].triangle_count;
  const auto found = gltf::written_error(path("rig.glb"), {model_, {}, {}}, {other, {}}, 1);
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().code, "gltf-mesh");
}

}  // namespace
}  // namespace krok::test
