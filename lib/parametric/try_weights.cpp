#include "parametric/try_weights.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "core/parallel.h"
#include "parametric/leave_one_out.h"
#include "parametric/thin_out.h"
#include "rbf/weight_solver.h"

namespace krok::parametric {

namespace {

constexpr int kMaxParts = 10;            // of the captures
constexpr std::size_t kMaxLeftOut = 20;  // of each part

// Examples to make motions of.
struct Material {
  Library library;
  PackedExamples packed;

  explicit Material(Library examples)
      : library(std::move(examples)), packed(pack_examples(library)) {}
};

Library thinned(const Library& library, double spacing, bool smoothed) {
  std::vector<Example> kept;
  for (const int i :
       smoothed ? thin_out_smoothed(library) : thin_out(library, spacing, rbf::kMaxExamples)) {
    kept.push_back(library.examples[static_cast<std::size_t>(i)]);
  }
  return library.with(std::move(kept));
}

// The distances for one example left out; nullopt if a candidate makes no motion.
struct Prediction {
  int group = 0;
  double planes = 0, nearest = 0;
  std::vector<std::optional<double>> by;  // [candidates]
};

class Part {
 public:
  Part(const Library& library, std::span<const int> groups,
       std::span<const WeightCandidate> candidates, int part, int parts)
      : library_(library), groups_(groups), candidates_(candidates) {
    for (std::size_t i = 0; i < library.examples.size(); ++i) {
      if (groups[i] % parts == part) left_out_.push_back(i);
    }
    const std::size_t stride = (left_out_.size() + kMaxLeftOut - 1) / kMaxLeftOut;
    for (std::size_t i = 0; i < left_out_.size(); i += std::max<std::size_t>(stride, 1)) {
      asked_.push_back(left_out_[i]);
    }
  }

  std::vector<Prediction> predict() const {
    std::vector<Example> others;
    for (std::size_t i = 0; i < library_.examples.size(); ++i) {
      if (!std::ranges::binary_search(left_out_, i)) others.push_back(library_.examples[i]);
    }
    std::vector<Prediction> predictions;
    if (others.empty()) return predictions;
    const Material all(library_.with(std::move(others)));
    const Bounds bounds = bounds_of(all.library);
    std::vector<std::vector<Vec3>> wanted;
    std::vector<std::size_t> inside;
    for (const std::size_t i : asked_) {
      const std::vector<double>& point = library_.examples[i].parameters;
      if (outside(bounds, point).distance > 0) continue;
      std::vector<Vec3> poses = detail::example_poses(library_, i);
      const auto planes =
          detail::distance(all.library, all.packed, detail::plane_weights(bounds, point), poses);
      const auto nearest =
          detail::distance(all.library, all.packed, detail::nearest_weights(bounds, point), poses);
      if (!planes || !nearest) continue;
      predictions.push_back({groups_[i], *planes, *nearest, {}});
      wanted.push_back(std::move(poses));
      inside.push_back(i);
    }
    if (!inside.empty()) try_all(all, inside, wanted, predictions);
    return predictions;
  }

 private:
  void try_all(const Material& all, const std::vector<std::size_t>& inside,
               const std::vector<std::vector<Vec3>>& wanted,
               std::vector<Prediction>& predictions) const {
    std::vector<double> points;
    for (const std::size_t i : inside) {
      const std::vector<double>& point = library_.examples[i].parameters;
      points.insert(points.end(), point.begin(), point.end());
    }
    std::map<std::pair<double, bool>, Material> by_spacing;
    for (const WeightCandidate& candidate : candidates_) {
      const bool smoothed = candidate.smoothing > 0;
      auto found = by_spacing.find({candidate.spacing, smoothed});
      if (found == by_spacing.end()) {
        found = by_spacing
                    .emplace(std::pair(candidate.spacing, smoothed),
                             Material(thinned(all.library, candidate.spacing, smoothed)))
                    .first;
      }
      const Material& material = found->second;
      const std::size_t n = material.library.examples.size();
      const auto weights =
          rbf::point_weights(library_.dimensions(), detail::parameters_of(material.library),
                             candidate.kernel, candidate.smoothing, points);
      for (std::size_t p = 0; p < inside.size(); ++p) {
        std::optional<double> apart;
        if (weights) {
          apart = detail::distance(material.library, material.packed,
                                   std::span(*weights).subspan(p * n, n), wanted[p]);
        }
        predictions[p].by.push_back(apart);
      }
    }
  }

  const Library& library_;
  std::span<const int> groups_;
  std::span<const WeightCandidate> candidates_;
  std::vector<std::size_t> left_out_, asked_;  // indices of examples, ascending
};

bool usable(const WeightTrial& trial) {
  return trial.failed == 0;
}

// The standard error of the mean difference between two candidates: examples of one capture differ
// alike, so captures count, not examples.
double uncertainty(const std::vector<std::vector<Prediction>>& parts, std::size_t candidate,
                   std::size_t best) {
  struct Sum {
    double difference = 0;
    int examples = 0;
  };
  std::map<int, Sum> sums;  // by capture
  Sum all;
  for (const auto& part : parts) {
    for (const Prediction& one : part) {
      const double difference = *one.by[candidate] - *one.by[best];
      for (Sum* sum : {&sums[one.group], &all}) {
        sum->difference += difference;
        ++sum->examples;
      }
    }
  }
  if (sums.size() < 2) return 0;
  const double mean = all.difference / all.examples;
  double squares = 0;
  for (const auto& [group, sum] : sums) {
    squares += (sum.difference - mean * sum.examples) * (sum.difference - mean * sum.examples);
  }
  const auto count = static_cast<double>(sums.size());
  return std::sqrt(squares * count / (count - 1)) / all.examples;
}

void find_best(const std::vector<std::vector<Prediction>>& parts, WeightTrials& trials) {
  for (std::size_t c = 1; c < trials.tried.size(); ++c) {
    const WeightTrial& trial = trials.tried[c];
    const WeightTrial& best = trials.tried[trials.best];
    if (usable(trial) && (!usable(best) || trial.distance < best.distance)) trials.best = c;
  }
  if (trials.tried.empty() || !usable(trials.tried[trials.best])) return;
  for (std::size_t c = 0; c < trials.tried.size(); ++c) {
    if (!usable(trials.tried[c])) continue;
    trials.tried[c].uncertain = uncertainty(parts, c, trials.best);
  }
}

WeightTrials means_of(const std::vector<std::vector<Prediction>>& parts,
                      std::span<const WeightCandidate> candidates) {
  WeightTrials trials;
  for (const WeightCandidate& candidate : candidates) trials.tried.push_back({candidate});
  std::set<int> groups;
  for (const auto& part : parts) {
    for (const Prediction& one : part) {
      ++trials.examples;
      groups.insert(one.group);
      trials.planes += one.planes;
      trials.nearest += one.nearest;
      for (std::size_t c = 0; c < candidates.size(); ++c) {
        if (one.by[c]) {
          trials.tried[c].distance += *one.by[c];
        } else {
          ++trials.tried[c].failed;
        }
      }
    }
  }
  trials.groups = static_cast<int>(groups.size());
  const double count = std::max(1, trials.examples);
  trials.planes /= count;
  trials.nearest /= count;
  for (WeightTrial& trial : trials.tried) {
    trial.distance /= std::max(1, trials.examples - trial.failed);
  }
  find_best(parts, trials);
  return trials;
}

}  // namespace

Result<WeightTrials> try_weights(const Library& library, std::span<const int> groups,
                                 std::span<const WeightCandidate> candidates, int jobs) {
  if (Status status = check(library); !status) return status.error();
  if (groups.size() != library.examples.size() ||
      std::ranges::any_of(groups, [](int group) { return group < 0; })) {
    return Error("parametric-groups", "each example needs a capture, counted from 0");
  }
  const int last = groups.empty() ? -1 : std::ranges::max(groups);
  const int parts = std::min(kMaxParts, last + 1);
  std::vector<std::vector<Prediction>> predictions(static_cast<std::size_t>(parts));
  parallel_for(predictions.size(), 1, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      predictions[i] = Part(library, groups, candidates, static_cast<int>(i), parts).predict();
    }
  });
  return means_of(predictions, candidates);
}

std::size_t trial_to_use(const WeightTrials& trials, double gain) {
  const WeightTrial& first = trials.tried.front();
  const WeightTrial& best = trials.tried[trials.best];
  if (usable(first) && first.distance <= gain * best.distance) return 0;
  std::size_t chosen = trials.best;
  if (best.candidate.smoothing == 0) return chosen;
  for (std::size_t c = 0; c < trials.tried.size(); ++c) {
    const WeightTrial& trial = trials.tried[c];
    if (!usable(trial) || trial.distance - best.distance > trial.uncertain) continue;
    const WeightTrial& now = trials.tried[chosen];
    const double more = trial.candidate.smoothing - now.candidate.smoothing;
    if (more > 0 || (more == 0 && c < chosen)) chosen = c;
  }
  return chosen;
}

}  // namespace krok::parametric
