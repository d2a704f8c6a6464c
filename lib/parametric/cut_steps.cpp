#include "parametric/cut_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/index.h"
#include "core/numbers.h"
#include "math/quaternion.h"
#include "math/window.h"
#include "motion/hips_root.h"
#include "motion/mirror.h"
#include "motion/sample.h"
#include "parametric/find_steps_internal.h"
#include "scene/frame_source.h"

namespace krok::parametric {

namespace {

constexpr double kJumpAngle = 60 * kRadiansPerDegree;
constexpr double kJumpWay = 0.3;  // metres
constexpr double kTouch = 0.05;   // seconds; shorter overlaps of a contact with a step are ignored
// Min deviation of an outlier.
constexpr double kFarLength = 0.1, kFarAngle = 15 * kRadiansPerDegree, kFarTime = 0.3;
constexpr std::ptrdiff_t kMaxOutliers = 10;  // at most one in this many
constexpr std::string_view kOutlier = "an outlier";
constexpr double kNormal = 1.4826;  // standard deviation of a normal distribution over its MAD

// Description of a jump of the pose between frames; empty if there is none.
std::string jump_in(const Clip& motion, int carrier) {
  const HipsRoot hips_root(motion, carrier);
  const Clip piece = hips_root.rooted(motion);
  std::vector<Transform> before(piece.skeleton.names.size()), pose(before.size()),
      local(before.size());
  for (int f = 0; f < piece.frame_count(); ++f) {
    piece.get_pose(f, pose);
    world_to_local(piece.skeleton.parents, pose, local);
    for (std::size_t j = 0; f > 0 && j < local.size(); ++j) {
      const bool turns = angle_between(before[j].orientation, local[j].orientation) > kJumpAngle;
      const bool moves = j == 0 && (before[j].position - local[j].position).norm() > kJumpWay;
      if (!turns && !moves) continue;
      const int joint = hips_root.original(static_cast<int>(j));
      return fmt::format("{} jumps", piece.skeleton.names[at(joint)]);
    }
    std::swap(before, local);
  }
  return {};
}

// When the swing foot passes the stance foot, along the direction of the stance foot's toes.
std::optional<double> pass_of(const Clip& piece, const Library& library, double from, double to) {
  const FootShape& stance = library.foot(library.stance());
  const FootShape& swing = library.foot(library.swing);
  const auto ahead = [&](int frame) {
    const auto place = [&](int joint) -> Vec3 {
      return piece.frame_positions(frame)[static_cast<std::size_t>(joint)].cast<double>();
    };
    const Vec3 toes = piece.frame_orientations(frame)[static_cast<std::size_t>(stance.joint)]
                          .cast<double>()
                          .normalized() *
                      stance.forward;
    return (place(swing.joint) - place(stance.joint)).dot(Vec3(toes.x(), 0, toes.z()));
  };
  std::optional<double> passes;
  for (int f = static_cast<int>(std::ceil(from * piece.rate)); f + 1 <= to * piece.rate; ++f) {
    const double now = ahead(f), next = ahead(f + 1);
    if (!(now < 0 && next >= 0)) continue;
    if (passes) return std::nullopt;
    passes = (f - now / (next - now)) / piece.rate;
  }
  return passes;
}

void find_toe_out(std::span<const Walk> walks, std::array<FootShape, 2>& feet) {
  std::vector<std::vector<WalkPrint>> prints;
  for (const Walk& walk : walks) {
    auto& list = prints.emplace_back();
    for (const Strike& strike : strikes_of(*walk.keys)) {
      const FootShape& foot = feet[static_cast<std::size_t>(strike.side)];
      list.push_back({strike.side, print_at(foot, *walk.clip, strike.time)});
    }
  }
  const auto toe_out = toe_out_of(prints);
  for (std::size_t s = 0; s < feet.size(); ++s) feet[s].toe_out = toe_out[s];
}

class Cutter {
 public:
  Cutter(const RoleMap& roles, const CutOptions& options) : roles_(roles), options_(options) {}

  Status begin(std::span<const Walk> walks, std::span<const std::string> parameters) {
    Library& library = result_.library;
    library.skeleton = walks.front().clip->skeleton;
    library.rate = walks.front().clip->rate;
    library.swing = options_.swing;
    library.keytimes = keytimes_of(options_.gait);
    if (options_.pass) library.keytimes.insert(library.keytimes.begin() + 2, "swing_pass");
    std::vector<ClipContacts> clips;
    for (const Walk& walk : walks) {
      if (Status status = same_skeleton(library.skeleton, walk.clip->skeleton); !status) {
        return std::move(status).error().in_file(walk.name);
      }
      clips.push_back({walk.clip, walk.found});
    }
    auto feet = find_foot_shapes(clips, roles_);
    if (!feet) return feet.error();
    library.feet = *feet;
    library.given_roles = given_roles(roles_);
    find_toe_out(walks, library.feet);
    for (const std::string& name : parameters) {
      auto parameter = parse_parameter(name, library.skeleton, library.keytimes);
      if (!parameter) return parameter.error();
      library.parameters.push_back(*parameter);
    }
    pairs_ = find_mirror_pairs(library.skeleton, roles_);
    posture_ = usual_pose(*walks.front().clip);
    return check(library);
  }

  void add(const Walk& walk) {
    int count = 0;
    for (const FoundStep& step :
         find_steps(*walk.clip, carrying_joint(roles_), *walk.keys, options_)) {
      ++count;
      std::string fault = step.fault.empty() ? add_step(walk, step, count) : step.fault;
      if (!fault.empty()) drop(walk.name, step.times.front(), step.times.back(), std::move(fault));
    }
  }

  // Outliers are found from all measures at once, so that one does not mask another.
  void drop_outliers() {
    Library& library = result_.library;
    if (options_.outlier <= 0 || library.examples.size() < 5) return;
    std::vector<std::string> faults(library.examples.size());
    for (std::size_t d = 0; d <= library.parameters.size(); ++d) find_outliers(d, faults);
    std::vector<Example> kept;
    for (std::size_t i = 0; i < faults.size(); ++i) {
      if (faults[i].empty()) {
        kept.push_back(std::move(library.examples[i]));
      } else {
        drop(origins_[i].walk, origins_[i].start, origins_[i].end, faults[i]);
      }
    }
    library.examples = std::move(kept);
  }

  Result<StepLibrary> finish() {
    if (result_.library.examples.empty()) {
      std::string why;
      if (!result_.dropped.empty()) why = ": " + commonest_reasons(result_.dropped);
      return Error(
          "parametric-none",
          fmt::format("no usable step was found, {} dropped{}",
                      counted(static_cast<long long>(result_.dropped.size()), "was", "were"), why),
          "krok-keys lists the strikes and offs of a walk");
    }
    return std::move(result_);
  }

 private:
  struct Origin {
    std::string walk;
    double start, end;
  };

  void drop(const std::string& walk, double start, double end, std::string reason) {
    result_.dropped.push_back({walk, start, end, std::move(reason)});
  }

  // Why the step cannot be used; empty if it was added.
  std::string add_step(const Walk& walk, const FoundStep& step, int number) {
    Library& library = result_.library;
    const Clip& clip = *walk.clip;
    const double start = step.times.front(), end = step.times.back();
    const DirectedStep directed = direction_of(step, clip, carrying_joint(roles_), library.feet,
                                               walk.found == nullptr ? 0 : walk.found->leg_length);
    if (std::string fault = wrong_direction(directed, options_.gait); !fault.empty()) return fault;
    const int first = std::max(0, static_cast<int>(std::floor(start * clip.rate + 1e-6)));
    const int last =
        std::min(clip.frame_count() - 1, static_cast<int>(std::ceil(end * clip.rate - 1e-6)));
    if (last <= first) return "it is outside the walk";
    Clip piece = cut(clip, first, last);
    if (std::string jump = jump_in(piece, carrying_joint(roles_)); !jump.empty()) return jump;
    const double shift = first / clip.rate;
    const auto within = [&](double time) {
      return std::clamp(time - shift, 0.0, piece.duration());
    };
    std::vector<Contact> contacts = contacts_in(*walk.keys, step, shift, piece.duration());
    const bool flipped = step.swing != library.swing;
    if (flipped) flip(piece, contacts);
    std::vector<double> times;
    for (const double time : step.times) times.push_back(within(time));
    if (options_.pass) {
      const auto pass = pass_of(piece, library, times[1], times[2]);
      if (!pass) return "the swing foot does not pass the stance foot exactly once";
      times.insert(times.begin() + 2, *pass);
    }
    auto example =
        make_example(library, fmt::format("{} {} {}", walk.name, number, name_of(step.swing)),
                     piece, times, std::move(contacts));
    if (!example) return example.error().message;
    example->mirrored = flipped;
    example->style = walk.style;
    library.examples.push_back(*std::move(example));
    origins_.push_back({walk.name, step.times.front(), step.times.back()});
    return {};
  }

  static std::vector<Contact> contacts_in(const MotionKeys& keys, const FoundStep& step,
                                          double shift, double duration) {
    std::vector<Contact> contacts;
    for (Contact contact : keys.contacts) {
      if (std::min(contact.end, step.times.back()) - std::max(contact.start, step.times.front()) <
          kTouch)
        continue;
      contact.start = std::clamp(contact.start - shift, 0.0, duration);
      contact.end = std::clamp(contact.end - shift, 0.0, duration);
      contacts.push_back(contact);
    }
    return contacts;
  }

  void flip(Clip& piece, std::vector<Contact>& contacts) const {
    piece = mirror(piece, pairs_, posture_);
    piece.skeleton = result_.library.skeleton;
    const auto partner = [&](const Contact& contact) {
      return pairs_.partners[static_cast<std::size_t>(contact.joint)];
    };
    std::erase_if(contacts, [&](const Contact& c) { return partner(c) == MirrorPairs::kNone; });
    for (Contact& contact : contacts) {
      contact.joint = partner(contact);
      contact.place.x() = -contact.place.x();
    }
  }

  // Flags the outliers of parameter d; the index after the last parameter is the duration.
  void find_outliers(std::size_t d, std::vector<std::string>& faults) const {
    const Library& library = result_.library;
    const bool lasts = d == library.parameters.size();
    const std::string_view unit = lasts ? "s" : unit_of(library.parameters[d]);
    std::vector<double> values;
    for (const Example& example : library.examples) {
      values.push_back(lasts ? example.keytimes.back() - example.keytimes.front()
                             : example.parameters[d]);
    }
    const double middle = upper_median(values);
    std::vector<double> apart;
    for (const double value : values) apart.push_back(std::abs(value - middle));
    const double floor = unit == "rad" ? kFarAngle : unit == "s" ? kFarTime : kFarLength;
    const double far = std::max(floor, options_.outlier * kNormal * upper_median(apart));
    // If there are many, they are variation of the data, not outliers.
    const auto beyond = std::ranges::count_if(apart, [&](double value) { return value > far; });
    if (beyond * kMaxOutliers > static_cast<std::ptrdiff_t>(apart.size())) return;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (apart[i] <= far || !faults[i].empty()) continue;
      const std::string name =
          lasts ? "duration" : name_of(library.parameters[d], library.skeleton, library.keytimes);
      const double scale = unit == "rad" ? 1 / kRadiansPerDegree : 1;
      faults[i] = fmt::format("{}: {} is {} {}, the median is {} {}", kOutlier, name,
                              readable(values[i] * scale, 3), unit == "rad" ? "degrees" : unit,
                              readable(middle * scale, 3), unit == "rad" ? "degrees" : unit);
    }
  }

  const RoleMap& roles_;
  const CutOptions& options_;
  MirrorPairs pairs_;
  std::vector<Transform> posture_;  // see mirror()
  StepLibrary result_;
  std::vector<Origin> origins_;  // [examples]
};

}  // namespace

std::string commonest_reasons(std::span<const DroppedStep> dropped) {
  constexpr std::size_t kShown = 3;
  std::vector<std::pair<int, std::string>> reasons;  // [reasons] minus how often
  for (const DroppedStep& step : dropped) {
    const bool outlier = step.reason.starts_with(kOutlier);
    const std::string reason = outlier ? std::string(kOutlier) : step.reason;
    auto known = std::ranges::find(reasons, reason, &std::pair<int, std::string>::second);
    if (known == reasons.end()) known = reasons.insert(known, {0, reason});
    --known->first;
  }
  std::ranges::sort(reasons);
  std::string text;
  for (std::size_t i = 0; i < std::min(kShown, reasons.size()); ++i) {
    text += fmt::format("{}{} as {}", i == 0 ? "" : ", ", -reasons[i].first, reasons[i].second);
  }
  return text;
}

Result<StepLibrary> cut_steps(std::span<const Walk> walks, const RoleMap& roles,
                              std::span<const std::string> parameters, const CutOptions& options) {
  if (walks.empty()) return Error("parametric-none", "no walk to cut steps from");
  Cutter cutter(roles, options);
  if (Status status = cutter.begin(walks, parameters); !status) return status.error();
  for (const Walk& walk : walks) cutter.add(walk);
  cutter.drop_outliers();
  return cutter.finish();
}

}  // namespace krok::parametric
