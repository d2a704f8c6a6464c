#include "filter/noise_filter.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/index.h"
#include "core/parallel.h"
#include "filter/rotation_series.h"
#include "filter/series_denoiser.h"
#include "math/quaternion.h"
#include "motion/local_motion.h"

namespace krok::filter {

namespace {

using Eigen::MatrixXd;

constexpr int kMinFrames = 20;
constexpr double kCourseCutoff = 6;  // Hz; the course that is unrolled along
constexpr double kDeviations = 5, kUsual = 3.5;
constexpr int kNear = 5;  // frames on either side, of which two may be as far off as half a spike
constexpr double kMinNoiseAngle = 1e-3 * kRadiansPerDegree, kMinNoiseDistance = 1e-5;
constexpr int kSpikeRounds = 6;  // each replaces the largest of neighbouring outliers

// The rotations or positions of one joint as vectors, [frames x 3].
class Track {
 public:
  Track(LocalMotion& motion, int joint, bool of_position, double rate)
      : joint_(joint), of_position_(of_position), rate_(rate) {
    if (of_position) {
      positions_ = motion.joint_positions(joint);
    } else {
      rotations_ = motion.joint_orientations(joint);
    }
  }

  void find_spikes(const WhittakerLadder& ladder);
  void unroll();
  double noise() const { return noise_; }
  bool is_noisy() const { return noise_ > (of_position_ ? kMinNoiseDistance : kMinNoiseAngle); }
  bool of_position() const { return of_position_; }
  const MatrixXd& vectors() const { return vectors_; }
  void set(const MatrixXd& vectors);
  const std::vector<Spike>& spikes() const { return spikes_; }

 private:
  int size() const {
    return static_cast<int>(of_position_ ? positions_.size() : rotations_.size());
  }
  bool replace_outliers(const WhittakerLadder& ladder);
  void replace(int frame, const Vec3& vector);

  int joint_;
  bool of_position_;
  double rate_;
  std::span<Vec3> positions_;
  std::span<Quat> rotations_;
  std::vector<Quat> course_;
  MatrixXd rolled_out_, vectors_;
  double noise_ = 0;
  std::vector<Spike> spikes_;
  std::vector<double> weights_;  // 0 for frames that were spikes
};

void Track::unroll() {
  vectors_.resize(size(), 3);
  if (of_position_) {
    for (int f = 0; f < size(); ++f) vectors_.row(f) = positions_[at(f)].transpose();
  } else {
    const double lambda = whittaker_lambda(std::min(kCourseCutoff, 0.4 * rate_), rate_);
    course_.assign(rotations_.begin(), rotations_.end());
    smooth_rotations([smoother = Whittaker(size(), lambda)](
                         std::span<double> series) { smoother.smooth(series); },
                     course_);
    rolled_out_.resize(size(), 3);
    Vec3 sum = Vec3::Zero();
    for (int f = 0; f < size(); ++f) {
      const Quat& course = course_[at(f)];
      if (f > 0) sum += rotation_vector(course_[at(f - 1)].conjugate() * course);
      rolled_out_.row(f) = sum.transpose();
      vectors_.row(f) = (sum + rotation_vector(course.conjugate() * rotations_[at(f)])).transpose();
    }
  }
  noise_ = noise_deviation(vectors_);
}

void Track::replace(int frame, const Vec3& vector) {
  if (of_position_) {
    positions_[at(frame)] = vector;
  } else {
    const Vec3 offset = vector - Vec3(rolled_out_.row(frame).transpose());
    rotations_[at(frame)] =
        normalized_or_identity(course_[at(frame)] * from_rotation_vector(offset));
  }
}

void Track::set(const MatrixXd& vectors) {
  for (int f = 0; f < size(); ++f) replace(f, vectors.row(f).transpose());
}

// Distances of frames from the course of the others, which a frame's own share is taken out of.
bool Track::replace_outliers(const WhittakerLadder& ladder) {
  const Whittaker& smoother = ladder.choose(vectors_, noise_);
  MatrixXd smooth = vectors_;
  for (int axis = 0; axis < 3; ++axis) smoother.smooth({smooth.col(axis).data(), at(size())});
  const double others = 1 - std::min(0.95, smoother.freedom() / size());
  std::vector<double> distances(at(size()));
  for (int f = 0; f < size(); ++f) {
    distances[at(f)] = (smooth.row(f) - vectors_.row(f)).norm() / others;
  }
  const SpikeOptions usual;
  const double limit =
      std::max(of_position_ ? usual.least_distance : usual.least_angle, kDeviations * noise_);
  const int around = std::max(10, static_cast<int>(std::lround(0.5 * rate_)));
  const int longest = std::max(1, static_cast<int>(std::lround(usual.longest * rate_)));
  std::vector<int> found;
  std::vector<double> near;
  for (int f = 0; f < size(); ++f) {
    const auto range = [&](int reach) {
      return std::pair{distances.begin() + std::max(0, f - reach),
                       distances.begin() + std::min(size(), f + reach + 1)};
    };
    if (distances[at(f)] <= limit || weights_[at(f)] == 0) continue;
    const auto [first, last] = range(longest);
    if (*std::max_element(first, last) > distances[at(f)]) continue;
    const auto usual_of = [&](int reach, std::size_t rank_from_top) {
      const auto [begin, end] = range(reach);
      near.assign(begin, end);
      const auto place =
          near.end() - static_cast<std::ptrdiff_t>(std::min(near.size(), rank_from_top));
      std::nth_element(near.begin(), place, near.end());
      return *place;
    };
    const double typical = usual_of(around, static_cast<std::size_t>(around + 1));
    // Fast motion is off in more frames than a spike.
    const bool alone = distances[at(f)] > 2 * usual_of(kNear, 3);
    if (alone && distances[at(f)] > kUsual * typical) found.push_back(f);
  }
  if (found.empty()) return false;
  for (const int f : found) weights_[at(f)] = 0;
  const Whittaker without(size(), smoother.lambda(), weights_);
  smooth = vectors_;
  for (int axis = 0; axis < 3; ++axis) without.smooth({smooth.col(axis).data(), at(size())});
  for (int f = 0; f < size(); ++f) {
    if (weights_[at(f)] == 0) replace(f, smooth.row(f).transpose());
  }
  for (const int f : found) {
    const double moved = (smooth.row(f) - vectors_.row(f)).norm();
    spikes_.push_back({joint_, f, f, of_position_, moved});
  }
  return true;
}

void Track::find_spikes(const WhittakerLadder& ladder) {
  weights_.assign(at(size()), 1.0);
  for (int round = 0; round < kSpikeRounds; ++round) {
    unroll();
    if (!is_noisy() || !replace_outliers(ladder)) return;
  }
  unroll();
}

void sort_spikes(std::vector<Spike>& spikes) {
  std::ranges::stable_sort(spikes, {}, [](const Spike& spike) {
    return std::tuple(spike.joint, spike.of_position, spike.first_frame);
  });
}

}  // namespace

Result<NoiseRemoval> remove_noise(const Clip& clip, std::span<const std::uint8_t> joints,
                                  int jobs) {
  auto removal = remove_spikes(clip, {}, joints, jobs);
  if (!removal) return removal.error();
  NoiseRemoval result{std::move(removal->clip), std::move(removal->spikes), 0, 0};
  if (clip.frame_count() < kMinFrames) return result;
  LocalMotion motion = local_motion(result.clip);
  const std::vector<std::uint8_t> moving = moving_joints(motion);
  std::vector<Track> tracks;
  for (int j = 0; j < motion.joints; ++j) {
    if (!joints.empty() && joints[at(j)] == 0) continue;
    tracks.emplace_back(motion, j, false, clip.rate);
    if (moving[at(j)] != 0) tracks.emplace_back(motion, j, true, clip.rate);
  }
  const WhittakerLadder ladder(clip.frame_count());
  parallel_for(tracks.size(), 1, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) tracks[i].find_spikes(ladder);
  });
  std::vector<double> angles;
  std::vector<Track*> noisy;
  for (Track& track : tracks) {
    result.spikes.insert(result.spikes.end(), track.spikes().begin(), track.spikes().end());
    if (!track.is_noisy()) continue;
    noisy.push_back(&track);
    if (track.of_position()) {
      if (result.distance == 0) result.distance = track.noise();
    } else {
      angles.push_back(track.noise());
    }
  }
  sort_spikes(result.spikes);
  if (noisy.empty()) return result;
  if (!angles.empty()) {
    std::ranges::nth_element(angles,
                             angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2));
    result.angle = angles[angles.size() / 2];
  }
  MatrixXd series(clip.frame_count(), 3 * static_cast<Eigen::Index>(noisy.size()));
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    series.middleCols(static_cast<Eigen::Index>(3 * i), 3) =
        noisy[i]->vectors() / noisy[i]->noise();
  }
  series = without_noise(series, clip.rate, jobs);
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    noisy[i]->set(series.middleCols(static_cast<Eigen::Index>(3 * i), 3) * noisy[i]->noise());
  }
  set_local_motion(motion, result.clip);
  return result;
}

}  // namespace krok::filter
