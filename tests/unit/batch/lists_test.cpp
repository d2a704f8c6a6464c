// If these fail, patterns fit other names than in a shell, a manifest is read wrongly, or what a
// batch says depends on its threads.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <new>
#include <thread>

#include "core/glob.h"
#include "core/in_order.h"
#include "tools/batch/option_sets.h"

namespace krok::cli::batch {
namespace {

TEST(Glob, Matches) {
  EXPECT_TRUE(matches("*.bvh", "a.bvh"));
  EXPECT_TRUE(matches("*", ""));
  EXPECT_TRUE(matches("a*b*c", "aXbbYc"));
  EXPECT_TRUE(matches("a?c", "abc"));
  EXPECT_TRUE(matches("[a-cx]1", "x1"));
  EXPECT_TRUE(matches("[]]", "]"));
  EXPECT_TRUE(matches("[!a-c]", "d"));
  EXPECT_TRUE(matches("[a-]", "-"));
  EXPECT_TRUE(matches("[a", "[a")) << "no set";
  EXPECT_TRUE(matches(".*", ".hidden"));
  EXPECT_TRUE(matches("\xC3\xA4*", "\xC3\xA4.bvh"));
}

TEST(Glob, DoesNotMatch) {
  EXPECT_FALSE(matches("*.bvh", ".bvh")) << "hidden";
  EXPECT_FALSE(matches("?hidden", ".hidden"));
  EXPECT_FALSE(matches("[.]hidden", ".hidden"));
  EXPECT_FALSE(matches("*.bvh", "a.bvh2"));
  EXPECT_FALSE(matches("a?c", "ac"));
  EXPECT_FALSE(matches("[!a-c]", "b"));
  EXPECT_FALSE(matches("", "a"));
  EXPECT_FALSE(matches("A", "a"));
}

TEST(Glob, ManyStarsDoNotTakeLong) {
  const std::string name(2000, 'a');
  EXPECT_FALSE(matches("*a*a*a*a*a*a*a*a*a*a*a*b", name));
}

TEST(Glob, FixedPart) {
  EXPECT_EQ(fixed_part("a/b/*/c.bvh"), "a/b");
  EXPECT_EQ(fixed_part("*.bvh"), "");
  EXPECT_EQ(fixed_part("/*.bvh"), "/");
  EXPECT_EQ(fixed_part("a/b[1]/c"), "a");
}

TEST(ManifestText, FieldsAndWords) {
  const Manifest manifest = parse_manifest(
      "\xEF\xBB\xBF# heading\n a b.bvh\tout/x.anim\t--up 'a b'\"c\"  -v\r\nc.bvh", "list.tsv");
  EXPECT_TRUE(manifest.errors.empty());
  ASSERT_EQ(manifest.lines.size(), 2u);
  const ManifestLine& line = manifest.lines[0];
  EXPECT_EQ(line.input.text, " a b.bvh");
  EXPECT_EQ(line.output.text, "out/x.anim");
  ASSERT_EQ(line.options.size(), 3u);
  EXPECT_EQ(line.options[1].text, "a bc");
  EXPECT_EQ(line.options[1].where.line, 2);
  EXPECT_EQ(line.options[1].where.column, 26);
  EXPECT_EQ(line.options[2].text, "-v");
  EXPECT_EQ(manifest.lines[1].output.text, "");
}

TEST(ManifestText, AnEmptyWordInQuotesIsAWord) {
  const Manifest manifest = parse_manifest("a\tb\t--up ''", "list.tsv");
  ASSERT_EQ(manifest.lines.size(), 1u);
  ASSERT_EQ(manifest.lines[0].options.size(), 2u);
  EXPECT_EQ(manifest.lines[0].options[1].text, "");
}

TEST(InOrder, OutcomesComeInOrderWhateverTakesLong) {
  for (const int threads : {1, 2, 5}) {
    std::vector<std::size_t> order;
    std::atomic<int> ahead{0};
    int most = 0;
    in_order<std::size_t>(
        100, threads, 8,
        [&](std::size_t i) {
          ++ahead;
          if (i % 7 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
          return i * 2;
        },
        [&](std::size_t i, std::size_t outcome) {
          EXPECT_EQ(outcome, i * 2);
          most = std::max(most, ahead--);
          order.push_back(i);
          return true;
        });
    ASSERT_EQ(order.size(), 100u);
    EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
    EXPECT_LE(most, 8);
  }
}

TEST(InOrder, OthersGoOnWhileAnOutcomeIsTaken) {
  constexpr int kOthers = 5;
  std::atomic<int> done{0};
  bool went_on = false;
  in_order<int>(
      100, 2, 16,
      [&](std::size_t) {
        ++done;
        return 0;
      },
      [&](std::size_t i, int) {
        if (i > 0) return true;
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
        while (!went_on && std::chrono::steady_clock::now() < end) went_on = done > kOthers;
        return true;
      });
  EXPECT_TRUE(went_on);
  EXPECT_EQ(done, 100);
}

TEST(InOrder, StopsWhereItIsTold) {
  for (const int threads : {1, 4}) {
    std::atomic<std::size_t> begun{0};
    std::size_t taken = 0;
    in_order<int>(
        1000, threads, 16,
        [&](std::size_t) {
          ++begun;
          return 0;
        },
        [&](std::size_t i, int) {
          ++taken;
          return i != 10;
        });
    EXPECT_EQ(taken, 11u);
    EXPECT_LE(begun, 11u + 16u);
  }
}

// As where memory ends. The threads that wait for their turn must not wait for ever.
TEST(InOrder, AnExceptionEndsItAndIsThrownOn) {
  for (const int threads : {1, 4}) {
    std::size_t taken = 0;
    const auto run = [&](bool in_work) {
      taken = 0;
      in_order<int>(
          1000, threads, 8,
          [&](std::size_t i) {
            if (in_work && i == 20) throw std::bad_alloc();
            return 0;
          },
          [&](std::size_t i, int) {
            if (!in_work && i == 20) throw std::bad_alloc();
            ++taken;
            return true;
          });
    };
    for (const bool in_work : {true, false}) {
      EXPECT_THROW(run(in_work), std::bad_alloc);
      EXPECT_LE(taken, 20u);
    }
  }
}

}  // namespace
}  // namespace krok::cli::batch
