// If these fail, near-duplicates stay in a library and make its weights wild, or examples are lost
// that nothing stands in for.

#include "parametric/thin_out.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace krok::parametric {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Library library_at(const std::vector<std::vector<double>>& points) {
  Library library;
  library.parameters.resize(points.empty() ? 1 : points.front().size());
  for (const auto& point : points) {
    library.examples.emplace_back();
    library.examples.back().parameters = point;
  }
  return library;
}

TEST(ThinOut, KeepsOneOfThoseThatMeasureAlike) {
  // 0.52 and 0.5 are a fiftieth of the range apart; 0.5 is nearer to the middle.
  const Library library = library_at({{0}, {1}, {0.52}, {0.5}, {0.75}});
  EXPECT_THAT(thin_out(library, 0.1), ElementsAre(0, 1, 2, 4));
  EXPECT_THAT(thin_out(library, 0), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(thin_out(library, -1), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(thin_out(library, 0.6), ElementsAre(2));
  // Not more than asked for: the middle and the extremes.
  EXPECT_THAT(thin_out(library, 0.1, 3), ElementsAre(0, 1, 2));
  EXPECT_THAT(thin_out(library_at({}), 0.1), IsEmpty());
  EXPECT_THAT(thin_out(library_at({{3}}), 0.1), ElementsAre(0));
  EXPECT_THAT(thin_out(library_at({{3}, {3}}), 0.1), ElementsAre(0));
}

TEST(ThinOut, KeptAreApartAndTheOthersNearThem) {
  std::mt19937 random(4);
  std::vector<std::vector<double>> points;
  for (int i = 0; i < 200; ++i) {
    points.push_back({static_cast<double>(random() % 1000), static_cast<double>(random() % 50)});
  }
  points.push_back({0, 0});
  points.push_back({999, 49});
  const auto kept = thin_out(library_at(points), 0.2);
  const auto apart = [&](std::size_t a, std::size_t b) {
    return std::hypot((points[a][0] - points[b][0]) / 999, (points[a][1] - points[b][1]) / 49);
  };
  EXPECT_LT(kept.size(), 40u);
  for (std::size_t i = 0; i < points.size(); ++i) {
    double nearest = 9;
    for (const int k : kept) {
      const auto other = static_cast<std::size_t>(k);
      if (other != i) nearest = std::min(nearest, apart(i, other));
    }
    const bool is_kept = std::ranges::find(kept, static_cast<int>(i)) != kept.end();
    if (is_kept) {
      EXPECT_GE(nearest, 0.2 - 1e-12);
    } else {
      EXPECT_LT(nearest, 0.2);
    }
  }
}

// Would fail if one style took the places of another, or usual steps were lost to unusual ones.
TEST(ThinOut, SmoothedExamplesAreOfAllStylesAndMostlyUsual) {
  std::mt19937 random(4);
  std::normal_distribution<double> usual(0, 1);
  std::vector<std::vector<double>> points;
  for (int i = 0; i < 3000; ++i) points.push_back({usual(random), usual(random)});
  Library library = library_at(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    library.examples[i].style = i < 40 ? "rare" : i < 1000 ? "some" : "most";
  }
  const auto kept = thin_out_smoothed(library);
  EXPECT_LE(kept.size(), kMaxSmoothed);
  EXPECT_GT(kept.size(), kMaxSmoothed - 30);
  int rare = 0, some = 0, near = 0;
  for (const int i : kept) {
    const auto k = static_cast<std::size_t>(i);
    rare += k < 40 ? 1 : 0;
    some += k >= 40 && k < 1000 ? 1 : 0;
    near += std::hypot(points[k][0], points[k][1]) < 1.5 ? 1 : 0;
  }
  EXPECT_GE(rare, 38);
  EXPECT_NEAR(some, 230, 10);
  EXPECT_GT(near, static_cast<int>(kept.size()) / 2);
  EXPECT_TRUE(std::ranges::is_sorted(kept));
  EXPECT_THAT(thin_out_smoothed(library_at({{0}, {1}, {1}})), ElementsAre(0, 1));
  EXPECT_THAT(thin_out_smoothed(library_at({})), IsEmpty());
}

}  // namespace
}  // namespace krok::parametric
