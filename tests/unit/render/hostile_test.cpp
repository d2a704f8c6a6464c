// If this fails, a file with odd coordinates, as damaged or generated ones have, brings down the
// tool that draws it: the ray tracer's own assertions end the program.

#include <gtest/gtest.h>

#include <random>

#include "unit/render/actors.h"

namespace krok::render {
namespace {

class Odd {
 public:
  explicit Odd(unsigned seed) : random_(seed) {}

  // Of any size, often 0 or one that was there before.
  float number() {
    const int kind = pick(8);
    if (kind == 0) return 0;
    if (kind < 3) return last_;
    last_ = static_cast<float>(std::pow(10.0, kind == 3 ? pick(30) - 15 : pick(3) - 1) *
                               (pick(2001) - 1000) / 1000.0);
    return last_;
  }
  float radius() { return std::abs(number()); }
  Vec3f point() { return {number(), number(), number()}; }
  Colour colour() { return {200, static_cast<std::uint8_t>(pick(256)), 20}; }
  int pick(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }

 private:
  std::mt19937 random_;
  float last_ = 1;
};

Actor odd_actor(Odd& odd) {
  Actor actor;
  actor.centre = Vec3(odd.number(), 0, odd.number());
  for (int i = odd.pick(6); i > 0; --i) {
    actor.bones.push_back(
        {odd.point(), odd.point(), odd.radius(), odd.radius(), odd.colour(), odd.colour()});
  }
  for (int i = odd.pick(3); i > 0; --i) {
    Surface surface;
    const int vertices = 3 + odd.pick(6);
    for (int v = 0; v < vertices; ++v) surface.positions.push_back(odd.point());
    if (odd.pick(2) == 0) {
      for (int v = 0; v < vertices; ++v) surface.normals.push_back(1e20F * odd.point());
    }
    Triangles triangles;
    for (int t = odd.pick(12); t > 0; --t) {
      const auto corner = [&] { return static_cast<std::uint32_t>(odd.pick(vertices)); };
      triangles.push_back({corner(), corner(), corner()});
    }
    surface.triangles = std::make_shared<Triangles>(triangles);
    surface.colours = {odd.colour()};
    actor.surfaces.push_back(surface);
  }
  return actor;
}

TEST(HostileNumbers, AreDrawnOrRefusedAndDrawnAlikeByAnyNumberOfThreads) {
  int drawn = 0;
  for (unsigned seed = 0; seed < 150; ++seed) {
    Odd odd(seed);
    const Actor first = odd_actor(odd);
    const Actor second = odd_actor(odd);
    Sheet sheet = test::sheet_of(first, odd.number(), 0.5 * (odd.pick(5) - 2));
    sheet.rows[0].cells[0].layers.push_back({&second, 0.5});
    sheet.rows[0].cells[0].path = {odd.point().cast<double>(), odd.point().cast<double>()};
    sheet.rows[0].cells[0].marks = {{odd.point().cast<double>(), "here"}};
    const auto once = make_sheet(sheet, {.row_height = 48, .cell_width = 64, .jobs = 1});
    const auto again = make_sheet(sheet, {.row_height = 48, .cell_width = 64, .jobs = 3});
    ASSERT_EQ(once.ok(), again.ok()) << seed;
    if (!once) continue;
    EXPECT_EQ(once->image.rgb, again->image.rgb) << seed;
    ++drawn;
  }
  EXPECT_GT(drawn, 75);
}

}  // namespace
}  // namespace krok::render
