#include "formats/acclaim/acclaim_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <mutex>

#include "capture/far_values.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "core/text.h"
#include "formats/acclaim/files_internal.h"
#include "formats/acclaim/kinematics_internal.h"
#include "formats/acclaim/source_text_internal.h"
#include "scene/clip.h"
#include "scene/skeleton.h"

namespace krok::acclaim {

namespace {

// The one-based line that has only the frame number; 0 if there is none.
std::int64_t line_of_frame(std::string_view text, long long number) {
  std::int64_t line = 0;
  while (!text.empty()) {
    ++line;
    const std::size_t length = std::min(text.find('\n'), text.size());
    const std::string_view here = trimmed(text.substr(0, length));
    long long found = 0;
    const auto [end, trouble] = std::from_chars(here.data(), here.data() + here.size(), found);
    if (trouble == std::errc() && end == here.data() + here.size() && found == number) return line;
    text.remove_prefix(std::min(length + 1, text.size()));
  }
  return 0;
}

// Diagnostics for implausibly large values: the first rotation and the first position of `far`,
// each with joint, frame and line. Frames in `far` are indices in the file; `places` maps them to
// frames of the clip. Codes acclaim-far-rotation, acclaim-far-position.
std::vector<Error> far_frame_faults(std::string_view amc_text, const MotionFile& motion,
                                    const Kinematics& kinematics, const FarValues& far,
                                    const Clip& clip, const std::vector<std::size_t>& places) {
  std::vector<Error> faults;
  const auto add = [&](Error failure, std::size_t frame, std::size_t joint) {
    const std::int64_t line = line_of_frame(amc_text, motion.frame_numbers[frame]);
    if (line > 0) failure = std::move(failure).at_line(line, 1);
    failure.joint = clip.skeleton.names[joint];
    failure.frame = static_cast<std::int64_t>(places[frame]);
    faults.push_back(std::move(failure));
  };
  if (far.rotations > 0) {
    if (const auto found = kinematics.far_rotation(motion.frame(far.first_rotation))) {
      const std::string channel =
          fmt::format("{} {}", clip.skeleton.names[found->joint], channel_name(found->channel));
      add(far_rotation("acclaim-far-rotation", channel, found->degrees, far.rotations),
          far.first_rotation, found->joint);
    }
  }
  if (far.positions > 0) {
    const double farthest = farthest_position(clip.skeleton.reference);
    std::vector<Transform> pose(clip.skeleton.names.size());
    clip.get_pose(static_cast<int>(places[far.first_position]), pose);
    const auto found = std::find_if(pose.begin(), pose.end(), [&](const Transform& joint) {
      return joint.position.norm() > farthest;
    });
    const auto joint = found == pose.end() ? 0 : static_cast<std::size_t>(found - pose.begin());
    add(far_position("acclaim-far-position", clip.skeleton.names[joint], pose[joint].position,
                     far.positions),
        far.first_position, joint);
  }
  return faults;
}

constexpr double kInch = 0.0254;
// CMU skeletons have "length 0.45"; their lengths are inches divided by it (mocap.cs.cmu.edu, FAQ).
constexpr double kCmuLengthUnit = 0.45;
constexpr double kUsualRate = 120.0;
constexpr std::size_t kMaxSamples = 200;
constexpr std::size_t kFramesAtOnce = 64;

class Reader {
 public:
  Reader(std::string_view asf_text, const std::string& asf_name, std::string_view amc_text,
         const std::string& amc_name, const ReadOptions& options)
      : asf_(without_byte_order_mark(asf_text), asf_name, options.strictness, capture_.diagnostics),
        amc_(without_byte_order_mark(amc_text), amc_name, options.strictness, capture_.diagnostics),
        has_motion_(!amc_text.empty() || !amc_name.empty()),
        options_(options) {}

  Result<Capture> read() {
    if (Status status = check_kind(asf_.text(), asf_.file_name(), true); !status)
      return status.error();
    if (has_motion_) {
      if (Status status = check_kind(amc_.text(), amc_.file_name(), false); !status) {
        return status.error();
      }
    }
    auto skeleton = parse_skeleton(asf_, options_);
    if (!skeleton) return std::move(skeleton).error();
    file_ = std::move(*skeleton);
    capture_.name = file_.name;
    capture_.documentation = file_.documentation;
    if (has_motion_) {
      auto motion = parse_motion(amc_, file_, joint_count_with_ends(file_), options_);
      if (!motion) return std::move(motion).error();
      motion_ = std::move(*motion);
      capture_.repairs = motion_.repairs;
    }
    const Kinematics kinematics(file_,
                                motion_.degrees.value_or(file_.degrees) ? kRadiansPerDegree : 1.0);
    if (Status status = choose_conventions(kinematics); !status) return status.error();
    if (Status status = place_frames(); !status) return status.error();
    choose_rate();
    if (Status status = fill_clip(kinematics); !status) return status.error();
    fill_freedoms(kinematics);
    settle_rest();
    asf_.finish();
    amc_.finish();
    return std::move(capture_);
  }

 private:
  void tell(Severity severity, const SourceText& source, std::string code, std::string message,
            std::string hint = {}) {
    capture_.diagnostics.push_back(make_diagnostic(severity, std::move(code), std::move(message),
                                                   std::move(hint), source.file_name()));
  }

  Status choose_conventions(const Kinematics& kinematics) {
    Conventions& conventions = capture_.conventions;
    const Skeleton in_file = kinematics.skeleton();
    auto roles = roles_of(in_file, options_);
    if (!roles) return std::move(roles).error();
    capture_.roles = *std::move(roles);
    if (!options_.complete()) {
      std::vector<Vec3> samples;
      std::vector<Transform> pose(kinematics.joint_count());
      const std::size_t count = std::min(motion_.frame_count(), kMaxSamples);
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t frame = count < 2 ? 0 : i * (motion_.frame_count() - 1) / (count - 1);
        kinematics.pose(motion_.frame(frame), pose);
        for (const Transform& joint : pose) samples.push_back(joint.position);
      }
      conventions = detect_conventions(in_file, capture_.roles, samples);
      take_unit_of_file(in_file);
    }
    apply_given(options_, conventions);
    auto conversion = Conversion::make(conventions);
    if (!conversion) return std::move(conversion).error().in_file(asf_.file_name());
    conversion_ = *conversion;
    report_conventions(conventions, options_, "acclaim", asf_.file_name(), capture_.diagnostics);
    capture_.clip.provenance.conversions = describe_conversions(conventions, options_);
    return {};
  }

  // The format's "length" is a factor without a unit. Vicon files use inches divided by it; this is
  // accepted if it gives a human-sized character.
  void take_unit_of_file(const Skeleton& in_file) {
    if (!file_.length_unit || *file_.length_unit == 1.0) return;
    const double metres = kInch / *file_.length_unit;
    const double size = reference_extent(in_file) * metres;
    const bool cmu = *file_.length_unit == kCmuLengthUnit;
    const bool person = size > 1.0 && size < 2.6;
    const bool possible = size > 0.05 && size < 10.0;
    if (!person && !(cmu && possible)) return;
    Conventions& conventions = capture_.conventions;
    const std::string unit = readable(*file_.length_unit);
    conventions.unit = {metres, cmu ? "cmu" : fmt::format("inches / {}", unit)};
    conventions.unit_confidence = cmu && person ? Confidence::certain : Confidence::likely;
    conventions.unit_reason = fmt::format(
        ":units has length {}, taken as inches divided by it; the character is then {} m in size",
        unit, readable(size, 3));
  }

  // Infers the frame times from the frame numbers.
  Status place_frames() {
    const std::vector<long long>& numbers = motion_.frame_numbers;
    const std::size_t count = numbers.size();
    places_.resize(count);
    for (std::size_t i = 0; i < count; ++i) places_[i] = i;
    if (count == 0) return {};
    capture_.first_frame_number = numbers[0];
    if (numbers[0] != 0 && numbers[0] != 1) {
      tell(Severity::note, amc_, "acclaim-frame",
           fmt::format("the first frame has number {}; times start from it", numbers[0]));
    }
    if (std::adjacent_find(numbers.begin(), numbers.end(), std::greater_equal<>()) !=
        numbers.end()) {
      return {};  // not increasing, already reported by the parser
    }
    // Differences without overflow: numbers are increasing.
    const auto step = [&](std::size_t i) {
      return static_cast<unsigned long long>(numbers[i]) -
             static_cast<unsigned long long>(numbers[i - 1]);
    };
    std::size_t gaps = 0, first_gap = 0;
    bool constant = true;
    for (std::size_t i = 1; i < count; ++i) {
      constant = constant && step(i) == step(1);
      if (step(i) > 1 && gaps++ == 0) first_gap = i;
    }
    if (gaps == 0) return {};
    if (constant && count > 2) {
      frame_step_ = static_cast<double>(step(1));
      return {};
    }
    return close_or_fill(gaps, first_gap);
  }

  Status close_or_fill(std::size_t gaps, std::size_t first_gap) {
    const std::vector<long long>& numbers = motion_.frame_numbers;
    const std::string where =
        fmt::format("{} gap{} in the frame numbers (the first: {} is followed by {})", gaps,
                    gaps == 1 ? "" : "s", numbers[first_gap - 1], numbers[first_gap]);
    if (options_.strictness != Strictness::repair) {
      if (options_.strictness == Strictness::strict) {
        return Error("acclaim-frame", where, "").in_file(amc_.file_name());
      }
      tell(Severity::warning, amc_, "acclaim-frame", where + "; later frames move up",
           "--repair fills the gaps");
      return {};
    }
    const auto after_first = [&](std::size_t i) {
      return static_cast<std::size_t>(static_cast<unsigned long long>(numbers[i]) -
                                      static_cast<unsigned long long>(numbers[0]));
    };
    const std::size_t last = after_first(numbers.size() - 1);
    if (last >= most_frames(amc_.text().size(), 0, joint_count_with_ends(file_), options_)) {
      return Error("acclaim-limit",
                   where + "; filling them is out of proportion to the size of the file",
                   "import it without --repair")
          .in_file(amc_.file_name());
    }
    for (std::size_t i = 0; i < places_.size(); ++i) places_[i] = after_first(i);
    capture_.repairs.push_back(
        fmt::format("{} frames filled by interpolation in {}", last + 1 - numbers.size(), where));
    tell(Severity::warning, amc_, "acclaim-repair", where + ", filled by interpolation");
    return {};
  }

  void choose_rate() {
    double& rate = capture_.clip.rate;
    rate = kUsualRate;
    if (!has_motion_) {
      if (options_.rate) rate = *options_.rate;
      capture_.rate = {readable(rate), "there is no motion", Confidence::guess};
      return;
    }
    if (options_.rate) {
      rate = *options_.rate;
      capture_.rate = {readable(rate), "as given", Confidence::certain};
      return;
    }
    std::string reason = "stated in the motion";
    if (motion_.rate) {
      rate = *motion_.rate;
    } else {
      reason = "an AMC does not store its rate; most of the CMU database has this one";
    }
    if (frame_step_ > 1) {
      rate /= frame_step_;
      reason = fmt::format("the frame numbers increase by {}, so it is {} / {}; for the {}, {}",
                           readable(frame_step_), readable(rate * frame_step_),
                           readable(frame_step_), readable(rate * frame_step_), reason);
    }
    const bool guess = !motion_.rate || frame_step_ > 1;
    capture_.rate = {readable(rate), reason, guess ? Confidence::guess : Confidence::certain};
    tell(guess ? Severity::warning : Severity::note, amc_, "acclaim-rate",
         fmt::format("{} frames per second: {}", readable(rate), reason),
         guess ? "set the rate with --fps N if this is wrong" : "");
  }

  Error overflow(const SourceText& source) const {
    return Error("acclaim-number", "the numbers are so large that a joint is over 1e9 m away")
        .in_file(source.file_name());
  }

  Status fill_clip(const Kinematics& kinematics) {
    Clip& clip = capture_.clip;
    clip.skeleton = kinematics.skeleton();
    for (Transform& joint : clip.skeleton.reference) {
      joint = conversion_.reference(joint);
      if (!is_near(joint.position)) return overflow(asf_);
    }
    if (places_.empty()) return {};
    clip.resize(static_cast<int>(places_.back() + 1));
    const std::size_t count = places_.size();
    if (options_.progress != nullptr) options_.progress->begin("reading frames", count);
    std::atomic<bool> finite = true;
    const double farthest = farthest_position(clip.skeleton.reference);
    FarValues far;
    std::mutex of_far;
    parallel_for(count, kFramesAtOnce, options_.jobs, [&](std::size_t begin, std::size_t end) {
      std::vector<Transform> pose(kinematics.joint_count());
      FarValues far_here;
      for (std::size_t i = begin; i < end; ++i) {
        kinematics.pose(motion_.frame(i), pose);
        bool is_far = false;
        for (Transform& joint : pose) {
          joint = conversion_.pose(joint);
          if (!is_near(joint.position)) finite = false;
          is_far = is_far || joint.position.norm() > farthest;
        }
        if (is_far) far_here.add_position(i);
        if (kinematics.far_rotation(motion_.frame(i))) far_here.add_rotation(i);
        clip.set_pose(static_cast<int>(places_[i]), pose);
      }
      if (far_here.any()) {
        const std::lock_guard lock(of_far);
        far.add(far_here);
      }
      if (options_.progress != nullptr) options_.progress->advance(end - begin);
    });
    if (options_.progress != nullptr) options_.progress->end();
    if (!finite) return overflow(amc_);
    if (Status status = report_far_values(kinematics, far); !status) return status;
    for (std::size_t i = 1; i < count; ++i) {
      if (places_[i] - places_[i - 1] < 2) continue;
      fill_frames_between(clip, static_cast<int>(places_[i - 1]), static_cast<int>(places_[i]));
    }
    return {};
  }

  Status report_far_values(const Kinematics& kinematics, const FarValues& far) {
    for (Error& fault :
         far_frame_faults(amc_.text(), motion_, kinematics, far, capture_.clip, places_)) {
      fault.where.file = amc_.file_name();
      if (options_.strictness == Strictness::strict) return std::move(fault);
      fault.severity = Severity::warning;
      capture_.diagnostics.push_back(std::move(fault));
    }
    return {};
  }

  void settle_rest() {
    const RestPose rest = find_rest_pose(capture_.clip, capture_.roles);
    capture_.rest_frame_found = rest.first_frame_is_rest;
    capture_.rest_frame_dropped =
        settle_rest_frame(rest, options_.rest_frame, "acclaim", amc_.file_name(), capture_);
    if (!capture_.rest_frame_dropped || capture_.clip.frame_count() == 0) return;
    // The second frame may have been filled in.
    capture_.first_frame_number =
        places_[1] == 1 ? motion_.frame_numbers[1] : motion_.frame_numbers[0] + 1;
  }

  void fill_freedoms(const Kinematics& kinematics) {
    capture_.freedoms.resize(kinematics.joint_count());
    for (std::size_t j = 0; j < capture_.freedoms.size(); ++j) {
      const int source = kinematics.file_joint(j);
      if (source < 0) continue;
      const SkeletonFile::Joint& joint = file_.joints[static_cast<std::size_t>(source)];
      JointFreedom& freedom = capture_.freedoms[j];
      freedom.axes = conversion_.reference_rotation(joint.axes);
      for (std::size_t c = 0; c < joint.channels.size(); ++c) {
        const Channel channel = joint.channels[c];
        const SkeletonFile::Limit limit =
            joint.limits.empty() ? SkeletonFile::Limit() : joint.limits[c];
        using Kind = DegreeOfFreedom::Kind;
        DegreeOfFreedom degree;
        degree.kind = is_rotation(channel)      ? Kind::rotation
                      : is_translation(channel) ? Kind::translation
                                                : Kind::stretch;
        degree.axis = axis_index(channel);
        const double unit = is_rotation(channel) ? 1.0 : conversion_.metres();
        degree.lower = limit.lower * unit;
        degree.upper = limit.upper * unit;
        freedom.degrees.push_back(degree);
      }
    }
  }

  Capture capture_;
  SourceText asf_, amc_;
  bool has_motion_;
  const ReadOptions& options_;
  SkeletonFile file_;
  MotionFile motion_;
  Conversion conversion_;
  std::vector<std::size_t> places_;  // [frames of the file] the frame of the clip
  double frame_step_ = 1;
};

}  // namespace

Result<Capture> read(std::string_view asf_text, const std::string& asf_name,
                     std::string_view amc_text, const std::string& amc_name,
                     const ReadOptions& options) {
  if (Status status = check_rate(options.rate, "acclaim-rate"); !status) return status.error();
  return Reader(asf_text, asf_name, amc_text, amc_name, options).read();
}

}  // namespace krok::acclaim
