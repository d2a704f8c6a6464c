#include "parametric/step_direction_internal.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "motion/ground_frame.h"

namespace krok::parametric {

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
