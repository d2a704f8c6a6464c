#include "character/motion.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/index.h"
#include "core/parallel.h"
#include "math/quaternion.h"

namespace krok::character {

namespace {

constexpr int kParts = 4;           // of the time between two frames
constexpr double kOnFrame = 0.01;   // frames
constexpr std::size_t kTried = 16;  // of the times between two frames, the worst
constexpr int kMaxTimes = 32;       // the rate
constexpr double kFastest = 1000;   // frames per second that are suggested
constexpr std::size_t kGapsAtOnce = 16;

struct GapError {
  double largest = 0;
  int joint = -1;
  double time = 0;  // of the scene
};

class Sampled {
 public:
  Sampled(const nodes::Evaluator& evaluator, const Rig& rig, const Conversion& conversion,
          int animation)
      : evaluator_(evaluator), rig_(rig), conversion_(conversion), animation_(animation) {}

  // The largest error between two times with a frame each.
  GapError between(double begin, double end) const {
    nodes::Evaluation state;
    const std::vector<Transform> first = pose(begin, state), last = pose(end, state);
    GapError worst;
    std::vector<Transform> shown(first.size());
    for (int part = 1; part < kParts; ++part) {
      const double share = static_cast<double>(part) / kParts;
      const double time = begin + share * (end - begin);
      const std::vector<Transform> real = pose(time, state);
      for (std::size_t j = 0; j < shown.size(); ++j) {
        const int parent = rig_.skeleton.parents[j];
        const auto local = [&](const std::vector<Transform>& pose) {
          return parent < 0 ? pose[j] : pose[at(parent)].inverse() * pose[j];
        };
        const Transform a = local(first), b = local(last);
        const Transform here{a.position + share * (b.position - a.position),
                             slerp(a.orientation, b.orientation, share)};
        shown[j] = parent < 0 ? here : shown[at(parent)] * here;
        const double off = (shown[j].position - real[j].position).norm();
        if (off > worst.largest) worst = {off, static_cast<int>(j), time};
      }
    }
    return worst;
  }

 private:
  std::vector<Transform> pose(double time, nodes::Evaluation& state) const {
    evaluator_.place_nodes(animation_, time, state);
    std::vector<Transform> joints;
    for (int j = 0; j < rig_.joints.count(); ++j) {
      joints.push_back(conversion_.pose(nodes::rigid_part(rig_.joint_to_world(state, j))));
    }
    return joints;
  }

  const nodes::Evaluator& evaluator_;
  const Rig& rig_;
  const Conversion& conversion_;
  int animation_;
};

// The errors of gaps that a finer rate divides in `times` each.
std::vector<GapError> errors_of(const Sampled& sampled, const Sampling& sampling,
                                const std::vector<int>& gaps, int times, int jobs) {
  std::vector<GapError> errors(gaps.size());
  parallel_for(gaps.size(), kGapsAtOnce, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (int k = 0; k < times; ++k) {
        const double step = sampling.step / times, start = sampling.time(gaps[i]) + k * step;
        const GapError error = sampled.between(start, start + step);
        if (error.largest > errors[i].largest) errors[i] = error;
      }
    }
  });
  return errors;
}

GapError largest_of(const std::vector<GapError>& errors) {
  return *std::ranges::max_element(errors, {}, &GapError::largest);
}

}  // namespace

bool is_sampled_exactly(const nodes::Animation& animation, const Sampling& sampling) {
  return std::ranges::all_of(animation.channels, [&](const nodes::Channel& channel) {
    if (channel.times->size() < 2) return true;
    return channel.interpolation == nodes::Interpolation::linear &&
           std::ranges::all_of(*channel.times, [&](float time) {
             const double place = (static_cast<double>(time) - sampling.start) / sampling.step;
             return std::abs(place - std::round(place)) < kOnFrame;
           });
  });
}

SamplingError sampling_error(const nodes::Evaluator& evaluator, const Rig& rig,
                             const Conversion& conversion, const nodes::Animation& animation,
                             int index, const Sampling& sampling, double wanted, int jobs) {
  SamplingError result;
  std::vector<int> all;
  for (int gap = 0; gap + 1 < sampling.frames; ++gap) all.push_back(gap);
  if (all.empty() || is_sampled_exactly(animation, sampling)) return result;
  const Sampled sampled(evaluator, rig, conversion, index);
  const std::vector<GapError> errors = errors_of(sampled, sampling, all, 1, jobs);
  const GapError worst = largest_of(errors);
  result.largest = worst.largest;
  result.joint = worst.joint;
  result.time = (worst.time - sampling.start) / (sampling.step * sampling.rate);
  result.jumps = std::ranges::any_of(animation.channels, [](const nodes::Channel& channel) {
    return channel.interpolation == nodes::Interpolation::step && channel.times->size() > 1;
  });
  if (worst.largest <= wanted) return result;
  std::vector<int> hardest = all;
  const std::size_t tried = std::min(kTried, hardest.size());
  std::ranges::partial_sort(
      hardest, hardest.begin() + static_cast<std::ptrdiff_t>(tried),
      [&](int a, int b) { return errors[at(a)].largest > errors[at(b)].largest; });
  hardest.resize(tried);
  for (int times = 2; times <= kMaxTimes && sampling.rate * times <= kFastest; times *= 2) {
    if (largest_of(errors_of(sampled, sampling, hardest, times, jobs)).largest > wanted) continue;
    if (largest_of(errors_of(sampled, sampling, all, times, jobs)).largest > wanted) continue;
    result.rate = sampling.rate * times;
    break;
  }
  return result;
}

}  // namespace krok::character
