// If these fail, a camera in a glTF file stands elsewhere than in its track, moves in another
// animation than the character, or the character's file is damaged by it.

#include "formats/gltf/add_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "formats/gltf/gltf_reader.h"
#include "nodes/evaluate.h"
#include "support/glb_builder.h"
#include "unit/gltf/glb.h"

namespace krok::gltf {
namespace {

CameraTrack moving(int frames = 31, double rate = 30) {
  CameraTrack track;
  track.rate = rate;
  for (int i = 0; i < frames; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(rate);
    track.positions.emplace_back(t, 1.5f, 4 - t * t);
    track.orientations.emplace_back(Eigen::AngleAxisf(0.5f * t, Vec3f::UnitY()));
    if (i % 2 == 1) track.orientations.back().coeffs() *= -1;  // the same rotation
    track.fields_of_view.push_back(0.7f);
  }
  return track;
}

// As the test's own reader of GLB has it.
test::Glb opened(const std::vector<std::byte>& bytes) {
  return test::written([&](OutputFile& file) { return file.write(bytes); });
}

struct Seen {
  Vec3 place;
  Quat turn = Quat::Identity();
};

// Where the reader and evaluator have the camera at a moment.
Seen seen_at(const nodes::Scene& scene, int animation, double time) {
  const auto evaluator = *nodes::Evaluator::create(scene);
  nodes::Evaluation state;
  evaluator.place_nodes(animation, time, state);
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].camera < 0) continue;
    const Transform at = nodes::rigid_part(state.node_to_world[n]);
    return {at.position, at.orientation};
  }
  ADD_FAILURE() << "no camera";
  return {};
}

void expect_as_in(const CameraTrack& track, const nodes::Scene& scene, int animation) {
  for (int i = 0; i < track.frame_count(); i += 5) {
    const auto f = static_cast<std::size_t>(i);
    const Seen seen = seen_at(scene, animation, i / track.rate);
    EXPECT_LT((seen.place - track.positions[f].cast<double>()).norm(), 1e-6) << i;
    EXPECT_LT(seen.turn.angularDistance(track.orientations[f].cast<double>()), 1e-6) << i;
  }
}

TEST(CameraInGltf, AloneIsAWholeFile) {
  const CameraTrack track = moving();
  CameraOptions options;
  options.aspect = 1.5;
  options.near_plane = 0.2;
  const auto made = camera_alone(track, options);
  ASSERT_TRUE(made.ok()) << made.error().message;
  EXPECT_TRUE(made->diagnostics.empty());
  const test::Glb glb = opened(made->bytes);
  const auto& lens = glb.json["cameras"][0]["perspective"];
  EXPECT_FLOAT_EQ(lens["yfov"].get<float>(), 0.7f);
  EXPECT_EQ(lens["aspectRatio"], 1.5);
  EXPECT_EQ(lens["znear"], 0.2);
  EXPECT_FALSE(lens.contains("zfar"));
  EXPECT_EQ(glb.json["scenes"][0]["nodes"], nlohmann::json::array({0}));
  // Frame by frame what the track has, rotations in one hemisphere.
  const auto& animation = glb.json["animations"][0];
  for (const auto& channel : animation["channels"]) {
    const auto& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
    const auto times = glb.values<float>(sampler["input"]);
    const auto values = glb.values<float>(sampler["output"]);
    ASSERT_EQ(times.size(), 31u);
    EXPECT_FLOAT_EQ(times[15], 0.5f);
    EXPECT_EQ(glb.json["accessors"][sampler["input"].get<int>()]["max"][0], times.back());
    if (channel["target"]["path"] == "translation") {
      EXPECT_EQ(values[3 * 15 + 2], track.positions[15].z());
    } else {
      ASSERT_EQ(channel["target"]["path"], "rotation");
      for (std::size_t i = 1; i < 31; ++i) {
        float dot = 0;
        for (std::size_t k = 0; k < 4; ++k) dot += values[4 * i + k] * values[4 * i - 4 + k];
        EXPECT_GT(dot, 0.9f) << i;
      }
    }
  }
  const auto scene = read(made->bytes);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_TRUE(scene->diagnostics.empty());
  expect_as_in(track, *scene, 0);
}

// Else viewers of 60 Hz show a flight of a thirtieth of a second at each cut.
TEST(CameraInGltf, HoldsUntilACut) {
  for (const double rate : {30.0, 120.0}) {
    CameraTrack track = moving(61, rate);
    track.cuts = {20, 21};
    for (std::size_t f = 20; f < 61; ++f) track.positions[f].x() += f < 21 ? 50.f : 100.f;
    const auto made = camera_alone(track, {});
    ASSERT_TRUE(made.ok()) << made.error().message;
    const auto scene = read(made->bytes);
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    EXPECT_EQ(scene->animations[0].rate, rate);
    expect_as_in(track, *scene, 0);
    for (const auto& [moment, frame] : {std::pair(19.98, 19u), {20.0, 20u}, {20.98, 20u}}) {
      const Seen seen = seen_at(*scene, 0, moment / rate);
      EXPECT_LT((seen.place - track.positions[frame].cast<double>()).norm(), 0.01) << moment;
    }
  }
}

TEST(CameraInGltf, GoesIntoTheCharactersSceneAndAnimation) {
  const std::vector<std::byte> before = test::rig().glb();
  const auto old_scene = read(before);
  ASSERT_TRUE(old_scene.ok());
  const CameraTrack track = moving();
  const auto made = add_camera(before, track, {}, {});
  ASSERT_TRUE(made.ok()) << made.error().message;
  const auto scene = read(made->bytes);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  ASSERT_EQ(scene->animations.size(), 1u);
  EXPECT_EQ(scene->animations[0].channels.size(), old_scene->animations[0].channels.size() + 2);
  ASSERT_EQ(scene->nodes.size(), old_scene->nodes.size() + 1);
  EXPECT_TRUE(scene->nodes.back().in_scene);
  EXPECT_EQ(scene->nodes.back().name, "camera");
  expect_as_in(track, *scene, 0);
  // The character is as it was.
  const auto old_evaluator = *nodes::Evaluator::create(*old_scene);
  const auto evaluator = *nodes::Evaluator::create(*scene);
  for (const double time : {0.0, 0.3, 1.0}) {
    nodes::Evaluation was, is;
    old_evaluator.evaluate(0, time, was);
    evaluator.evaluate(0, time, is);
    EXPECT_EQ(was.positions, is.positions);
  }
}

TEST(CameraInGltf, ASecondOneGetsANameOfItsOwn) {
  const CameraTrack track = moving();
  const auto once = add_camera(test::rig().glb(), track, {}, {});
  ASSERT_TRUE(once.ok());
  const auto twice = add_camera(once->bytes, track, {}, {});
  ASSERT_TRUE(twice.ok());
  const auto scene = read(twice->bytes);
  ASSERT_TRUE(scene.ok());
  EXPECT_EQ(scene->cameras.size(), 2u);
  EXPECT_EQ(scene->nodes.back().name, "camera_2");
}

TEST(CameraInGltf, MovesInTheAnimationThatIsAskedFor) {
  test::GlbBuilder builder = test::rig();
  builder.json["animations"].push_back(builder.json["animations"][0]);
  const auto first = add_camera(builder.glb(), moving(), {}, {});
  ASSERT_TRUE(first.ok());
  ASSERT_EQ(first->diagnostics.size(), 1u);
  EXPECT_EQ(first->diagnostics[0].code, "gltf-animations");
  CameraOptions options;
  options.animation = "1";
  const auto made = add_camera(builder.glb(), moving(), options, {});
  ASSERT_TRUE(made.ok());
  EXPECT_TRUE(made->diagnostics.empty());
  const auto scene = read(made->bytes);
  ASSERT_TRUE(scene.ok());
  EXPECT_EQ(scene->animations[1].channels.size(), scene->animations[0].channels.size() + 2);
  for (const char* wrong : {"2", "-1", "1x", "none"}) {
    options.animation = wrong;
    const auto failed = add_camera(builder.glb(), moving(), options, {});
    ASSERT_FALSE(failed.ok());
    EXPECT_EQ(failed.error().code, "gltf-animation");
  }
}

TEST(CameraInGltf, AFileWithoutAnimationsOrScenesGetsThem) {
  test::GlbBuilder builder = test::square();
  builder.json.erase("scenes");
  builder.json.erase("scene");
  builder.json["nodes"].push_back({{"name", "Parent"}, {"children", {0}}});
  const auto made = add_camera(builder.glb(), moving(), {}, {});
  ASSERT_TRUE(made.ok()) << made.error().message;
  const auto scene = read(made->bytes);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_EQ(scene->roots, (std::vector<int>{1, 2}));
  ASSERT_EQ(scene->animations.size(), 1u);
  EXPECT_EQ(scene->animations[0].channels.size(), 2u);
}

TEST(CameraInGltf, OneFrameIsAStillCamera) {
  const auto made = camera_alone(moving(1), {});
  ASSERT_TRUE(made.ok());
  const auto scene = read(made->bytes);
  ASSERT_TRUE(scene.ok());
  EXPECT_TRUE(scene->animations.empty());
  EXPECT_LT((seen_at(*scene, -1, 0).place - Vec3(0, 1.5, 4)).norm(), 1e-6);
}

TEST(CameraInGltf, AChangingLensComesBackThroughExtras) {
  CameraTrack track = moving();
  for (std::size_t i = 0; i < track.fields_of_view.size(); ++i) {
    track.fields_of_view[i] = 0.5f + 0.013f * static_cast<float>(i);
  }
  const auto made = camera_alone(track, {});
  ASSERT_TRUE(made.ok());
  ASSERT_EQ(made->diagnostics.size(), 1u);
  EXPECT_EQ(made->diagnostics[0].code, "gltf-lens");
  const auto scene = read(made->bytes);
  ASSERT_TRUE(scene.ok());
  EXPECT_EQ(scene->cameras[0].lens, track.fields_of_view);
  EXPECT_EQ(scene->cameras[0].lens_rate, 30);
}

TEST(CameraInGltf, ExtrasOfOthersAreNoLens) {
  for (const char* extras :
       {R"({"fieldsOfView": [1, 2]})", R"({"fieldsOfView": {"rate": 30}})",
        R"({"fieldsOfView": {"rate": 0, "values": [0.5]}})",
        R"({"fieldsOfView": {"rate": -1e999, "values": [0.5]}})",
        R"({"fieldsOfView": {"rate": 30, "values": []}})",
        R"({"fieldsOfView": {"rate": 30, "values": [0.5, "x"]}})",
        R"({"fieldsOfView": {"rate": 30, "values": [0.5, 9]}})", R"([1])", "3"}) {
    test::GlbBuilder builder = test::square();
    auto parsed = nlohmann::ordered_json::parse(extras, nullptr, false);
    if (parsed.is_discarded()) continue;
    builder.json["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 0.6}, {"znear", 1}}}}};
    builder.json["cameras"][0]["extras"] = parsed;
    const auto scene = read(builder.glb());
    ASSERT_TRUE(scene.ok()) << extras;
    EXPECT_TRUE(scene->cameras[0].lens.empty()) << extras;
    EXPECT_EQ(scene->cameras[0].field_of_view, 0.6);
  }
}

TEST(CameraInGltf, RefusesWhatItCannotWrite) {
  const auto code = [](const CameraTrack& track, const CameraOptions& options = {}) {
    const auto made = camera_alone(track, options);
    return made ? std::string("none") : made.error().code;
  };
  EXPECT_EQ(code(moving(0)), "camera-shape");
  CameraTrack track = moving();
  track.positions[3].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(code(track), "camera-value");
  EXPECT_EQ(code(moving(3, 1e5)), "none");
  EXPECT_EQ(code(moving(3, 1e300)), "camera-rate");
  CameraOptions options;
  for (const double aspect : {0.0, -1.0, std::nan("")}) {
    options.aspect = aspect;
    EXPECT_EQ(code(moving(), options), "gltf-value");
  }
  options.aspect.reset();
  options.near_plane = 0;
  EXPECT_EQ(code(moving(), options), "gltf-value");
  const std::vector<std::byte> nothing(20);
  const auto made = add_camera(nothing, moving(), {}, {});
  ASSERT_FALSE(made.ok());
  EXPECT_FALSE(made.error().code.empty());
}

TEST(CameraInGltf, DamagedFilesAreRefusedOrStayWhole) {
  const std::vector<std::byte> good = test::rig().glb();
  const CameraTrack track = moving(3);
  for (std::size_t i = 12; i < good.size(); i += 3) {
    for (const unsigned bit : {0u, 3u, 6u}) {
      std::vector<std::byte> bytes = good;
      bytes[i] ^= static_cast<std::byte>(1u << bit);
      const auto made = add_camera(bytes, track, {}, {});
      if (!made) continue;
      EXPECT_TRUE(read(made->bytes).ok()) << "byte " << i << " bit " << bit;
    }
  }
}

}  // namespace
}  // namespace krok::gltf
