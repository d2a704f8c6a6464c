#include "formats/gltf/joint_tracks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <memory>

#include "core/numbers.h"
#include "core/parallel.h"
#include "formats/gltf/filters_internal.h"
#include "formats/gltf/track_kernel_internal.h"
#include "math/quaternion.h"

namespace krok::gltf {

namespace {

constexpr double kAngleTolerance = 1e-6;  // radians

constexpr std::size_t kFramesAtOnce = 128;

// Computes the tracks of all joints in blocks of frames. Which joints need tracks is known only
// after all frames, yet affects their descendants, which are relative to what a viewer shows. It is
// therefore estimated from a few frames. If other frames need more tracks, everything is computed
// again with those; each pass settles the decisions of one more level of the hierarchy.
class TrackBuilder {
 public:
  // `rest`: those of rest_tracks(). The skeleton and the source must outlive it.
  TrackBuilder(const Skeleton& skeleton, const JointTracks& rest, const FrameSource& source,
               double tolerance, int jobs)
      : parents_(skeleton.parents),
        source_(source),
        tolerance_(tolerance),
        jobs_(jobs),
        joints_(skeleton.names.size()),
        frames_(static_cast<std::size_t>(source.frame_count)),
        blocks_((frames_ + kFramesAtOnce - 1) / kFramesAtOnce),
        tracks_(joints_, track_detail::kRotates) {
    for (const JointTrack& joint : rest.joints) {
      for (int k = 0; k < 3; ++k) rest_translations_.push_back(joint.rest_translation[k]);
      for (int k = 0; k < 4; ++k) rest_rotations_.push_back(joint.rest_rotation.coeffs()[k]);
    }
  }

  bool moves(std::size_t joint) const { return (tracks_[joint] & track_detail::kMoves) != 0; }
  bool rotates(std::size_t joint) const { return (tracks_[joint] & track_detail::kRotates) != 0; }

  // Finds which tracks there are. `begin` is called before a pass over all frames, whose keys
  // `take` gets, if set: those of the last pass are the result.
  Status find(const std::function<void()>& begin, const JointTracks::TakeKeys& take) {
    if (frames_ == 0) {
      tracks_.assign(joints_, 0);
      return {};
    }
    if (Status status = settle_on_samples(); !status) return status;
    for (;;) {
      begin();
      Seen seen(joints_, 0);
      if (Status status = read(take, seen); !status) return status;
      if (seen == tracks_) return {};
      tracks_ = std::move(seen);
    }
  }

  Status read(const JointTracks::TakeKeys& take) const {
    Seen seen(joints_, 0);
    return read(take, seen);
  }

 private:
  using Seen = std::vector<std::uint8_t>;

  // Working memory for a block of frames.
  struct Block {
    std::vector<Vec3f> positions;
    std::vector<Quatf> orientations;
    std::vector<double> scratch;
    std::vector<track_detail::Places> places;
    std::vector<Vec3f> translations;  // [joints x kFramesAtOnce], as the rotations
    std::vector<Quatf> rotations;
    Seen seen;

    template <typename Value>
    static std::span<Value> keys_of(std::size_t joint, std::size_t count,
                                    std::vector<Value>& values) {
      return std::span(values).subspan(joint * kFramesAtOnce, count);
    }
  };

  track_detail::Nodes nodes() const {
    return {parents_.data(),        joints_,        rest_translations_.data(),
            rest_rotations_.data(), tracks_.data(), tolerance_,
            kAngleTolerance};
  }

  std::size_t frames_in(std::size_t block) const {
    return std::min(kFramesAtOnce, frames_ - block * kFramesAtOnce);
  }

  // Adds the tracks that the block's frames need to made.seen; computes the keys if `keep`.
  Status do_block(std::size_t block, bool keep, Block& made) const {
    constexpr std::size_t kAlignment = 64;
    const std::size_t first = block * kFramesAtOnce, count = frames_in(block);
    made.positions.resize(kFramesAtOnce * joints_);
    made.orientations.resize(kFramesAtOnce * joints_);
    made.scratch.resize(track_detail::kScratch * joints_ + kAlignment / sizeof(double));
    made.seen.resize(joints_, 0);
    Status status = source_.read(static_cast<int>(first), static_cast<int>(count),
                                 std::span(made.positions).first(count * joints_),
                                 std::span(made.orientations).first(count * joints_));
    if (!status) return status;
    made.places.assign(joints_, {});
    if (keep) {
      made.translations.resize(kFramesAtOnce * joints_);
      made.rotations.resize(kFramesAtOnce * joints_);
    }
    for (std::size_t j = 0; keep && j < joints_; ++j) {
      if (rotates(j)) {
        made.places[j].rotations = made.rotations[j * kFramesAtOnce].coeffs().data();
      }
      if (moves(j)) made.places[j].translations = made.translations[j * kFramesAtOnce].data();
    }
    void* scratch = made.scratch.data();
    std::size_t space = made.scratch.size() * sizeof(double);
    std::align(kAlignment, 1, scratch, space);
    track_detail::joint_tracks(nodes(), made.positions.data()->data(),
                               made.orientations.data()->coeffs().data(), count, made.places.data(),
                               static_cast<double*>(scratch), made.seen.data());
    for (std::size_t j = 0; keep && j < joints_; ++j) {
      if (rotates(j)) join_signs(Block::keys_of(j, count, made.rotations));
    }
    return {};
  }

  Status settle_on_samples() {
    constexpr std::size_t kSamples = 4;
    for (std::size_t round = 0; round < kSamples; ++round) {
      Block made;
      for (std::size_t i = 0; i < std::min(kSamples, blocks_); ++i) {
        if (Status status = do_block(i * blocks_ / kSamples % blocks_, false, made); !status)
          return status;
      }
      if (made.seen == tracks_) break;
      tracks_ = std::move(made.seen);
    }
    return {};
  }

  Status read(const JointTracks::TakeKeys& take, Seen& seen) const {
    std::vector<Block> made(slots_for(jobs_));
    // The last rotations: each block is turned into the hemisphere of the one before, the first
    // into that of the rest rotation.
    std::vector<Quatf> before;
    for (std::size_t j = 0; j < joints_; ++j) before.emplace_back(&rest_rotations_[4 * j]);
    const auto make = [&](std::size_t block, std::size_t slot) {
      return do_block(block, static_cast<bool>(take), made[slot]);
    };
    const auto pass_on = [&](std::size_t block, std::size_t slot) -> Status {
      const std::size_t first = block * kFramesAtOnce, count = frames_in(block);
      for (std::size_t j = 0; take && j < joints_; ++j) {
        std::span<Vec3f> translations;
        std::span<Quatf> rotations;
        if (moves(j)) translations = Block::keys_of(j, count, made[slot].translations);
        if (rotates(j)) {
          rotations = Block::keys_of(j, count, made[slot].rotations);
          if (before[j].dot(rotations.front()) < 0) std::ranges::for_each(rotations, turn_over);
          before[j] = rotations.back();
        }
        if (Status status = take(j, first, translations, rotations); !status) return status;
      }
      if (source_.release) source_.release(static_cast<int>(first + count));
      return {};
    };
    if (Status status = make_in_order(blocks_, jobs_, make, pass_on); !status) return status;
    for (const Block& block : made) {
      for (std::size_t j = 0; j < block.seen.size(); ++j) seen[j] |= block.seen[j];
    }
    return {};
  }

  static void turn_over(Quatf& q) { q.coeffs() = -q.coeffs(); }

  // Brings each rotation into the hemisphere of the previous one.
  static void join_signs(std::span<Quatf> rotations) {
    for (std::size_t f = 1; f < rotations.size(); ++f) {
      if (rotations[f - 1].dot(rotations[f]) < 0) turn_over(rotations[f]);
    }
  }

  const std::vector<int> parents_;
  const FrameSource& source_;
  const double tolerance_;
  const int jobs_;
  const std::size_t joints_, frames_, blocks_;
  Seen tracks_;  // [joints], the tracks that each is assumed to have
  std::vector<float> rest_translations_, rest_rotations_;
};

Result<JointTracks> tracks_at_rest(const Skeleton& rest, const FrameSource& source) {
  assert(rest.joint_count() == source.joint_count());
  auto times = key_times(source.frame_count, source.rate);
  if (!times) return times.error();
  JointTracks tracks = rest_tracks(rest);
  tracks.times = std::move(*times);
  tracks.rate = source.rate;
  return tracks;
}

}  // namespace

Result<std::vector<float>> key_times(int frames, double rate) {
  std::vector<float> times(frames);
  for (int f = 0; f < frames; ++f) {
    times[f] = static_cast<float>(f / rate);
    if (!std::isfinite(times[f]) || (f > 0 && !(times[f] > times[f - 1]))) {
      return Error("gltf-times",
                   fmt::format("at {} frames per second, frames {} and {} have the same time in "
                               "glTF, which stores times as floats",
                               readable(rate), f - 1, f),
                   "split the motion, or lower the frame rate");
    }
  }
  return times;
}

JointTracks rest_tracks(const Skeleton& rest) {
  JointTracks tracks;
  tracks.joints.resize(rest.names.size());
  for (int j = 0; j < rest.joint_count(); ++j) {
    const Transform local = rest.reference_local(j);
    tracks.joints[j].rest_translation = local.position.cast<float>();
    tracks.joints[j].rest_rotation = normalized_or_identity(local.orientation).cast<float>();
  }
  return tracks;
}

Result<JointTracks> joint_tracks(const Skeleton& rest, const Clip& clip, double tolerance) {
  auto tracks = joint_tracks(rest, frames_of(clip), 1, tolerance);
  if (tracks) tracks->removed_root_motion = clip.provenance.removed_root_motion;
  return tracks;
}

Result<JointTracks> joint_tracks(const Skeleton& rest, const FrameSource& source, int jobs,
                                 double tolerance) {
  auto tracks = tracks_at_rest(rest, source);
  if (!tracks) return tracks;
  TrackBuilder builder(rest, *tracks, source, tolerance, jobs);
  const auto begin = [&] {
    for (std::size_t j = 0; j < tracks->joints.size(); ++j) {
      tracks->joints[j].translations.resize(builder.moves(j) ? tracks->times.size() : 0);
      tracks->joints[j].rotations.resize(builder.rotates(j) ? tracks->times.size() : 0);
    }
  };
  const auto take = [&](std::size_t joint, std::size_t first, std::span<const Vec3f> translations,
                        std::span<const Quatf> rotations) {
    const auto place = static_cast<std::ptrdiff_t>(first);
    std::ranges::copy(translations, tracks->joints[joint].translations.begin() + place);
    std::ranges::copy(rotations, tracks->joints[joint].rotations.begin() + place);
    return Status();
  };
  if (Status status = builder.find(begin, take); !status) return status.error();
  return tracks;
}

Result<JointTracks> streamed_tracks(const Skeleton& rest, const FrameSource& source, int jobs,
                                    double tolerance) {
  auto tracks = tracks_at_rest(rest, source);
  if (!tracks) return tracks;
  const auto builder = std::make_shared<TrackBuilder>(rest, *tracks, source, tolerance, jobs);
  if (Status status = builder->find([] {}, {}); !status) return status.error();
  for (std::size_t j = 0; j < tracks->joints.size(); ++j) {
    tracks->joints[j].read_translations = builder->moves(j);
    tracks->joints[j].read_rotations = builder->rotates(j);
  }
  tracks->read = [builder](const JointTracks::TakeKeys& take) { return builder->read(take); };
  return tracks;
}

JointTracks rounded(const JointTracks& tracks, bool filtered) {
  JointTracks result = tracks;
  for (JointTrack& track : result.joints) {
    for (std::vector<Quatf>* rotations : {&track.rotations, &track.inner_rotations}) {
      if (rotations->empty() || track.rotation_bits == JointTrack::kExact) continue;
      if (filtered && track.rotation_bits <= JointTrack::kShortBits) {
        *rotations = decoded_quaternion(*rotations, track.rotation_bits);
        continue;
      }
      for (Quatf& rotation : *rotations) {
        for (float& component : rotation.coeffs()) {
          component = track.rotation_bits > JointTrack::kShortBits
                          ? in_steps(component, 1 - track.rotation_bits)
                          : std::round(component * 32767.0f) / 32767.0f;
        }
        rotation.normalize();
      }
    }
    if (!filtered || track.translation_exponent == JointTrack::kExact) continue;
    for (Vec3f& translation : track.translations) {
      for (float& component : translation) {
        component = in_steps(component, track.translation_exponent);
      }
    }
  }
  return result;
}

}  // namespace krok::gltf
