// If these fail, lips stay open at b, m and p, mouths jump or open in pauses, weights exceed 1 in
// sum, or a phoneme is read as another.

#include "face/visemes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/index.h"

namespace krok::face {
namespace {

std::vector<Shape> unit_shapes() {
  const std::size_t count = viseme_names().size();
  std::vector<Shape> shapes(count, Shape(count, 0.0));
  for (std::size_t v = 0; v < count; ++v) shapes[v][v] = 1;
  return shapes;
}

std::size_t place_of(std::string_view name) {
  return static_cast<std::size_t>(std::ranges::find(viseme_names(), name) - viseme_names().begin());
}

// 10 s of sounds of 40 to 180 ms, with pauses; every fourth closes the lips.
std::vector<Phoneme> speech() {
  const char* const kSounds[] = {"P",  "AA1", "T",  "IY0", "M", "OW1", "S", "AH0", "B",
                                 "UW", "K",   "EH", "M",   "B", "AY1", "F", "sil", "P"};
  std::vector<Phoneme> list;
  double now = 0.1;
  for (std::size_t i = 0; now < 10; ++i) {
    const double length = 0.04 + 0.02 * static_cast<double>((i * 5) % 8);
    list.push_back({now, now + length, kSounds[i % std::size(kSounds)], {"t.TextGrid", 1, 1}});
    now += length;
  }
  return list;
}

VisemeTrack track_of(const std::vector<Phoneme>& phonemes, double hold) {
  auto track = VisemeTrack::create(phonemes, Alphabet::automatic, unit_shapes(), hold);
  EXPECT_TRUE(track.ok());
  return *track;
}

std::vector<double> at(const VisemeTrack& track, double seconds) {
  std::vector<double> weights(viseme_names().size(), 0.0);
  track.at(seconds, weights);
  return weights;
}

TEST(Visemes, WeightsAreAtMostOneInSumAndNeverNegative) {
  const VisemeTrack track = track_of(speech(), 1.0 / 30);
  for (double t = -0.5; t < 10.8; t += 0.0007) {
    const auto weights = at(track, t);
    EXPECT_LE(std::accumulate(weights.begin(), weights.end(), 0.0), 1 + 1e-12) << t;
    EXPECT_GE(*std::ranges::min_element(weights), 0) << t;
  }
}

// A velocity that jumps would stay as large however short the step.
TEST(Visemes, VelocityIsContinuous) {
  const VisemeTrack track = track_of(speech(), 1.0 / 30);
  const double step = 1e-5;
  double largest = 0, fastest = 0;
  for (double t = 0; t < 10.2; t += 0.00037) {
    const auto a = at(track, t - step), b = at(track, t), c = at(track, t + step);
    for (std::size_t v = 0; v < a.size(); ++v) {
      largest = std::max(largest, std::abs(c[v] - 2 * b[v] + a[v]) / step);
      fastest = std::max(fastest, std::abs(c[v] - b[v]) / step);
    }
  }
  EXPECT_LT(largest, 0.5);  // of the change of velocity in 10 microseconds
  EXPECT_GT(fastest, 10);   // beside velocities of
}

TEST(Visemes, LipsAreClosedInAFrameAtEachBMAndP) {
  for (const double rate : {12.0, 24.0, 30.0, 60.0, 120.0}) {
    const auto phonemes = speech();
    const VisemeTrack track = track_of(phonemes, 1.001 / rate);
    int closures = 0;
    for (const Phoneme& phoneme : phonemes) {
      if (phoneme.label != "P" && phoneme.label != "B" && phoneme.label != "M") continue;
      ++closures;
      const double centre = 0.5 * (phoneme.start + phoneme.end);
      const double frame = std::round(centre * rate) / rate;
      EXPECT_NEAR(at(track, centre)[0], 1, 1e-12);
      EXPECT_NEAR(at(track, frame)[0], 1, 1e-9) << rate << ' ' << centre;
    }
    EXPECT_GT(closures, 20);
  }
}

TEST(Visemes, AreWhatCohenAndMassaroSay) {
  const std::vector<Phoneme> phonemes = {{0, 0.06, "AA", {}}, {0.06, 0.12, "IY", {}}};
  const VisemeTrack track = track_of(phonemes, 0);
  // Segments of 60 ms have no middle part; pauses before and after begin 30 ms from their ends.
  for (double t = -0.1; t < 0.3; t += 0.013) {
    const auto dominance = [&](double alpha, double tau) {
      return alpha * std::exp(-tau * tau / (0.09 * 0.09));
    };
    const double aa = dominance(1, t - 0.03), ih = dominance(1, t - 0.09);
    const double rest =
        dominance(0.7, std::max(0.0, t + 0.03)) + dominance(0.7, std::max(0.0, 0.15 - t));
    EXPECT_NEAR(at(track, t)[place_of("aa")], aa / (aa + ih + rest), 1e-12) << t;
    EXPECT_NEAR(at(track, t)[place_of("ih")], ih / (aa + ih + rest), 1e-12) << t;
  }
}

TEST(Visemes, PausesAreStill) {
  const std::vector<Phoneme> phonemes = {
      {0, 0.1, "AA", {}}, {0.1, 2.1, "", {}}, {2.1, 2.2, "OW", {}}};
  const VisemeTrack track = track_of(phonemes, 0);
  for (const double t : {-3.0, 0.5, 1.1, 1.7, 5.0, 50.0, -50.0}) {
    const auto weights = at(track, t);
    EXPECT_LT(*std::ranges::max_element(weights), 1e-3) << t;
  }
}

TEST(Visemes, LabelsOfThreeAlphabets) {
  const auto name = [](const char* label, Alphabet alphabet) {
    std::string names;
    const auto found = visemes_of(label, alphabet);
    if (!found) return std::string("unknown");
    for (const std::size_t v : *found) names += std::string(viseme_names()[v]) + " ";
    return names;
  };
  EXPECT_EQ(name("AY1", Alphabet::arpabet), "aa ih ");
  EXPECT_EQ(name("T", Alphabet::arpabet), "DD ");
  EXPECT_EQ(name("T", Alphabet::sampa), "TH ");
  EXPECT_EQ(name("ˈaɪ", Alphabet::ipa), "aa ih ");
  EXPECT_EQ(name("t͡ʃ", Alphabet::ipa), "CH ");
  EXPECT_EQ(name("uː", Alphabet::ipa), "ou ");
  EXPECT_EQ(name("{", Alphabet::sampa), "aa ");
  EXPECT_EQ(name("sil", Alphabet::ipa), "");
  EXPECT_EQ(name("ǃ", Alphabet::ipa), "unknown");
  EXPECT_EQ(alphabet_of(speech()), Alphabet::arpabet);
  const std::vector<Phoneme> german = {{0, 1, "ʃ", {}}};
  const std::vector<Phoneme> sampa = {{0, 1, "S", {}}, {1, 2, "u:", {}}};
  EXPECT_EQ(alphabet_of(german), Alphabet::ipa);
  EXPECT_EQ(alphabet_of(sampa), Alphabet::sampa);
  // A label that is wrong does not change the alphabet that the error names.
  std::vector<Phoneme> wrong = speech();
  wrong.push_back({9, 10, "é", {}});
  EXPECT_EQ(alphabet_of(wrong), Alphabet::arpabet);
}

TEST(Visemes, MistakesAreTold) {
  const std::vector<Phoneme> unknown = {{0, 1, "XX", {"a.TextGrid", 7, 3}}};
  const auto none = VisemeTrack::create(unknown, Alphabet::arpabet, unit_shapes(), 0);
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.error().code, "face-phoneme");
  EXPECT_EQ(none.error().where.line, 7);
  const std::vector<Phoneme> back = {{0, 1, "P", {}}, {0.5, 2, "P", {}}};
  EXPECT_FALSE(VisemeTrack::create(back, Alphabet::arpabet, unit_shapes(), 0).ok());
  const VisemeTrack empty = track_of({}, 0);
  EXPECT_EQ(at(empty, 1), std::vector<double>(viseme_names().size(), 0.0));
}

}  // namespace
}  // namespace krok::face
