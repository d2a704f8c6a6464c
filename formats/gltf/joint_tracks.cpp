#include "formats/gltf/joint_tracks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <memory>
#include <span>

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
  TrackBuilder(const Skeleton& rest, const FrameSource& source, double tolerance, int jobs,
               JointTracks& tracks)
      : rest_(rest),
        source_(source),
        tolerance_(tolerance),
        jobs_(jobs),
        result_(tracks),
        joints_(rest.names.size()),
        frames_(static_cast<std::size_t>(source.frame_count)),
        blocks_((frames_ + kFramesAtOnce - 1) / kFramesAtOnce),
        tracks_(joints_, track_detail::kRotates) {
    for (const JointTrack& joint : tracks.joints) {
      for (int k = 0; k < 3; ++k) rest_translations_.push_back(joint.rest_translation[k]);
      for (int k = 0; k < 4; ++k) rest_rotations_.push_back(joint.rest_rotation.coeffs()[k]);
    }
  }

  Status build() {
    if (frames_ == 0) return {};
    if (Status status = settle_on_samples(); !status) return status;
    for (;;) {
      take_memory();
      Seen seen(joints_, 0);
      if (Status status = fill(seen); !status) return status;
      if (seen == tracks_) break;
      tracks_ = std::move(seen);
    }
    parallel_for(joints_, 1, jobs_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j) join_blocks(result_.joints[j]);
    });
    return {};
  }

 private:
  using Seen = std::vector<std::uint8_t>;

  // Working memory for a block of frames.
  struct Room {
    std::vector<Vec3f> positions;
    std::vector<Quatf> orientations;
    std::vector<double> scratch;
    std::vector<track_detail::Places> places;
    Seen seen;
  };

  track_detail::Nodes nodes() const {
    return {rest_.parents.data(),   joints_,        rest_translations_.data(),
            rest_rotations_.data(), tracks_.data(), tolerance_,
            kAngleTolerance};
  }

  // Adds the tracks that the block's frames need to room.seen; stores the values if `keep`.
  Status do_block(std::size_t block, bool keep, Room& room) {
    constexpr std::size_t kAlignment = 64;
    const std::size_t first = block * kFramesAtOnce;
    const std::size_t count = std::min(kFramesAtOnce, frames_ - first);
    room.positions.resize(kFramesAtOnce * joints_);
    room.orientations.resize(kFramesAtOnce * joints_);
    room.scratch.resize(track_detail::kScratch * joints_ + kAlignment / sizeof(double));
    room.seen.resize(joints_, 0);
    Status status = source_.read(static_cast<int>(first), static_cast<int>(count),
                                 std::span(room.positions).first(count * joints_),
                                 std::span(room.orientations).first(count * joints_));
    if (!status) return status;
    room.places.assign(joints_, {});
    for (std::size_t j = 0; keep && j < joints_; ++j) {
      JointTrack& track = result_.joints[j];
      if (!track.rotations.empty())
        room.places[j].rotations = track.rotations[first].coeffs().data();
      if (!track.translations.empty())
        room.places[j].translations = track.translations[first].data();
    }
    void* scratch = room.scratch.data();
    std::size_t space = room.scratch.size() * sizeof(double);
    std::align(kAlignment, 1, scratch, space);
    track_detail::joint_tracks(nodes(), room.positions.data()->data(),
                               room.orientations.data()->coeffs().data(), count, room.places.data(),
                               static_cast<double*>(scratch), room.seen.data());
    for (std::size_t j = 0; keep && j < joints_; ++j) {
      if (!result_.joints[j].rotations.empty()) {
        join_signs(std::span(result_.joints[j].rotations).subspan(first, count));
      }
    }
    return {};
  }

  Status settle_on_samples() {
    constexpr std::size_t kSamples = 4;
    for (std::size_t round = 0; round < kSamples; ++round) {
      Room room;
      for (std::size_t i = 0; i < std::min(kSamples, blocks_); ++i) {
        if (Status status = do_block(i * blocks_ / kSamples % blocks_, false, room); !status)
          return status;
      }
      if (room.seen == tracks_) break;
      tracks_ = std::move(room.seen);
    }
    return {};
  }

  void take_memory() {
    for (std::size_t j = 0; j < joints_; ++j) {
      JointTrack& track = result_.joints[j];
      track.rotations.resize((tracks_[j] & track_detail::kRotates) != 0 ? frames_ : 0);
      track.translations.resize((tracks_[j] & track_detail::kMoves) != 0 ? frames_ : 0);
    }
  }

  Status fill(Seen& seen) {
    std::vector<Room> rooms(slots_for(jobs_));
    const auto make = [&](std::size_t block, std::size_t slot) {
      return do_block(block, true, rooms[slot]);
    };
    const auto take = [&](std::size_t block, std::size_t) {
      if (source_.release) {
        source_.release(static_cast<int>(std::min((block + 1) * kFramesAtOnce, frames_)));
      }
      return Status();
    };
    if (Status status = make_in_order(blocks_, jobs_, make, take); !status) return status;
    for (const Room& room : rooms) {
      for (std::size_t j = 0; j < room.seen.size(); ++j) seen[j] |= room.seen[j];
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

  // Negates whole blocks that are not in the hemisphere of the previous one; the first block is
  // compared with the rest rotation.
  void join_blocks(JointTrack& track) const {
    Quatf before = track.rest_rotation;
    for (std::size_t first = 0; first < track.rotations.size(); first += kFramesAtOnce) {
      const auto block =
          std::span(track.rotations).subspan(first, std::min(kFramesAtOnce, frames_ - first));
      if (before.dot(block.front()) < 0) {
        for (Quatf& rotation : block) turn_over(rotation);
      }
      before = block.back();
    }
  }

  const Skeleton& rest_;
  const FrameSource& source_;
  const double tolerance_;
  const int jobs_;
  JointTracks& result_;
  const std::size_t joints_, frames_, blocks_;
  Seen tracks_;  // [joints], the tracks that each is assumed to have
  std::vector<float> rest_translations_, rest_rotations_;
};

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
  assert(rest.joint_count() == source.joint_count());
  auto times = key_times(source.frame_count, source.rate);
  if (!times) return times.error();
  JointTracks tracks = rest_tracks(rest);
  tracks.times = std::move(*times);
  tracks.rate = source.rate;
  TrackBuilder builder(rest, source, tolerance, jobs, tracks);
  if (Status status = builder.build(); !status) return status.error();
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
