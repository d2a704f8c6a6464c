#include "blend/blend_clips.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "core/index.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "pose/packed_pose.h"

namespace krok::blend {

namespace {

// A motion split into the character's ground frame (position and heading) over time and poses
// relative to it, so that motions along different paths can be blended. Of the poses it has those
// of one part of the motion at a time.
class GroundedMotion {
 public:
  // `carrier` comes from carrying_joint(); -1 keeps the poses in world space and the ground frame
  // at the origin. `motion` needs at least one frame.
  static Result<GroundedMotion> of(const FrameSource& motion, int carrier, int jobs) {
    GroundedMotion grounded;
    grounded.motion_ = motion;
    grounded.carrier_ = carrier;
    grounded.places_.resize(at(motion.frame_count));
    if (carrier < 0) return grounded;
    const Status status = for_each_block(motion, jobs, [&](int first, const Clip& block) {
      for (int f = 0; f < block.frame_count(); ++f) {
        GroundFrame& place = grounded.places_[at(first + f)];
        place = ground_frame(block, carrier, f);
        if (first + f == 0) continue;
        const double before = grounded.places_[at(first + f - 1)].heading;
        place.heading = before + wrapped(place.heading - before);
      }
      return Status();
    });
    if (!status) return status.error();
    return grounded;
  }

  // Loads the poses between two times in seconds.
  Status load_between(double from, double to, int jobs) {
    const FrameMoment last = moment(to);
    begin_ = moment(from).before;
    const int end = last.before + (last.fraction > 0 ? 2 : 1);
    auto loaded = load(part_of(motion_, begin_, end - begin_), jobs);
    if (!loaded) return loaded.error();
    if (motion_.release) motion_.release(begin_);
    part_ = *std::move(loaded);
    if (carrier_ < 0) {
      poses_ = pack_clip(part_);
    } else {
      Clip grounded = part_;
      std::vector<Transform> pose(part_.skeleton.names.size());
      for (int f = 0; f < part_.frame_count(); ++f) {
        const Transform world_to_place = places_[at(begin_ + f)].to_world().inverse();
        part_.get_pose(f, pose);
        for (Transform& joint : pose) joint = world_to_place * joint;
        grounded.set_pose(f, pose);
      }
      poses_ = pack_clip(grounded);
    }
    poses_.rate = 1;
    return {};
  }

  // joint_to_parent of the part, a frame a second; the root is relative to the ground frame.
  const PackedClip& poses() const { return poses_; }
  // The place of a time within the part among its frames. A difference of frames is exact, so that
  // poses are those of the whole motion.
  double frame_in_part(double time) const {
    const FrameMoment at = moment(time);
    return at.before - begin_ + at.fraction;
  }

  // The ground frame at `time` seconds, linear between frames; the heading is unwrapped.
  GroundFrame place(double time) const {
    const FrameMoment now = moment(time);
    const auto i = static_cast<std::size_t>(now.before);
    GroundFrame place = places_[i];
    if (now.fraction == 0) return place;
    const GroundFrame& next = places_[i + 1];
    place.x += now.fraction * (next.x - place.x);
    place.z += now.fraction * (next.z - place.z);
    place.heading += now.fraction * (next.heading - place.heading);
    return place;
  }

  // World position of a joint at a time within the part.
  Vec3 position(int joint, double time) const {
    const FrameMoment now = moment(time);
    const auto j = static_cast<std::size_t>(joint);
    const Vec3 position = part_.frame_positions(now.before - begin_)[j].cast<double>();
    if (now.fraction == 0) return position;
    const Vec3 next = part_.frame_positions(now.before - begin_ + 1)[j].cast<double>();
    return position + now.fraction * (next - position);
  }

 private:
  FrameMoment moment(double time) const {
    return frame_moment(time, motion_.rate, motion_.frame_count);
  }

  FrameSource motion_;
  int carrier_ = -1;
  std::vector<GroundFrame> places_;  // [frames], unwrapped headings
  int begin_ = 0;                    // the part's first frame
  Clip part_;
  PackedClip poses_;
};

constexpr double kMaxTransforms = 1e8;
constexpr double kRounding = 1e-6;  // of a frame, for the number of frames
constexpr std::size_t kFramesAtOnce = 32;
constexpr int kFramesOfBlock = 4096;

Status check_sources(std::span<const BlendSource> inputs) {
  if (inputs.empty()) return Error("blend-empty", "there are no motions to blend");
  for (const BlendSource& input : inputs) {
    if (Status status = check(input.frames.skeleton); !status) {
      return std::move(status).error().in_file(input.name);
    }
    if (input.frames.frame_count == 0) {
      return Error("blend-empty", fmt::format("{} has no frames", input.name));
    }
    const std::string differs =
        difference_in_structure(inputs.front().frames.skeleton, input.frames.skeleton);
    if (!differs.empty()) {
      return Error("blend-skeleton",
                   fmt::format("{} and {} have different skeletons: {}", inputs.front().name,
                               input.name, differs),
                   "use krok-retarget to transfer one to the other's skeleton");
    }
    if (input.keys == nullptr) continue;
    const FrameSource& frames = input.frames;
    if (Status status = check(*input.keys, frames.skeleton, frames.duration()); !status) {
      return std::move(status).error().in_file(input.name);
    }
  }
  return {};
}

// ", here 0.3 and 0.7", of constant weights.
std::string in_shares(std::span<const BlendSource> inputs, double sum) {
  std::string text = ", here ";
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    text += fmt::format("{}{}",
                        i == 0                   ? ""
                        : i + 1 == inputs.size() ? " and "
                                                 : ", ",
                        readable(inputs[i].weight.at(0) / sum, 3));
  }
  return text;
}

// The sum is linear between the points of all curves, so checking at the points suffices.
Status check_sum(std::span<const BlendSource> inputs) {
  std::set<double> points = {0};
  for (const BlendSource& input : inputs) {
    points.insert(input.weight.generic.begin(), input.weight.generic.end());
  }
  for (const double point : points) {
    double sum = 0;
    for (const BlendSource& input : inputs) sum += input.weight.at(point);
    if (std::abs(sum - 1) <= 1e-6) continue;
    const bool constant = points.size() == 1;
    return Error("blend-sum",
                 fmt::format("the weights sum to {}{}, not to 1", readable(sum),
                             constant ? "" : fmt::format(" at generic time {}", readable(point))),
                 fmt::format("give each its share of 1{}; --modifier is for motions that are added "
                             "on top of another",
                             constant && sum > 0 ? in_shares(inputs, sum) : ""));
  }
  return {};
}

class Blender {
 public:
  static Result<std::shared_ptr<Blender>> make(std::vector<BlendSource> inputs,
                                               const RoleMap& roles, const BlendOptions& options,
                                               const BlendTime& time, double rate,
                                               const Correspondence& correspondence) {
    const auto blender = std::make_shared<Blender>();
    blender->options_ = options;
    const int carrier = options.align == Align::none ? -1 : carrying_joint(roles);
    for (const BlendSource& input : inputs) {
      auto motion = GroundedMotion::of(input.frames, carrier, options.jobs);
      if (!motion) return motion.error();
      blender->motions_.push_back(*std::move(motion));
    }
    blender->blended_.clip.skeleton = inputs.front().frames.skeleton;
    blender->blended_.clip.rate = rate;
    blender->frames_ = static_cast<int>(std::floor(time.duration() * rate + kRounding)) + 1;
    blender->inputs_ = std::move(inputs);
    blender->find_contact_joints();
    blender->find_times(time);
    blender->find_keys(time, correspondence);
    return blender;
  }

  int frames() const { return frames_; }
  const Blended& blended() const { return blended_; }

  // Makes the frames of a block; blocks come in order, or again.
  Status blend(FrameRun& run) {
    Clip& clip = run.clip;
    const int last = run.first + clip.frame_count() - 1;
    for (std::size_t m = 0; m < motions_.size(); ++m) {
      const auto& times = blended_.times[m];
      Status status = motions_[m].load_between(times[at(std::max(run.first - 1, 0))],
                                               times[at(last)], options_.jobs);
      if (!status) return status;
    }
    sum_poses(run.first, clip);
    if (options_.align != Align::none) walk(run.first, clip);
    find_spread(run.first, clip);
    for (std::size_t c = 0; c < middles_.size(); ++c) {
      if (middles_[c] < run.first || middles_[c] > last) continue;
      Contact& contact = blended_.keys.contacts[c];
      contact.place =
          clip.frame_positions(middles_[c] - run.first)[at(contact.joint)].cast<double>();
    }
    return {};
  }

 private:
  double weight(std::size_t motion, int frame) const {
    return inputs_[motion].weight.at(blended_.generic[at(frame)]);
  }

  // Joints with contacts in any motion; none unless all motions have keys.
  void find_contact_joints() {
    for (const BlendSource& input : inputs_) {
      if (input.keys == nullptr) {
        contact_joints_.clear();
        return;
      }
      auto& spans = spans_.emplace_back();
      std::vector<Contact> contacts = input.keys->contacts;
      std::ranges::stable_sort(contacts, {}, &Contact::start);
      for (const Contact& contact : contacts) {
        contact_joints_.insert(contact.joint);
        auto& of_joint = spans[contact.joint];
        if (of_joint.empty() || contact.start > of_joint.back().second) {
          of_joint.emplace_back(contact.start, contact.end);
        }
        of_joint.back().second = std::max(of_joint.back().second, contact.end);
      }
    }
  }

  // Steps 2 and 3: generic time of each frame, and the corresponding time in each motion.
  void find_times(const BlendTime& time) {
    blended_.times.resize(motions_.size());
    for (int f = 0; f < frames(); ++f) {
      const double generic = time.generic_at(f / blended_.clip.rate);
      blended_.generic.push_back(generic);
      for (std::size_t m = 0; m < motions_.size(); ++m) {
        blended_.times[m].push_back(time.maps()[m].at(generic));
      }
    }
  }

  // Steps 4 and 5 for the pose relative to the ground frame. The first motion determines the
  // hemisphere of the quaternions.
  void sum_poses(int first, Clip& clip) const {
    const auto joints = clip.skeleton.names.size();
    parallel_for(at(clip.frame_count()), kFramesAtOnce, options_.jobs,
                 [&](std::size_t begin, std::size_t end) {
                   const std::size_t blocks = at(pose_blocks(clip.joint_count()));
                   std::vector<PoseBlock> reference(blocks), sum(blocks);
                   std::vector<BlendTerm> terms;
                   std::vector<Transform> pose(joints);
                   for (std::size_t f = begin; f < end; ++f) {
                     const int frame = first + static_cast<int>(f);
                     terms.clear();
                     for (std::size_t m = 0; m < motions_.size(); ++m) {
                       const auto share = static_cast<float>(weight(m, frame));
                       if (share == 0) continue;
                       terms.push_back({&motions_[m].poses(), frame_in_part(m, frame), share});
                     }
                     sample_pose(motions_.front().poses(), frame_in_part(0, frame), reference);
                     blend_poses(terms, reference, sum);
                     unpack_pose(sum, pose);
                     local_to_world(clip.skeleton.parents, pose, pose);
                     clip.set_pose(static_cast<int>(f), pose);
                   }
                 });
  }

  GroundFrame first_place() const {
    GroundFrame sum;
    const double reference = motions_.front().place(blended_.times.front().front()).heading;
    double all = 0;
    for (std::size_t m = 0; m < motions_.size(); ++m) {
      const GroundFrame place = motions_[m].place(blended_.times[m].front());
      const double share = weight(m, 0);
      all += share;
      sum.x += share * place.x;
      sum.z += share * place.z;
      sum.heading += share * wrapped(place.heading - reference);
    }
    return {sum.x / all, sum.z / all, reference + sum.heading / all};
  }

  double frame_in_part(std::size_t motion, int frame) const {
    return motions_[motion].frame_in_part(blended_.times[motion][at(frame)]);
  }

  // Step 4 for root motion: displacement per frame relative to the character's heading.
  void walk(int first, Clip& clip) {
    std::vector<Transform> pose(clip.skeleton.names.size());
    // Where the block before ended.
    auto [place, before] =
        first == 0 ? Walked{first_place(), std::vector<Vec3>(pose.size())} : walked_.at(first);
    for (int f = 0; f < clip.frame_count(); ++f) {
      clip.get_pose(f, pose);
      if (first + f > 0) place = next_place(place, first + f, before, pose);
      for (std::size_t j = 0; j < pose.size(); ++j) before[j] = pose[j].position;
      const Transform to_world = place.to_world();
      for (Transform& joint : pose) joint = to_world * joint;
      clip.set_pose(f, pose);
    }
    walked_.insert_or_assign(first + clip.frame_count(), Walked{place, std::move(before)});
  }

  GroundFrame next_place(const GroundFrame& place, int frame, std::span<const Vec3> before,
                         std::span<const Transform> pose) const {
    Vec3 way = Vec3::Zero();
    double turn = 0;
    for (std::size_t m = 0; m < motions_.size(); ++m) {
      const double share = weight(m, frame);
      if (share == 0) continue;
      const GroundFrame from = motions_[m].place(blended_.times[m][at(frame - 1)]);
      const GroundFrame to = motions_[m].place(blended_.times[m][at(frame)]);
      way +=
          share * (axis_rotation(Axis::y, -from.heading) * Vec3(to.x - from.x, 0, to.z - from.z));
      turn += share * (to.heading - from.heading);
    }
    const Quat heading = axis_rotation(Axis::y, place.heading);
    if (options_.align == Align::stance) {
      const Quat turned = axis_rotation(Axis::y, turn);
      way = pinned(way, frame,
                   [&](std::size_t j) -> Vec3 { return before[j] - turned * pose[j].position; });
    }
    const Vec3 moved = heading * way;
    return {place.x + moved.x(), place.z + moved.z(), place.heading + turn};
  }

  // The displacement with which joints in contact slide no more than they do in the motions.
  // `stay(j)` is the displacement, relative to the previous heading, with which joint j would not
  // move at all. Weighted by the contacts of all motions; the remainder is `way`.
  template <typename Stay>
  Vec3 pinned(const Vec3& way, int frame, const Stay& stay) const {
    double all = 0;
    Vec3 sum = Vec3::Zero();
    for (const int joint : contact_joints_) {
      double stands = 0;
      Vec3 slides = Vec3::Zero();
      for (std::size_t m = 0; m < motions_.size(); ++m) {
        const double share = weight(m, frame);
        if (share == 0) continue;
        const double from = blended_.times[m][at(frame - 1)], to = blended_.times[m][at(frame)];
        if (touches(m, joint, 0.5 * (from + to))) stands += share;
        const Vec3 slide = motions_[m].position(joint, to) - motions_[m].position(joint, from);
        slides += share * (axis_rotation(Axis::y, -motions_[m].place(from).heading) * slide);
      }
      stands = std::clamp(stands, 0.0, 1.0);
      all += stands;
      sum += stands * (stay(at(joint)) + slides);
    }
    if (all == 0) return way;
    Vec3 result = all >= 1 ? Vec3(sum / all) : Vec3(sum + (1 - all) * way);
    result.y() = 0;
    return result;
  }

  bool touches(std::size_t motion, int joint, double time) const {
    const auto spans = spans_[motion].find(joint);
    if (spans == spans_[motion].end()) return false;
    const auto after =
        std::ranges::upper_bound(spans->second, time, {}, &std::pair<double, double>::first);
    return after != spans->second.begin() && time <= std::prev(after)->second;
  }

  void find_spread(int first_frame, const Clip& clip) {
    std::vector<PoseBlock> block(at(pose_blocks(clip.joint_count())));
    std::vector<Transform> first(clip.skeleton.names.size()), other(first.size());
    for (int f = first_frame; f < first_frame + clip.frame_count() && motions_.size() > 1; ++f) {
      bool has_first = false;
      for (std::size_t m = 0; m < motions_.size(); ++m) {
        if (weight(m, f) == 0) continue;
        sample_pose(motions_[m].poses(), frame_in_part(m, f), block);
        unpack_pose(block, has_first ? other : first);
        for (std::size_t j = 0; has_first && j < first.size(); ++j) {
          const double angle = angle_between(first[j].orientation, other[j].orientation);
          if (angle <= blended_.widest_spread) continue;
          blended_.widest_spread = angle;
          blended_.spread_joint = static_cast<int>(j);
          blended_.spread_frame = f;
        }
        has_first = true;
      }
    }
  }

  // The contacts get their places when their frames are made.
  void find_keys(const BlendTime& time, const Correspondence& correspondence) {
    MotionKeys& keys = blended_.keys;
    const double rate = blended_.clip.rate, duration = frames() < 2 ? 0.0 : (frames() - 1) / rate;
    for (int k = 0; k < correspondence.moments(); ++k) {
      const std::string& name = correspondence.names[at(k)];
      const bool is_end =
          (k == 0 && name == "begin") || (k + 1 == correspondence.moments() && name == "end");
      if (is_end) continue;
      // The last moment may be up to a frame after the last frame.
      keys.keytimes.push_back({std::min(time.moments()[at(k)], duration), name});
    }
    if (contact_joints_.empty() || frames() < 2) return;
    // A joint is in contact if the motions in contact have more than half of the weight.
    for (const int joint : contact_joints_) {
      int begin = -1;
      for (int f = 0; f <= frames(); ++f) {
        double stands = 0;
        for (std::size_t m = 0; f < frames() && m < motions_.size(); ++m) {
          if (touches(m, joint, blended_.times[m][at(f)])) stands += weight(m, f);
        }
        if (stands > 0.5) {
          if (begin < 0) begin = f;
        } else if (begin >= 0) {
          keys.contacts.push_back({joint, begin / rate, (f - 1) / rate, Vec3::Zero()});
          begin = -1;
        }
      }
    }
    std::ranges::sort(keys.contacts, [](const Contact& a, const Contact& b) {
      return a.start != b.start ? a.start < b.start : a.joint < b.joint;
    });
    for (const Contact& contact : keys.contacts) {
      middles_.push_back(
          static_cast<int>(std::lround(contact.start * rate) + std::lround(contact.end * rate)) /
          2);
    }
  }

  struct Walked {
    GroundFrame place;
    std::vector<Vec3> before;  // [joints] of the last frame, relative to its place
  };

  std::vector<BlendSource> inputs_;
  BlendOptions options_;
  std::vector<GroundedMotion> motions_;
  int frames_ = 0;
  std::set<int> contact_joints_;
  // Of each motion the seconds in which a joint is in contact, apart and in order.
  std::vector<std::map<int, std::vector<std::pair<double, double>>>> spans_;
  std::vector<int> middles_;      // of each contact
  std::map<int, Walked> walked_;  // before the first frames of blocks
  Blended blended_;
};

}  // namespace

Result<BlendedFrames> blend_frames(std::span<const BlendSource> inputs, const RoleMap& roles,
                                   const Correspondence& correspondence,
                                   const BlendOptions& options) {
  if (Status status = check_sources(inputs); !status) return status.error();
  if (Status status = check(correspondence); !status) return status.error();
  if (correspondence.times.size() != inputs.size()) {
    return Error("blend-keys", "the number of motions and of keytime lists differ");
  }
  if (!options.any_sum) {
    if (Status status = check_sum(inputs); !status) return status.error();
  }
  const double rate = options.rate != 0 ? options.rate : inputs.front().frames.rate;
  if (Status status = check_frame_rate(rate, "clip-rate"); !status) return status.error();
  std::vector<TimeMap> maps;
  std::vector<WeightCurve> weights;
  for (std::size_t m = 0; m < inputs.size(); ++m) {
    maps.emplace_back(correspondence.times[m], options.warp);
    weights.push_back(inputs[m].weight);
  }
  const auto time = BlendTime::create(std::move(maps), std::move(weights), 2 / rate * (1 - 1e-9));
  if (!time) return time.error();
  if (time->duration() * rate * inputs.front().frames.joint_count() > kMaxTransforms) {
    return Error("clip-too-long", fmt::format("{} s at {} frames per second exceed the limit",
                                              readable(time->duration()), readable(rate)));
  }
  std::vector<FrameSource> motions;
  for (const BlendSource& input : inputs) motions.push_back(input.frames);
  const auto found = HipsRoot::of(motions, carrying_joint(roles), options.jobs);
  if (!found) return found.error();
  const HipsRoot hips_root = *found;
  std::vector<BlendSource> rooted(inputs.begin(), inputs.end());
  if (hips_root.changes()) {
    for (BlendSource& input : rooted) {
      Skeleton skeleton = hips_root.rooted(input.frames.skeleton);
      input.frames = changed(input.frames, [hips_root](Clip& frames) {
        frames = hips_root.rooted(frames);
        return Status();
      });
      input.frames.skeleton = std::move(skeleton);
    }
  }
  const auto made = Blender::make(std::move(rooted), roles, options, *time, rate, correspondence);
  if (!made) return made.error();
  const std::shared_ptr<Blender> blender = *made;

  FrameSource blank;  // whose frames are made
  blank.skeleton = blender->blended().clip.skeleton;
  blank.rate = rate;
  blank.frame_count = blender->frames();
  blank.read = [](int, int, auto...) { return Status(); };
  BlendedFrames blended;
  blended.frames = changed_in_blocks(blank, {kFramesOfBlock, 0}, 1,
                                     [blender](FrameRun& run) { return blender->blend(run); });
  const Skeleton& skeleton = motions.front().skeleton;
  if (hips_root.changes()) {
    blended.frames = changed(blended.frames, [hips_root, skeleton](Clip& frames) {
      frames = hips_root.restored(frames, skeleton);
      return Status();
    });
    blended.frames.skeleton = skeleton;
  }
  blended.done = [blender, hips_root, skeleton] {
    Blended result = blender->blended();
    result.clip.skeleton = skeleton;
    result.spread_joint = hips_root.original(result.spread_joint);
    return result;
  };
  return blended;
}

Result<Blended> blend_clips(std::span<const BlendInput> inputs, const RoleMap& roles,
                            const Correspondence& correspondence, const BlendOptions& options) {
  std::vector<BlendSource> sources;
  for (const BlendInput& input : inputs) {
    if (Status status = check(*input.clip); !status) {
      return std::move(status).error().in_file(input.name);
    }
    sources.push_back({input.name, frames_of(*input.clip), input.keys, input.weight});
  }
  const auto made = blend_frames(sources, roles, correspondence, options);
  if (!made) return made.error();
  auto clip = load(made->frames, 1);
  if (!clip) return clip.error();
  Blended blended = made->done();
  blended.clip = *std::move(clip);
  return blended;
}

}  // namespace krok::blend
