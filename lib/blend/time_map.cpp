#include "blend/time_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "math/hermite.h"

namespace krok::blend {

namespace {

constexpr int kParts = 64;  // per interval, for varying weights
constexpr double kMinSum = 1e-3;

std::size_t at_index(double value) {
  return static_cast<std::size_t>(value);
}

// Solves function(x) = value for a function that increases over [low, high], by Newton's method
// safeguarded by bisection.
template <typename Function, typename Slope>
double solve(double value, double low, double high, const Function& function, const Slope& slope) {
  double x = 0.5 * (low + high);
  for (int i = 0; i < 100; ++i) {
    const double off = function(x) - value;
    if (off == 0) return x;
    (off > 0 ? high : low) = x;
    const double steep = slope(x);
    double next = steep > 0 ? x - off / steep : low;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (next == x || !(next > low && next < high)) return x;
    x = next;
  }
  return x;
}

}  // namespace

TimeMap::TimeMap(std::vector<double> times, Warp warp) : times_(std::move(times)), warp_(warp) {
  for (std::size_t i = 0; i < times_.size(); ++i) generic_.push_back(static_cast<double>(i));
  slopes_.resize(times_.size());
  monotone_velocities(generic_, times_, Ends::open, slopes_);
}

double TimeMap::at(double generic) const {
  if (warp_ == Warp::pchip) return sample_curve(generic_, times_, slopes_, generic);
  const double place = std::clamp(generic, 0.0, last());
  const std::size_t i = std::min(at_index(place), times_.size() - 2);
  const double part = place - static_cast<double>(i);
  return part == 0 ? times_[i] : times_[i] + part * (times_[i + 1] - times_[i]);
}

double TimeMap::slope(int interval, double part) const {
  const auto i = static_cast<std::size_t>(interval);
  if (warp_ == Warp::linear) return times_[i + 1] - times_[i];
  return hermite_velocity(times_[i], slopes_[i], times_[i + 1], slopes_[i + 1], 1, part);
}

double TimeMap::slope(double generic) const {
  const double place = std::clamp(generic, 0.0, last());
  const int interval = std::min(static_cast<int>(place), static_cast<int>(times_.size()) - 2);
  return slope(interval, place - interval);
}

double WeightCurve::at(double time) const {
  const auto after = std::ranges::upper_bound(generic, time);
  if (after == generic.begin()) return weights.front();
  const auto i = static_cast<std::size_t>(after - generic.begin()) - 1;
  if (after == generic.end()) return weights.back();
  const double part = (time - generic[i]) / (generic[i + 1] - generic[i]);
  return weights[i] + part * (weights[i + 1] - weights[i]);
}

Result<BlendTime> BlendTime::create(std::vector<TimeMap> maps, std::vector<WeightCurve> weights,
                                    double shortest) {
  BlendTime result(std::move(maps), std::move(weights));
  if (Status status = result.integrate(shortest); !status) return status.error();
  return result;
}

double BlendTime::slope(int interval, double part) const {
  double sum = 0, all = 0;
  for (std::size_t j = 0; j < maps_.size(); ++j) {
    const double weight = weights_[j].at(interval + part);
    sum += weight * maps_[j].slope(interval, part);
    all += weight;
  }
  return sum / all;
}

double BlendTime::slope(double generic) const {
  const int intervals = static_cast<int>(maps_.front().last());
  const int interval = std::min(static_cast<int>(std::max(generic, 0.0)), intervals - 1);
  return slope(interval, std::min(generic - interval, 1.0));
}

Status BlendTime::integrate(double shortest) {
  const int intervals = static_cast<int>(maps_.front().last());
  for (const WeightCurve& curve : weights_) constant_ = constant_ && curve.is_constant();
  for (int part = 0; part <= intervals * kParts; ++part) {
    double all = 0;
    for (const WeightCurve& curve : weights_) all += curve.at(static_cast<double>(part) / kParts);
    if (!(std::abs(all) >= kMinSum) || !std::isfinite(all)) {
      return Error("blend-weights",
                   fmt::format("the weights sum to {} at generic time {}", readable(all),
                               readable(static_cast<double>(part) / kParts)),
                   "weights must be finite and sum to 1");
    }
    if (constant_) break;
  }
  moments_.push_back(0);
  if (!constant_) {
    // Simpson's rule over each part.
    table_.push_back(0);
    for (int part = 0; part < intervals * kParts; ++part) {
      const int interval = part / kParts;
      const double from = static_cast<double>(part % kParts) / kParts;
      const double low = slope(interval, from), middle = slope(interval, from + 0.5 / kParts),
                   high = slope(interval, from + 1.0 / kParts);
      // The slope of a monotone cubic may be 0 at its ends.
      if (!(std::min(low, high) >= 0) || !(middle > 0)) {
        return Error(
            "blend-interval",
            fmt::format("time would run backwards at generic time {}", readable(interval + from)),
            "the negative weights are too large here");
      }
      table_.push_back(table_.back() + (low + 4 * middle + high) / (6 * kParts));
    }
  }
  for (int i = 1; i <= intervals; ++i) {
    moments_.push_back(constant_ ? time_at(i) : table_[static_cast<std::size_t>(i * kParts)]);
    const double lasts = moments_.back() - moments_[moments_.size() - 2];
    if (!(lasts >= shortest) || !std::isfinite(lasts)) {
      return Error(
          "blend-interval",
          fmt::format("the interval from moment {} to moment {} would last {} s, less than "
                      "two frames",
                      i - 1, i, readable(lasts)),
          "remove a keytime there, or change the weights");
    }
  }
  return {};
}

double BlendTime::time_at(double generic) const {
  if (constant_) {
    double sum = 0, all = 0;
    for (std::size_t j = 0; j < maps_.size(); ++j) {
      const double weight = weights_[j].at(generic);
      sum += weight * (maps_[j].at(generic) - maps_[j].at(0));
      all += weight;
    }
    return sum / all;
  }
  const double place = std::clamp(generic, 0.0, maps_.front().last()) * kParts;
  const int i = std::min(static_cast<int>(place), static_cast<int>(table_.size()) - 2);
  const double from = static_cast<double>(i % kParts) / kParts;
  const auto entry = static_cast<std::size_t>(i);
  return hermite(table_[entry], slope(i / kParts, from), table_[entry + 1],
                 slope(i / kParts, from + 1.0 / kParts), 1.0 / kParts, place - i);
}

double BlendTime::generic_at(double time) const {
  if (!(time > 0)) return 0;
  if (time >= duration()) return maps_.front().last();
  const auto after = std::ranges::upper_bound(moments_, time);
  const auto i = static_cast<double>(after - moments_.begin()) - 1;
  return solve(
      time, i, i + 1, [&](double generic) { return time_at(generic); },
      [&](double generic) { return slope(generic); });
}

}  // namespace krok::blend
