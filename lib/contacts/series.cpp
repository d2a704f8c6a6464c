#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "contacts/series_internal.h"
#include "core/index.h"
#include "filter/smooth_clip.h"

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

// Numbers of several moments, for wide operations, and their places: a column for each axis.
constexpr int kLanes = 4;
using Lanes = Eigen::Array<double, kLanes, 1>;
using Rows = Eigen::Array<double, kLanes, 3>;

template <class Values>
[[gnu::always_inline]] inline void add(const Lanes& times, const Values& from, Values& to) {
  for (Eigen::Index axis = 0; axis < to.cols(); ++axis) to.col(axis) += times * from.col(axis);
}

// Horner's scheme for the shift of a polynomial: sums of (t + by)^k from those of t^k.
template <class Values, std::size_t kCount>
void shift(const Lanes& by, double sign, std::array<Values, kCount>& sums) {
  for (std::size_t k = 1; k < kCount; ++k) {
    for (std::size_t i = kCount - 1; i >= k; --i) add(by, sums[i - 1], sums[i]);
  }
  for (std::size_t i = 1; i < kCount; i += 2) sums[i] *= sign;
}

// Solutions of positive semidefinite systems, 0 for what they leave open: of unknowns 0, 1, 2 and
// one more. By L D L^T, of which the first three columns are shared; Eigen's own takes several
// times as long for so small a one.
class Systems {
 public:
  using Matrix = std::array<std::array<Lanes, 5>, 5>;  // the lower half, by rows
  using Right = std::array<Rows, 5>;

  Systems(const Matrix& a, const Right& b) : matrix_(a), right_(b), a_(a), b_(b) {
    least_ = 1e-14 * (a[0][0] + a[1][1] + a[2][2] + a[3][3] + a[4][4]);
    for (std::size_t i = 0; i < 3; ++i) {
      const Lanes inverse = inverse_of(i);
      for (std::size_t j = i + 1; j < 5; ++j) {
        const Lanes part = a_[j][i] * inverse;
        for (std::size_t k = j; k < 5; ++k) a_[k][j] -= part * a_[k][i];
        add(-part, b_[i], b_[j]);
      }
      for (std::size_t j = i + 1; j < 5; ++j) a_[j][i] *= inverse;
      b_[i].colwise() *= inverse;
    }
  }

  // By how much the unknowns 0, 1, 2 and `last` change a sum of squares, written so that their
  // errors count by their squares.
  Lanes change_by(std::size_t last) const {
    std::array<Rows, 4> x;
    x[3] = b_[last].colwise() * inverse_of(last);
    for (std::size_t i = 3; i-- > 0;) {
      x[i] = b_[i];
      add(-a_[last][i], x[3], x[i]);
      for (std::size_t j = i + 1; j < 3; ++j) add(-a_[j][i], x[j], x[i]);
    }
    Lanes change = Lanes::Zero();
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t row = i < 3 ? i : last;
      Rows half = -right_[row];
      add(0.5 * matrix_[row][row], x[i], half);
      for (std::size_t j = 0; j < i; ++j) add(matrix_[row][j], x[j], half);
      change += 2 * (x[i] * half).rowwise().sum();
    }
    return change;
  }

 private:
  Lanes inverse_of(std::size_t i) const { return (a_[i][i] > least_).select(1 / a_[i][i], 0.0); }

  const Matrix& matrix_;
  const Right& right_;
  Matrix a_;
  Right b_;
  Lanes least_;
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
      const Vec3 off = track[static_cast<std::size_t>(f)] - middle;
      const double t = (f - centre_) / reach_;
      Sums& next = upto_[index + 1];
      next = upto_[index];
      double power = 1;
      for (int k = 0; k < kPowers; ++k, power *= t) {
        next.powers[k] += power;
        if (k < kOffPowers) next.offs.row(k) += power * off.transpose().array();
      }
      squares_ += off.squaredNorm();
    }
  }

  // The sums of squares that the best pieces leave that meet at each moment. The moving side begins
  // without velocity of its own or, if that fits far better, with one at once.
  Lanes misfits(const Lanes& moments) const {
    // u = (f - moment) * sign / reach is < 0 on the moving side, whose columns u^2, u^3 and u are 0
    // on the other side.
    const Sums& total = upto_.back();
    std::array<Lanes, kPowers> part;
    std::array<Rows, kOffPowers> part_offs;
    for (int lane = 0; lane < kLanes; ++lane) {
      const double moment = moments[lane];
      const int split = static_cast<int>(sign_ > 0 ? std::ceil(moment) : std::floor(moment) + 1);
      const Sums& before = upto_[at(std::clamp(split - first_, 0, last_ + 1 - first_))];
      for (int k = 0; k < kPowers; ++k) {
        part[at(k)][lane] = sign_ < 0 ? total.powers[k] - before.powers[k] : before.powers[k];
      }
      for (int k = 0; k < kOffPowers; ++k) {
        part_offs[at(k)].row(lane) = before.offs.row(k);
        if (sign_ < 0) part_offs[at(k)].row(lane) = total.offs.row(k) - before.offs.row(k);
      }
    }
    std::array<Lanes, 3> all;
    std::array<Rows, 2> all_offs;
    for (int k = 0; k < 3; ++k) all[at(k)].setConstant(total.powers[k]);
    for (int k = 0; k < 2; ++k) all_offs[at(k)].rowwise() = total.offs.row(k);
    const Lanes by = (centre_ - moments) / reach_;
    shift(by, sign_, part), shift(by, sign_, part_offs);
    shift(by, sign_, all), shift(by, sign_, all_offs);
    constexpr std::array<std::size_t, 5> kExponents = {0, 1, 2, 3, 1};
    Systems::Matrix matrix;
    Systems::Right right;
    for (std::size_t i = 0; i < 5; ++i) {
      for (std::size_t j = 0; j < 5; ++j) matrix[j][i] = part[kExponents[i] + kExponents[j]];
      right[i] = i < 2 ? all_offs[i] : part_offs[kExponents[i]];
    }
    matrix[0][0] = all[0];
    matrix[1][0] = all[1];
    // One row more, which holds the drift down: a point that stays drifts only where its place on
    // the foot is not quite right, and jitter must not be taken for that.
    matrix[1][1] = all[2] + 4 * stiffness_ * stiffness_;
    const Systems systems(matrix, right);
    return (squares_ + systems.change_by(3)).min(kSudden * (squares_ + systems.change_by(4)));
  }

 private:
  static constexpr int kPowers = 7, kOffPowers = 4;
  // Of t^k, and of t^k times the place, over some frames, where t = (f - centre) / reach.
  struct Sums {
    Eigen::Array<double, kPowers, 1> powers = Eigen::Array<double, kPowers, 1>::Zero();
    Eigen::Array<double, kOffPowers, 3> offs = Eigen::Array<double, kOffPowers, 3>::Zero();
  };

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
    for (double moment = low; moment <= high + 1e-9;) {
      Lanes moments;
      for (double& lane : moments) lane = std::exchange(moment, moment + kStep);
      const Lanes left = pieces.misfits(moments);
      for (int i = 0; i < kLanes && moments[i] <= high + 1e-9; ++i) {
        if (least >= 0 && left[i] >= least) continue;
        least = left[i];
        best = moments[i];
      }
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
