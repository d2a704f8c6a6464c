#include <algorithm>
#include <array>
#include <cmath>

#include "contacts/series_internal.h"
#include "filter/butterworth.h"

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

namespace {

// How much better a sudden start must fit to be accepted: it overfits jitter, and feet mostly start
// smoothly.
constexpr double kSudden = 30;

// The solution of a positive semidefinite system, 0 for what it does not tell. By L D L^T; Eigen's
// own takes several times as long for so small a one.
Eigen::Matrix<double, 4, 3> solved(Eigen::Matrix4d a, Eigen::Matrix<double, 4, 3> b) {
  const double least = 1e-14 * a.trace();
  for (int i = 0; i < 4; ++i) {
    const double inverse = a(i, i) > least ? 1 / a(i, i) : 0;
    for (int j = i + 1; j < 4; ++j) {
      const double part = a(j, i) * inverse;
      for (int k = j; k < 4; ++k) a(k, j) -= part * a(k, i);
      for (int axis = 0; axis < 3; ++axis) b(j, axis) -= part * b(i, axis);
    }
    for (int j = i + 1; j < 4; ++j) a(j, i) *= inverse;
    for (int axis = 0; axis < 3; ++axis) b(i, axis) *= inverse;
  }
  for (int i = 3; i >= 0; --i) {
    for (int j = i + 1; j < 4; ++j) {
      for (int axis = 0; axis < 3; ++axis) b(i, axis) -= a(j, i) * b(j, axis);
    }
  }
  return b;
}

// Two pieces that meet at a moment, fitted to the positions of some frames. `reach` is half of
// those frames, for numbers near 1.
class Pieces {
 public:
  Pieces(const std::vector<Vec3>& track, int first, int last, bool arrives, double stiffness)
      : track_(track),
        first_(first),
        last_(last),
        reach_(0.5 * (last - first)),
        sign_(arrives ? 1 : -1),
        stiffness_(stiffness) {
    for (int f = first; f <= last; ++f)
      middle_ += track[static_cast<std::size_t>(f)] / (last - first + 1);
  }

  // The sum of squares that the best pieces leave that meet at `moment`. The moving side begins
  // without velocity of its own or, if that fits far better, with one at once.
  double misfit(double moment) const {
    Eigen::Matrix<double, 5, 5> moments = Eigen::Matrix<double, 5, 5>::Zero();
    Eigen::Matrix<double, 5, 3> sums = Eigen::Matrix<double, 5, 3>::Zero();
    double squares = 0;
    for (int f = first_; f <= last_; ++f) {
      const double u = (f - moment) * sign_ / reach_;
      const Vec3 off = track_[static_cast<std::size_t>(f)] - middle_;
      moments(0, 0) += 1;
      moments(1, 0) += u;
      moments(1, 1) += u * u;
      for (int axis = 0; axis < 3; ++axis) sums(0, axis) += off[axis];
      for (int axis = 0; axis < 3; ++axis) sums(1, axis) += u * off[axis];
      squares += off.squaredNorm();
      if (!(u < 0)) continue;  // the other columns are 0
      const double row[5] = {1, u, u * u, u * u * u, u};
      for (int i = 0; i < 5; ++i) {
        for (int j = std::max(i, 2); j < 5; ++j) moments(j, i) += row[i] * row[j];
      }
      for (int i = 2; i < 5; ++i) {
        for (int axis = 0; axis < 3; ++axis) sums(i, axis) += row[i] * off[axis];
      }
    }
    // One row more, which holds the drift down: a point that stays drifts only where its place on
    // the foot is not quite right, and jitter must not be taken for that.
    moments(1, 1) += 4 * stiffness_ * stiffness_;
    const Eigen::Matrix<double, 5, 5> full = moments.selfadjointView<Eigen::Lower>();
    double least = 0;
    for (const bool sudden : {false, true}) {
      const std::array<int, 4> used = {0, 1, 2, sudden ? 4 : 3};
      const Eigen::Matrix4d normal = full(used, used);
      const Eigen::Matrix<double, 4, 3> right = sums(used, Eigen::all);
      const Eigen::Matrix<double, 4, 3> fit = solved(normal, right);
      // Written so that errors of the fit count by their squares.
      const double left = squares + fit.cwiseProduct(normal * fit - 2 * right).sum();
      least = sudden ? std::min(least, kSudden * left) : left;
    }
    return least;
  }

 private:
  const std::vector<Vec3>& track_;
  int first_, last_;
  double reach_, sign_, stiffness_;
  Vec3 middle_ = Vec3::Zero();
};

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
    const Pieces pieces(track, first, last, arrives, stiffness);
    double least = -1;
    for (double moment = low; moment <= high + 1e-9; moment += kStep) {
      const double left = pieces.misfit(moment);
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
  // is small. The lower quartile of |x| of a Gaussian is 0.3186 of its deviation, that of the
  // length of two is sqrt(2 ln(4/3)); feet rest for more than a quarter of the time.
  if (track.size() < 4) return 0;
  std::vector<double> level, upright;
  for (std::size_t f = 3; f < track.size(); ++f) {
    const Vec3 third = track[f] - 3 * track[f - 1] + 3 * track[f - 2] - track[f - 3];
    level.push_back(std::sqrt(third.x() * third.x() + third.z() * third.z()));
    upright.push_back(std::abs(third.y()));
  }
  const auto quartile = [](std::vector<double>& sizes) {
    const auto part = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 4);
    std::nth_element(sizes.begin(), part, sizes.end());
    return *part / std::sqrt(20.0);
  };
  return std::max(quartile(level) / std::sqrt(2 * std::log(4.0 / 3)), quartile(upright) / 0.3186);
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
