#include "face/visemes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "timeline/easing.h"

namespace krok::face {

namespace {

constexpr double kPlateau = 0.03;    // seconds from a segment's ends to its middle part, at most
constexpr double kRelease = 0.05;    // seconds in which closed lips open
constexpr double kNothing = 40;      // of ln D: e^-40 is lost in rounding
constexpr double kPauseAround = 10;  // seconds of pause before and after
constexpr int kRest = -1;

constexpr std::array<std::string_view, 14> kNames = {"PP", "FF", "TH", "DD", "kk", "CH", "SS",
                                                     "nn", "RR", "aa", "E",  "ih", "oh", "ou"};

// alpha and width by viseme: lips dominate, the tongue behind the teeth gives way.
struct Manner {
  double alpha, width;
};
constexpr std::array<Manner, 14> kManners = {{{3, 0.06},
                                              {2, 0.06},
                                              {1, 0.06},
                                              {0.5, 0.06},
                                              {0.4, 0.06},
                                              {1, 0.07},
                                              {0.7, 0.06},
                                              {0.5, 0.06},
                                              {0.7, 0.07},
                                              {1, 0.09},
                                              {1, 0.09},
                                              {1, 0.09},
                                              {1, 0.09},
                                              {1, 0.09}}};
constexpr Manner kPause = {0.7, 0.09};

// Symbols of a viseme in each alphabet, between spaces. Two visemes: a diphthong.
struct Row {
  std::string_view visemes, arpabet, ipa, sampa;
};
constexpr Row kRows[] = {{"", " SIL SP SPN PAU NSN ", " ", " "},
                         {"PP", " P B M EM ", " p b m ", " p b m "},
                         {"FF", " F V ", " f v ɱ ", " f v F "},
                         {"TH", " TH DH ", " θ ð ", " T D "},
                         {"DD", " T D DX ", " t d ɾ ", " t d 4 "},
                         {"kk", " K G NG HH Q ", " k ɡ g ŋ x ɣ h ɦ ʔ ", " k g N x G h h\\ ? "},
                         {"CH", " CH JH SH ZH ", " tʃ dʒ ʃ ʒ ʧ ʤ ɕ ", " tS dZ S Z s\\ "},
                         {"SS", " S Z ", " s z ts dz ", " s z ts dz "},
                         {"nn", " N L EN EL ", " n l ɲ ʎ ɫ ", " n l J L 5 "},
                         {"RR", " R ER AXR ", " r ɹ ɝ ɚ ɜ ʁ ʀ ", " r r\\ 3` @` 3 R "},
                         {"aa", " AA AE AH ", " a ɑ æ ʌ ɐ ", " a A { V 6 "},
                         {"E", " EH AX ", " e ɛ ə ɘ ", " e E @ "},
                         {"ih", " IH IY Y IX ", " i ɪ j ɨ y ʏ ", " i I j 1 y Y "},
                         {"oh", " AO ", " o ɔ ɒ ", " o O Q "},
                         {"ou", " UH UW UX W ", " u ʊ w ʉ ø œ ", " u U w } 2 9 "},
                         {"aa ih", " AY ", " aɪ ai aj ", " aI "},
                         {"aa ou", " AW ", " aʊ au aw ", " aU "},
                         {"E ih", " EY ", " eɪ ei ɛɪ ", " eI "},
                         {"oh ih", " OY ", " ɔɪ ɔi ", " OI "},
                         {"oh ou", " OW ", " oʊ əʊ ou ", " oU @U "}};

constexpr std::string_view kPauses = "  sil sp spn pau # _ - <p:> <sil> ... ";

bool has(std::string_view symbols, std::string_view symbol) {
  if (symbol.empty() || symbol.find(' ') != std::string_view::npos) return false;
  return symbols.find(fmt::format(" {} ", symbol)) != std::string_view::npos;
}

// Without stress and length.
std::string bare(std::string_view label, Alphabet alphabet) {
  std::string symbol(trimmed(label));
  if (alphabet == Alphabet::arpabet) {
    while (!symbol.empty() && symbol.back() >= '0' && symbol.back() <= '2') symbol.pop_back();
    return symbol;
  }
  for (const std::string_view mark : {"ː", "ˑ", "ˈ", "ˌ", "͡", "\"", "%", ":"}) {
    for (std::size_t at = 0; (at = symbol.find(mark)) != std::string::npos;) {
      symbol.erase(at, mark.size());
    }
  }
  return symbol;
}

std::string_view symbols_of(const Row& row, Alphabet alphabet) {
  if (alphabet == Alphabet::arpabet) return row.arpabet;
  return alphabet == Alphabet::ipa ? row.ipa : row.sampa;
}

std::string_view alphabet_name(Alphabet alphabet) {
  if (alphabet == Alphabet::arpabet) return "ARPAbet";
  return alphabet == Alphabet::ipa ? "IPA" : "X-SAMPA";
}

// How far closed lips keep all other shapes away: 1 while they are closed, then falling to 0.
double closure(const VisemeTrack::Segment& segment, double hold, double seconds) {
  const double half = std::max(0.25 * (segment.end - segment.start), 0.5 * hold);
  const double away = std::abs(seconds - 0.5 * (segment.start + segment.end)) - half;
  return 1 - timeline::Easing().at(away / kRelease);
}

}  // namespace

std::span<const std::string_view> viseme_names() {
  return kNames;
}

std::optional<std::vector<std::size_t>> visemes_of(std::string_view label, Alphabet alphabet) {
  const std::string symbol = bare(label, alphabet);
  if (symbol.empty() || has(kPauses, ascii_lower(symbol))) return std::vector<std::size_t>();
  for (const Row& row : kRows) {
    if (!has(symbols_of(row, alphabet), symbol)) continue;
    std::vector<std::size_t> found;
    for (std::size_t v = 0; v < kNames.size(); ++v) {
      const std::size_t at = fmt::format(" {} ", row.visemes).find(fmt::format(" {} ", kNames[v]));
      // The first of a diphthong comes first.
      if (at != std::string::npos) found.insert(at == 0 ? found.begin() : found.end(), v);
    }
    return found;
  }
  return std::nullopt;
}

Alphabet alphabet_of(std::span<const Phoneme> phonemes) {
  Alphabet best = Alphabet::arpabet;
  std::ptrdiff_t most = -1;
  for (const Alphabet alphabet : {Alphabet::arpabet, Alphabet::sampa, Alphabet::ipa}) {
    const auto read = std::ranges::count_if(phonemes, [&](const Phoneme& phoneme) {
      return visemes_of(phoneme.label, alphabet).has_value();
    });
    if (read > most) most = read, best = alphabet;
  }
  return best;
}

Result<VisemeTrack> VisemeTrack::create(std::span<const Phoneme> phonemes, Alphabet alphabet,
                                        std::span<const Shape> shapes, double hold) {
  if (alphabet == Alphabet::automatic) alphabet = alphabet_of(phonemes);
  VisemeTrack track;
  track.shapes_.assign(shapes.begin(), shapes.end());
  track.hold_ = hold;
  const auto add = [&](double start, double end, int shape) {
    const Manner& manner = shape == kRest ? kPause : kManners[krok::at(shape)];
    track.segments_.push_back(
        {start, end, shape, std::log(manner.alpha), manner.width, shape == 0});
  };
  double now = phonemes.empty() ? 0 : phonemes.front().start - kPauseAround;
  for (const Phoneme& phoneme : phonemes) {
    const auto wrong = [&](std::string code, std::string message, std::string hint = {}) {
      Error error(std::move(code), std::move(message), std::move(hint));
      error.where = phoneme.where;
      return error;
    };
    if (!(phoneme.end > phoneme.start) || phoneme.start < now - 1e-9) {
      return wrong("face-time", fmt::format("'{}' from {} to {} s does not follow the one before",
                                            shown(phoneme.label), readable(phoneme.start),
                                            readable(phoneme.end)));
    }
    const auto visemes = visemes_of(phoneme.label, alphabet);
    if (!visemes) {
      return wrong(
          "face-phoneme",
          fmt::format("'{}' is no symbol of {}", shown(phoneme.label), alphabet_name(alphabet)),
          "mend the label, map it in \"symbols\", or name another \"alphabet\": arpabet, ipa, "
          "sampa");
    }
    if (phoneme.start > now + 1e-9) add(now, phoneme.start, kRest);
    now = phoneme.end;
    if (visemes->empty()) add(phoneme.start, phoneme.end, kRest);
    const double part = (phoneme.end - phoneme.start) / static_cast<double>(visemes->size());
    for (std::size_t i = 0; i < visemes->size(); ++i) {
      const double start = phoneme.start + static_cast<double>(i) * part;
      add(start, start + part, static_cast<int>((*visemes)[i]));
    }
  }
  if (!phonemes.empty()) add(now, now + kPauseAround, kRest);
  return track;
}

double VisemeTrack::dominance(const Segment& segment, double seconds) const {
  const double half = 0.5 * (segment.end - segment.start);
  const double away =
      std::max(0.0, std::abs(seconds - segment.start - half) - std::max(0.0, half - kPlateau)) /
      segment.width;
  return segment.strength - away * away;
}

void VisemeTrack::at(double seconds, std::span<double> weights) const {
  if (segments_.empty()) return;
  if (seconds <= segments_.front().start || seconds >= segments_.back().end) return;
  // All segments whose dominance may count: it falls with the distance beyond their ends.
  const auto middle =
      std::ranges::upper_bound(segments_, seconds, {}, &Segment::start) - segments_.begin() - 1;
  const double most = dominance(segments_[static_cast<std::size_t>(middle)], seconds);
  const double reach = 0.1 * std::sqrt(kNothing + std::max(0.0, 2 - most));
  auto first = middle, last = middle + 1;
  const auto count = std::ssize(segments_);
  const auto segment_at = [&](std::ptrdiff_t s) -> const Segment& {
    return segments_[static_cast<std::size_t>(s)];
  };
  while (first > 0 && segment_at(first - 1).end > seconds - reach) --first;
  while (last < count && segment_at(last).start < seconds + reach) ++last;
  double open = 1;  // what closed lips leave to others
  for (auto s = first; s < last; ++s) {
    if (segment_at(s).closes) open *= 1 - closure(segment_at(s), hold_, seconds);
  }
  double sum = 0;
  std::vector<double> shares(kNames.size(), 0.0);
  for (auto s = first; s < last; ++s) {
    const Segment& segment = segment_at(s);
    const double share = std::exp(dominance(segment, seconds) - most) * (segment.closes ? 1 : open);
    sum += share;
    if (segment.shape != kRest) shares[krok::at(segment.shape)] += share;
  }
  for (std::size_t v = 0; v < shares.size(); ++v) {
    if (shares[v] == 0) continue;
    for (std::size_t t = 0; t < weights.size(); ++t) {
      weights[t] += shares[v] / sum * shapes_[v][t];
    }
  }
}

namespace {

constexpr double kSigma = 0.5;

// SplitMix64 (Steele, Lea, Flood 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  // More than 0, less than 1.
  double uniform() {
    std::uint64_t value = state_ += 0x9e3779b97f4a7c15u;
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9u;
    value = (value ^ (value >> 27)) * 0x94d049bb133111ebu;
    return (static_cast<double>((value ^ (value >> 31)) >> 12) + 0.5) * 0x1p-52;
  }
  // Box and Muller.
  double normal() {
    const double radius = std::sqrt(-2 * std::log(uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace

std::vector<double> blink_times(double duration, const BlinkOptions& options) {
  std::vector<double> times;
  Random random(options.seed);
  const double mean = 60 / options.per_minute;
  const double length = options.closing + options.closed + options.opening;
  const auto interval = [&] {
    return std::max(length, mean * std::exp(kSigma * random.normal() - 0.5 * kSigma * kSigma));
  };
  for (double time = interval() * random.uniform(); time <= duration; time += interval()) {
    times.push_back(time);
  }
  return times;
}

double blink_at(double seconds, const std::vector<double>& times, const BlinkOptions& options) {
  const auto after = std::ranges::upper_bound(times, seconds);
  if (after == times.begin()) return 0;
  const double since = seconds - *(after - 1);
  return timeline::Easing().at(since / options.closing) -
         timeline::Easing().at((since - options.closing - options.closed) / options.opening);
}

namespace {

constexpr double kMaxWeights = 100e6;

double strength_at(const Item& item, double time) {
  if (time < item.start || time > item.end) return 0;
  double strength = item.weight.at(time - item.start);
  if (item.fade_in.duration > 0) {
    strength *= item.fade_in.easing.at((time - item.start) / item.fade_in.duration);
  }
  if (item.fade_out.duration > 0) {
    strength *= item.fade_out.easing.at((item.end - time) / item.fade_out.duration);
  }
  return strength;
}

}  // namespace

Item item_of(MorphCurves curves) {
  Item item;
  for (const MorphCurve& curve : curves.curves) item.has.push_back(curve.times.empty() ? 0 : 1);
  item.at = [shared = std::make_shared<const MorphCurves>(std::move(curves))](
                double seconds, std::span<double> weights) {
    for (std::size_t t = 0; t < weights.size(); ++t) {
      weights[t] = weight_at(shared->curves[t], seconds);
    }
  };
  return item;
}

Result<MorphWeights> mix(std::span<const std::string> targets, std::span<const Item> items,
                         double rate, int frames) {
  if (static_cast<double>(targets.size()) * frames > kMaxWeights) {
    return Error("morph-too-long", "the face has more than 100 million weights");
  }
  MorphWeights mixed;
  mixed.rate = rate;
  mixed.names.assign(targets.begin(), targets.end());
  std::vector<double> sum(targets.size()), own(targets.size());
  for (int frame = 0; frame < frames; ++frame) {
    const double time = frame / rate;
    std::ranges::fill(sum, 0.0);
    for (const Item& item : items) {
      const double strength = strength_at(item, time);
      if (strength == 0) continue;
      std::ranges::fill(own, 0.0);
      item.at(time - item.start, own);
      for (std::size_t t = 0; t < sum.size(); ++t) {
        if (item.has[t] == 0) continue;
        sum[t] = (item.additive ? sum[t] : (1 - strength) * sum[t]) + strength * own[t];
      }
    }
    for (const double weight : sum) mixed.values.push_back(static_cast<float>(weight));
  }
  return mixed;
}

}  // namespace krok::face
