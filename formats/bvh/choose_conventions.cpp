#include "formats/bvh/choose_conventions_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "capture/far_values.h"
#include "core/numbers.h"
#include "core/text.h"
#include "math/transform.h"

namespace krok::bvh {

namespace {

constexpr double kWholeTurn = 2.0 * kPi * 1.001;

// The values of rotation channels, in the file's unit.
struct Rotations {
  double largest = 0;
  int turning = 0;   // channels with more than kTurns
  int spinning = 0;  // with more than kSpins, in radians four turns
};

Rotations rotations_of(const Hierarchy& hierarchy, const SampleRows& rows) {
  constexpr double kTurns = 0.1, kSpins = 4 * kWholeTurn;
  Rotations rotations;
  for (std::size_t c = 0; c < hierarchy.channels.size(); ++c) {
    if (hierarchy.channels[c].kind != ChannelKind::rotation) continue;
    double most = 0;
    for (std::size_t row = 0; row < rows.count(); ++row) {
      most = std::max(most, std::abs(rows.row(row)[c]));
    }
    rotations.largest = std::max(rotations.largest, most);
    if (most > kTurns) ++rotations.turning;
    if (most > kSpins) ++rotations.spinning;
  }
  return rotations;
}

constexpr std::size_t kMaxSamples = 200;

// The root's height over the origin, over that above the lowest joint: 1 for who stands on the
// ground. None where it stays the same or changes as in a motion in place.
std::optional<double> root_scale(std::span<const Vec3> samples, std::size_t joints,
                                 const Vec3& up) {
  std::vector<double> heights, scales;
  for (std::size_t first = 0; first < samples.size(); first += joints) {
    const auto pose = samples.subspan(first, joints);
    const auto height = [&](const Vec3& place) { return place.dot(up); };
    const double root = height(pose.front());
    const double reach = root - height(*std::ranges::min_element(pose, {}, height));
    if (!(reach > 0)) continue;
    heights.push_back(root);
    scales.push_back(root / reach);
  }
  if (scales.size() < 3) return std::nullopt;
  std::ranges::sort(heights);
  std::ranges::sort(scales);
  const double middle = heights[heights.size() / 2];
  const double range = heights[heights.size() * 9 / 10] - heights[heights.size() / 10];
  if (!(range > 1e-3 * middle && range < 0.5 * middle)) return std::nullopt;
  return scales[scales.size() / 2];
}

class ConventionChooser {
 public:
  ConventionChooser(const IndexedFile& file, Hierarchy& hierarchy, Capture& capture)
      : file_(file), hierarchy_(hierarchy), capture_(capture) {}

  Result<ChosenConventions> choose() {
    if (Status status = choose_rate(); !status) return status.error();
    const SampleRows samples = sample_rows();
    report_exporter(samples);
    choose_angles(samples);
    PositionChoice positions;
    const bool detected = file_.options.positions == Positions::automatic && !mark();
    if (detected) {
      positions = choose_positions(hierarchy_, samples, file_.options.up);
    } else {
      const bool given = file_.options.positions != Positions::automatic;
      if (given) {
        const PositionChoice seen = choose_positions(hierarchy_, samples, file_.options.up);
        positions.positions = file_.options.positions;
        if (seen.has_evidence && seen.positions != positions.positions &&
            seen.choice.confidence != Confidence::guess) {
          report(Severity::warning, "bvh-positions",
                 fmt::format("position channels are taken as given; they are {} ({}): {}",
                             seen.choice.choice, confidence_name(seen.choice.confidence),
                             seen.choice.reason),
                 "without --positions they are detected");
        }
      }
      positions.choice.choice =
          positions.positions == Positions::absolute ? "absolute" : "additive";
      positions.choice.reason = given ? "as given" : "as krok-export writes them";
      positions.choice.confidence = Confidence::certain;
    }
    if (Status status = detect(samples, positions.positions); !status) return status.error();
    if (positions.depends_on_up) {
      auto again = choose_detected(samples, positions);
      if (!again) return again.error();
      positions = *std::move(again);
    }
    chosen_.positions = positions.positions;
    capture_.positions = positions.choice;
    if (detected && positions.has_evidence) {
      const bool guess = positions.choice.confidence == Confidence::guess;
      report(guess ? Severity::warning : Severity::note, "bvh-positions",
             fmt::format("position channels are {} ({}): {}", positions.choice.choice,
                         confidence_name(positions.choice.confidence), positions.choice.reason),
             guess ? "use --positions absolute or additive if this is wrong" : "");
    }
    warn_of_root_scale();
    if (Status status = make_conversion(); !status) return status.error();
    return chosen_;
  }

 private:
  void report(Severity severity, std::string code, std::string message, std::string hint = {},
              Location where = {}) {
    Diagnostic diagnostic;
    diagnostic.severity = severity;
    diagnostic.code = std::move(code);
    diagnostic.message = std::move(message);
    diagnostic.hint = std::move(hint);
    diagnostic.where = std::move(where);
    if (diagnostic.where.file.empty()) diagnostic.where.file = file_.file_name;
    capture_.diagnostics.push_back(std::move(diagnostic));
  }

  // A given rate that changes the duration, which who wants other frames does not expect.
  void warn_of_other_rate(double given) {
    if (!(file_.header.frame_time > 0)) return;
    const auto printed = rate_of_frame_time(file_.header.frame_time_text, file_.header.frame_time);
    const double faster = given / printed.rate;
    if (printed.unusual || std::abs(faster - 1) < 0.01) return;
    report(Severity::warning, "bvh-other-rate",
           fmt::format("{} frames per second instead of the file's {}: the motion is {} times as "
                       "fast",
                       readable(given), readable(printed.rate), readable(faster, 3)),
           fmt::format("--rate {} resamples it at its own speed", readable(given)));
  }

  Status choose_rate() {
    double& rate = capture_.clip.rate;
    if (file_.options.rate) {
      rate = *file_.options.rate;
      capture_.rate = {readable(rate), "as given", Confidence::certain};
      warn_of_other_rate(rate);
      return {};
    }
    if (hierarchy_.no_motion) {
      capture_.rate = {readable(rate), "there is no motion", Confidence::guess};
      return {};
    }
    PrintedRate printed = rate_of_frame_time(file_.header.frame_time_text, file_.header.frame_time);
    rate = printed.rate;
    if (mark()) {  // krok-export prints all digits of any rate
      printed.few_digits = printed.unusual = printed.also_ntsc = false;
      printed.reason = "as krok-export wrote it";
    }
    const bool doubtful = printed.few_digits || printed.unusual;
    capture_.rate = {readable(rate), printed.reason,
                     doubtful            ? Confidence::guess
                     : printed.also_ntsc ? Confidence::likely
                                         : Confidence::certain};
    if (printed.unusual && file_.options.strictness == Strictness::strict) {
      Error error("bvh-rate",
                  fmt::format("{} frames per second: {}", readable(rate), printed.reason),
                  "set the rate with --fps N");
      error.where = locate(file_.text, file_.header.frame_time_offset, file_.file_name);
      return error;
    }
    report(doubtful ? Severity::warning : Severity::note, "bvh-rate",
           fmt::format("{} frames per second: {}", readable(rate), printed.reason),
           doubtful ? "set the rate with --fps N if this is wrong" : "",
           doubtful ? locate(file_.text, file_.header.frame_time_offset, file_.file_name)
                    : Location());
    return {};
  }

  // Up to kMaxSamples complete rows, evenly over the file.
  SampleRows sample_rows() const {
    SampleRows samples;
    samples.channels = hierarchy_.channels.size();
    const std::size_t count = std::min(file_.rows.size(), kMaxSamples);
    std::vector<double> values(samples.channels);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t row = count < 2 ? 0 : i * (file_.rows.size() - 1) / (count - 1);
      if (file_.rows[row] == RowIndex::kFaulty) continue;
      if (parse_row(file_.text, file_.rows[row], values) == RowIndex::kFaulty) continue;
      samples.values.insert(samples.values.end(), values.begin(), values.end());
    }
    return samples;
  }

  // Recognised by the joint names and how the file is written.
  void report_exporter(const SampleRows& samples) {
    Skeleton names;
    for (const auto& joint : hierarchy_.joints) {
      names.add(joint.name, joint.parent, {}, joint.end_site);
    }
    ExporterTraits traits;
    traits.frame_time = file_.header.frame_time_text;
    const std::size_t row = file_.rows.empty() ? RowIndex::kFaulty : file_.rows[0];
    traits.rows_begin_with_tab = row != RowIndex::kFaulty && row > 0 && file_.text[row - 1] == '\t';
    traits.starts_unturned = samples.count() > 0;
    for (std::size_t c = 0; c < samples.channels && traits.starts_unturned; ++c) {
      const bool rotation = hierarchy_.channels[c].kind == ChannelKind::rotation;
      traits.starts_unturned = !rotation || samples.row(0)[c] == 0.0;
    }
    exporter_ = recognise_exporter(names, traits);
    if (!exporter_) return;
    capture_.exporter = {exporter_->name, exporter_->reason, exporter_->confidence};
    report(Severity::note, "bvh-exporter",
           fmt::format("{} ({}): {}", exporter_->name, confidence_name(exporter_->confidence),
                       exporter_->reason));
  }

  void choose_angles(const SampleRows& samples) {
    // A character that moves turns some joint by more than half a radian, and many a little.
    constexpr double kMoves = 0.5;
    constexpr int kMinChannels = 6;
    const Rotations rotations = rotations_of(hierarchy_, samples);
    if (file_.options.angles == Angles::radians) {
      hierarchy_.degrees_per_angle = 1.0 / kRadiansPerDegree;
      if (rotations.spinning < kMinChannels) return;  // few are damaged
      return report(
          Severity::warning, "bvh-angles",
          fmt::format("the angles may be degrees: one is {}, {} turns in radians",
                      readable(rotations.largest, 3), readable(rotations.largest / kWholeTurn, 2)),
          "leave --angles radians out if they are");
    }
    // Less than a turn in radians, which in degrees would be almost no motion.
    if (rotations.largest > kWholeTurn || rotations.largest < kMoves ||
        rotations.turning < kMinChannels) {
      return;
    }
    report(
        Severity::warning, "bvh-angles",
        fmt::format("the angles may be radians, though BVH uses degrees: no rotation exceeds {}, "
                    "which is less than a full turn in radians",
                    readable(rotations.largest, 3)),
        "use --angles radians if they are");
  }

  // The unit, if this project wrote the file; then the axes are Krok's.
  std::optional<Unit> mark() const {
    const std::size_t end_of_number =
        file_.header.frame_time_offset + file_.header.frame_time_text.size();
    if (end_of_number > file_.text.size()) return std::nullopt;
    const std::string_view after = std::string_view(file_.text).substr(end_of_number);
    return marked_unit(after.substr(0, after.find('\n')));
  }

  void take_mark(Conventions& conventions) const {
    const auto unit = mark();
    if (!unit) return;
    const Conventions seen = std::exchange(conventions, {});
    // A reference pose that lies is turned up, whoever wrote it.
    if (seen.reference_up != conventions.up) {
      conventions.reference_up = seen.reference_up;
      conventions.reference_forward = seen.reference_forward;
    }
    conventions.unit = *unit;
    conventions.unit_confidence = conventions.up_confidence = conventions.forward_confidence =
        Confidence::certain;
    conventions.unit_reason = conventions.up_reason = conventions.forward_reason =
        "marked in the file by krok-export";
  }

  // Unit and axes, from the options or else detected from the data.
  Status detect(const SampleRows& samples, Positions positions) {
    Conventions& conventions = capture_.conventions;
    const Kinematics in_file(hierarchy_, positions, {});
    const Skeleton skeleton = skeleton_of(hierarchy_, in_file);
    auto roles = roles_of(skeleton, file_.options);
    if (!roles) return std::move(roles).error();
    capture_.roles = *std::move(roles);
    std::vector<Vec3> sample_positions;
    std::vector<Transform> pose(in_file.joint_count());
    for (std::size_t i = 0; i < samples.count(); ++i) {
      in_file.pose(samples.row(i), pose);
      for (const Transform& joint : pose) sample_positions.push_back(joint.position);
    }
    if (!file_.options.complete()) {
      conventions = detect_conventions(skeleton, capture_.roles, sample_positions);
      if (exporter_) apply_exporter(*exporter_, conventions);
      take_mark(conventions);
    }
    apply_given(file_.options, conventions);
    root_scale_ = root_scale(sample_positions, pose.size(), direction_vector(conventions.up));
    chosen_.usual_distance =
        usual_distance(sample_positions, pose.size()) * conventions.unit.metres;
    return {};
  }

  // Of files whose positions are in another unit than their offsets, as scripts write them.
  void warn_of_root_scale() {
    constexpr std::array kScales = {0.001, 0.01, 0.0254, 39.37, 100.0, 1000.0};
    for (const double scale : kScales) {
      if (!root_scale_ || std::abs(std::log(*root_scale_ / scale)) > 0.2) continue;
      report(
          Severity::warning, "bvh-position-unit",
          fmt::format("the positions seem to be in another unit than the offsets: the root is at "
                      "{} of its height over the feet",
                      readable(*root_scale_, 3)),
          fmt::format("multiply the position channels by {} if so", readable(1 / scale, 3)));
    }
  }

  // The final choice, after a detection of the axes with the first one.
  Result<PositionChoice> choose_detected(const SampleRows& samples, const PositionChoice& first) {
    Positions assumed = first.positions;
    const Conventions& found = capture_.conventions;
    // A person's doubtful up axis is no evidence; without a person, +y is as good as any.
    const auto clear = [&] {
      return found.up_confidence != Confidence::guess || !capture_.roles.humanoid;
    };
    const Direction of_first = found.up;
    if (!clear()) {
      // The ground is evidence of up, which only the right positions show.
      if (Status status = detect(samples, Positions::additive); !status) return status.error();
      assumed = Positions::additive;
    }
    // Doubtful, but the same whichever positions are right: the ground may decide by it.
    const bool usable = clear() || found.up == of_first;
    auto choice =
        choose_positions(hierarchy_, samples, usable ? std::optional(found.up) : std::nullopt);
    if (!clear() && !choice.by_ground) choice = choose_positions(hierarchy_, samples, std::nullopt);
    if (choice.positions != assumed) {
      if (Status status = detect(samples, choice.positions); !status) return status.error();
    }
    return choice;
  }

  Status make_conversion() {
    const Conventions& conventions = capture_.conventions;
    auto conversion = Conversion::make(conventions);
    if (!conversion) return std::move(conversion).error().in_file(file_.file_name);
    chosen_.conversion = *conversion;
    report_conventions(conventions, file_.options, "bvh", file_.file_name, capture_.diagnostics);
    capture_.clip.provenance.conversions = describe_conversions(conventions, file_.options);
    return {};
  }

  const IndexedFile& file_;
  Hierarchy& hierarchy_;
  Capture& capture_;
  std::optional<Exporter> exporter_;
  std::optional<double> root_scale_;
  ChosenConventions chosen_;
};

}  // namespace

Skeleton skeleton_of(const Hierarchy& hierarchy, const Kinematics& kinematics) {
  Skeleton skeleton;
  const std::vector<Transform> reference = kinematics.reference();
  for (std::size_t j = 0; j < hierarchy.joints.size(); ++j) {
    const Hierarchy::Joint& joint = hierarchy.joints[j];
    skeleton.add(joint.name, joint.parent, reference[j], joint.end_site);
  }
  return skeleton;
}

Result<ChosenConventions> choose_conventions(const IndexedFile& file, Hierarchy& hierarchy,
                                             Capture& capture) {
  return ConventionChooser(file, hierarchy, capture).choose();
}

}  // namespace krok::bvh
