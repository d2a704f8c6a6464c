// If these fail, files of meshes in motion hold frames in another order, or other frames than the
// motion has.

#include "scene/mesh_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <memory>
#include <stdexcept>

namespace krok {
namespace {

using testing::ElementsAre;

// Vertex v of frame f is at (f, v, 0), with a normal of (0, f, v).
void number(int frame, const ShapeOutput& to) {
  const auto f = static_cast<float>(frame);
  for (std::size_t v = 0; v < to.positions.size(); ++v) {
    to.positions[v] = Vec3f(f, static_cast<float>(v), 0);
  }
  for (std::size_t v = 0; v < to.normals.size(); ++v) {
    to.normals[v] = Vec3f(0, f, static_cast<float>(v));
  }
}

MeshMotion numbered(int frames) {
  return {frames, 30, copies_of(number)};
}

Status nothing(int, ShapeRoom&) {
  return {};
}

Status take_all(int, std::span<const ShapeRoom>) {
  return {};
}

TEST(MakeShapes, HandsOverEachFrameOnceAndInOrder) {
  for (const int jobs : {1, 2, 3, 16}) {
    std::vector<int> taken;
    std::atomic<int> prepared = 0;
    const Status status = make_shapes(
        numbered(50), {3, 45, 7, true}, jobs,
        [&](int frame, ShapeRoom& shape) -> Status {
          ++prepared;
          shape.positions[0].z() = static_cast<float>(2 * frame);
          return {};
        },
        [&](int first, std::span<const ShapeRoom> shapes) -> Status {
          for (const ShapeRoom& shape : shapes) {
            taken.push_back(first);
            const auto f = static_cast<float>(first++);
            EXPECT_EQ(shape.positions.size(), 7u);
            EXPECT_EQ(shape.positions[0], Vec3f(f, 0, 2 * f));
            EXPECT_EQ(shape.positions[6], Vec3f(f, 6, 0));
            EXPECT_EQ(shape.normals.at(6), Vec3f(0, f, 6));
          }
          return {};
        });
    EXPECT_TRUE(status.ok());
    EXPECT_EQ(prepared, 42);
    ASSERT_EQ(taken.size(), 42u);
    for (int i = 0; i < 42; ++i) EXPECT_EQ(taken[static_cast<std::size_t>(i)], 3 + i);
  }
}

// If it were not so, files would be written in pieces as small as the frames.
TEST(MakeShapes, HandsOverAsManyFramesAtOnceWhateverTheThreads) {
  for (const int jobs : {1, 2, 8}) {
    std::vector<std::size_t> counts;
    const Status status =
        make_shapes(numbered(40), {0, 40, 2, false}, jobs, nothing, [&](int, auto shapes) {
          counts.push_back(shapes.size());
          return Status();
        });
    EXPECT_TRUE(status.ok());
    EXPECT_EQ(counts, (std::vector<std::size_t>{16, 16, 8}));
  }
}

// Sources have working memory of their own and some, as those that read files, cannot go back.
TEST(MakeShapes, AsksASourceOnOneThreadAtATimeForFramesThatRise) {
  for (const int jobs : {1, 2, 8}) {
    std::vector<std::atomic<int>> asked(200);
    MeshMotion motion = numbered(200);
    motion.source = [&asked]() -> ShapeSource {
      struct Use {
        std::atomic<int> inside = 0;
        int last = -1;
      };
      return [&asked, use = std::make_shared<Use>()](int frame, const ShapeOutput& to) {
        EXPECT_EQ(++use->inside, 1);
        EXPECT_GT(frame, use->last);
        EXPECT_TRUE(to.normals.empty());
        use->last = frame;
        ++asked[static_cast<std::size_t>(frame)];
        number(frame, to);
        --use->inside;
      };
    };
    const Status status = make_shapes(motion, {0, 200, 3, false}, jobs, nothing, take_all);
    EXPECT_TRUE(status.ok());
    for (const auto& times : asked) EXPECT_EQ(times, 1);
  }
}

// If it were not so, two threads would take as long as one: all frames would wait for one source.
TEST(MakeShapes, MakesShapesOnSeveralThreadsAtOnce) {
  // Frames of more than a megabyte are handed over one by one.
  constexpr std::size_t kVertices = 100'000;
  std::latch both(2);
  MeshMotion motion = numbered(2);
  motion.source = copies_of([&both](int, const ShapeOutput&) { both.arrive_and_wait(); });
  EXPECT_TRUE(make_shapes(motion, {0, 2, kVertices, false}, 2, nothing, take_all).ok());
}

TEST(MakeShapes, HoldsFewFramesOfManyVertices) {
  std::atomic<int> sources = 0;
  MeshMotion motion = numbered(100);
  motion.source = [&]() -> ShapeSource {
    ++sources;
    return [](int, const ShapeOutput&) {};
  };
  constexpr std::size_t kVertices = 4'000'000;  // 48 MB a frame
  const Status status = make_shapes(motion, {0, 8, kVertices, false}, 64, nothing, take_all);
  EXPECT_TRUE(status.ok());
  EXPECT_EQ(sources, 4);
}

TEST(MakeShapes, GivesTheFirstErrorWhateverTheThreads) {
  for (const int jobs : {1, 2, 8}) {
    const auto refuse = [](int frame) { return Status(Error("no", std::to_string(frame))); };
    const Status status = make_shapes(
        numbered(30), {0, 30, 2, false}, jobs,
        [&](int frame, ShapeRoom&) { return frame < 9 ? Status() : refuse(frame); }, take_all);
    ASSERT_FALSE(status.ok());
    EXPECT_EQ(status.error().message, "9");
    const Status taken =
        make_shapes(numbered(30), {0, 30, 2, false}, jobs, nothing,
                    [&](int first, auto) { return first < 16 ? Status() : refuse(first); });
    ASSERT_FALSE(taken.ok());
    EXPECT_EQ(taken.error().message, "16");
  }
}

// A motion that throws must not leave other threads waiting.
TEST(MakeShapes, PassesOnWhatIsThrown) {
  for (const int jobs : {1, 3}) {
    MeshMotion motion = numbered(30);
    motion.source = copies_of([](int frame, const ShapeOutput&) {
      if (frame == 5) throw std::runtime_error("five");
    });
    EXPECT_THROW((void)make_shapes(motion, {0, 30, 2, false}, jobs, nothing, take_all).ok(),
                 std::runtime_error);
  }
}

TEST(MakeShapes, OfNoFramesAsksForNothing) {
  MeshMotion motion;  // source is empty: calling it would throw
  const auto refuse = [](int, auto) { return Status(Error("no", "")); };
  EXPECT_TRUE(make_shapes(motion, {0, 0, 3, true}, 2, nothing, refuse).ok());
  EXPECT_TRUE(make_shapes(motion, {4, 2, 3, true}, 2, nothing, refuse).ok());
}

}  // namespace
}  // namespace krok
