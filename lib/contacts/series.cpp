#include <algorithm>
#include <cmath>

#include "contacts/series_internal.h"
#include "filter/butterworth.h"
#include "math/dense_solve.h"

namespace krok::contacts {

std::vector<Vec3> smoothed(const std::vector<Vec3>& track, double rate, double cutoff) {
  if (!(cutoff > 0) || rate < 2.5 * cutoff) return track;
  const filter::Butterworth low_pass{cutoff, 4};
  const auto sections = filter::design(low_pass, rate);
  if (!sections) return track;
  const int padding = filter::padding_for(low_pass, rate);
  std::vector<Vec3> result(track.size());
  std::vector<double> series(track.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t f = 0; f < track.size(); ++f) series[f] = track[f][axis];
    filter::filter_both_ways(*sections, padding, series);
    for (std::size_t f = 0; f < track.size(); ++f) result[f][axis] = series[f];
  }
  return result;
}

std::vector<Vec3> velocities(const std::vector<Vec3>& track, double rate) {
  std::vector<Vec3> result(track.size(), Vec3::Zero());
  if (track.size() < 2) return result;
  for (std::size_t f = 0; f < track.size(); ++f) {
    const std::size_t from = f == 0 ? 0 : f - 1, to = std::min(f + 1, track.size() - 1);
    result[f] = (track[to] - track[from]) * (rate / static_cast<double>(to - from));
  }
  // At the ends the slope of the parabola through three frames.
  const std::size_t n = track.size();
  if (n > 2) {
    result[0] = (4 * track[1] - 3 * track[0] - track[2]) * (rate / 2);
    result[n - 1] = (3 * track[n - 1] - 4 * track[n - 2] + track[n - 3]) * (rate / 2);
  }
  return result;
}

std::vector<double> norms(const std::vector<Vec3>& vectors) {
  std::vector<double> result;
  result.reserve(vectors.size());
  for (const Vec3& v : vectors) result.push_back(v.norm());
  return result;
}

double middle(std::vector<double> values) {
  const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), half, values.end());
  return *half;
}

namespace {

// How much better a sudden start must fit to be accepted: it overfits jitter, and feet mostly start
// smoothly.
constexpr double kSudden = 30;

// How the moving side starts: at zero velocity, or at a finite one.
enum class Start : unsigned char { smooth, sudden };

// The residual sum of squares of the best two pieces that meet at `moment`.
double misfit(const std::vector<Vec3>& track, int first, int last, double moment, bool arrives,
              double stiffness, Start start) {
  const int count = last - first + 1;
  // An extra row penalises drift: a resting point drifts only if its position on the foot is
  // slightly wrong, and jitter must not be fitted as drift.
  Eigen::MatrixXd basis(count + 1, 4);
  Eigen::MatrixXd values(count + 1, 3);
  basis.row(count) << 0, 0, 0, stiffness * (last - first);
  values.row(count).setZero();
  for (int i = 0; i < count; ++i) {
    const double u = (first + i - moment) * (arrives ? 1 : -1);
    const double moving = std::min(u, 0.0);
    const double third = start == Start::smooth ? moving * moving * moving : moving;
    basis.row(i) << 1, moving * moving, third, u;
    values.row(i) = track[static_cast<std::size_t>(first + i)].transpose();
  }
  const Eigen::MatrixXd solution = solve_least_squares(basis, values);
  return (values - basis * solution).squaredNorm();
}

}  // namespace

double break_near(const std::vector<Vec3>& track, double guess, double window, bool arrives,
                  double stiffness) {
  constexpr double kStep = 0.25;  // frames
  constexpr int kRounds = 4;      // the window is re-centred on the result
  const int last_frame = static_cast<int>(track.size()) - 1;
  double best = guess;
  for (int round = 0; round < kRounds; ++round) {
    const double middle = best;
    const int first = std::max(0, static_cast<int>(std::ceil(middle - window)));
    const int last = std::min(last_frame, static_cast<int>(std::floor(middle + window)));
    if (last - first + 1 < 7) return best;
    // At least two frames on either side.
    const double low = std::max(middle - 0.6 * window, first + 1.5);
    const double high = std::min(middle + 0.6 * window, last - 1.5);
    double least = -1;
    for (double moment = low; moment <= high + 1e-9; moment += kStep) {
      const double left =
          std::min(misfit(track, first, last, moment, arrives, stiffness, Start::smooth),
                   kSudden * misfit(track, first, last, moment, arrives, stiffness, Start::sudden));
      if (least >= 0 && left >= least) continue;
      least = left;
      best = moment;
    }
    if (std::abs(best - middle) < 1) break;
  }
  return best;
}

double jitter_of(const std::vector<Vec3>& track) {
  // The third difference of white noise has 1 + 9 + 9 + 1 = 20 times its variance, that of movement
  // is small; the lower quartile of |x| of a Gaussian is 0.3186 of its deviation; feet rest for
  // more than a quarter of the time.
  double worst = 0;
  std::vector<double> differences;
  for (int axis = 0; axis < 3; ++axis) {
    differences.clear();
    for (std::size_t f = 3; f < track.size(); ++f) {
      differences.push_back(std::abs(track[f][axis] - 3 * track[f - 1][axis] +
                                     3 * track[f - 2][axis] - track[f - 3][axis]));
    }
    if (differences.empty()) return 0;
    const auto half = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 4);
    std::nth_element(differences.begin(), half, differences.end());
    worst = std::max(worst, *half / 0.3186 / std::sqrt(20.0));
  }
  return worst;
}

double cutoff_for(double jitter, double speed, double rate) {
  // White noise low-passed at c and differentiated has 2 (2 pi)^2 c^3 / (3 rate) times its variance
  // on each of three axes.
  if (!(jitter > 0)) return rate;
  return std::cbrt(speed * speed * rate / (8 * kPi * kPi * jitter * jitter));
}

double speed_jitter(double jitter, double cutoff, double rate) {
  return jitter * std::sqrt(8 * kPi * kPi * cutoff * cutoff * cutoff / rate);
}

}  // namespace krok::contacts
