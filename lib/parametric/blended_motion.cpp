#include "parametric/blended_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/numbers.h"
#include "math/hermite.h"
#include "scene/clip.h"

namespace krok::parametric {

namespace {

constexpr double kSumOff = 1e-6;
constexpr double kMaxTransforms = 1e8;
constexpr double kNoWeight = 1e-9;
constexpr int kPosesAtOnce = 16;  // batch size of local_to_model()

// The fraction of an interval at which a monotone cubic has the value `value`, by Newton's method
// safeguarded by bisection.
double part_at(double value, double from, double from_slope, double to, double to_slope,
               double span) {
  double low = 0, high = 1;
  double s = std::clamp((value - from) / (to - from), 0.0, 1.0);
  for (int i = 0; i < 60; ++i) {
    const double off = hermite(from, from_slope, to, to_slope, span, s) - value;
    if (off == 0) break;
    (off > 0 ? high : low) = s;
    const double steep = span * hermite_velocity(from, from_slope, to, to_slope, span, s);
    double next = steep > 0 ? s - off / steep : -1;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - s) < 1e-15) break;
    s = next;
  }
  return s;
}

// The name of a step's keytime in a walk.
std::string walk_name(const std::string& keytime, const Library& library) {
  if (keytime == "stance_strike") return fmt::format("{}_strike", name_of(library.stance()));
  if (keytime == "swing_strike") return fmt::format("{}_strike", name_of(library.swing));
  if (keytime == "stance_off") return fmt::format("{}_off", name_of(library.stance()));
  if (keytime == "swing_off") return fmt::format("{}_off", name_of(library.swing));
  return keytime;
}

}  // namespace

Result<BlendedMotion> BlendedMotion::create(const Library& library, const PackedExamples& packed,
                                            std::span<const double> weights) {
  double sum = 0;
  for (const double weight : weights) sum += weight;
  if (weights.size() != packed.clips.size() || !(std::abs(sum - 1) <= kSumOff)) {
    return Error("parametric-weights",
                 fmt::format("{} weights with sum {} for {} examples", weights.size(),
                             readable(sum), packed.clips.size()),
                 "give one weight per example; they must sum to 1");
  }
  BlendedMotion motion(library, packed);
  motion.weights_.assign(weights.begin(), weights.end());
  const auto count = static_cast<std::size_t>(packed.keytimes());
  motion.keytimes_.assign(count, 0);
  motion.slopes_.assign(count, 0);
  for (std::size_t k = 1; k < count; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      motion.keytimes_[k] += weights[i] * (packed.times(row, column) - packed.times(0, column));
    }
    const double lasts = motion.keytimes_[k] - motion.keytimes_[k - 1];
    if (lasts >= shortest_interval(library)) continue;
    return Error("parametric-interval",
                 fmt::format("the interval from {} to {} would last {} s, the min is {} s",
                             library.keytimes[k - 1], library.keytimes[k], readable(lasts),
                             readable(shortest_interval(library), 3)),
                 "the weights extrapolate too far from the examples' timing");
  }
  monotone_velocities(packed.generic, motion.keytimes_, Ends::open, motion.slopes_);
  motion.set_on_stance_foot();
  return motion;
}

void BlendedMotion::set_on_stance_foot() {
  Scratch scratch = make_scratch();
  std::vector<PoseBlock> first(scratch.reference.size());
  std::vector<Transform> local(library_.skeleton.names.size());
  pose(0, first, scratch);
  unpack_pose(first, local);
  const FootShape& foot = library_.foot(library_.stance());
  Transform foot_to_world;
  for (int j = foot.joint; j >= 0; j = library_.skeleton.parents[static_cast<std::size_t>(j)]) {
    foot_to_world = local[static_cast<std::size_t>(j)] * foot_to_world;
  }
  set_ = footprint(foot, foot_to_world).to_world().inverse();
}

double BlendedMotion::generic_of(const double* times, const double* slopes, double time) const {
  const std::vector<double>& knots = packed_.generic;
  const std::size_t last = knots.size() - 1;
  if (!(time > times[0])) return 0;
  if (time >= times[last]) return knots[last];
  std::size_t k = 0;
  while (time >= times[k + 1]) ++k;
  const double span = knots[k + 1] - knots[k];
  return knots[k] + span * part_at(time, times[k], slopes[k], times[k + 1], slopes[k + 1], span);
}

double BlendedMotion::generic_at(double time) const {
  return generic_of(keytimes_.data(), slopes_.data(), time);
}

BlendedMotion::Scratch BlendedMotion::make_scratch() const {
  Scratch scratch;
  scratch.terms.reserve(weights_.size());
  scratch.reference.resize(static_cast<std::size_t>(packed_.reference.blocks_per_pose()));
  scratch.apart.resize(scratch.reference.size());
  return scratch;
}

bool BlendedMotion::use(const ExampleSums& sums, int apart, double weight) {
  std::vector<double> others = weights_;
  if (apart >= 0) others[static_cast<std::size_t>(apart)] -= weight;
  double left_out = 0;
  auto coefficients = sums.coefficients(others, left_out);
  if (!(left_out <= ExampleSums::kMaxLeftOut)) return false;
  sums_ = &sums;
  coefficients_ = std::move(coefficients);
  apart_ = apart;
  apart_weight_ = weight;
  return true;
}

float BlendedMotion::sum_examples(double generic, const GenericTimePoint& place,
                                  std::span<PoseBlock> pose, Scratch& scratch) const {
  clear_sum(pose);
  sums_->add(generic, coefficients_, pose);
  if (apart_ >= 0) {
    sample_pose(packed_.clips[static_cast<std::size_t>(apart_)],
                example_time(packed_, place, apart_), scratch.apart);
    add_to_sum(scratch.apart, static_cast<float>(apart_weight_), scratch.reference, pose);
  }
  return finish_sum(scratch.reference, pose);
}

float BlendedMotion::pose(double time, std::span<PoseBlock> pose, Scratch& scratch) const {
  const double generic = generic_at(time);
  const GenericTimePoint place = generic_place(packed_.generic, generic);
  sample_pose(packed_.reference, generic, scratch.reference);
  float agreement = 0;
  if (sums_ != nullptr) {
    agreement = sum_examples(generic, place, pose, scratch);
  } else {
    scratch.terms.clear();
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      if (weights_[i] == 0) continue;
      scratch.terms.push_back({&packed_.clips[i], example_time(packed_, place, static_cast<int>(i)),
                               static_cast<float>(weights_[i])});
    }
    agreement = blend_poses(scratch.terms, scratch.reference, pose);
  }
  // The root is the first joint.
  PoseBlock& block = pose.front();
  const Vec3 root = set_ * Vec3(block.position[0][0], block.position[1][0], block.position[2][0]);
  const Quat turn = set_.orientation * Quat(block.rotation[3][0], block.rotation[0][0],
                                            block.rotation[1][0], block.rotation[2][0]);
  for (int c = 0; c < 3; ++c) block.position[c][0] = static_cast<float>(root[c]);
  for (int c = 0; c < 4; ++c) block.rotation[c][0] = static_cast<float>(turn.coeffs()[c]);
  return agreement;
}

Result<BlendedMotion::Made> BlendedMotion::make(double rate, LastFrame last) const {
  const bool any_rate = rate == 0;
  if (any_rate) rate = library_.rate;
  if (Status status = check_frame_rate(rate, "clip-rate"); !status) return status.error();
  const double frames = duration() * rate;
  const auto joints = packed_.skeleton.names.size();
  if (!(frames * static_cast<double>(joints) <= kMaxTransforms)) {
    return Error("clip-too-long", fmt::format("{} s at {} frames per second are too many frames",
                                              readable(duration()), readable(rate)));
  }
  const int count = last == LastFrame::kept ? std::max(1, static_cast<int>(std::lround(frames)))
                                            : static_cast<int>(std::floor(frames + 1e-6));
  const double stretch = last == LastFrame::kept && !any_rate ? count / frames : 1;
  if (last == LastFrame::kept && any_rate) rate = count / duration();
  Made made;
  made.clip.skeleton = packed_.skeleton;
  made.clip.rate = rate;
  made.clip.resize(count + 1);
  Scratch scratch = make_scratch();
  const std::size_t blocks = scratch.reference.size();
  std::vector<PoseBlock> poses(kPosesAtOnce * blocks);
  std::vector<PoseBlock> space(static_cast<std::size_t>(model_scratch(static_cast<int>(joints))));
  for (int first = 0; first <= count; first += kPosesAtOnce) {
    const auto some = static_cast<std::size_t>(std::min(kPosesAtOnce, count + 1 - first));
    for (std::size_t f = 0; f < some; ++f) {
      const double time = (first + static_cast<double>(f)) / rate / stretch;
      const float agreement = pose(time, std::span(poses).subspan(f * blocks, blocks), scratch);
      made.agreement = std::min(made.agreement, static_cast<double>(agreement));
    }
    const std::size_t from = static_cast<std::size_t>(first) * joints;
    local_to_model({packed_.skeleton.parents, std::span(poses).first(some * blocks), space},
                   std::span(made.clip.positions).subspan(from, some * joints),
                   std::span(made.clip.orientations).subspan(from, some * joints));
  }
  for (Quatf& orientation : made.clip.orientations) orientation.normalize();
  made.clip = packed_.hips_root.changes() ? packed_.hips_root.restored(made.clip, library_.skeleton)
                                          : std::move(made.clip);
  made.keys = keys(stretch, made.clip.duration());
  return made;
}

MotionKeys BlendedMotion::keys(double stretch, double duration) const {
  MotionKeys keys;
  for (std::size_t k = 0; k < keytimes_.size(); ++k) {
    const double time = keytimes_[k] * stretch;
    if (time > duration + 1e-3) continue;
    keys.keytimes.push_back({std::min(time, duration), walk_name(library_.keytimes[k], library_)});
  }
  keys.contacts = contacts();
  std::erase_if(keys.contacts, [&](Contact& contact) {
    contact.start *= stretch;
    contact.end = std::min(contact.end * stretch, duration);
    return contact.start >= contact.end;
  });
  return keys;
}

// Contacts of a joint are matched by order across the examples, if all that have a weight have
// equally many.
std::vector<Contact> BlendedMotion::contacts() const {
  struct Sum {
    double start = 0, end = 0;  // generic time
    Vec3 place = Vec3::Zero();
    std::size_t count = 0;
  };
  std::map<std::pair<int, int>, Sum> sums;  // by joint and number
  std::size_t examples = 0;
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    if (std::abs(weights_[i]) < kNoWeight) continue;
    ++examples;
    std::map<int, int> numbers;
    const auto column = static_cast<Eigen::Index>(i);
    for (const Contact& contact : library_.examples[i].contacts) {
      Sum& sum = sums[{contact.joint, numbers[contact.joint]++}];
      const auto generic = [&](double time) {
        return generic_of(packed_.times.col(column).data(), packed_.slopes.col(column).data(),
                          time);
      };
      sum.start += weights_[i] * generic(contact.start);
      sum.end += weights_[i] * generic(contact.end);
      sum.place += weights_[i] * contact.place;
      ++sum.count;
    }
  }
  std::vector<Contact> result;
  for (const auto& [key, sum] : sums) {
    if (sum.count != examples || !(sum.start < sum.end)) continue;
    const auto time = [&](double generic) {
      const GenericTimePoint place = generic_place(packed_.generic, generic);
      const auto k = static_cast<std::size_t>(place.interval);
      return place.value[0] * keytimes_[k] + place.slope[0] * slopes_[k] +
             place.value[1] * keytimes_[k + 1] + place.slope[1] * slopes_[k + 1];
    };
    result.push_back({key.first, time(sum.start), time(sum.end), set_ * sum.place});
  }
  std::ranges::stable_sort(result, [](const Contact& a, const Contact& b) {
    return a.start != b.start ? a.start < b.start : a.joint < b.joint;
  });
  return result;
}

}  // namespace krok::parametric
