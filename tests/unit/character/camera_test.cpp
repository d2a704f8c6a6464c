// If these fail, an imported camera stands elsewhere or looks elsewhere than in its file, and a
// film made with it shows something else.

#include <gtest/gtest.h>

#include "character/motion.h"
#include "character/space.h"
#include "scenes.h"

namespace krok::test {
namespace {

using namespace character;

nodes::Scene filmed() {
  nodes::Scene scene;
  const int dolly = add_node(scene, "Dolly", -1, Vec3(1, 2, 3));
  const int camera =
      add_node(scene, "Shot", dolly, Vec3::Zero(), from_rotation_vector(Vec3(0, kPi / 2, 0)), 2.0);
  scene.cameras.push_back({"Lens", true, 0.8});
  scene.nodes[static_cast<std::size_t>(camera)].camera = 0;
  nodes::Animation animation;
  add_channel(animation, dolly, nodes::Path::translation, 3, {0, 1}, {1, 2, 3, 1, 2, 5});
  scene.animations.push_back(std::move(animation));
  return scene;
}

CameraTrack track_of(const nodes::Scene& scene, int animation, const GivenConventions& given = {},
                     Diagnostics* diagnostics = nullptr) {
  const auto evaluator = *nodes::Evaluator::create(scene);
  const auto cameras = camera_nodes(scene, evaluator);
  EXPECT_EQ(cameras, std::vector<int>{1});
  const auto conventions = find_conventions(scene.space, nullptr, {}, {}, given);
  Diagnostics found;
  Sampling sampling;
  if (animation >= 0) {
    SamplingOptions options;
    options.rate = 10;
    sampling = choose_sampling(scene.animations[0], options, found)->sampling;
  }
  auto track = make_camera(scene, evaluator, 1, *Conversion::make(conventions),
                           rotation_to_apply(scene.space), animation, sampling, found);
  EXPECT_TRUE(track.ok());
  EXPECT_TRUE(check(*track).ok());
  if (diagnostics != nullptr) *diagnostics = found;
  return *track;
}

TEST(ImportedCamera, StandsAndLooksAsInTheScene) {
  nodes::Scene scene = filmed();
  scene.space = {1.0, Quat::Identity()};
  const CameraTrack track = track_of(scene, 0);
  ASSERT_EQ(track.frame_count(), 11);
  EXPECT_EQ(track.rate, 10);
  EXPECT_LT((track.positions[5] - Vec3f(1, 2, 4)).norm(), 1e-6f);
  const Vec3f looks = track.orientations[5] * -Vec3f::UnitZ();
  EXPECT_LT((looks - Vec3f(-1, 0, 0)).norm(), 1e-6f);
  EXPECT_FLOAT_EQ(track.fields_of_view[0], 0.8f);
}

// Else a cut in another program's file is flown through at any other rate.
TEST(ImportedCamera, CutsAreWhereItsNodeJumps) {
  nodes::Scene scene = filmed();
  nodes::Animation& animation = scene.animations[0];
  add_channel(animation, 1, nodes::Path::translation, 3, {0, 0.4f, 0.4001f, 1},
              {0, 0, 0, 1, 0, 0, 9, 0, 0, 9, 0, 1});
  EXPECT_EQ(track_of(scene, 0).cuts, std::vector<int>{5});
  add_channel(animation, 1, nodes::Path::rotation, 4, {0, 0.3f, 0.7f, 1},
              {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 0, 1, 0, 0});
  animation.channels.back().interpolation = nodes::Interpolation::step;
  EXPECT_EQ(track_of(scene, 0).cuts, (std::vector<int>{5, 7}));
}

TEST(ImportedCamera, WithoutAnimationItIsOneFrame) {
  nodes::Scene scene = filmed();
  scene.space = {1.0, Quat::Identity()};
  const CameraTrack track = track_of(scene, -1);
  ASSERT_EQ(track.frame_count(), 1);
  EXPECT_EQ(track.positions[0], Vec3f(1, 2, 3));
}

TEST(ImportedCamera, TheWorldTurnsAboutIt) {
  // +Z up, forward -Y, centimetres: the camera looked along -X and still does.
  GivenConventions given;
  given.unit = *parse_unit("cm");
  given.up = Direction::plus_z;
  given.forward = Direction::minus_y;
  nodes::Scene scene = filmed();
  const CameraTrack track = track_of(scene, -1, given);
  EXPECT_LT((track.positions[0] - Vec3f(0.01f, 0.03f, -0.02f)).norm(), 1e-7f);
  EXPECT_LT((track.orientations[0] * -Vec3f::UnitZ() - Vec3f(-1, 0, 0)).norm(), 1e-6f);
  // Its own up was the file's +Y, which is Krok's -Z.
  EXPECT_LT((track.orientations[0] * Vec3f::UnitY() - Vec3f(0, 0, -1)).norm(), 1e-6f);
  // The same where the file says so itself, also by a turn that is none by quarters.
  scene.space = {0.01, *rotation_to_krok(Direction::plus_z, Direction::minus_y)};
  const CameraTrack said = track_of(scene, -1);
  EXPECT_LT((said.positions[0] - track.positions[0]).norm(), 1e-7f);
  const Quat odd = from_rotation_vector(Vec3(0.3, 0.2, 0.1));
  scene.space = {1.0, odd};
  const CameraTrack turned = track_of(scene, -1);
  EXPECT_LT((turned.positions[0].cast<double>() - odd * Vec3(1, 2, 3)).norm(), 1e-6);
}

TEST(ImportedCamera, AnOrthographicOneIsSaid) {
  nodes::Scene scene = filmed();
  scene.space = {1.0, Quat::Identity()};
  scene.cameras[0] = {"Plan", false, 0.0};
  Diagnostics diagnostics;
  track_of(scene, -1, {}, &diagnostics);
  EXPECT_TRUE(has_code(diagnostics, "scene-camera"));
}

}  // namespace
}  // namespace krok::test
