// If these fail, a camera whose lens changes over time is imported with another lens than it had.

#include <gtest/gtest.h>

#include "character/motion.h"
#include "scenes.h"

namespace krok::test {
namespace {

using namespace character;

nodes::Scene zooming(bool perspective) {
  nodes::Scene scene;
  const int camera = add_node(scene, "Shot", -1, Vec3(1, 2, 3));
  scene.cameras.push_back({"Lens", perspective, 0.8});
  scene.cameras[0].lens_rate = 10;
  scene.cameras[0].lens = {0.8f, 0.6f, 0.7f};
  scene.nodes[static_cast<std::size_t>(camera)].camera = 0;
  nodes::Animation animation;
  add_channel(animation, camera, nodes::Path::translation, 3, {0, 1}, {1, 2, 3, 1, 2, 5});
  scene.animations.push_back(std::move(animation));
  return scene;
}

std::vector<float> lens_of(const nodes::Scene& scene, int animation, double rate) {
  const auto evaluator = *nodes::Evaluator::create(scene);
  Diagnostics found;
  SamplingOptions options;
  options.rate = rate;
  const Sampling sampling = choose_sampling(scene.animations[0], options, found)->sampling;
  const auto track =
      make_camera(scene, evaluator, 0, Conversion(), Mat4::Identity(), animation, sampling, found);
  EXPECT_TRUE(track.ok());
  return track->fields_of_view;
}

TEST(ImportedLens, IsThatOfItsMomentAndLinearBetween) {
  const auto at_10 = lens_of(zooming(true), 0, 10);
  ASSERT_EQ(at_10.size(), 11u);
  EXPECT_EQ(at_10[0], 0.8f);
  EXPECT_EQ(at_10[1], 0.6f);
  EXPECT_EQ(at_10[2], 0.7f);
  EXPECT_EQ(at_10[10], 0.7f);  // the last one holds
  EXPECT_NEAR(lens_of(zooming(true), 0, 20)[1], 0.7f, 1e-6f);
}

TEST(ImportedLens, ChannelsOfAnAnimationGoFirst) {
  nodes::Scene scene = zooming(true);
  nodes::Animation lens;
  add_channel(lens, 0, nodes::Path::field_of_view, 1, {0, 2}, {0.5f, 0.7f});
  scene.animations[0].lenses = lens.channels;
  const auto at_10 = lens_of(scene, 0, 10);
  ASSERT_EQ(at_10.size(), 21u);  // as long as its keys
  EXPECT_NEAR(at_10[5], 0.55f, 1e-6f);
  EXPECT_EQ(at_10[20], 0.7f);
}

TEST(ImportedLens, StandsStillWithoutAnimationAndIsNoneOfAnOrthographicCamera) {
  EXPECT_EQ(lens_of(zooming(true), -1, 10)[2], 0.8f);
  EXPECT_NEAR(lens_of(zooming(false), 0, 10)[1], kPi / 4, 1e-6);
}

}  // namespace
}  // namespace krok::test
