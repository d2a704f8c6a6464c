#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "blend/time_map.h"
#include "core/result.h"
#include "scene/morph_set.h"
#include "skin/morph.h"
#include "timeline/timeline.h"

// Mouth shapes (visemes) for a list of phonemes, with coarticulation.
//
// Source: Cohen and Massaro, Modeling coarticulation in synthetic visual speech (Models and
// Techniques in Computer Animation, 1993): each segment s has a dominance over time,
// D_s(t) = alpha_s exp(-theta_s |tau|^c), and the face is sum_s D_s T_s / sum_s D_s, with T_s the
// segment's shape. Here c is 2, so that the result has a continuous velocity, and one dominance
// holds for the whole shape of a segment, so that weights that are at most 1 in sum for each
// segment are so at all times. tau is the distance to the middle part of a segment, not to its
// centre: a long pause stays a pause. Where lips close, the dominance of all others falls smoothly
// to 0: a weighted mean alone would leave them open. alpha and theta are Krok's own.

namespace krok::face {

struct Phoneme {
  double start = 0, end = 0;  // seconds, start < end
  std::string label;
  Location where;  // for messages
};

enum class Alphabet : unsigned char { automatic, arpabet, ipa, sampa };

// The visemes, as they are widely named: PP, FF, TH, DD, kk, CH, SS, nn, RR, aa, E, ih, oh, ou.
std::span<const std::string_view> viseme_names();

// The alphabet that labels are written in: the one that has most of them; of equals the first of
// ARPAbet, X-SAMPA and IPA.
Alphabet alphabet_of(std::span<const Phoneme> phonemes);

// Indices into viseme_names() of a label: none for a pause, two for a diphthong. Stress and length
// marks are ignored. Nothing if it is not in the alphabet, which must not be automatic.
std::optional<std::vector<std::size_t>> visemes_of(std::string_view label, Alphabet alphabet);

// The weights of morph targets that make a viseme.
using Shape = std::vector<double>;  // [targets], >= 0, at most 1 in sum

// Mouth shapes over time. Const members are safe to call from several threads.
class VisemeTrack {
 public:
  // Phonemes by time, which do not overlap; gaps are pauses. `shapes`: one for each viseme.
  // `hold`: lips that close stay so for this long at least, seconds; a little more than a frame
  // makes sure that one shows it. Codes, with the phoneme's location: face-phoneme (not in the
  // alphabet; the hint names it), face-time.
  static Result<VisemeTrack> create(std::span<const Phoneme> phonemes, Alphabet alphabet,
                                    std::span<const Shape> shapes, double hold);

  // Adds the weights at a time, [targets].
  void at(double seconds, std::span<double> weights) const;

  double duration() const { return segments_.empty() ? 0 : segments_.back().end; }

  struct Segment {
    double start = 0, end = 0;
    int shape = -1;       // of the shapes; -1: the mouth at rest
    double strength = 0;  // ln alpha
    double width = 0.1;   // theta^(-1/2), seconds
    bool closes = false;  // lips
  };
  const std::vector<Segment>& segments() const { return segments_; }

 private:
  double dominance(const Segment& segment, double seconds) const;  // ln D

  std::vector<Segment> segments_;  // without gaps, from a pause to a pause
  std::vector<Shape> shapes_;
  double hold_ = 0;
};

// Blinks at human intervals.

struct BlinkOptions {
  // Means of adults: 17 a minute at rest, 26 in conversation, 4.5 reading. Source: Bentivoglio et
  // al., Analysis of blink rate patterns in normal subjects (Movement Disorders 12, 1997).
  double per_minute = 26;  // > 0, at most 60
  std::uint64_t seed = 1;
  // The lid closes about twice as fast as it opens. Seconds; Krok's own, within what is measured.
  double closing = 0.08, closed = 0.03, opening = 0.16;
};

// When lids begin to close, seconds from 0, up to `duration`. Intervals are log-normal with the
// wanted mean, as measured ones have a long tail; their spread (sigma 0.5) is Krok's own. The first
// comes after a part of an interval. The same seed gives the same blinks.
std::vector<double> blink_times(double duration, const BlinkOptions& options);

// How far lids are closed, 0 to 1, with continuous velocity.
double blink_at(double seconds, const std::vector<double>& times, const BlinkOptions& options);

// Several animations of a face, one above the other, as morph weights over time.

struct Item {
  // Sets the weights of the targets that it has, [targets], at a time since its start.
  std::function<void(double seconds, std::span<double> weights)> at;
  std::vector<char> has;      // [targets] 1: it moves this one
  double start = 0, end = 0;  // seconds of the result
  timeline::Fade fade_in, fade_out;
  blend::WeightCurve weight = blend::WeightCurve::constant(1);  // over seconds since its start
  bool additive = false;  // adds to what is below; otherwise replaces it
};

// Of curves for targets of the same names; those with keys are moved. The curves are copied.
Item item_of(MorphCurves curves);

// Weights of frames 0 to frames - 1. Items are applied in their order: with a strength s of fades
// and weight, one that replaces gives (1 - s) below + s own, as cross-fades of motions do. Code
// morph-too-long for more than 100 million weights.
Result<MorphWeights> mix(std::span<const std::string> targets, std::span<const Item> items,
                         double rate, int frames);

}  // namespace krok::face
