// If these fail, the animation of another object is imported: a character that stands still.

#include <gtest/gtest.h>

#include "nodes/animation_choice.h"
#include "unit/character/scenes.h"

namespace krok::test {
namespace {

nodes::Channel channel(nodes::Path path, int width, std::vector<float> values,
                       nodes::Interpolation how = nodes::Interpolation::linear) {
  nodes::Animation animation;
  add_channel(animation, 0, path, width, {0, 1}, std::move(values));
  animation.channels[0].interpolation = how;
  return animation.channels[0];
}

TEST(Moving, ChangesAreMoreThanRoundingAndSigns) {
  using nodes::Path;
  EXPECT_FALSE(changes(channel(Path::rotation, 4, {0, 0, 0.6f, 0.8f, 0, 0, -0.6f, -0.80001f})));
  EXPECT_TRUE(changes(channel(Path::rotation, 4, {0, 0, 0.6f, 0.8f, 0, 0, 0.62f, 0.7846f})));
  EXPECT_FALSE(changes(channel(Path::translation, 3, {0, 90, 0, 0, 90.0005f, 0})));
  EXPECT_TRUE(changes(channel(Path::translation, 3, {0, 90, 0, 0, 90.01f, 0})));
  EXPECT_TRUE(changes(channel(Path::translation, 3, {0, 0, 0, 0, 0.001f, 0})));
  // Of splines the values, not the tangents.
  const auto spline = nodes::Interpolation::cubic_spline;
  EXPECT_FALSE(changes(channel(Path::weights, 1, {5, 1, 6, 7, 1, 8}, spline)));
  EXPECT_TRUE(changes(channel(Path::weights, 1, {5, 1, 5, 5, 2, 5}, spline)));
}

TEST(Moving, JointsCountAndElseWhatIsAboveThem) {
  nodes::Scene scene;
  const int armature = add_node(scene, "Armature", -1);
  const int hips = add_node(scene, "Hips", armature);
  const int spine = add_node(scene, "Spine", hips);
  const int box = add_node(scene, "Box", -1);
  const auto count = [&](const std::vector<int>& moved, const std::vector<int>& still) {
    nodes::Animation animation;
    for (const int node : moved) {
      add_channel(animation, node, nodes::Path::translation, 3, {0, 1}, {0, 0, 0, 1, 0, 0});
    }
    for (const int node : still) {
      add_channel(animation, node, nodes::Path::translation, 3, {0, 1}, {1, 2, 3, 1, 2, 3});
    }
    return nodes::moved_count(scene, animation, std::vector<int>{-1, hips, spine});
  };
  EXPECT_EQ(count({box}, {hips, spine}), 0u);
  EXPECT_EQ(count({armature, box}, {}), 1u);
  EXPECT_EQ(count({armature, hips}, {spine}), 1u);
  EXPECT_EQ(count({spine, hips}, {}), 2u);
}

}  // namespace
}  // namespace krok::test
