// If these fail, files of meshes in motion hold frames in another order, or other frames than the
// motion has, or a vertex that is no number gets into one.

#include "scene/mesh_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <stdexcept>

namespace krok {
namespace {

using testing::ElementsAre;

// Vertex v of frame f is at (f, v, 0), with a normal of (0, f, v).
MeshMotion numbered(int frames) {
  return {frames, 30, [](int frame, std::span<Vec3f> positions, std::span<Vec3f> normals) {
            const auto f = static_cast<float>(frame);
            for (std::size_t v = 0; v < positions.size(); ++v) {
              positions[v] = Vec3f(f, static_cast<float>(v), 0);
            }
            for (std::size_t v = 0; v < normals.size(); ++v) {
              normals[v] = Vec3f(0, f, static_cast<float>(v));
            }
          }};
}

Status nothing(int, ShapeRoom&) {
  return {};
}

TEST(MakeShapes, HandsOverEachFrameOnceAndInOrder) {
  for (const int jobs : {1, 2, 3, 16}) {
    std::vector<int> taken;
    std::atomic<int> prepared = 0;
    const Status done = make_shapes(
        numbered(50), {3, 45, 7, true}, jobs,
        [&](int frame, ShapeRoom& shape) -> Status {
          ++prepared;
          shape.positions[0].z() = static_cast<float>(2 * frame);
          return {};
        },
        [&](int frame, const ShapeRoom& shape) -> Status {
          taken.push_back(frame);
          const auto f = static_cast<float>(frame);
          EXPECT_EQ(shape.positions.size(), 7u);
          EXPECT_EQ(shape.positions[0], Vec3f(f, 0, 2 * f));
          EXPECT_EQ(shape.positions[6], Vec3f(f, 6, 0));
          EXPECT_EQ(shape.normals.at(6), Vec3f(0, f, 6));
          return {};
        });
    EXPECT_TRUE(done.ok());
    EXPECT_EQ(prepared, 42);
    ASSERT_EQ(taken.size(), 42u);
    for (int i = 0; i < 42; ++i) EXPECT_EQ(taken[static_cast<std::size_t>(i)], 3 + i);
  }
}

TEST(MakeShapes, AsksForOneFrameAtATimeInOrder) {
  for (const int jobs : {1, 2, 8}) {
    MeshMotion motion = numbered(200);
    std::atomic<int> inside = 0;
    int next = 0;
    motion.shape_at = [&, shapes = motion.shape_at](int frame, auto positions, auto normals) {
      EXPECT_EQ(++inside, 1);
      EXPECT_EQ(frame, next++);
      EXPECT_TRUE(normals.empty());
      shapes(frame, positions, normals);
      --inside;
    };
    const Status done = make_shapes(motion, {0, 200, 3, false}, jobs, nothing,
                                    [](int, const ShapeRoom&) { return Status(); });
    EXPECT_TRUE(done.ok());
    EXPECT_EQ(next, 200);
  }
}

TEST(MakeShapes, GivesTheFirstErrorWhateverTheThreads) {
  for (const int jobs : {1, 2, 8}) {
    const auto fail_from = [](int first) {
      return [first](int frame, const ShapeRoom&) {
        return frame < first ? Status() : Status(Error("no", std::to_string(frame)));
      };
    };
    const Status prepared = make_shapes(numbered(30), {0, 30, 2, false}, jobs, fail_from(9),
                                        [](int, const ShapeRoom&) { return Status(); });
    ASSERT_FALSE(prepared.ok());
    EXPECT_EQ(prepared.error().message, "9");
    const Status taken = make_shapes(numbered(30), {0, 30, 2, false}, jobs, nothing, fail_from(4));
    ASSERT_FALSE(taken.ok());
    EXPECT_EQ(taken.error().message, "4");
  }
}

// A motion that throws must not leave others waiting for their turn.
TEST(MakeShapes, PassesOnWhatIsThrown) {
  for (const int jobs : {1, 3}) {
    MeshMotion motion = numbered(30);
    motion.shape_at = [](int frame, auto, auto) {
      if (frame == 5) throw std::runtime_error("five");
    };
    EXPECT_THROW((void)make_shapes(motion, {0, 30, 2, false}, jobs, nothing,
                                   [](int, const ShapeRoom&) { return Status(); })
                     .ok(),
                 std::runtime_error);
  }
}

TEST(MakeShapes, OfNoFramesAsksForNothing) {
  MeshMotion motion;  // shape_at is empty: calling it would throw
  const auto refuse = [](int, const ShapeRoom&) { return Status(Error("no", "")); };
  EXPECT_TRUE(make_shapes(motion, {0, 0, 3, true}, 2, nothing, refuse).ok());
  EXPECT_TRUE(make_shapes(motion, {4, 2, 3, true}, 2, nothing, refuse).ok());
}

TEST(AllFinite, FindsOneAmongMany) {
  std::vector<Vec3f> vectors(37, Vec3f(3.4e38f, -3.4e38f, 1e-45f));
  EXPECT_TRUE(all_finite(vectors));
  EXPECT_TRUE(all_finite({}));
  for (std::size_t v = 0; v < vectors.size(); ++v) {
    for (const float bad :
         {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
          std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::quiet_NaN()}) {
      const Vec3f was = vectors[v];
      vectors[v][static_cast<int>(v % 3)] = bad;
      EXPECT_FALSE(all_finite(vectors)) << v << " " << bad;
      vectors[v] = was;
    }
  }
}

}  // namespace
}  // namespace krok
