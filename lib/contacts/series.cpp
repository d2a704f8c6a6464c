#include <algorithm>
#include <array>
#include <cmath>

#include "contacts/series_internal.h"
#include "core/index.h"
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

// Rows of x, y, z and 0, which fill whole registers.
template <int kRows>
using Rows = Eigen::Matrix<double, kRows, 4, Eigen::RowMajor>;

// Solutions of positive semidefinite systems, 0 for what they leave open: of unknowns 0, 1, 2 and
// one more. By L D L^T, of which the first three columns are shared; Eigen's own takes several
// times as long for so small a one.
class Systems {
 public:
  Systems(const Eigen::Matrix<double, 5, 5>& a, const Rows<5>& b)
      : a_(a), b_(b), least_(1e-14 * a_.trace()) {
    for (int i = 0; i < 3; ++i) {
      const double inverse = a_(i, i) > least_ ? 1 / a_(i, i) : 0;
      for (int j = i + 1; j < 5; ++j) {
        const double part = a_(j, i) * inverse;
        for (int k = j; k < 5; ++k) a_(k, j) -= part * a_(k, i);
        b_.row(j) -= part * b_.row(i);
      }
      for (int j = i + 1; j < 5; ++j) a_(j, i) *= inverse;
      b_.row(i) *= inverse;
    }
  }

  Rows<4> with(int last) const {
    Rows<4> x;
    x.row(3) = b_.row(last) * (a_(last, last) > least_ ? 1 / a_(last, last) : 0);
    for (int i = 2; i >= 0; --i) {
      x.row(i) = b_.row(i) - a_(last, i) * x.row(3);
      for (int j = i + 1; j < 3; ++j) x.row(i) -= a_(j, i) * x.row(j);
    }
    return x;
  }

 private:
  Eigen::Matrix<double, 5, 5> a_;  // the lower half
  Rows<5> b_;
  double least_;
};

// Two pieces that meet at a moment, fitted to the positions of some frames. `reach` is half of
// those frames, for numbers near 1. Sums over frames are kept up to each frame, so that a moment
// costs no more where there are many frames.
class Pieces {
 public:
  Pieces(const std::vector<Vec3>& track, int first, int last, bool arrives, double stiffness)
      : first_(first),
        last_(last),
        centre_(0.5 * (first + last)),
        reach_(0.5 * (last - first)),
        sign_(arrives ? 1 : -1),
        stiffness_(stiffness),
        upto_(static_cast<std::size_t>(last - first + 2)) {
    Vec3 middle = Vec3::Zero();
    for (int f = first; f <= last; ++f) {
      middle += track[static_cast<std::size_t>(f)] / (last - first + 1);
    }
    for (int f = first; f <= last; ++f) {
      const std::size_t index = static_cast<std::size_t>(f - first);
      const Vec3 off3 = track[static_cast<std::size_t>(f)] - middle;
      const Vec4 off(off3.x(), off3.y(), off3.z(), 0);
      const double t = (f - centre_) / reach_;
      Sums& next = upto_[index + 1];
      next = upto_[index];
      double power = 1;
      for (int k = 0; k < kPowers; ++k, power *= t) {
        next.powers[k] += power;
        if (k < kOffPowers) next.offs.row(k) += power * off.transpose();
      }
      squares_ += off.squaredNorm();
    }
  }

  // The sum of squares that the best pieces leave that meet at `moment`. The moving side begins
  // without velocity of its own or, if that fits far better, with one at once.
  double misfit(double moment) const {
    // u = (f - moment) * sign / reach is < 0 on the moving side, whose columns u^2, u^3 and u are 0
    // on the other side.
    const int split = static_cast<int>(sign_ > 0 ? std::ceil(moment) : std::floor(moment) + 1);
    const std::size_t place =
        static_cast<std::size_t>(std::clamp(split - first_, 0, last_ + 1 - first_));
    const Sums& before = upto_[place];
    const Sums& total = upto_.back();
    Sums moving = before;
    if (sign_ < 0) {
      moving.powers = total.powers - before.powers;
      moving.offs = total.offs - before.offs;
    }
    const Sums all = shifted(total, moment, 2), part = shifted(moving, moment, kPowers - 1);
    constexpr std::array<int, 5> kExponents = {0, 1, 2, 3, 1};
    Eigen::Matrix<double, 5, 5> moments;
    Rows<5> sums;
    for (int i = 0; i < 5; ++i) {
      for (int j = std::max(i, 2); j < 5; ++j) {
        moments(j, i) = part.powers[kExponents[at(i)] + kExponents[at(j)]];
      }
      sums.row(i) = i < 2 ? all.offs.row(i) : part.offs.row(kExponents[at(i)]);
    }
    moments(0, 0) = all.powers[0];
    moments(1, 0) = all.powers[1];
    // One row more, which holds the drift down: a point that stays drifts only where its place on
    // the foot is not quite right, and jitter must not be taken for that.
    moments(1, 1) = all.powers[2] + 4 * stiffness_ * stiffness_;
    const Systems systems(moments, sums);
    return std::min(left_by(systems.with(3), 3, moments, sums),
                    kSudden * left_by(systems.with(4), 4, moments, sums));
  }

 private:
  static constexpr int kPowers = 7, kOffPowers = 4;
  // Of t^k, and of t^k times the place, over some frames.
  struct Sums {
    Eigen::Array<double, kPowers, 1> powers = Eigen::Array<double, kPowers, 1>::Zero();
    Rows<kOffPowers> offs = Rows<kOffPowers>::Zero();
  };

  // The sum of squares that a fit leaves by unknowns 0, 1, 2 and `last`, written so that errors of
  // the fit count by their squares. `moments`: the lower half.
  double left_by(const Rows<4>& fit, int last, const Eigen::Matrix<double, 5, 5>& moments,
                 const Rows<5>& sums) const {
    Vec4 left = Vec4::Zero();
    for (int i = 0; i < 4; ++i) {
      const int row = i < 3 ? i : last;
      Vec4 half = 0.5 * moments(row, row) * fit.row(i) - sums.row(row);
      for (int j = 0; j < i; ++j) half += moments(row, j) * fit.row(j);
      left += 2 * fit.row(i).transpose().cwiseProduct(half);
    }
    return squares_ + left.sum();
  }

  // The sums of u^k up to u^`most` from those of t^k, where t = (f - centre) / reach: Horner's
  // scheme for the shift of a polynomial.
  Sums shifted(Sums sums, double moment, int most) const {
    const double by = (centre_ - moment) / reach_;
    for (int k = 1; k <= most; ++k) {
      for (int i = most; i >= k; --i) sums.powers[i] += by * sums.powers[i - 1];
    }
    const int offs = std::min(most, kOffPowers - 1);
    for (int k = 1; k <= offs; ++k) {
      for (int i = offs; i >= k; --i) sums.offs.row(i) += by * sums.offs.row(i - 1);
    }
    if (sign_ < 0) {
      for (int i = 1; i <= most; i += 2) {
        sums.powers[i] = -sums.powers[i];
        if (i < kOffPowers) sums.offs.row(i) = -sums.offs.row(i);
      }
    }
    return sums;
  }

  int first_, last_;
  double centre_, reach_, sign_, stiffness_;
  std::vector<Sums> upto_;  // [frames + 1], of the frames before
  double squares_ = 0;
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
  std::vector<double> level, upright;  // squares; sizes
  level.reserve(track.size()), upright.reserve(track.size());
  for (std::size_t f = 3; f < track.size(); ++f) {
    const Vec3 third = track[f] - 3 * track[f - 1] + 3 * track[f - 2] - track[f - 3];
    level.push_back(third.x() * third.x() + third.z() * third.z());
    upright.push_back(std::abs(third.y()));
  }
  const auto quartile = [](std::vector<double>& sizes) {
    const auto part = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 4);
    std::nth_element(sizes.begin(), part, sizes.end());
    return *part;
  };
  return std::max(std::sqrt(quartile(level)) / std::sqrt(20.0) / std::sqrt(2 * std::log(4.0 / 3)),
                  quartile(upright) / std::sqrt(20.0) / 0.3186);
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
