#include "blend/blend_clips.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "core/index.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "math/euler.h"
#include "math/quaternion.h"
#include "motion/ground_frame.h"
#include "motion/hips_root.h"
#include "pose/blend_pose.h"
#include "pose/packed_pose.h"
#include "scene/clip.h"
#include "scene/frame_moment.h"

namespace krok::blend {

namespace {

// A motion split into the character's ground frame (position and heading) over time and poses
// relative to it, so that motions along different paths can be blended.
class GroundedClip {
 public:
  // `carrier` comes from carrying_joint(); -1 keeps the poses in world space and the ground frame
  // at the origin. `clip` needs at least one frame and must outlive this.
  GroundedClip(const Clip& clip, int carrier);

  // joint_to_parent; the root is relative to the ground frame.
  const PackedClip& poses() const { return poses_; }

  // The ground frame at `time` seconds, linear between frames; the heading is unwrapped.
  GroundFrame place(double time) const;

  // World position of a joint.
  Vec3 position(int joint, double time) const;

 private:
  const Clip& clip_;
  PackedClip poses_;
  std::vector<GroundFrame> places_;  // [frames], unwrapped headings
};

GroundedClip::GroundedClip(const Clip& clip, int carrier) : clip_(clip) {
  const int frames = clip.frame_count();
  places_.resize(static_cast<std::size_t>(frames));
  if (carrier < 0) {
    poses_ = pack_clip(clip);
    return;
  }
  Clip grounded = clip;
  std::vector<Transform> pose(clip.skeleton.names.size());
  for (int f = 0; f < frames; ++f) {
    GroundFrame& place = places_[static_cast<std::size_t>(f)];
    place = ground_frame(clip, carrier, f);
    if (f > 0) {
      const double before = places_[static_cast<std::size_t>(f - 1)].heading;
      place.heading = before + wrapped(place.heading - before);
    }
    const Transform world_to_place = place.to_world().inverse();
    clip.get_pose(f, pose);
    for (Transform& joint : pose) joint = world_to_place * joint;
    grounded.set_pose(f, pose);
  }
  poses_ = pack_clip(grounded);
}

GroundFrame GroundedClip::place(double time) const {
  const FrameMoment moment = frame_moment(time, clip_.rate, clip_.frame_count());
  const auto i = static_cast<std::size_t>(moment.before);
  GroundFrame place = places_[i];
  if (moment.fraction == 0) return place;
  const GroundFrame& next = places_[i + 1];
  place.x += moment.fraction * (next.x - place.x);
  place.z += moment.fraction * (next.z - place.z);
  place.heading += moment.fraction * (next.heading - place.heading);
  return place;
}

Vec3 GroundedClip::position(int joint, double time) const {
  const FrameMoment moment = frame_moment(time, clip_.rate, clip_.frame_count());
  const auto j = static_cast<std::size_t>(joint);
  const Vec3 position = clip_.frame_positions(moment.before)[j].cast<double>();
  if (moment.fraction == 0) return position;
  const Vec3 next = clip_.frame_positions(moment.before + 1)[j].cast<double>();
  return position + moment.fraction * (next - position);
}

constexpr double kMaxTransforms = 1e8;
constexpr double kRounding = 1e-6;  // of a frame, for the number of frames
constexpr std::size_t kFramesAtOnce = 32;

Status check_inputs(std::span<const BlendInput> inputs) {
  if (inputs.empty()) return Error("blend-empty", "there are no motions to blend");
  for (const BlendInput& input : inputs) {
    if (Status status = check(*input.clip); !status) {
      return std::move(status).error().in_file(input.name);
    }
    if (input.clip->frame_count() == 0) {
      return Error("blend-empty", fmt::format("{} has no frames", input.name));
    }
    const std::string differs =
        difference_in_structure(inputs.front().clip->skeleton, input.clip->skeleton);
    if (!differs.empty()) {
      return Error("blend-skeleton",
                   fmt::format("{} and {} have different skeletons: {}", inputs.front().name,
                               input.name, differs),
                   "use krok-retarget to transfer one to the other's skeleton");
    }
    if (input.keys == nullptr) continue;
    if (Status status = check(*input.keys, input.clip->skeleton, input.clip->duration()); !status) {
      return std::move(status).error().in_file(input.name);
    }
  }
  return {};
}

// ", here 0.3 and 0.7", of constant weights.
std::string in_shares(std::span<const BlendInput> inputs, double sum) {
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
Status check_sum(std::span<const BlendInput> inputs) {
  std::set<double> points = {0};
  for (const BlendInput& input : inputs) {
    points.insert(input.weight.generic.begin(), input.weight.generic.end());
  }
  for (const double point : points) {
    double sum = 0;
    for (const BlendInput& input : inputs) sum += input.weight.at(point);
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
  Blender(std::span<const BlendInput> inputs, const RoleMap& roles, const BlendOptions& options,
          const BlendTime& time, double rate)
      : inputs_(inputs), options_(options), time_(time) {
    const int carrier = options.align == Align::none ? -1 : carrying_joint(roles);
    for (const BlendInput& input : inputs) motions_.emplace_back(*input.clip, carrier);
    blended_.clip.skeleton = inputs.front().clip->skeleton;
    blended_.clip.rate = rate;
    blended_.clip.resize(static_cast<int>(std::floor(time.duration() * rate + kRounding)) + 1);
    find_contact_joints();
  }

  Blended blend(const Correspondence& correspondence) {
    find_times();
    sum_poses();
    if (options_.align != Align::none) walk();
    find_spread();
    find_keys(correspondence);
    return std::move(blended_);
  }

 private:
  int frames() const { return blended_.clip.frame_count(); }
  double weight(std::size_t motion, int frame) const {
    return inputs_[motion].weight.at(blended_.generic[at(frame)]);
  }

  // Joints with contacts in any motion; none unless all motions have keys.
  void find_contact_joints() {
    for (const BlendInput& input : inputs_) {
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
  void find_times() {
    blended_.times.resize(motions_.size());
    for (int f = 0; f < frames(); ++f) {
      const double generic = time_.generic_at(f / blended_.clip.rate);
      blended_.generic.push_back(generic);
      for (std::size_t m = 0; m < motions_.size(); ++m) {
        blended_.times[m].push_back(time_.maps()[m].at(generic));
      }
    }
  }

  // Steps 4 and 5 for the pose relative to the ground frame. The first motion determines the
  // hemisphere of the quaternions.
  void sum_poses() {
    Clip& clip = blended_.clip;
    const auto joints = clip.skeleton.names.size();
    parallel_for(at(frames()), kFramesAtOnce, options_.jobs,
                 [&](std::size_t begin, std::size_t end) {
                   const std::size_t blocks = at(pose_blocks(clip.joint_count()));
                   std::vector<PoseBlock> reference(blocks), sum(blocks);
                   std::vector<BlendTerm> terms;
                   std::vector<Transform> pose(joints);
                   for (std::size_t f = begin; f < end; ++f) {
                     terms.clear();
                     for (std::size_t m = 0; m < motions_.size(); ++m) {
                       const auto share = static_cast<float>(weight(m, static_cast<int>(f)));
                       if (share == 0) continue;
                       terms.push_back({&motions_[m].poses(), blended_.times[m][f], share});
                     }
                     sample_pose(motions_.front().poses(), blended_.times.front()[f], reference);
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

  // Step 4 for root motion: displacement per frame relative to the character's heading.
  void walk() {
    Clip& clip = blended_.clip;
    std::vector<Transform> pose(clip.skeleton.names.size());
    std::vector<Vec3> before(pose.size());
    GroundFrame place = first_place();
    for (int f = 0; f < frames(); ++f) {
      clip.get_pose(f, pose);
      if (f > 0) place = next_place(place, f, before, pose);
      for (std::size_t j = 0; j < pose.size(); ++j) before[j] = pose[j].position;
      const Transform to_world = place.to_world();
      for (Transform& joint : pose) joint = to_world * joint;
      clip.set_pose(f, pose);
    }
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

  void find_spread() {
    std::vector<PoseBlock> block(at(pose_blocks(blended_.clip.joint_count())));
    std::vector<Transform> first(blended_.clip.skeleton.names.size()), other(first.size());
    for (int f = 0; f < frames() && motions_.size() > 1; ++f) {
      bool has_first = false;
      for (std::size_t m = 0; m < motions_.size(); ++m) {
        if (weight(m, f) == 0) continue;
        sample_pose(motions_[m].poses(), blended_.times[m][at(f)], block);
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

  void find_keys(const Correspondence& correspondence) {
    MotionKeys& keys = blended_.keys;
    for (int k = 0; k < correspondence.moments(); ++k) {
      const std::string& name = correspondence.names[at(k)];
      const bool is_end =
          (k == 0 && name == "begin") || (k + 1 == correspondence.moments() && name == "end");
      if (is_end) continue;
      // The last moment may be up to a frame after the last frame.
      keys.keytimes.push_back({std::min(time_.moments()[at(k)], blended_.clip.duration()), name});
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
          add_contact(joint, begin, f - 1);
          begin = -1;
        }
      }
    }
    std::ranges::sort(keys.contacts, [](const Contact& a, const Contact& b) {
      return a.start != b.start ? a.start < b.start : a.joint < b.joint;
    });
  }

  void add_contact(int joint, int first, int last) {
    const Clip& clip = blended_.clip;
    const Vec3 place = clip.frame_positions((first + last) / 2)[at(joint)].cast<double>();
    blended_.keys.contacts.push_back({joint, first / clip.rate, last / clip.rate, place});
  }

  std::span<const BlendInput> inputs_;
  const BlendOptions& options_;
  const BlendTime& time_;
  std::vector<GroundedClip> motions_;
  std::set<int> contact_joints_;
  // Of each motion the seconds in which a joint is in contact, apart and in order.
  std::vector<std::map<int, std::vector<std::pair<double, double>>>> spans_;
  Blended blended_;
};

}  // namespace

Result<Blended> blend_clips(std::span<const BlendInput> inputs, const RoleMap& roles,
                            const Correspondence& correspondence, const BlendOptions& options) {
  if (Status status = check_inputs(inputs); !status) return status.error();
  if (Status status = check(correspondence); !status) return status.error();
  if (correspondence.times.size() != inputs.size()) {
    return Error("blend-keys", "the number of motions and of keytime lists differ");
  }
  if (!options.any_sum) {
    if (Status status = check_sum(inputs); !status) return status.error();
  }
  const double rate = options.rate != 0 ? options.rate : inputs.front().clip->rate;
  if (Status status = check_frame_rate(rate, "clip-rate"); !status) return status.error();
  std::vector<TimeMap> maps;
  std::vector<WeightCurve> weights;
  for (std::size_t m = 0; m < inputs.size(); ++m) {
    maps.emplace_back(correspondence.times[m], options.warp);
    weights.push_back(inputs[m].weight);
  }
  const auto time = BlendTime::create(std::move(maps), std::move(weights), 2 / rate * (1 - 1e-9));
  if (!time) return time.error();
  if (time->duration() * rate * inputs.front().clip->joint_count() > kMaxTransforms) {
    return Error("clip-too-long", fmt::format("{} s at {} frames per second exceed the limit",
                                              readable(time->duration()), readable(rate)));
  }
  std::vector<const Clip*> clips;
  for (const BlendInput& input : inputs) clips.push_back(input.clip);
  const HipsRoot hips_root(clips, carrying_joint(roles));
  if (!hips_root.changes()) {
    return Blender(inputs, roles, options, *time, rate).blend(correspondence);
  }
  std::vector<Clip> rooted;
  rooted.reserve(inputs.size());
  std::vector<BlendInput> rooted_inputs(inputs.begin(), inputs.end());
  for (BlendInput& input : rooted_inputs) {
    input.clip = &rooted.emplace_back(hips_root.rooted(*input.clip));
  }
  Blended blended = Blender(rooted_inputs, roles, options, *time, rate).blend(correspondence);
  blended.clip = hips_root.restored(blended.clip, clips.front()->skeleton);
  blended.spread_joint = hips_root.original(blended.spread_joint);
  return blended;
}

}  // namespace krok::blend
