#include "gait/body_motion_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numbers.h"
#include "gait/ground_prints_internal.h"
#include "motion/hips_root.h"

namespace krok::gait {

namespace {

using parametric::Quantity;

constexpr int kCorrections = 3;
constexpr double kFarOutside = 0.62;  // of the leg: how far a step may be from the nearest example
constexpr double kFarTurn = 60 * kRadiansPerDegree;
constexpr double kUsualRange = 0.4;  // metres, of a parameter of a library
constexpr double kTurnCost = 0.5;    // metres a radian
constexpr double kBeyond = 0.1;      // metres: steps that are longer or wider are warned of
constexpr int kBisections = 20;
constexpr int kBlendTries = 6;

// `is_asked`: see PlannedStep.
std::vector<double> parameters_for(const StepLibrary& steps, FootSide swing, const StepShape& to,
                                   const StepShape& from, double duration,
                                   std::vector<std::uint8_t>& is_asked) {
  const parametric::Library& library = steps.steps(swing).library();
  std::vector<double> asked(library.parameters.size(), 0);
  is_asked.assign(asked.size(), 1);
  for (std::size_t d = 0; d < asked.size(); ++d) {
    // At the first keytime the swing foot is on the print it comes from.
    const StepShape& shape = library.parameters[d].keytime == 0 ? from : to;
    switch (library.parameters[d].quantity) {
      case Quantity::step_length:
        asked[d] = shape.along;
        break;
      case Quantity::step_width:
        asked[d] = shape.across;
        break;
      case Quantity::step_height:
        asked[d] = shape.up;
        break;
      case Quantity::step_turn:
        asked[d] = shape.turn;
        break;
      case Quantity::path_turn:
        asked[d] = shape.path_turn;
        break;
      case Quantity::duration:
        asked[d] = duration;
        is_asked[d] = duration > 0 ? 1 : 0;
        break;
      case Quantity::joint:
        is_asked[d] = 0;
    }
  }
  take_usual(steps, swing, is_asked, asked);
  return asked;
}

// How far parameters are apart: metres of the foot's place, and radians of its heading.
struct Apart {
  double place = 0, turn = 0;
};
Apart apart(const parametric::Library& library, std::span<const double> a,
            std::span<const double> b) {
  Apart result;
  for (std::size_t d = 0; d < a.size(); ++d) {
    switch (library.parameters[d].quantity) {
      case Quantity::step_length:
      case Quantity::step_width:
      case Quantity::step_height:
        result.place = std::hypot(result.place, a[d] - b[d]);
        break;
      case Quantity::step_turn:
      case Quantity::path_turn:
        result.turn = std::abs(a[d] - b[d]);
        break;
      case Quantity::duration:
      case Quantity::joint:
        break;
    }
  }
  return result;
}

// Distance of a step from the nearest example in what their library has no parameter for.
Apart beyond(const StepLibrary& steps, const StepShape& shape) {
  const auto measures = [&](Quantity one, Quantity other) {
    return std::ranges::any_of(steps.library().parameters, [&](const parametric::Parameter& given) {
      return given.quantity == one || given.quantity == other;
    });
  };
  const double along = measures(Quantity::step_length, Quantity::step_length) ? 0 : 1;
  const double across = measures(Quantity::step_width, Quantity::step_width) ? 0 : 1;
  const double turn = measures(Quantity::step_turn, Quantity::path_turn) ? 0 : 1;
  Apart nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const FoundStep& step : steps.found_steps()) {
    const Apart here = {
        std::hypot(along * (shape.along - step.along), across * (shape.across - step.across)),
        turn * std::abs(shape.turn - step.turn)};
    const double far = here.place + kTurnCost * here.turn;
    if (far >= least) continue;
    least = far;
    nearest = here;
  }
  return nearest;
}

// Facing of the body above each print: the mean of the feet's headings, which does not depend on
// how far they turn out.
std::vector<double> facing_of(std::span<const Print> prints) {
  std::vector<double> result;
  for (std::size_t k = 0; k < prints.size(); ++k) {
    const double heading = prints[k].heading;
    const double before = k == 0 ? 0 : wrapped(prints[k - 1].heading - heading);
    const double after = k + 1 == prints.size() ? 0 : wrapped(prints[k + 1].heading - heading);
    const bool is_end = k == 0 || k + 1 == prints.size();
    result.push_back(heading + (is_end ? 0.5 : 0.25) * (before + after));
  }
  return result;
}

class Planner {
 public:
  Planner(std::span<const StepLibrary> libraries, const Walker& walker, const Terrain& ground,
          const WalkOptions& options)
      : libraries_(libraries), walker_(walker), ground_(ground), options_(options) {}

  Result<PlannedWalk> plan(std::span<const Print> prints);

 private:
  Status check_prints(std::span<const Print> prints) const;
  Status add_print(std::size_t number, Print print);
  Status try_print(std::size_t number, const Print& print, GroundedPrint& grounded,
                   PlannedStep& step) const;
  Status choose(const GroundedPrint& to, double duration, int number, PlannedStep& step) const;
  Status adapt(std::size_t number, const Print& wanted, const Error& why);
  // First and last steps are those of starts and stops where there are any.
  StepKind kind_of_step(int number) const {
    const bool is_first = number == 2, is_last = number + 1 == count_;
    const StepKind kind = is_first == is_last ? StepKind::walk
                          : is_first          ? StepKind::start
                                              : StepKind::stop;
    const auto found = std::ranges::find(libraries_, kind, &StepLibrary::kind);
    return found == libraries_.end() ? StepKind::walk : kind;
  }
  bool serves(const StepLibrary& library, StepKind kind) const {
    return kind == StepKind::walk ? library.is_middle() : library.kind() == kind;
  }
  Status make_weights(PlannedStep& step) const;
  void warn_of_steps_beyond();

  std::span<const StepLibrary> libraries_;
  const Walker& walker_;
  const Terrain& ground_;
  const WalkOptions& options_;
  int count_ = 0;               // of prints
  bool walks_ = false;          // whether there is a library of walks
  std::vector<double> facing_;  // radians, [prints]
  PlannedWalk walk_;
};

Status Planner::check_prints(std::span<const Print> prints) const {
  if (prints.size() < 3) {
    return Error(
        "walk-prints",
        fmt::format("{} prints are no walk: the walker stands on the first two", prints.size()),
        "give at least three prints");
  }
  for (std::size_t k = 0; k < prints.size(); ++k) {
    const Print& print = prints[k];
    const bool finite = std::isfinite(print.x) && std::isfinite(print.z) &&
                        std::isfinite(print.heading) && std::isfinite(print.height.value_or(0)) &&
                        std::isfinite(print.time.value_or(0));
    const double far = std::max(std::abs(print.x), std::abs(print.z));
    if (!finite || far > 1e6 || std::abs(print.heading) > 1e6) {
      return Error("walk-prints",
                   fmt::format("print {}: a value is no number, or out of range", k + 1));
    }
    if (k > 0 && print.side == prints[k - 1].side) {
      return Error("walk-prints",
                   fmt::format("print {}: a second {} foot in a row", k + 1, name_of(print.side)),
                   "sides alternate");
    }
  }
  return {};
}

Status Planner::choose(const GroundedPrint& to, double duration, int number,
                       PlannedStep& step) const {
  const GroundedPrint& stance = walk_.grounded[static_cast<std::size_t>(number - 1)];
  const GroundedPrint& from = walk_.grounded[static_cast<std::size_t>(number - 2)];
  const FootSide swing = to.side;
  const StepKind kind = kind_of_step(number);
  double least = std::numeric_limits<double>::infinity();
  Apart far, more;
  for (std::size_t i = 0; i < libraries_.size(); ++i) {
    if (!serves(libraries_[i], kind)) continue;
    // People walk out of standing and into it.
    const bool is_end = number == 2 || number + 1 == count_;
    if (is_end && libraries_[i].kind() == StepKind::run && walks_) continue;
    const parametric::Synthesiser& steps = libraries_[i].steps(swing);
    const StepShape shape = shape_of(stance, to, libraries_[i].toe_out());
    const StepShape begin = shape_of(stance, from, libraries_[i].toe_out());
    std::vector<std::uint8_t> is_asked;
    auto asked = parameters_for(libraries_[i], swing, shape, begin, duration, is_asked);
    auto off = parametric::outside(steps.bounds(), asked);
    const Apart here = beyond(libraries_[i], shape);
    const double cost = off.distance + (here.place + kTurnCost * here.turn) / kUsualRange;
    if (cost >= least) continue;
    least = cost;
    more = here;
    far = apart(steps.library(), asked, off.nearest);
    step.library = static_cast<int>(i);
    step.asked = std::move(asked);
    step.is_asked = std::move(is_asked);
    step.nearest = options_.extrapolate ? step.asked : std::move(off.nearest);
  }
  step.far = options_.extrapolate ? 0 : std::hypot(far.place, more.place);
  // The first and the last step are blended with standing: examples need not reach their
  // parameters.
  if (options_.extrapolate || number == 2 || number + 1 == count_) return {};
  if (far.place <= kFarOutside * walker_.leg(swing).length && far.turn <= kFarTurn) return {};
  return Error("walk-outside",
               far.turn > kFarTurn
                   ? fmt::format("print {}: the step turns by {}° more than the library's",
                                 number + 1, readable(far.turn / kRadiansPerDegree, 3))
                   : fmt::format("print {}: the step is {} m from the nearest that the library has",
                                 number + 1, readable(far.place, 3)),
               "add examples of such steps, or use --adapt");
}

Status Planner::try_print(std::size_t number, const Print& print, GroundedPrint& grounded,
                          PlannedStep& step) const {
  const GroundedPrint& stance = walk_.grounded[number - 1];
  auto found = set_on_ground(print, static_cast<int>(number), walker_, ground_, stance.heel.y());
  if (!found) return found.error();
  grounded = *std::move(found);
  grounded.facing = facing_[number];
  const GroundedPrint& from = walk_.grounded[number - 2];
  if (Status status =
          check_reach(from, stance, grounded, static_cast<int>(number), walker_, ground_);
      !status) {
    return status;
  }
  const auto& before = walk_.prints[number - 1].time;
  const double duration = print.time && before ? *print.time - *before : 0;
  return choose(grounded, duration, static_cast<int>(number), step);
}

// The nearest print on the straight way from the foot's easiest place that can be stepped on.
Status Planner::adapt(std::size_t number, const Print& wanted, const Error& why) {
  const GroundedPrint& stance = walk_.grounded[number - 1];
  const double side = wanted.side == FootSide::left ? 1 : -1;
  Print easy = wanted;
  const double across = side * 2.2 * walker_.sole_width;
  const Vec3 ahead(std::sin(stance.facing), 0, std::cos(stance.facing));
  const Vec3 to_wanted(wanted.x - stance.heel.x(), 0, wanted.z - stance.heel.z());
  const double along =
      std::clamp(to_wanted.dot(ahead), -0.3, 0.5) * walker_.leg(wanted.side).length;
  easy.x = stance.heel.x() + along * ahead.x() + across * ahead.z();
  easy.z = stance.heel.z() + along * ahead.z() - across * ahead.x();
  easy.heading = stance.facing;
  easy.height.reset();
  const auto between = [&](double part) {
    Print print = wanted;
    print.x = easy.x + part * (wanted.x - easy.x);
    print.z = easy.z + part * (wanted.z - easy.z);
    const double turn = std::remainder(wanted.heading - easy.heading, 2 * kPi);
    print.heading = easy.heading + part * turn;
    if (part < 1) print.height.reset();
    return print;
  };
  GroundedPrint grounded;
  PlannedStep step;
  if (!try_print(number, easy, grounded, step)) return why;
  double low = 0, high = 1;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (try_print(number, between(middle), grounded, step) ? low : high) = middle;
  }
  const Print moved = between(low);
  if (Status status = try_print(number, moved, grounded, step); !status) return status;
  step.stance = static_cast<int>(number) - 1;
  walk_.prints.push_back(moved);
  walk_.grounded.push_back(grounded);
  walk_.steps.push_back(std::move(step));
  walk_.moved.push_back(std::hypot(moved.x - wanted.x, moved.z - wanted.z));
  walk_.why_moved.push_back(why.message);
  return {};
}

Status Planner::add_print(std::size_t number, Print print) {
  if (number < 2) {
    const double from = number == 0 ? print.height.value_or(1e6) : walk_.grounded[0].heel.y();
    auto grounded = set_on_ground(print, static_cast<int>(number), walker_, ground_, from);
    if (!grounded) return grounded.error();
    grounded->facing = facing_[number];
    walk_.prints.push_back(print);
    walk_.grounded.push_back(*std::move(grounded));
    walk_.moved.push_back(0);
    walk_.why_moved.emplace_back();
    return {};
  }
  GroundedPrint grounded;
  PlannedStep step;
  const Status status = try_print(number, print, grounded, step);
  if (!status) {
    if (!options_.adapt) return status;
    return adapt(number, print, status.error());
  }
  step.stance = static_cast<int>(number) - 1;
  walk_.prints.push_back(print);
  walk_.grounded.push_back(grounded);
  walk_.steps.push_back(std::move(step));
  walk_.moved.push_back(0);
  walk_.why_moved.emplace_back();
  return {};
}

// A step nearer to the middle of the examples where the weights would extrapolate too far.
Status Planner::make_weights(PlannedStep& step) const {
  const GroundedPrint& to = walk_.grounded[static_cast<std::size_t>(step.stance) + 1];
  const parametric::Synthesiser& steps =
      libraries_[static_cast<std::size_t>(step.library)].steps(to.side);
  const parametric::SynthesisOptions how{options_.extrapolate, kCorrections};
  std::vector<double> middle(step.nearest.size(), 0);
  for (const parametric::Example& example : steps.library().examples) {
    for (std::size_t d = 0; d < middle.size(); ++d) {
      middle[d] += example.parameters[d] / static_cast<double>(steps.library().examples.size());
    }
  }
  Status last;
  for (int i = 0; i <= kBlendTries; ++i) {
    const double part = static_cast<double>(i) / kBlendTries;
    std::vector<double> point = step.nearest;
    for (std::size_t d = 0; d < point.size(); ++d) point[d] += part * (middle[d] - point[d]);
    auto made = steps.weights(point, how);
    if (made) {
      auto motion = steps.motion(made->weights);
      if (motion) {
        step.weights = std::move(made->weights);
        step.made = std::move(made->parameters);
        return {};
      }
      last = motion.error();
    } else {
      last = made.error();
    }
  }
  return last;
}

// Steps that are longer or wider than any of their library's; the first and the last one are
// blended with standing.
void Planner::warn_of_steps_beyond() {
  // Along the way that the body faces and across it.
  std::vector<Eigen::AlignedBox2d> known(libraries_.size());
  for (std::size_t i = 0; i < known.size(); ++i) {
    const Eigen::Rotation2Dd from_toes(-libraries_[i].toe_out());
    for (const FoundStep& step : libraries_[i].found_steps()) {
      known[i].extend(from_toes * Vec2(step.along, step.across));
    }
  }
  int count = 0;
  double worst = 0;
  std::string text;
  for (std::size_t i = 1; i + 1 < walk_.steps.size(); ++i) {
    const PlannedStep& step = walk_.steps[i];
    const auto stance = static_cast<std::size_t>(step.stance);
    const auto library = static_cast<std::size_t>(step.library);
    const StepShape shape = shape_of(walk_.grounded[stance], walk_.grounded[stance + 1], 0);
    const Vec2 largest = known[library].max();
    const double beyond = (Vec2(shape.along, shape.across) - largest).maxCoeff();
    if (!(beyond > kBeyond)) continue;
    ++count;
    if (beyond <= worst) continue;
    worst = beyond;
    const auto metres = [](double value) { return readable(value, 3); };
    text = fmt::format("to print {} it is {} m long and {} m wide, there at most {} m and {} m",
                       stance + 2, metres(shape.along), metres(shape.across), metres(largest.x()),
                       metres(largest.y()));
  }
  if (count == 0) return;
  walk_.warnings.push_back(make_warning(
      "walk-beyond",
      fmt::format("{} of {} steps are longer or wider than any in the library: {}", count,
                  walk_.steps.size(), text),
      "legs are stretched for them: set prints closer together, or give examples of such steps"));
}

Result<PlannedWalk> Planner::plan(std::span<const Print> prints) {
  if (Status status = check_prints(prints); !status) return status.error();
  count_ = static_cast<int>(prints.size());
  walks_ = main_library(libraries_).kind() == StepKind::walk;
  facing_ = facing_of(prints);
  for (std::size_t k = 0; k < prints.size(); ++k) {
    if (Status status = add_print(k, prints[k]); !status) return status.error();
  }
  for (PlannedStep& step : walk_.steps) {
    if (Status status = make_weights(step); !status) return status.error();
  }
  if (!options_.extrapolate) warn_of_steps_beyond();
  return std::move(walk_);
}

}  // namespace

void take_usual(const StepLibrary& steps, FootSide swing, std::span<const std::uint8_t> is_asked,
                std::span<double> parameters) {
  const parametric::Bounds& bounds = steps.steps(swing).bounds();
  const auto& examples = steps.steps(swing).library().examples;
  std::vector<double> sums(parameters.size(), 0);
  double weights = 0;
  for (std::size_t i = 0; i < examples.size(); ++i) {
    if (!steps.in_style(i)) continue;
    double far = 0.01;
    for (std::size_t d = 0; d < parameters.size(); ++d) {
      if (!is_asked[d]) continue;
      const double range = std::max(bounds.upper[d] - bounds.lower[d], 1e-9);
      far += std::pow((examples[i].parameters[d] - parameters[d]) / range, 2);
    }
    for (std::size_t d = 0; d < sums.size(); ++d)
      sums[d] += examples[i].parameters[d] / (far * far);
    weights += 1 / (far * far);
  }
  for (std::size_t d = 0; d < sums.size(); ++d) {
    if (!is_asked[d]) parameters[d] = sums[d] / weights;
  }
}

Result<PlannedWalk> plan_steps(std::span<const StepLibrary> libraries, const Walker& walker,
                               std::span<const Print> prints, const Terrain& ground,
                               const WalkOptions& options) {
  return Planner(libraries, walker, ground, options).plan(prints);
}

}  // namespace krok::gait
