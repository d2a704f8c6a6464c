// If these fail, an animation is sampled at a rate that is not its own: keys fall between frames,
// the motion is too fast, or its end is cut off.

#include <gtest/gtest.h>

#include "character/sampling.h"
#include "scenes.h"

namespace krok::test {
namespace {

using namespace character;

nodes::Animation keyed(std::vector<float> times) {
  nodes::Animation animation;
  std::vector<float> values(times.size() * 3, 0.0f);
  add_channel(animation, 0, nodes::Path::translation, 3, std::move(times), std::move(values));
  return animation;
}

ChosenSampling chosen(const nodes::Animation& animation, const SamplingOptions& options = {}) {
  Diagnostics diagnostics;
  const auto result = choose_sampling(animation, options, diagnostics);
  EXPECT_TRUE(result.ok());
  return result.ok() ? *result : ChosenSampling();
}

TEST(Sampling, EvenKeysGiveTheirRate) {
  for (const double rate : {24.0, 25.0, 30.0, 50.0, 60.0, 120.0, 240.0, 30 / 1.001, 72.0}) {
    const auto result = chosen(keyed(even_times(2000, rate, 0.5)));
    EXPECT_DOUBLE_EQ(result.sampling.rate, rate);
    EXPECT_EQ(result.sampling.frames, 2000) << rate;
    EXPECT_EQ(result.sampling.start, 0.5);
    EXPECT_EQ(result.rate.confidence, Confidence::certain);
  }
}

// Readers add keys between those of splines: 1.4 s of an FBX became 1,313 frames.
TEST(Sampling, KeysBetweenFramesAreNoFrames) {
  nodes::Animation animation = keyed(even_times(1600, 960, 0));
  animation.rate = 60;
  EXPECT_EQ(chosen(animation).sampling.rate, 60);
  EXPECT_EQ(chosen(animation).sampling.frames, 101);
  animation.rate = 0;
  EXPECT_EQ(chosen(animation).sampling.rate, 960) << "frames, for all that is known";
  animation = keyed(even_times(400, 240, 0));
  animation.rate = 60;
  EXPECT_EQ(chosen(animation).sampling.rate, 240) << "a rate of captures";
}

TEST(Sampling, LongMotionsKeepTheirRateDespiteFloats) {
  const auto result = chosen(keyed(even_times(100000, 60, 0)));
  EXPECT_EQ(result.sampling.rate, 60);
  EXPECT_EQ(result.sampling.frames, 100000);
}

// So late, floats are coarser than frames: any time would be near enough to one.
TEST(Sampling, LateUnevenKeysDoNotPassForFrames) {
  std::vector<float> times;
  for (int i = 0; i < 40; ++i) {
    times.push_back(static_cast<float>(70000 + i + 0.5 * std::fmod(i * 0.618034, 1.0)));
  }
  const auto result = chosen(keyed(times));
  EXPECT_EQ(result.sampling.rate, 60);
  EXPECT_EQ(result.rate.confidence, Confidence::guess);
}

TEST(Sampling, TimesOfThreeDecimalsAreUnderstood) {
  std::vector<float> times;
  for (int i = 0; i < 50; ++i) times.push_back(static_cast<float>(std::round(i / 0.03) / 1000));
  const auto result = chosen(keyed(times));
  EXPECT_EQ(result.sampling.rate, 30);
  EXPECT_EQ(result.sampling.frames, 50);
}

// A hold before keys of each frame whose times an exporter rounded to 8,192nds of a second: 60 fps
// were taken instead of 100, and steps between them shook.
TEST(Sampling, AHoldBeforeRoundedTimesIsNoOtherRate) {
  std::vector<float> times = {0};
  for (int i = 10; i < 900; ++i) {
    times.push_back(static_cast<float>(std::round(0.01 * i * 8192) / 8192));
  }
  EXPECT_EQ(chosen(keyed(times)).sampling.rate, 100);
  EXPECT_EQ(chosen(keyed(times)).sampling.frames, 900);
}

TEST(Sampling, SparseKeysFallOnFrames) {
  const auto result = chosen(keyed({0, 10 / 30.0f, 11 / 30.0f, 2}));
  EXPECT_EQ(result.sampling.rate, 30);
  EXPECT_EQ(result.sampling.frames, 61);
  EXPECT_EQ(result.rate.confidence, Confidence::likely);
  // A film's sixth and a television's.
  EXPECT_EQ(chosen(keyed({0, 1 / 24.0f, 1})).sampling.rate, 24);
  EXPECT_EQ(chosen(keyed({0, 1 / 25.0f, 1})).sampling.rate, 25);
}

TEST(Sampling, ChannelsOfDifferentTimesAreTakenTogether) {
  nodes::Animation animation = keyed({0, 0.5f});
  add_channel(animation, 1, nodes::Path::rotation, 4, {0.25f, 1.0f}, {0, 0, 0, 1, 0, 0, 0, 1});
  const auto result = chosen(animation);
  EXPECT_EQ(result.keys_from, 0);
  EXPECT_EQ(result.keys_to, 1);
}

TEST(Sampling, UnevenKeysAreSampledAtSixty) {
  const auto result = chosen(keyed({0, 0.1234f, 0.456f, 0.99991f}));
  EXPECT_EQ(result.sampling.rate, 60);
  EXPECT_EQ(result.rate.confidence, Confidence::guess);
  EXPECT_EQ(result.sampling.frames, 61);  // the last key is reached
}

// Assimp adds keys where Euler angles go far round: packs with a key a frame were read at 60 fps,
// with poses from halfway round in every other frame.
TEST(Sampling, KeysBesideThoseOfEachFrameAreBetweenFrames) {
  std::vector<float> times = even_times(25, 30);
  times.insert(times.begin() + 8, {0.2389f, 0.2512f});
  const auto result = chosen(keyed(times));
  EXPECT_EQ(result.sampling.rate, 30);
  EXPECT_EQ(result.sampling.frames, 25);
  times.erase(times.begin() + 15);
  EXPECT_EQ(chosen(keyed(times)).sampling.rate, 60) << "a frame without a key";
}

TEST(Sampling, TheLastKeyIsReached) {
  SamplingOptions options;
  options.rate = 7;
  const auto result = chosen(keyed(even_times(31, 30)), options);
  EXPECT_EQ(result.sampling.frames, 8);
  EXPECT_GE(result.sampling.time(7) + 1e-9, 1.0);
  options.rate = 10;
  EXPECT_EQ(chosen(keyed(even_times(31, 30)), options).sampling.frames, 11);
}

// Rates of 1, 2, 5 and 7 fps came back as 30 and 60; and after --reduce few keys tell a rate.
TEST(Sampling, TheRateOfTheFileIsKept) {
  for (const double rate : {1.0, 2.0, 5.0, 7.0, 30.0}) {
    nodes::Animation animation = keyed(even_times(9, rate));
    animation.rate = rate;
    const auto result = chosen(animation);
    EXPECT_EQ(result.sampling.rate, rate);
    EXPECT_EQ(result.sampling.frames, 9);
  }
  nodes::Animation other = keyed(even_times(9, 24));
  other.rate = 7;  // not that of its keys
  EXPECT_EQ(chosen(other).sampling.rate, 24);
  nodes::Animation few = keyed({0, 4 / 7.0f, 1});
  few.rate = 7;
  EXPECT_EQ(chosen(few).sampling.frames, 8);
}

TEST(Sampling, GivenRatesRetime) {
  SamplingOptions options;
  options.source_rate = 60;
  const auto faster = chosen(keyed(even_times(31, 30)), options).sampling;
  EXPECT_EQ(faster.frames, 31);
  EXPECT_EQ(faster.rate, 60);
  EXPECT_NEAR(faster.time(30), 1.0, 1e-12);
  options.rate = 30;
  const auto both = chosen(keyed(even_times(31, 30)), options).sampling;
  EXPECT_EQ(both.frames, 16);
  EXPECT_EQ(both.rate, 30);
  EXPECT_NEAR(both.time(15), 1.0, 1e-12);

  Diagnostics diagnostics;
  options.rate.reset();
  const auto uneven = choose_sampling(keyed({0, 0.1234f, 0.456f, 0.99991f}), options, diagnostics);
  ASSERT_FALSE(uneven.ok());
  EXPECT_EQ(uneven.error().code, "scene-rate");
}

TEST(Sampling, FewKeys) {
  EXPECT_EQ(chosen(nodes::Animation()).sampling.frames, 1);
  const auto one = chosen(keyed({3}));
  EXPECT_EQ(one.sampling.frames, 1);
  EXPECT_EQ(one.sampling.start, 3);
}

// A clip of glTF whose first key is at 1/30 s came back a frame early, 108 mm off: viewers hold the
// first key until its time.
TEST(Sampling, FramesBeforeTheFirstKeyOfGltfAreKept) {
  const auto late = [](double start, double rate = 30, const SamplingOptions& options = {}) {
    nodes::Animation animation = keyed(even_times(31, rate, start));
    animation.from_zero = true;
    return chosen(animation, options).sampling;
  };
  struct Case {
    double start, rate, result_rate, result_start;
    int frames;
  };
  for (const Case& one : {Case{0, 30, 30, 0, 31}, Case{1 / 30.0, 30, 30, 0, 32},
                          Case{0.5, 30, 30, 0, 46}, Case{1 / 24.0, 24, 24, 0, 32},
                          // On frames from 0 at another rate only; at none; too late.
                          Case{1 / 24.0, 30, 120, 0, 126}, Case{0.0123, 30, 30, 0.0123, 31},
                          Case{70, 30, 30, 70, 31}}) {
    const Sampling found = late(one.start, one.rate);
    EXPECT_DOUBLE_EQ(found.rate, one.result_rate) << one.start;
    EXPECT_NEAR(found.start, one.result_start, 1e-5) << one.start;
    EXPECT_EQ(found.frames, one.frames) << one.start;
  }
  EXPECT_EQ(late(0.0123, 30, {.source_rate = {}, .rate = 60}).start, 0);
  EXPECT_EQ(late(1 / 30.0, 30, {.source_rate = 60, .rate = {}}).frames, 32);
}

TEST(Sampling, AShiftAgainstViewersIsAWarning) {
  const auto severity = [](double start) {
    nodes::Animation animation = keyed(even_times(31, 30, start));
    animation.from_zero = true;
    Diagnostics diagnostics;
    EXPECT_TRUE(choose_sampling(animation, {}, diagnostics).ok());
    for (const Diagnostic& one : diagnostics) {
      if (one.code == "scene-start") return one.severity;
    }
    return Severity::error;
  };
  EXPECT_EQ(severity(0.0123), Severity::warning);
  EXPECT_EQ(severity(0.5), Severity::note);
}

TEST(Sampling, EndlessTimesAreAnError) {
  Diagnostics diagnostics;
  for (const float end : {1e9f, 1e30f, 3e38f}) {
    const auto result = choose_sampling(keyed({0, 0.001f, end}), {}, diagnostics);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, "scene-too-long");
  }
}

}  // namespace
}  // namespace krok::test
