#include "filter/noise_filter.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "core/index.h"
#include "core/parallel.h"
#include "filter/series_denoiser.h"
#include "filter/smooth_clip.h"
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

// What the noise of a Track is like: its deviation, and by which risks strengths are chosen, for
// the course that spikes are far from and in without_noise().
struct NoiseLevel {
  double noise = 0;
  Risks course;
  GroupRisks smoothing;
};

bool is_noise(double deviation, bool of_position) {
  return deviation > (of_position ? kMinNoiseDistance : kMinNoiseAngle);
}

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

  // `known` (optional): instead of what these frames show.
  void find_spikes(const WhittakerLadder& ladder, const NoiseLevel* known);
  double noise() const { return level_.noise; }
  bool is_noisy() const { return is_noise(noise(), of_position_); }
  NoiseLevel& level() { return level_; }
  bool of_position() const { return of_position_; }
  const MatrixXd& vectors() const { return vectors_; }
  void unroll();
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
  NoiseLevel level_;
  bool is_known_ = false;
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
  if (!is_known_) level_.noise = noise_deviation(vectors_);
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
  const Risks risks = is_known_ ? level_.course : ladder.risks(vectors_, noise());
  if (level_.course.empty()) level_.course = risks;
  const Whittaker& smoother = ladder.choose(risks);
  MatrixXd smooth = vectors_;
  for (int axis = 0; axis < 3; ++axis) smoother.smooth({smooth.col(axis).data(), at(size())});
  const double others = 1 - std::min(0.95, smoother.freedom() / size());
  std::vector<double> distances(at(size()));
  for (int f = 0; f < size(); ++f) {
    distances[at(f)] = (smooth.row(f) - vectors_.row(f)).norm() / others;
  }
  const SpikeOptions usual;
  const double limit =
      std::max(of_position_ ? usual.least_distance : usual.least_angle, kDeviations * noise());
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

void Track::find_spikes(const WhittakerLadder& ladder, const NoiseLevel* known) {
  is_known_ = known != nullptr;
  if (is_known_) level_ = *known;
  if (is_known_ && !is_noisy()) return;
  weights_.assign(at(size()), 1.0);
  for (int round = 0; round < kSpikeRounds; ++round) {
    unroll();
    if (!is_noisy() || !replace_outliers(ladder)) return;
  }
  unroll();
}

// Spikes in frames side by side as one.
std::vector<Spike> in_runs(std::vector<Spike> spikes) {
  std::ranges::sort(spikes, {}, &Spike::first_frame);
  std::vector<Spike> runs;
  for (const Spike& spike : spikes) {
    if (runs.empty() || spike.first_frame > runs.back().last_frame + 1) {
      runs.push_back(spike);
      continue;
    }
    runs.back().last_frame = std::max(runs.back().last_frame, spike.last_frame);
    runs.back().size = std::max(runs.back().size, spike.size);
  }
  return runs;
}

// Of noisy tracks the median of rotations, and the first position, which is the root's.
void set_noise(std::span<const NoiseLevel> levels, std::span<const std::uint8_t> of_position,
               double& angle, double& distance) {
  std::vector<double> angles;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const bool position = of_position[i] != 0;
    if (!is_noise(levels[i].noise, position)) continue;
    if (!position) angles.push_back(levels[i].noise);
    if (position && distance == 0) distance = levels[i].noise;
  }
  if (angles.empty()) return;
  const auto middle = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2);
  std::ranges::nth_element(angles, middle);
  angle = *middle;
}

struct Denoised {
  NoiseRemoval removal;
  std::vector<NoiseLevel> levels;         // [tracks]
  std::vector<std::uint8_t> of_position;  // [tracks]
};

// Steps 2 to 4 of a clip without plain spikes. `moving`: as of moving_joints(), of the whole
// motion; `known`: the tracks' levels, empty: those that this clip shows.
Denoised denoise(Clip clip, std::span<const std::uint8_t> joints,
                 std::span<const std::uint8_t> moving, int jobs,
                 std::span<const NoiseLevel> known) {
  Denoised result;
  NoiseRemoval& made = result.removal;
  made.clip = std::move(clip);
  LocalMotion motion = local_motion(made.clip);
  const double rate = made.clip.rate;
  std::vector<Track> tracks;
  for (int j = 0; j < motion.joints; ++j) {
    if (!joints.empty() && joints[at(j)] == 0) continue;
    tracks.emplace_back(motion, j, false, rate);
    if (moving[at(j)] != 0) tracks.emplace_back(motion, j, true, rate);
  }
  const WhittakerLadder ladder(motion.frames);
  parallel_for(tracks.size(), 1, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      tracks[i].find_spikes(ladder, known.empty() ? nullptr : &known[i]);
    }
  });
  std::vector<Track*> noisy;
  for (Track& track : tracks) {
    const std::vector<Spike> spikes = in_runs(track.spikes());
    made.spikes.insert(made.spikes.end(), spikes.begin(), spikes.end());
    if (track.is_noisy()) noisy.push_back(&track);
  }
  if (!made.spikes.empty()) {
    const double most = 0.5 * SpikeOptions().least_distance;
    SpikeRemoval repaired = without_throws(made.clip, most, joints, motion, made.spikes);
    made.spikes = std::move(repaired.spikes);
    for (Track* track : noisy) track->unroll();
  }
  if (!noisy.empty()) {
    MatrixXd series(motion.frames, 3 * static_cast<Eigen::Index>(noisy.size()));
    std::vector<GroupRisks> risks, found;
    for (std::size_t i = 0; i < noisy.size(); ++i) {
      series.middleCols(static_cast<Eigen::Index>(3 * i), 3) =
          noisy[i]->vectors() / noisy[i]->noise();
      if (!known.empty()) risks.push_back(noisy[i]->level().smoothing);
    }
    series = without_noise(series, rate, jobs, risks, &found);
    for (std::size_t i = 0; i < noisy.size(); ++i) {
      noisy[i]->set(series.middleCols(static_cast<Eigen::Index>(3 * i), 3) * noisy[i]->noise());
      noisy[i]->level().smoothing = std::move(found[i]);
    }
    set_local_motion(motion, made.clip);
  }
  for (Track& track : tracks) {
    result.of_position.push_back(track.of_position() ? 1 : 0);
    result.levels.push_back(std::move(track.level()));
  }
  set_noise(result.levels, result.of_position, made.angle, made.distance);
  return result;
}

void add(const Risks& more, double times, Risks& sum) {
  sum.resize(std::max(sum.size(), more.size()), 0.0);
  for (std::size_t i = 0; i < more.size(); ++i) sum[i] += times * more[i];
}

constexpr int kSamples = 8, kMinSample = 256, kMaxSample = 2048;  // frames
// Frames over which what the end of a block changes falls to a hundredth with the strongest
// smoother of a WhittakerLadder; with usual ones a tenth of them.
constexpr int kReach = 1200;

// From samples spread evenly over the motion: of deviations the median, of risks the sum.
Result<Denoised> sample_levels(const FrameSource& source, std::span<const std::uint8_t> joints,
                               std::span<const std::uint8_t> moving, int jobs) {
  const int frames = std::min(source.frame_count,
                              std::clamp(source.frame_count / kSamples, kMinSample, kMaxSample));
  Denoised all;
  std::vector<std::vector<double>> noises;
  for (int sample = 0; sample < kSamples; ++sample) {
    const auto first = static_cast<int>(static_cast<long long>(source.frame_count - frames) *
                                        sample / (kSamples - 1));
    auto clip = load(part_of(source, first, frames), jobs);
    if (!clip) return clip.error();
    Denoised one = denoise(*std::move(clip), joints, moving, jobs, {});
    noises.resize(one.levels.size());
    all.levels.resize(one.levels.size());
    all.of_position = std::move(one.of_position);
    for (std::size_t i = 0; i < one.levels.size(); ++i) {
      const NoiseLevel& level = one.levels[i];
      noises[i].push_back(level.noise);
      add(level.course, 1, all.levels[i].course);
      // Those of without_noise() are in units of the noise.
      const double square = level.noise * level.noise;
      add(level.smoothing.common, square, all.levels[i].smoothing.common);
      add(level.smoothing.own, square, all.levels[i].smoothing.own);
    }
  }
  for (std::size_t i = 0; i < noises.size(); ++i) {
    std::ranges::sort(noises[i]);
    all.levels[i].noise = noises[i][noises[i].size() / 2];
  }
  set_noise(all.levels, all.of_position, all.removal.angle, all.removal.distance);
  return all;
}

}  // namespace

Result<NoiseRemoval> remove_noise(const Clip& clip, std::span<const std::uint8_t> joints,
                                  int jobs) {
  auto removal = remove_spikes(clip, {}, joints, jobs);
  if (!removal) return removal.error();
  if (clip.frame_count() < kMinFrames) {
    return NoiseRemoval{std::move(removal->clip), std::move(removal->spikes), 0, 0};
  }
  const std::vector<std::uint8_t> moving = moving_joints(local_motion(removal->clip));
  NoiseRemoval made = denoise(std::move(removal->clip), joints, moving, jobs, {}).removal;
  made.spikes.insert(made.spikes.begin(), removal->spikes.begin(), removal->spikes.end());
  sort_spikes(made.spikes);
  return made;
}

Result<NoiseFrames> remove_noise(
    const FrameSource& source, std::span<const std::uint8_t> joints, int jobs,
    const std::function<void(const FrameRun& before, const NoiseRemoval& after)>& watch,
    int block_frames) {
  // By the first frame kept of their block.
  const auto plain = std::make_shared<std::map<int, std::vector<Spike>>>();
  const auto keep = [plain](const FrameRun& run, const SpikeRemoval& removal) {
    (*plain)[run.first + run.kept_begin] = removal.spikes;
  };
  auto frames = remove_spikes(source, {}, joints, jobs, keep, block_frames);
  if (!frames) return frames.error();
  if (source.frame_count < kMinFrames) return NoiseFrames{*std::move(frames), 0, 0};
  auto moving = moving_joints(source, jobs);
  if (!moving) return moving.error();
  auto sample = sample_levels(*frames, joints, *moving, jobs);
  if (!sample) return sample.error();
  // Windows of without_noise() begin at the same frames in all blocks.
  const int step = window_step(source.rate);
  const BlockSize size{(block_frames + step - 1) / step * step, (kReach + step - 1) / step * step};
  NoiseFrames result;
  result.angle = sample->removal.angle;
  result.distance = sample->removal.distance;
  result.frames = changed_in_blocks(
      *frames, size, jobs,
      [source, plain, jobs, watch, moving = *std::move(moving), levels = std::move(sample->levels),
       joints = std::vector(joints.begin(), joints.end())](FrameRun& run) -> Status {
        NoiseRemoval made = denoise(std::move(run.clip), joints, moving, jobs, levels).removal;
        for (Spike& spike : made.spikes) {
          spike.first_frame += run.first;
          spike.last_frame += run.first;
        }
        for (const auto& [frame, spikes] : *plain) {
          made.spikes.insert(made.spikes.end(), spikes.begin(), spikes.end());
        }
        std::erase_if(made.spikes, [&](const Spike& spike) {
          return spike.first_frame < run.first + run.kept_begin ||
                 spike.first_frame >= run.first + run.kept_end;
        });
        sort_spikes(made.spikes);
        if (watch) {
          auto before = load(part_of(source, run.first, made.clip.frame_count()), jobs);
          if (!before) return before.error();
          run.clip = *std::move(before);
          watch(run, made);
        }
        run.clip = std::move(made.clip);
        return {};
      });
  return result;
}

}  // namespace krok::filter
