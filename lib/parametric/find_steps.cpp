#include "parametric/find_steps_internal.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "core/numbers.h"
#include "motion/hips_root.h"

namespace krok::parametric {

namespace {

constexpr double kRestSpeed = 0.06;    // metres per second, of the hips over the ground
constexpr double kRestWindow = 0.1;    // seconds, over which speeds are taken
constexpr double kShortestRest = 0.1;  // seconds
constexpr double kWeightShift = 1.5;   // seconds at most from the last rest to the off
constexpr double kSettled = 0.2;       // seconds of a rest that belong to a start or a stop
constexpr double kShortestStand = 0.5;
constexpr double kLongestFlight = 0.3;  // seconds

struct Span {
  double begin = 0, end = 0;  // seconds
};

bool is_off(const Keytime& key) {
  return key.name.ends_with("_off");
}

std::string off_of(FootSide side) {
  return fmt::format("{}_off", name_of(side));
}

// When the hips rest.
std::vector<Span> rests_of(const Clip& clip, int carrier) {
  const int reach = std::max(1, static_cast<int>(std::lround(0.5 * kRestWindow * clip.rate)));
  std::vector<Span> rests;
  bool rested = false;
  for (int f = 0; f < clip.frame_count(); ++f) {
    const int a = std::max(0, f - reach), b = std::min(clip.frame_count() - 1, f + reach);
    const Vec3f way = clip.frame_positions(b)[at(carrier)] - clip.frame_positions(a)[at(carrier)];
    const bool rest = b > a && std::hypot(way.x(), way.z()) * clip.rate / (b - a) < kRestSpeed;
    if (rest && !rested) rests.push_back({f / clip.rate, 0});
    if (rest) rests.back().end = f / clip.rate;
    rested = rest;
  }
  std::erase_if(rests, [](const Span& rest) { return rest.end - rest.begin < kShortestRest; });
  return rests;
}

bool any_key(const MotionKeys& keys, double after, double before) {
  return std::ranges::any_of(keys.keytimes, [&](const Keytime& key) {
    return key.time > after + 1e-9 && key.time < before - 1e-9;
  });
}

std::vector<FoundStep> steps_between_strikes(const MotionKeys& keys, const CutOptions& options) {
  std::vector<FoundStep> steps;
  const auto strikes = strikes_of(keys);
  for (std::size_t i = 0; i + 1 < strikes.size(); ++i) {
    FoundStep step;
    step.swing = strikes[i + 1].side;
    if (step.swing != options.swing && !options.mirror) continue;
    const double start = strikes[i].time, end = strikes[i + 1].time;
    const bool runs = options.gait == StepGait::run;
    const std::string off = off_of(runs ? strikes[i].side : step.swing);
    step.times = {start, start, end};
    int offs = 0;
    bool flies = false;  // the swing foot leaves before the stance foot strikes
    for (const Keytime& key : keys.keytimes) {
      flies = flies || (key.name == off && key.time <= start && key.time > start - kLongestFlight);
      if (key.name != off || key.time <= start || key.time >= end) continue;
      ++offs;
      step.times[1] = key.time;
    }
    const double lasts = end - start;
    if (strikes[i].side == step.swing) {
      step.fault = fmt::format("the {} foot strikes twice in a row", name_of(step.swing));
    } else if (offs != 1) {
      step.fault =
          offs == 0 && flies
              ? fmt::format(R"({} ("steps": "runs" takes such steps))", kOfARun)
              : fmt::format("{} {} between the strikes", offs == 0 ? "no" : "more than one", off);
    } else if (lasts < options.shortest || lasts > options.longest) {
      step.fault = fmt::format("{} s is too {}", readable(lasts, 3),
                               lasts < options.shortest ? "short" : "long");
    }
    steps.push_back(std::move(step));
  }
  return steps;
}

// First steps: an off that nothing but a rest comes before.
std::vector<FoundStep> starts_of(const Clip& clip, int carrier, const MotionKeys& keys,
                                 const CutOptions& options) {
  std::vector<FoundStep> steps;
  const std::vector<Span> rests = rests_of(clip, carrier);
  for (const Keytime& off : keys.keytimes) {
    if (!is_off(off)) continue;
    const FootSide side = off.name == off_of(FootSide::left) ? FootSide::left : FootSide::right;
    if (side != options.swing && !options.mirror) continue;
    const auto rest = std::ranges::find_if(rests.rbegin(), rests.rend(), [&](const Span& one) {
      return one.begin < off.time - kShortestRest;
    });
    if (rest == rests.rend()) continue;
    const double settled = std::min(kSettled, 0.5 * (rest->end - rest->begin));
    const double stands = std::min(rest->end - settled, off.time - kShortestRest);
    if (off.time - stands > kWeightShift || any_key(keys, stands, off.time)) continue;
    FoundStep step;
    step.swing = side;
    step.times = {stands, off.time, off.time};
    for (const Strike& strike : strikes_of(keys)) {
      if (strike.side != side || strike.time <= off.time) continue;
      step.times[2] = strike.time;
      break;
    }
    const double lasts = step.times[2] - stands;
    if (step.times[2] == off.time) step.fault = "its foot does not strike";
    if (lasts > 2 * options.longest)
      step.fault = fmt::format("{} s is too long", readable(lasts, 3));
    steps.push_back(std::move(step));
  }
  return steps;
}

// Last steps: from the stance foot's strike to the rest after the swing foot's.
std::vector<FoundStep> stops_of(const Clip& clip, int carrier, const MotionKeys& keys,
                                const CutOptions& options) {
  std::vector<FoundStep> steps;
  const std::vector<Span> rests = rests_of(clip, carrier);
  for (FoundStep& step : steps_between_strikes(keys, options)) {
    const double strike = step.times[2];
    const auto rest = std::ranges::find_if(
        rests, [&](const Span& one) { return one.end > strike + kShortestRest; });
    if (rest == rests.end()) continue;
    const double settled = std::min(kSettled, 0.5 * (rest->end - rest->begin));
    const double stands = std::max(rest->begin + settled, strike + kShortestRest);
    if (stands - strike > kWeightShift || any_key(keys, strike, stands)) continue;
    step.times.push_back(stands);
    steps.push_back(std::move(step));
  }
  return steps;
}

std::vector<FoundStep> stands_of(const Clip& clip, int carrier, const MotionKeys& keys,
                                 const CutOptions& options) {
  std::vector<FoundStep> stands;
  for (const Span& rest : rests_of(clip, carrier)) {
    if (rest.end - rest.begin < kShortestStand || any_key(keys, rest.begin, rest.end)) continue;
    stands.push_back({options.swing, {rest.begin, rest.end}, {}});
  }
  return stands;
}

}  // namespace

std::vector<std::string> keytimes_of(StepGait gait) {
  switch (gait) {
    case StepGait::run:
      return {"stance_strike", "stance_off", "swing_strike"};
    case StepGait::start:
      return {"stand", "swing_off", "swing_strike"};
    case StepGait::stop:
      return {"stance_strike", "swing_off", "swing_strike", "stand"};
    case StepGait::stand:
      return {"stand", "stand_end"};
    case StepGait::walk:
    case StepGait::backward:
    case StepGait::side:
    case StepGait::side_closing:
    case StepGait::turn:
    case StepGait::turn_closing:
      break;
  }
  return {"stance_strike", "swing_off", "swing_strike"};
}

std::vector<Strike> strikes_of(const MotionKeys& keys) {
  std::vector<Strike> strikes;
  for (const Keytime& key : keys.keytimes) {
    if (key.name == "left_strike") strikes.push_back({FootSide::left, key.time});
    if (key.name == "right_strike") strikes.push_back({FootSide::right, key.time});
  }
  return strikes;
}

std::vector<FoundStep> find_steps(const Clip& clip, int carrier, const MotionKeys& keys,
                                  const CutOptions& options) {
  if (options.gait == StepGait::start) return starts_of(clip, carrier, keys, options);
  if (options.gait == StepGait::stop) return stops_of(clip, carrier, keys, options);
  if (options.gait == StepGait::stand) return stands_of(clip, carrier, keys, options);
  return steps_between_strikes(keys, options);
}

namespace {

constexpr double kUsualLegLength = 0.86;  // metres, hip to ankle
constexpr double kOnTheSpot = 0.15;       // metres, way of the hips
constexpr double kTurning = 15 * kRadiansPerDegree;

// Position of the carrying joint at a time, linearly between frames.
Vec3 place_at(const Clip& clip, int carrier, double time) {
  const double frame = std::clamp(time * clip.rate, 0.0, clip.frame_count() - 1.0);
  const int before = static_cast<int>(frame);
  const int after = std::min(before + 1, clip.frame_count() - 1);
  const Vec3 a = clip.frame_positions(before)[at(carrier)].cast<double>();
  const Vec3 b = clip.frame_positions(after)[at(carrier)].cast<double>();
  return a + (frame - before) * (b - a);
}

}  // namespace

DirectedStep direction_of(const FoundStep& step, const Clip& clip, int carrier,
                          const std::array<FootShape, 2>& feet, double leg_length) {
  const double begin = step.times.front(), end = step.times.back();
  const FootShape& swing = feet[static_cast<std::size_t>(step.swing)];
  const FootShape& stance = feet[1 - static_cast<std::size_t>(step.swing)];
  const double swing_side = step.swing == FootSide::left ? 1 : -1;
  const double from = print_at(stance, clip, begin).heading;
  const double to = print_at(swing, clip, end).heading;
  const double facing = from + 0.5 * wrapped(to - from);
  const Vec3 way = place_at(clip, carrier, end) - place_at(clip, carrier, begin);
  const double scale = leg_length > 0 ? leg_length / kUsualLegLength : 1;
  DirectedStep found;
  if (std::hypot(way.x(), way.z()) < kOnTheSpot * scale) {
    const double turn = wrapped(to - print_at(swing, clip, begin).heading);
    if (std::abs(turn) < kTurning) return found;
    found.direction = StepDirection::turn;
    found.leads = swing_side * turn > 0;
    return found;
  }
  const double angle = wrapped(std::atan2(way.x(), way.z()) - facing);
  found.direction = std::abs(angle) < kPi / 4       ? StepDirection::forward
                    : std::abs(angle) > 3 * kPi / 4 ? StepDirection::backward
                                                    : StepDirection::side;
  found.leads = swing_side * angle > 0;
  return found;
}

std::string wrong_direction(const DirectedStep& step, StepGait gait) {
  switch (gait) {
    case StepGait::start:
    case StepGait::stop:
    case StepGait::stand:
      return {};
    case StepGait::walk:
    case StepGait::run:
      switch (step.direction) {
        case StepDirection::forward:
        case StepDirection::in_place:
          return {};
        case StepDirection::backward:
          return "it goes backward (\"steps\": \"backward\" takes such steps)";
        case StepDirection::side:
          return "it goes to the side (\"steps\": \"side\" takes such steps)";
        case StepDirection::turn:
          return "it turns on the spot (\"steps\": \"turns\" takes such steps)";
      }
      return {};
    case StepGait::backward:
      return step.direction == StepDirection::backward ? "" : "it does not go backward";
    case StepGait::side:
    case StepGait::side_closing:
      if (step.direction != StepDirection::side) return "it does not go to the side";
      break;
    case StepGait::turn:
    case StepGait::turn_closing:
      if (step.direction != StepDirection::turn) return "it does not turn on the spot";
      break;
  }
  const bool closing = gait == StepGait::side_closing || gait == StepGait::turn_closing;
  if (step.leads != closing) return {};
  return closing ? "its foot leads (\"_closing\" is for the foot that follows)"
                 : "its foot follows the other one (\"_closing\" takes such steps)";
}

}  // namespace krok::parametric
