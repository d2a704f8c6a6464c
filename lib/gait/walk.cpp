#include "gait/walk.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <map>
#include <mutex>

#include "core/index.h"
#include "core/numbers.h"
#include "gait/body_motion_internal.h"
#include "gait/walk_block_internal.h"

namespace krok::gait {

namespace {

constexpr double kMaxFrames = 1e8;
constexpr double kMissed = 1e-4;     // metres that count as a footprint missed
constexpr double kLowered = 5e-4;    // metres of clearance that may be missing
constexpr double kOffSupport = 0.2;  // metres
// Of dorsiflexion under load: 45 degrees in the lunge of Bennell and others, "Intra-rater and
// inter-rater reliability of a weight-bearing lunge measure of ankle dorsiflexion" (Australian
// Journal of Physiotherapy 44, 1998).
constexpr double kMaxAnkle = 45 * kRadiansPerDegree;
constexpr std::size_t kStepsAtOnce = 64;

Status check_options(std::span<const StepLibrary> libraries, const WalkOptions& options) {
  if (libraries.empty() || !main_library(libraries).is_middle()) {
    return Error("walk-library", "walking needs a library of the steps between start and stop",
                 "krok-fit makes one with \"steps\": \"auto\"");
  }
  for (const StepLibrary& library : libraries.subspan(1)) {
    if (Status status =
            parametric::same_skeleton(libraries[0].library().skeleton, library.library().skeleton);
        !status) {
      return status;
    }
  }
  if (!(options.speed >= 0.1 && options.speed <= 10)) {
    return Error("walk-time", fmt::format("a speed of {} is out of range", readable(options.speed)),
                 "give 0.1 to 10 times the library's");
  }
  if (!(options.rate >= 0 && options.rate <= 1e5)) {
    return Error("clip-rate", fmt::format("a rate of {} is out of range", readable(options.rate)));
  }
  return {};
}

}  // namespace

struct Walk::State {
  WalkOptions options;
  Walker walker;
  PlannedWalk plan;
  std::optional<BodyMotion> body;
  std::vector<std::string> libraries, examples;  // [steps], names
  std::optional<WalkParts> parts;
  const parametric::PackedExamples* packed = nullptr;
  const Skeleton* skeleton = nullptr;  // of the result

  // Written by the block that makes a step.
  std::vector<MadeStep> made;   // [steps]
  std::vector<Stance> stances;  // [prints]

  FrameSource frames;
  using Made = std::shared_ptr<const Clip>;
  std::mutex mutex;
  std::map<std::size_t, std::shared_future<Made>> blocks;  // made or being made

  std::size_t block_count() const { return (made.size() + kStepsAtOnce - 1) / kStepsAtOnce; }
  std::size_t block_of(int frame) const;
  int first_frame(std::size_t block) const { return parts->first_frame(block * kStepsAtOnce); }
  Made block(std::size_t index);
  bool try_make(std::size_t index);
  Made make_block(std::size_t index);
  Status read(int first, int count, std::span<Vec3f> positions, std::span<Quatf> orientations);
};

std::size_t Walk::State::block_of(int frame) const {
  std::size_t low = 0, high = block_count();
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (first_frame(middle) <= frame ? low : high) = middle;
  }
  return low;
}

Walk::State::Made Walk::State::make_block(std::size_t index) {
  const std::size_t from = index * kStepsAtOnce;
  const std::size_t to = std::min(from + kStepsAtOnce, made.size());
  Clip clip;
  clip.skeleton = *walker.skeleton;
  clip.rate = frames.rate;
  clip.resize(parts->first_frame(to) - parts->first_frame(from));
  WalkBlock block(*parts, from, to);
  block.make(clip, made);
  for (std::size_t print = from; print < to + (to == made.size() ? 2 : 0); ++print) {
    stances[print] = block.stance(print);
  }
  if (packed->hips_root.changes()) clip = packed->hips_root.restored(clip, *skeleton);
  return std::make_shared<const Clip>(std::move(clip));
}

// Makes a block unless it is made or being made.
bool Walk::State::try_make(std::size_t index) {
  std::promise<Made> promise;
  {
    const std::lock_guard lock(mutex);
    if (index >= block_count() || blocks.contains(index)) return false;
    blocks.emplace(index, promise.get_future().share());
  }
  promise.set_value(make_block(index));
  return true;
}

// While another thread makes the block, makes the one after it.
Walk::State::Made Walk::State::block(std::size_t index) {
  if (!try_make(index)) {
    std::shared_future<Made> future;
    {
      const std::lock_guard lock(mutex);
      future = blocks.at(index);
    }
    if (future.wait_for(std::chrono::seconds(0)) != std::future_status::ready) try_make(index + 1);
    return future.get();
  }
  const std::lock_guard lock(mutex);
  return blocks.at(index).get();
}

Status Walk::State::read(int first, int count, std::span<Vec3f> positions,
                         std::span<Quatf> orientations) {
  const std::size_t joints = skeleton->names.size();
  for (int done = 0; done < count;) {
    const std::size_t index = block_of(first + done);
    const Made clip = block(index);
    const int skip = first + done - first_frame(index);
    const int some = std::min(count - done, clip->frame_count() - skip);
    const std::size_t from = at(skip) * joints, size = at(some) * joints, to = at(done) * joints;
    std::copy_n(clip->positions.begin() + static_cast<std::ptrdiff_t>(from), size,
                positions.begin() + static_cast<std::ptrdiff_t>(to));
    std::copy_n(clip->orientations.begin() + static_cast<std::ptrdiff_t>(from), size,
                orientations.begin() + static_cast<std::ptrdiff_t>(to));
    done += some;
  }
  return {};
}

Result<Walk> Walk::plan(std::span<const StepLibrary> libraries, std::span<const Print> prints,
                        const Terrain& ground, const WalkOptions& options) {
  if (Status status = check_options(libraries, options); !status) return status.error();
  const auto state = std::make_shared<State>();
  state->options = options;
  const StepLibrary& main = main_library(libraries);
  auto walker = make_walker(libraries);
  if (!walker) return walker.error();
  state->walker = *std::move(walker);
  auto plan = plan_steps(libraries, state->walker, prints, ground, options);
  if (!plan) return plan.error();
  state->plan = *std::move(plan);
  choose_styles(libraries, options, state->plan);
  auto body = BodyMotion::create(libraries, state->walker, state->plan, options);
  if (!body) return body.error();
  state->body = *std::move(body);
  const double rate = options.rate > 0 ? options.rate : main.library().rate;
  const double duration = state->body->steps().back().finish;
  if (!(duration * rate <= kMaxFrames)) {
    return Error("clip-too-long", fmt::format("{} s at {} frames per second are too many frames",
                                              readable(duration), readable(rate)));
  }
  const int frames = static_cast<int>(std::ceil(duration * rate - 1e-9)) + 1;
  state->parts.emplace(
      WalkParts{state->walker, state->plan, *state->body, ground, state->options, rate, frames});
  for (const PlannedStep& step : state->plan.steps) {
    state->libraries.push_back(libraries[at(step.library)].name());
    const auto& examples = libraries[at(step.library)].library().examples;
    state->examples.push_back(step.example < 0 ? "" : examples[at(step.example)].name);
  }
  state->packed = &main.steps(FootSide::left).packed();
  state->skeleton = &main.library().skeleton;
  state->made.resize(state->plan.steps.size());
  state->stances.resize(state->plan.grounded.size());
  state->frames.skeleton = *state->skeleton;
  state->frames.rate = rate;
  state->frames.frame_count = frames;
  // Plain pointers: the source belongs to the state.
  state->frames.read = [own = state.get()](int first, int count, std::span<Vec3f> positions,
                                           std::span<Quatf> orientations) {
    return own->read(first, count, positions, orientations);
  };
  state->frames.release = [own = state.get()](int frame) {
    const std::size_t before =
        frame >= own->frames.frame_count ? own->block_count() : own->block_of(frame);
    const std::lock_guard lock(own->mutex);
    own->blocks.erase(own->blocks.begin(), own->blocks.lower_bound(before));
  };
  return Walk(state);
}

const FrameSource& Walk::frames() const {
  return state_->frames;
}

WalkDetails Walk::details() const {
  WalkDetails details;
  details.prints = state_->plan.grounded;
  details.warnings = state_->plan.warnings;
  details.keys =
      keys_of(*state_->parts, state_->stances, state_->frames.duration(), details.prints);
  for (std::size_t i = 0; i < state_->made.size(); ++i) {
    const PlannedStep& planned = state_->plan.steps[i];
    const BodyStep& step = state_->body->steps()[i];
    const MadeStep& made = state_->made[i];
    const std::size_t to = at(planned.stance) + 1;
    details.steps.push_back({planned.stance, step.start, step.strike, state_->libraries[i],
                             state_->examples[i], planned.asked, planned.made,
                             state_->plan.moved[to], made.clearance, made.lowered, made.extension,
                             made.missed, state_->plan.why_moved[to]});
    const auto warn = [&](const char* code, const std::string& what, const char* hint) {
      details.warnings.push_back(
          make_warning(code, fmt::format("print {}: {}", to + 1, what), hint));
    };
    if (made.missed > kMissed) {
      warn("walk-missed",
           fmt::format("a leg is {} mm too short for its footprint",
                       readable(1000 * made.missed, 3)),
           "move the prints closer together, or allow --stretch");
    }
    const double asked = state_->options.clearance;
    if (made.clearance < asked - kLowered) {
      warn("walk-clearance",
           fmt::format("the swing foot comes to {} mm over the ground, {} mm are asked for",
                       readable(1000 * made.clearance, 3), readable(1000 * asked, 3)),
           "move the print, or give a library with steps like this one");
    }
    if (made.off_support > kOffSupport) {
      warn("walk-balance",
           fmt::format("the hips are {} mm beside the line between the feet",
                       readable(1000 * made.off_support, 3)),
           "give a library with steps like this one");
    }
    if (made.ankle > kMaxAnkle) {
      warn("walk-ankle",
           fmt::format("an ankle bends by {}°, more than people's",
                       readable(made.ankle / kRadiansPerDegree, 3)),
           "on steep ground lead the way across the slope; on the level another --pace, "
           "--style or library bends it less");
    }
  }
  return details;
}

Result<WholeWalk> walk(std::span<const StepLibrary> libraries, std::span<const Print> prints,
                       const Terrain& ground, const WalkOptions& options, int jobs) {
  const auto walk = Walk::plan(libraries, prints, ground, options);
  if (!walk) return walk.error();
  auto clip = load(walk->frames(), jobs);
  if (!clip) return clip.error();
  return WholeWalk{*std::move(clip), walk->details()};
}

}  // namespace krok::gait
