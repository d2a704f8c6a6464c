// If these fail, what a library says of how well it fills gaps is wrong.

#include "parametric/leave_one_out.h"

#include <gmock/gmock.h>

#include "walks.h"

namespace krok::parametric {
namespace {

const Library& library() {
  static const Library made =
      test::library_of(test::grid_walks(false), {"step.length", "step.height"}, {.mirror = false})
          .library;
  return made;
}

double mean(const std::vector<HeldOut>& all, double HeldOut::*value) {
  double sum = 0;
  int count = 0;
  for (const HeldOut& one : all) {
    if (one.failed || !one.inside) continue;
    sum += one.*value;
    ++count;
  }
  EXPECT_GT(count, 0);
  return sum / count;
}

TEST(LeaveOneOut, WeightsFillGapsBetterThanPlanesAndNeighbours) {
  const auto held = leave_one_out(library(), rbf::Kernel::cubic);
  ASSERT_TRUE(held.ok()) << held.error().message;
  ASSERT_EQ(held->size(), 9u);
  std::printf("inside, mean distance of joints: weights %.1f mm, planes %.1f mm, nearest %.1f mm\n",
              1000 * mean(*held, &HeldOut::weighted), 1000 * mean(*held, &HeldOut::linear),
              1000 * mean(*held, &HeldOut::nearest));
  EXPECT_LT(mean(*held, &HeldOut::weighted), mean(*held, &HeldOut::linear));
  EXPECT_LT(mean(*held, &HeldOut::weighted), mean(*held, &HeldOut::nearest));
  // The middle of the grid lies inside, a corner does not.
  EXPECT_TRUE((*held)[4].inside);
  EXPECT_FALSE((*held)[0].inside);
  EXPECT_GT((*held)[4].nearest, 0.01);
}

// With the same example twice as another's neighbour nothing is missing.
TEST(LeaveOneOut, AnExampleThatIsTwiceThereIsItsNearestNeighbour) {
  Library twice = library();
  Example image = twice.examples[4];
  image.parameters[0] += 5e-3;
  twice.examples.push_back(image);
  const auto held = leave_one_out(twice, rbf::Kernel::cubic);
  ASSERT_TRUE(held.ok()) << held.error().message;
  EXPECT_NEAR(held->back().nearest, 0, 1e-6);
  EXPECT_LT(held->back().weighted, 5e-3);
}

TEST(LeaveOneOut, SaysWhenThereIsTooLittle) {
  Library few = library();
  few.examples.resize(2);
  EXPECT_EQ(leave_one_out(few, rbf::Kernel::cubic).error().code, "rbf-examples");
  // Without one of three there are too few for two parameters.
  few.examples = {library().examples[0], library().examples[1], library().examples[3]};
  const auto held = leave_one_out(few, rbf::Kernel::cubic);
  ASSERT_TRUE(held.ok()) << held.error().message;
  for (const HeldOut& one : *held) EXPECT_TRUE(one.failed);
}

}  // namespace
}  // namespace krok::parametric
