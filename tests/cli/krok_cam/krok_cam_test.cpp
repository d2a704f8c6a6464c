// If these fail, krok-cam films something else than it was told, puts a camera into a character's
// file that viewers play otherwise, or leaves its user without knowing what is wrong.

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/judged_test.h"
#include "cli/kept_files.h"
#include "formats/cam/cam.h"
#include "support/glb_builder.h"

namespace krok::test {
namespace {

constexpr const char* kKeys = R"({
  "schema": "krok.camera-keys/1",
  "rate": 30,
  "keys": [
    {"time": 0, "position": [0, 1.6, 4], "target": [0, 1, 0], "field_of_view": 40},
    {"time": 1, "position": [3, 1.8, 3], "target": [0, 1.2, 0.5]},
    {"time": 2, "position": [4, 1.2, 0], "target": [0, 1.2, 1]}
  ]
})";

class KrokCam : public JudgedTest {
 protected:
  KrokCam() : keys_(put("shot.json", kKeys)), walk_(put("walk.bvh", get(kWalk))) {}

  ToolRun cam(std::vector<std::string> arguments) const { return run_tool("krok-cam", arguments); }
  json result_of(std::vector<std::string> arguments) const {
    arguments.push_back("--json");
    const ToolRun run = cam(std::move(arguments));
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return json::parse(run.out)["result"];
  }
  CameraTrack track_at(const std::string& name) const {
    const std::string bytes = get(path(name));
    const auto track = cam::read(std::as_bytes(std::span(bytes)));
    EXPECT_TRUE(track.ok()) << name;
    return track ? *track : CameraTrack();
  }

  // What a viewer must show of a track.
  json expected_of(const CameraTrack& track) const {
    json moments = json::array();
    for (int i = 0; i < track.frame_count(); i += 7) {
      const auto f = static_cast<std::size_t>(i);
      const Vec3f forward = track.orientations[f] * -Vec3f::UnitZ();
      const Vec3f up = track.orientations[f] * Vec3f::UnitY();
      const auto list = [](const Vec3f& v) { return json({v.x(), v.y(), v.z()}); };
      moments.push_back({{"time", i / track.rate},
                         {"position", list(track.positions[f])},
                         {"forward", list(forward)},
                         {"up", list(up)}});
    }
    return {{"fov", static_cast<double>(track.fields_of_view[0]) / kRadiansPerDegree},
            {"moments", moments}};
  }

  std::string keys_, walk_;
};

TEST_F(KrokCam, GoesThroughItsKeys) {
  const json result = result_of({keys_, "-o", path("shot.cam")});
  EXPECT_EQ(result["frames"], 61);
  EXPECT_EQ(result["keys"], 3);
  EXPECT_GT(result["largest_speed"]["speed"], 2.0);
  const CameraTrack track = track_at("shot.cam");
  EXPECT_LT((track.positions[30] - Vec3f(3, 1.8f, 3)).norm(), 1e-6f);
  EXPECT_EQ(track.rate, 30);
  EXPECT_EQ(track.provenance.tool, "krok-cam");
  ASSERT_EQ(track.provenance.sources.size(), 1u);
  EXPECT_EQ(track.provenance.sources[0].name, "shot.json");
  EXPECT_EQ(result_of({keys_, "--rate", "60", "-o", path("fast.cam")})["frames"], 121);
}

TEST_F(KrokCam, InterpolatesAllKeysAsAsked) {
  result_of({keys_, "--interpolation", "linear", "-o", path("straight.cam")});
  const CameraTrack straight = track_at("straight.cam");
  EXPECT_LT((straight.positions[15] - Vec3f(1.5f, 1.7f, 3.5f)).norm(), 1e-5f);
  result_of({keys_, "--interpolation", "hermite:1", "-o", path("stops.cam")});
  const CameraTrack stops = track_at("stops.cam");
  // By the source's formula with no velocity at the keys: 3t^2 - 2t^3.
  const Vec3f wanted = Vec3f(0, 1.6f, 4) + 0.104f * Vec3f(3, 0.2f, -1);
  EXPECT_LT((stops.positions[6] - wanted).norm(), 1e-5f);
  EXPECT_EQ(cam({keys_, "--interpolation", "cubic", "-o", path("x.cam")}).exit_code, 2);
  const ToolRun film =
      cam({walk_, "--follow", "hips", "--interpolation", "linear", "-o", path("x.cam")});
  EXPECT_EQ(film.exit_code, 2);
  EXPECT_EQ(cam({path("stops.cam"), "--interpolation", "linear", "-o", path("x.cam")}).exit_code,
            2);
}

TEST_F(KrokCam, AMistakeInTheKeysIsToldWithItsPlace) {
  std::string wrong = kKeys;
  wrong.replace(wrong.find("\"time\": 1"), 9, "\"time\": 0");
  const ToolRun run = cam({put("wrong.json", wrong), "-o", path("shot.cam")});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("wrong.json:6:14: error: "));
  EXPECT_TRUE(has_code(run.err, "camera-keys-time")) << run.err;
  EXPECT_FALSE(std::filesystem::exists(path("shot.cam")));
}

TEST_F(KrokCam, FollowsWithTheActorInTheImage) {
  const json result = result_of({walk_, "--follow", "hips", "-o", path("a.cam")});
  EXPECT_EQ(result["frames_shown"], result["frames"]);
  EXPECT_EQ(result["frames_inside"], 0);
  EXPECT_EQ(result["framed"], "full body");
  EXPECT_EQ(result["follows"], "Hips");
  // By its name it is the same joint.
  ASSERT_EQ(cam({walk_, "--follow", "Hips", "-o", path("b.cam")}).exit_code, 0);
  EXPECT_EQ(track_at("a.cam").positions, track_at("b.cam").positions);
  const json head = result_of({walk_, "--follow", "head", "--frame", "head", "-o", path("c.cam")});
  EXPECT_LT(head["distance"].get<double>(), 0.4 * result["distance"].get<double>());
  // A longer lens stands farther away.
  const json tele = result_of({walk_, "--follow", "hips", "--lens", "100", "-o", path("d.cam")});
  EXPECT_GT(tele["distance"].get<double>(), 2 * result["distance"].get<double>());
  EXPECT_NEAR(tele["field_of_view"]["largest"].get<double>(), 13.686, 0.001);
}

TEST_F(KrokCam, FramesTheJointThatItFollows) {
  const json whole = result_of({walk_, "--follow", "left_lower_arm", "-o", path("a.cam")});
  const json close =
      result_of({walk_, "--follow", "left_lower_arm", "--frame", "joint", "-o", path("b.cam")});
  EXPECT_EQ(close["framed"], "joint");
  EXPECT_EQ(close["frames_shown"], close["frames"]);
  EXPECT_LT(close["distance"].get<double>(), 0.6 * whole["distance"].get<double>());
  EXPECT_EQ(cam({walk_, "--still", "--frame", "joint", "-o", path("c.cam")}).exit_code, 2);
}

TEST_F(KrokCam, OrbitsAtItsPace) {
  const json result =
      result_of({walk_, "--orbit", "20s", "--fixed-centre", "-o", path("orbit.cam")});
  EXPECT_NEAR(result["largest_turning"]["angular_velocity"].get<double>(), 18, 0.05);
  EXPECT_EQ(result["frames_shown"], result["frames"]);
  EXPECT_TRUE(result["follows"].is_null());
  const double duration = result["duration"];
  const json turns = result_of(
      {walk_, "--orbit", "2turns", "--clockwise", "--fixed-centre", "-o", path("turns.cam")});
  EXPECT_NEAR(turns["largest_turning"]["angular_velocity"].get<double>(), 720 / duration, 0.2);
  const CameraTrack there = track_at("orbit.cam"), back = track_at("turns.cam");
  // They set out to opposite sides.
  const Vec3f way = there.positions[9] - there.positions[0];
  const Vec3f way_back = back.positions[9] - back.positions[0];
  EXPECT_LT(way.dot(way_back), 0);
}

TEST_F(KrokCam, StandsStillForAWholeFolder) {
  std::filesystem::create_directory(path("in"));
  for (const char* name : {"in/a.bvh", "in/b.bvh"}) put(name, get(kWalk));
  const ToolRun run =
      cam({path("in"), "--still", "--view", "left", "--out-dir", path("out"), "-j", "2"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* name : {"out/a.cam", "out/b.cam"}) {
    const CameraTrack track = track_at(name);
    EXPECT_EQ(track.positions.front(), track.positions.back());
    // From the figure's left: it looks towards -X, level but for ten degrees.
    const Vec3f forward = track.orientations[0] * -Vec3f::UnitZ();
    EXPECT_LT(forward.x(), -0.9f);
  }
  const ToolRun glb = cam({path("in"), "--still", "--format", "glb", "--out-dir", path("glb")});
  EXPECT_EQ(glb.exit_code, 0) << glb.err;
  EXPECT_TRUE(std::filesystem::exists(path("glb/a.glb")));
}

TEST_F(KrokCam, TheSameInputGivesTheSameBytes) {
  for (const char* name : {"a.cam", "b.cam"}) {
    ASSERT_EQ(cam({walk_, "--orbit", "5s", "-o", path(name)}).exit_code, 0);
  }
  EXPECT_EQ(get(path("a.cam")), get(path("b.cam")));
  for (const char* name : {"a.glb", "b.glb"}) {
    ASSERT_EQ(cam({path("a.cam"), "-o", path(name)}).exit_code, 0);
  }
  EXPECT_EQ(get(path("a.glb")), get(path("b.glb")));
}

TEST_F(KrokCam, GltfIsValidAndThreeShowsTheTrack) {
  ASSERT_EQ(cam({keys_, "-o", path("shot.cam")}).exit_code, 0);
  ASSERT_EQ(cam({path("shot.cam"), "--aspect", "16:9", "-o", path("shot.glb")}).exit_code, 0);
  ASSERT_EQ(run_tool("krok-export", {walk_, "-o", path("walk.glb")}).exit_code, 0);
  ASSERT_EQ(cam({path("shot.cam"), "--into", path("walk.glb"), "-o", path("film.glb")}).exit_code,
            0);
  ASSERT_EQ(cam({walk_, "--orbit", "3s", "--into", path("walk.glb"), "--name", "orbit", "-o",
                 path("orbit.glb")})
                .exit_code,
            0);
  ASSERT_EQ(cam({walk_, "--orbit", "3s", "-o", path("orbit.cam")}).exit_code, 0);
  judge({"validate_gltf.mjs", "shot.glb", "film.glb", "orbit.glb"});
  json expected = expected_of(track_at("shot.cam"));
  put("film.json", expected.dump());
  judge({"three_camera.mjs", "film.glb", "film.json"});
  expected["aspect"] = 16.0 / 9;
  put("shot3.json", expected.dump());
  judge({"three_camera.mjs", "shot.glb", "shot3.json"});
  put("orbit.json", expected_of(track_at("orbit.cam")).dump());
  judge({"three_camera.mjs", "orbit.glb", "orbit.json"});
}

TEST_F(KrokCam, ComesBackFromGltf) {
  std::string zoom = kKeys;
  zoom.replace(zoom.find("[0, 1.2, 1]"), 11, "[0, 1.2, 1], \"focal_length\": 50");
  ASSERT_EQ(cam({put("zoom.json", zoom), "-o", path("zoom.cam")}).exit_code, 0);
  const ToolRun run = cam({path("zoom.cam"), "-o", path("zoom.glb")});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_TRUE(has_code(run.err, "gltf-lens")) << run.err;
  ASSERT_EQ(run_tool("krok-import", {path("zoom.glb"), "--save-cam", path("back.cam")}).exit_code,
            0);
  const ToolRun diff = run_tool("krok-diff", {path("zoom.cam"), path("back.cam")});
  EXPECT_EQ(diff.exit_code, 0) << diff.out;
  EXPECT_EQ(track_at("zoom.cam").fields_of_view, track_at("back.cam").fields_of_view);
}

TEST_F(KrokCam, SaysWhatIsCutOrTooNear) {
  const ToolRun near = cam({walk_, "--follow", "hips", "--distance", "1m", "-o", path("a.cam")});
  EXPECT_EQ(near.exit_code, 0);
  EXPECT_TRUE(has_code(near.err, "cam-cut")) << near.err;
  const ToolRun inside = cam({walk_, "--follow", "hips", "--distance", "5cm", "-o", path("b.cam")});
  EXPECT_TRUE(has_code(inside.err, "cam-inside")) << inside.err;
  const ToolRun far = cam({walk_, "--follow", "hips", "--distance", "20m", "-o", path("c.cam")});
  EXPECT_FALSE(has_code(far.err, "cam-cut")) << far.err;
}

struct Mistake {
  std::vector<std::string> arguments;
  const char* code;
};

TEST_F(KrokCam, MistakesAreTold) {
  const std::string out = path("x.cam");
  const Mistake mistakes[] = {
      {{walk_, "-o", out}, "usage"},
      {{walk_, "--follow", "hips", "--still", "-o", out}, "usage"},
      {{walk_, "--follow", "tail", "-o", out}, "cam-joint"},
      {{walk_, "--follow", "left_fingers_9", "-o", out}, "cam-joint"},
      {{keys_, "--still", "-o", out}, "usage"},
      {{keys_, "--camera", "0", "-o", out}, "usage"},
      {{walk_, "--still", "--camera", "0", "-o", out}, "usage"},
      {{keys_, "--fov", "40", "-o", out}, "usage"},
      {{keys_, "--clockwise", "-o", out}, "usage"},
      {{walk_, "--still", "--clockwise", "-o", out}, "usage"},
      {{walk_, "--still", "--smooth", "1s", "-o", out}, "usage"},
      {{walk_, "--still", "--facing", "actor", "-o", out}, "usage"},
      {{walk_, "--still", "--rate", "30", "-o", out}, "usage"},
      {{walk_, "--still", "--fov", "180", "-o", out}, "usage"},
      {{walk_, "--still", "--fov", "40deg", "--lens", "50", "-o", out}, "usage"},
      {{walk_, "--still", "--lens", "0", "-o", out}, "usage"},
      {{walk_, "--still", "--margin", "0.6", "-o", out}, "usage"},
      {{walk_, "--still", "--aspect", "16:0", "-o", out}, "usage"},
      {{walk_, "--still", "--aspect", "wide", "-o", out}, "usage"},
      {{walk_, "--still", "--elevation", "100deg", "-o", out}, "usage"},
      {{walk_, "--still", "--view", "left", "--azimuth", "3deg", "-o", out}, "usage"},
      {{walk_, "--still", "--distance", "0m", "-o", out}, "usage"},
      {{walk_, "--orbit", "0s", "-o", out}, "usage"},
      {{walk_, "--orbit", "-3s", "-o", out}, "usage"},
      {{walk_, "--orbit", "manyturns", "-o", out}, "usage"},
      {{walk_, "--orbit", "soon", "-o", out}, "quantity-number"},
      {{walk_, "--follow", "hips", "--smooth", "-1s", "-o", out}, "usage"},
      {{walk_, "--follow", "hips", "--dead-zone", "-1m", "-o", out}, "usage"},
      {{keys_, "--clip", "1", "-o", out}, "usage"},
      {{keys_, "--aspect", "2", "-o", out}, "usage"},
      {{keys_, "-o", path("x.gltf")}, "usage"},
      {{keys_, "-o", path("x.anim")}, "usage"},
      {{keys_, "--into", path("none.glb"), "-o", path("x.glb")}, "file-missing"},
      {{keys_, "--into", walk_, "-o", path("x.glb")}, "gltf-container"},
      {{keys_, "--into", path("none.glb"), "-o", out}, "usage"},
      {{path("none.cam"), "-o", path("x.glb")}, "file-missing"},
  };
  for (const Mistake& mistake : mistakes) {
    const ToolRun run = cam(mistake.arguments);
    std::string line;
    for (const std::string& argument : mistake.arguments) line += argument + " ";
    EXPECT_EQ(run.exit_code, 2) << line << run.err;
    EXPECT_TRUE(has_code(run.err, mistake.code)) << line << run.err;
  }
  EXPECT_THAT(listing(), ElementsAre("shot.json", "walk.bvh"));
}

// A camera on a boom that is turned by a quarter; two animations move it, none the second camera.
std::vector<std::byte> scene_with_cameras() {
  GlbBuilder builder;
  const int times = builder.add(std::vector<float>{0, 1}, "SCALAR");
  const int boom = builder.add(std::vector<float>{0, 0, 0, 10, 0, 0}, "VEC3");
  const int own = builder.add(std::vector<float>{0, 0, 1, 0, 0, 3}, "VEC3");
  const auto lens = [](double view) {
    return json{{"type", "perspective"}, {"perspective", {{"yfov", view}, {"znear", 0.1}}}};
  };
  builder.json["cameras"] = {lens(0.5), lens(0.6)};
  const double half = std::sqrt(0.5);
  builder.json["nodes"] = {
      {{"name", "Boom"}, {"children", {1}}, {"rotation", {0.0, half, 0.0, half}}},
      {{"name", "Hung"}, {"camera", 0}},
      {{"name", "Far"}, {"camera", 1}, {"translation", {7, 8, 9}}}};
  builder.json["scenes"] = {{{"nodes", {0, 2}}}};
  builder.json["scene"] = 0;
  const auto animation = [&](int node, int values) {
    return json{
        {"samplers", {{{"input", times}, {"output", values}}}},
        {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", "translation"}}}}}}};
  };
  builder.json["animations"] = {animation(0, boom), animation(1, own)};
  return builder.glb();
}

TEST_F(KrokCam, TakesACameraOutOfAScene) {
  const std::vector<std::byte> bytes = scene_with_cameras();
  const std::string scene =
      put("scene.glb", std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  const ToolRun run = cam({scene, "--rate", "10", "-o", path("a.cam")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(has_code(run.err, "import-cameras")) << run.err;
  EXPECT_TRUE(has_code(run.err, "cam-animations")) << run.err;
  const CameraTrack track = track_at("a.cam");
  ASSERT_EQ(track.frame_count(), 11);
  // The boom goes 10 m along X within a second; turned by a quarter, it looks along -X.
  EXPECT_LT((track.positions[3] - Vec3f(3, 0, 0)).norm(), 1e-5f);
  EXPECT_LT((track.orientations[3] * -Vec3f::UnitZ() - Vec3f(-1, 0, 0)).norm(), 1e-5f);
  EXPECT_FLOAT_EQ(track.fields_of_view[0], 0.5f);

  ASSERT_EQ(cam({scene, "--camera", "Far", "-o", path("b.cam")}).exit_code, 0);
  const CameraTrack far = track_at("b.cam");
  ASSERT_EQ(far.frame_count(), 1);  // nothing moves it
  EXPECT_EQ(far.positions[0], Vec3f(7, 8, 9));
  ASSERT_EQ(cam({scene, "--camera", "1", "-o", path("c.cam")}).exit_code, 0);
  EXPECT_EQ(track_at("c.cam").positions, far.positions);
  const ToolRun none = cam({scene, "--camera", "Near", "-o", path("d.cam")});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_TRUE(has_code(none.err, "import-camera")) << none.err;
}

TEST_F(KrokCam, ItsOwnGltfComesBackFrameByFrame) {
  ASSERT_EQ(
      cam({walk_, "--follow", "hips", "--orientation", "xyzw", "-o", path("a.cam")}).exit_code, 0);
  ASSERT_EQ(cam({path("a.cam"), "-o", path("a.glb")}).exit_code, 0);
  ASSERT_EQ(cam({path("a.glb"), "--orientation", "xyzw", "-o", path("b.cam")}).exit_code, 0);
  const CameraTrack there = track_at("a.cam"), back = track_at("b.cam");
  ASSERT_EQ(there.frame_count(), back.frame_count());
  EXPECT_EQ(there.rate, back.rate);
  for (std::size_t i = 0; i < there.positions.size(); ++i) {
    EXPECT_LT((there.positions[i] - back.positions[i]).norm(), 2e-6f) << i;
    EXPECT_LT(there.orientations[i].angularDistance(back.orientations[i]), 1e-6f) << i;
  }
}

TEST_F(KrokCam, WhatHoldsNoCameraIsSaid) {
  ASSERT_EQ(run_tool("krok-export", {walk_, "-o", path("walk.glb")}).exit_code, 0);
  const ToolRun scene = cam({path("walk.glb"), "-o", path("x.cam")});
  EXPECT_EQ(scene.exit_code, 2);
  EXPECT_TRUE(has_code(scene.err, "cam-missing")) << scene.err;
  const ToolRun other = cam({put("x.fbx", "Kaydara FBX Binary  "), "-o", path("x.cam")});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_TRUE(has_code(other.err, "cam-input")) << other.err;
  EXPECT_THAT(other.err, HasSubstr("krok-import"));
}

}  // namespace
}  // namespace krok::test
