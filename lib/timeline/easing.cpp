#include "timeline/easing.h"

#include <array>
#include <cmath>
#include <utility>

#include "math/hermite.h"
#include "math/transform.h"

namespace krok::timeline {

namespace {

constexpr std::array<std::pair<Curve, std::string_view>, 12> kCurves = {
    {{Curve::linear, "linear"},
     {Curve::smooth, "smooth"},
     {Curve::smoother, "smoother"},
     {Curve::quad, "quad"},
     {Curve::cubic, "cubic"},
     {Curve::quart, "quart"},
     {Curve::sine, "sine"},
     {Curve::expo, "expo"},
     {Curve::circ, "circ"},
     {Curve::back, "back"},
     {Curve::elastic, "elastic"},
     {Curve::bounce, "bounce"}}};
constexpr std::array<std::pair<Ease, std::string_view>, 3> kEases = {
    {{Ease::in, "-in"}, {Ease::out, "-out"}, {Ease::in_out, "-in-out"}}};

bool has_no_direction(Curve curve) {
  return curve == Curve::linear || curve == Curve::smooth || curve == Curve::smoother;
}

// Four parabolas, each half as wide as the previous one.
double bounce_out(double u) {
  constexpr double kSteep = 7.5625, kPart = 2.75;
  if (u < 1 / kPart) return kSteep * u * u;
  if (u < 2 / kPart) return kSteep * (u - 1.5 / kPart) * (u - 1.5 / kPart) + 0.75;
  if (u < 2.5 / kPart) return kSteep * (u - 2.25 / kPart) * (u - 2.25 / kPart) + 0.9375;
  return kSteep * (u - 2.625 / kPart) * (u - 2.625 / kPart) + 0.984375;
}

// Penner's oscillation with the given period; it ends a quarter period after its last zero.
double elastic_in(double u, double period) {
  return -std::exp2(10 * (u - 1)) * std::sin((u - 1 - period / 4) * 2 * kPi / period);
}

// The ease-in curve. back and elastic use different constants in the halves of in-out.
double eased_in(Curve curve, double u, bool half) {
  switch (curve) {
    case Curve::quad:
      return u * u;
    case Curve::cubic:
      return u * u * u;
    case Curve::quart:
      return u * u * u * u;
    case Curve::sine:
      return 1 - std::cos(u * kPi / 2);
    case Curve::expo:
      return std::exp2(10 * (u - 1));
    case Curve::circ:
      return 1 - std::sqrt(1 - u * u);
    case Curve::back: {
      const double beyond = 1.70158 * (half ? 1.525 : 1);
      return u * u * ((beyond + 1) * u - beyond);
    }
    case Curve::elastic:
      return elastic_in(u, half ? 0.45 : 0.3);
    case Curve::bounce:
      return 1 - bounce_out(1 - u);
    default:
      return u;
  }
}

}  // namespace

double Easing::at(double u) const {
  if (!(u > 0)) return 0;
  if (u >= 1) return 1;
  if (curve == Curve::linear) return u;
  if (curve == Curve::smooth) return u * u * (3 - 2 * u);
  if (curve == Curve::smoother) return smoother_step(u);
  if (ease == Ease::in) return eased_in(curve, u, false);
  if (ease == Ease::out) return 1 - eased_in(curve, 1 - u, false);
  return u < 0.5 ? 0.5 * eased_in(curve, 2 * u, true) : 1 - 0.5 * eased_in(curve, 2 - 2 * u, true);
}

std::string easing_name(const Easing& easing) {
  std::string name;
  for (const auto& [curve, word] : kCurves) {
    if (curve == easing.curve) name = word;
  }
  if (has_no_direction(easing.curve)) return name;
  for (const auto& [ease, word] : kEases) {
    if (ease == easing.ease) name += word;
  }
  return name;
}

std::optional<Easing> parse_easing(std::string_view name) {
  for (const auto& [curve, word] : kCurves) {
    if (name == word) return Easing{curve, Ease::in_out};
    if (has_no_direction(curve) || !name.starts_with(word)) continue;
    for (const auto& [ease, end] : kEases) {
      if (name.substr(word.size()) == end) return Easing{curve, ease};
    }
  }
  return std::nullopt;
}

std::vector<std::string> easing_names() {
  std::vector<std::string> names;
  for (const auto& [curve, word] : kCurves) {
    for (const auto& [ease, end] : kEases) {
      if (has_no_direction(curve) && ease != Ease::in_out) continue;
      names.push_back(easing_name({curve, ease}));
    }
  }
  return names;
}

}  // namespace krok::timeline
