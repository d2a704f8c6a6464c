// Would fail if a clip on its way into a file were held in memory, if its targets had bounds that
// are not theirs, or if threads or the kind of output changed its bytes.

#include "formats/gltf/gltf_writer.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <limits>
#include <thread>

#include "support/mesh_motions.h"
#include "support/test_scenes.h"
#include "unit/gltf/glb.h"

namespace krok {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::HasSubstr;

// Some vertices more than a multiple of those that are looked at together.
Model odd_model() {
  Model model = test::tube_model(test::human_skeleton(), 1, 3, 5);
  while (model.positions.size() % 4 != 3) {
    model.positions.push_back(model.positions.back());
    model.normals.push_back(model.normals.back());
    model.texture_coordinates.push_back(model.texture_coordinates.back());
    model.influence_joints.push_back(0);
    model.influence_weights.push_back(1);
  }
  return model;
}

test::Glb baked(const Model& model, const MeshMotion& motion, int jobs = 1) {
  return test::written(
      [&](OutputFile& file) { return gltf::write_baked(model, motion, {}, file, nullptr, jobs); });
}

TEST(BakedWriter, EachTargetHasItsOwnBounds) {
  const Model model = odd_model();
  const auto glb = baked(model, test::wobble(model, 5));
  const auto& targets = glb.json["meshes"][0]["primitives"][0]["targets"];
  ASSERT_EQ(targets.size(), 4u);
  for (const auto& target : targets) {
    const auto& accessor = glb.json["accessors"][target["POSITION"].get<int>()];
    const auto values = glb.values<float>(target["POSITION"]);
    Vec3f least(&values[0]), most(&values[0]);
    for (std::size_t i = 0; i < values.size(); i += 3) {
      least = least.cwiseMin(Vec3f(&values[i]));
      most = most.cwiseMax(Vec3f(&values[i]));
    }
    EXPECT_THAT(accessor["min"].get<std::vector<float>>(), ElementsAreArray(least));
    EXPECT_THAT(accessor["max"].get<std::vector<float>>(), ElementsAreArray(most));
    EXPECT_FALSE(glb.json["accessors"][target["NORMAL"].get<int>()].contains("min"));
  }
}

// The longest texts of floats find room too.
TEST(BakedWriter, BoundsOfAnyLengthFit) {
  const Model model = odd_model();
  const float longest = -1.17549435e-38f;
  const ShapeSource source = [&](int frame, const ShapeOutput& to) {
    std::ranges::copy(model.normals, to.normals.begin());
    std::ranges::fill(to.positions, Vec3f::Zero());
    if (frame == 1) to.positions[1] = Vec3f(longest, -1.23456789e-30f, 3e38f);
  };
  const MeshMotion motion{3, 30, copies_of(source)};
  const auto glb = baked(model, motion);
  const auto& targets = glb.json["meshes"][0]["primitives"][0]["targets"];
  const auto& first = glb.json["accessors"][targets[0]["POSITION"].get<int>()];
  EXPECT_THAT(first["min"].get<std::vector<float>>(), ElementsAre(longest, -1.23456789e-30f, 0));
  EXPECT_THAT(first["max"].get<std::vector<float>>(), ElementsAre(0, 0, 3e38f));
  const auto& second = glb.json["accessors"][targets[1]["POSITION"].get<int>()];
  EXPECT_THAT(second["max"].get<std::vector<float>>(), ElementsAre(0, 0, 0));
}

TEST(BakedWriter, WritesAFrameBeforeItAsksForTheOneAfterTheNext) {
  const Model model = test::tube_model(test::human_skeleton(), 1, 40, 40);
  const std::uint64_t frame_bytes = 24 * model.positions.size();
  MeshMotion motion = test::wobble(model, 30);
  const ShapeSource wobble = motion.source();
  std::vector<int> asked;
  (void)test::bytes_of([&](OutputFile& file) {
    motion.source = copies_of([&](int frame, const ShapeOutput& to) {
      const auto before = static_cast<std::uint64_t>(frame);
      // Frame 0 is in the file's head.
      if (frame > 1) {
        EXPECT_GE(file.size(), before * frame_bytes);
      }
      asked.push_back(frame);
      wobble(frame, to);
    });
    return gltf::write_baked(model, motion, {}, file, nullptr, 1);
  });
  std::vector<int> in_order(30);
  for (int f = 0; f < 30; ++f) in_order[static_cast<std::size_t>(f)] = f;
  EXPECT_EQ(asked, in_order);
}

TEST(BakedWriter, ThreadsDoNotChangeTheBytes) {
  const Model model = odd_model();
  const MeshMotion motion = test::wobble(model, 40);
  const std::string one = baked(model, motion, 1).bytes;
  for (const int jobs : {2, 3, 8}) EXPECT_EQ(baked(model, motion, jobs).bytes, one) << jobs;
}

// A stream cannot be overwritten, so the bounds must be known before.
TEST(BakedWriter, AStreamGetsTheBytesOfAFile) {
  const Model model = odd_model();
  const MeshMotion motion = test::wobble(model, 6);
  const std::string path = testing::TempDir() + "krok_pipe_" + std::to_string(getpid());
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  for (const bool binary : {true, false}) {
    gltf::WriteOptions options;
    options.binary = binary;
    const auto write = [&](OutputFile& file) {
      return gltf::write_baked(model, motion, options, file);
    };
    std::string streamed;
    std::thread reader([&] {
      std::ifstream pipe(path, std::ios::binary);
      streamed.assign(std::istreambuf_iterator<char>(pipe), {});
    });
    {
      auto file = OutputFile::create(path);
      EXPECT_TRUE(file.ok() && write(*file).ok() && file->commit().ok());
    }
    reader.join();
    EXPECT_EQ(streamed, test::bytes_of(write));
  }
  unlink(path.c_str());
}

TEST(BakedWriter, TextHoldsTheSameAsTheGlb) {
  const Model model = odd_model();
  const MeshMotion motion = test::wobble(model, 4);
  gltf::WriteOptions text;
  text.binary = false;
  auto json = nlohmann::json::parse(test::bytes_of(
      [&](OutputFile& file) { return gltf::write_baked(model, motion, text, file); }));
  const auto glb = baked(model, motion);
  const std::string uri = json["buffers"][0]["uri"];
  json["buffers"][0].erase("uri");
  EXPECT_EQ(json, glb.json);
  const std::string prefix = "data:application/octet-stream;base64,";
  EXPECT_EQ(uri.substr(0, prefix.size()), prefix);
  EXPECT_EQ(uri.size() - prefix.size(), (glb.data.size() + 2) / 3 * 4);
  EXPECT_GT(glb.data.size(), 10'000u);
}

TEST(BakedWriter, AVertexThatIsNotFiniteIsToldByItsFrame) {
  const Model model = odd_model();
  for (const int bad : {0, 3}) {
    for (const bool in_normals : {false, true}) {
      MeshMotion motion = test::wobble(model, 5);
      const auto wobble = motion.source();
      motion.source = copies_of([&](int frame, const ShapeOutput& to) {
        wobble(frame, to);
        auto& vector = in_normals ? to.normals[2] : to.positions.back();
        if (frame == bad) vector.y() = std::numeric_limits<float>::quiet_NaN();
      });
      Status status;
      test::bytes_of([&](OutputFile& file) { return gltf::write_baked(model, motion, {}, file); },
                     status);
      ASSERT_FALSE(status.ok());
      EXPECT_EQ(status.error().code, "gltf-structure");
      EXPECT_THAT(status.error().message, HasSubstr("frame " + std::to_string(bad)));
    }
  }
}

TEST(BakedWriter, MoreThanGltfCanTellIsRefusedBeforeItIsMade) {
  const Model model = odd_model();
  // Weights for each pair of frames: 40,000 of them take 6.4 GB.
  const ShapeSource source = [&](int frame, const ShapeOutput& to) {
    EXPECT_EQ(frame, 0);
    std::ranges::fill(to.positions, Vec3f::Zero());
  };
  const MeshMotion motion{40'000, 30, copies_of(source)};
  Model bare = model;
  bare.normals.clear();
  EXPECT_EQ(
      test::error_code([&](OutputFile& file) { return gltf::write_baked(bare, motion, {}, file); }),
      "gltf-too-large");
}

}  // namespace
}  // namespace krok
