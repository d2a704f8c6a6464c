// Captures whose fits wiggle. If these fail, what is to remove noise and spikes throws feet and
// hands aside that were still.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "corpus/bvh/corpus_files.h"
#include "filter/noise_filter.h"
#include "formats/bvh/bvh_reader.h"

namespace krok {
namespace {

// How far a joint is from the middle of its places in the frames before and after, twice.
float bend(const Clip& clip, int frame, std::size_t joint) {
  const auto at = [&](int f) { return clip.frame_positions(f)[joint]; };
  return (at(frame - 1) - 2 * at(frame) + at(frame + 1)).norm();
}

class FilteredCaptures : public testing::TestWithParam<const char*> {};

TEST_P(FilteredCaptures, ThrowNothing) {
  const std::string path = test::corpus_folder() + "/bvh/" + GetParam();
  if (!std::filesystem::exists(path)) {
    GTEST_SKIP() << "skipped: no corpus at " << test::corpus_folder();
  }
  const auto capture = bvh::read(test::text_of_file(path), path, {});
  ASSERT_TRUE(capture.ok());
  const Clip& clip = capture->clip;
  const auto filtered = filter::remove_noise(clip, {});
  ASSERT_TRUE(filtered.ok());
  const int last = clip.frame_count() - 1;
  for (std::size_t j = 0; j < clip.skeleton.names.size(); ++j) {
    for (int f = 1; f < last; ++f) {
      float before = 0;
      for (int g = std::max(1, f - 2); g <= std::min(last - 1, f + 2); ++g) {
        before = std::max(before, bend(clip, g, j));
      }
      ASSERT_LT(bend(filtered->clip, f, j), 2 * before + 0.015f)
          << clip.skeleton.names[j] << " in frame " << f;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Takes, FilteredCaptures,
                         testing::Values("animated_drawings/fair1_dab.bvh",
                                         "animated_drawings/fair1_zombie.bvh",
                                         "iclone_cmu/002_01.bvh", "walkset_cmu07/007_06.bvh"),
                         test::name_of_file);

}  // namespace
}  // namespace krok
