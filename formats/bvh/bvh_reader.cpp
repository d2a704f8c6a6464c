#include "formats/bvh/bvh_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>

#include "capture/fill_frames.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "formats/bvh/frame_rate.h"
#include "formats/bvh/hierarchy.h"
#include "formats/bvh/kinematics.h"
#include "formats/bvh/motion_rows.h"
#include "formats/bvh/position_choice.h"
#include "formats/bvh/rest_frame.h"
#include "formats/bvh/text_cursor.h"

namespace krok::bvh {

namespace {

constexpr std::size_t kMostSamples = 200;

class Reader {
 public:
  Reader(std::string_view text, const std::string& file_name, const ReadOptions& options)
      : text_(text), file_name_(file_name), options_(options) {}

  Result<Capture> read() {
    auto hierarchy = parse_hierarchy(text_, file_name_, options_, capture_.diagnostics);
    if (!hierarchy) return std::move(hierarchy).error();
    hierarchy_ = std::move(*hierarchy);
    recognise_exporter();
    auto header =
        parse_motion_header(text_, hierarchy_.end, file_name_, options_, capture_.diagnostics);
    if (!header) return std::move(header).error();
    header_ = *header;
    capture_.frames_announced = header_.frames;
    capture_.frame_time = header_.frame_time;

    // Nearly every file has a row a line and nothing odd; the rows are taken as such, and only if
    // one of them turns out otherwise does the careful search for the rows begin.
    const Diagnostics before = capture_.diagnostics;
    rows_ = index_lines(text_, header_.end);
    if (!hierarchy_.channels.empty() && static_cast<long long>(rows_.size()) == header_.frames) {
      Status done = convert();
      if (!row_is_faulty_) {
        if (!done) return std::move(done).error();
        return std::move(capture_);
      }
      capture_.clip = {};
    }
    capture_.diagnostics = before;
    auto index = index_rows_with_care(text_, header_, hierarchy_, file_name_, options_,
                                      capture_.diagnostics);
    if (!index) return std::move(index).error();
    rows_ = std::move(index->begins);
    capture_.repairs = std::move(index->repairs);
    row_is_faulty_ = false;
    careful_ = true;
    if (Status done = convert(); !done) return std::move(done).error();
    assert(!row_is_faulty_);
    return std::move(capture_);
  }

 private:
  void tell(Severity severity, std::string code, std::string message, std::string hint = {},
            Location where = {}) {
    Diagnostic told;
    told.severity = severity;
    told.code = std::move(code);
    told.message = std::move(message);
    told.hint = std::move(hint);
    told.where = std::move(where);
    if (told.where.file.empty()) told.where.file = file_name_;
    capture_.diagnostics.push_back(std::move(told));
  }

  // iPi Mocap Studio's own names; it writes MotionBuilder's as well, which many others do.
  void recognise_exporter() {
    const std::array<std::string_view, 4> spine = {"Hip", "LowerSpine", "MiddleSpine", "Chest"};
    const auto& joints = hierarchy_.joints;
    if (joints.size() < spine.size()) return;
    for (std::size_t j = 0; j < spine.size(); ++j) {
      if (joints[j].name != spine[j] || joints[j].parent != static_cast<int>(j) - 1) return;
    }
    const auto ends = std::count_if(joints.begin(), joints.end(),
                                    [](const Hierarchy::Joint& joint) { return joint.end_site; });
    tell(Severity::note, "bvh-exporter",
         fmt::format("{} joints with the names that iPi Mocap Studio gives",
                     static_cast<std::ptrdiff_t>(joints.size()) - ends));
  }

  // From the places of the rows to the clip.
  Status convert() {
    choose_rate();
    if (Status chosen = choose_conventions(); !chosen) return chosen;
    if (Status filled = fill_clip(); !filled) return filled;
    if (!row_is_faulty_) report_rest_pose();
    return {};
  }

  void choose_rate() {
    double& rate = capture_.clip.rate;
    if (options_.rate) {
      rate = *options_.rate;
      capture_.rate = {readable(rate), "as given", Confidence::certain};
      return;
    }
    const PrintedRate printed = rate_of_frame_time(header_.frame_time_text, header_.frame_time);
    rate = printed.rate;
    capture_.rate = {readable(rate), printed.reason,
                     printed.few_digits ? Confidence::guess : Confidence::certain};
    const bool doubtful = printed.few_digits;
    tell(doubtful ? Severity::warning : Severity::note, "bvh-rate",
         fmt::format("{} frames a second: {}", readable(rate), printed.reason),
         doubtful ? "say the rate with --fps N if it is another" : "",
         doubtful ? locate(text_, header_.frame_time_offset, file_name_) : Location());
  }

  // Up to kMostSamples whole rows, evenly over the file.
  SampleRows sample_rows() const {
    SampleRows samples;
    samples.channels = hierarchy_.channels.size();
    const std::size_t count = std::min(rows_.size(), kMostSamples);
    std::vector<double> values(samples.channels);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t row = count < 2 ? 0 : i * (rows_.size() - 1) / (count - 1);
      if (rows_[row] == RowIndex::kFaulty) continue;
      if (parse_row(text_, rows_[row], values) == RowIndex::kFaulty) continue;
      samples.values.insert(samples.values.end(), values.begin(), values.end());
    }
    return samples;
  }

  Status choose_conventions() {
    const SampleRows samples = sample_rows();
    PositionChoice positions;
    if (options_.positions == Positions::automatic) {
      positions = choose_positions(hierarchy_, samples, options_.up);
    } else {
      positions.positions = options_.positions;
      positions.choice.choice = options_.positions == Positions::absolute ? "absolute" : "additive";
      positions.choice.reason = "as given";
      positions.choice.confidence = Confidence::certain;
    }
    if (Status detected = detect(samples, positions.positions); !detected) return detected;
    if (options_.positions == Positions::automatic && samples.count() > 0) {
      positions = choose_positions(hierarchy_, samples, capture_.conventions.up);
    }
    positions_ = positions.positions;
    capture_.positions = positions.choice;
    if (options_.positions == Positions::automatic && positions.has_evidence) {
      const bool guess = positions.choice.confidence == Confidence::guess;
      tell(guess ? Severity::warning : Severity::note, "bvh-positions",
           fmt::format("position channels are {} ({}): {}", positions.choice.choice,
                       confidence_name(positions.choice.confidence), positions.choice.reason),
           guess ? "say --positions absolute or additive if it is otherwise" : "");
    }
    return make_conversion();
  }

  Skeleton skeleton_of(const Kinematics& kinematics) const {
    Skeleton skeleton;
    const std::vector<Transform> reference = kinematics.reference();
    for (std::size_t j = 0; j < hierarchy_.joints.size(); ++j) {
      const Hierarchy::Joint& joint = hierarchy_.joints[j];
      skeleton.add(joint.name, joint.parent, reference[j], joint.end_site);
    }
    return skeleton;
  }

  // Unit and axes, from the options and, where they say nothing, from the data.
  Status detect(const SampleRows& samples, Positions positions) {
    Conventions& conventions = capture_.conventions;
    if (!options_.complete()) {
      const Kinematics in_file(hierarchy_, positions, {});
      const Skeleton skeleton = skeleton_of(in_file);
      std::vector<Vec3> sample_positions;
      std::vector<Transform> pose(in_file.joint_count());
      for (std::size_t i = 0; i < samples.count(); ++i) {
        in_file.pose(samples.row(i), pose);
        for (const Transform& joint : pose) sample_positions.push_back(joint.position);
      }
      conventions = detect_conventions(skeleton, find_roles(skeleton), sample_positions);
    }
    apply_given(options_, conventions);
    return {};
  }

  Status make_conversion() {
    const Conventions& conventions = capture_.conventions;
    auto conversion = Conversion::make(conventions);
    if (!conversion) return std::move(conversion).error().in_file(file_name_);
    conversion_ = *conversion;
    report_conventions(conventions, options_, "bvh", file_name_, capture_.diagnostics);
    capture_.clip.provenance.conversions = describe_conversions(conventions, options_);
    return {};
  }

  Status fill_clip() {
    const Kinematics kinematics(hierarchy_, positions_, conversion_);
    Clip& clip = capture_.clip;
    clip.skeleton = skeleton_of(kinematics);
    const double transforms =
        static_cast<double>(rows_.size()) * static_cast<double>(clip.skeleton.names.size());
    const double bytes = transforms * (sizeof(Vec3f) + sizeof(Quatf));
    constexpr double kSmall = 1 << 26;
    if (bytes > kSmall + options_.max_expansion * static_cast<double>(text_.size()) ||
        rows_.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      return Error("bvh-limit",
                   fmt::format("{} frames of {} joints are out of proportion to the size of the "
                               "file",
                               rows_.size(), clip.skeleton.names.size()))
          .in_file(file_name_);
    }
    clip.resize(static_cast<int>(rows_.size()));
    if (options_.progress != nullptr) options_.progress->begin("reading frames", rows_.size());
    std::atomic<std::size_t> first_overflow = rows_.size();
    parallel_for(rows_.size(), kRowsAtOnce, options_.jobs, [&](std::size_t begin, std::size_t end) {
      std::vector<double> values(hierarchy_.channels.size());
      std::vector<Transform> pose(kinematics.joint_count());
      for (std::size_t row = begin; row < end; ++row) {
        if (rows_[row] == RowIndex::kFaulty) continue;
        if (!parse_whole_row(row, values)) {
          row_is_faulty_ = true;
          return;
        }
        kinematics.pose(values, pose);
        // Zero times a number is zero, but not if it is infinite or NaN.
        float zero = 0;
        for (const Transform& joint : pose) {
          zero += 0.0f * (joint.position.cast<float>().sum() +
                          joint.orientation.coeffs().cast<float>().sum());
        }
        if (zero != 0) {
          std::size_t first = first_overflow;
          while (row < first && !first_overflow.compare_exchange_weak(first, row)) {
          }
        }
        clip.set_pose(static_cast<int>(row), pose);
      }
      if (options_.progress != nullptr) options_.progress->advance(end - begin);
    });
    if (row_is_faulty_) return {};
    if (first_overflow < rows_.size()) {
      Error overflow("bvh-number", "the numbers are so large that positions overflow",
                     "look at the frame's position channels, and at the unit if --unit was given");
      overflow.where = locate(text_, rows_[first_overflow], file_name_);
      overflow.frame = static_cast<std::int64_t>(first_overflow);
      return overflow;
    }
    if (options_.progress != nullptr) options_.progress->end();
    fill_faulty_frames();
    return {};
  }

  // False if the row is not all there, or if more than it stands before the next row.
  bool parse_whole_row(std::size_t row, std::span<double> values) const {
    std::size_t after = parse_row(text_, rows_[row], values);
    if (after == RowIndex::kFaulty) return false;
    if (careful_) return true;
    const std::size_t end = row + 1 < rows_.size() ? rows_[row + 1] : text_.size();
    while (after < end && is_space(text_[after])) ++after;
    return after == end;
  }

  // Frames without a row stand between whole ones.
  void fill_faulty_frames() {
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      if (rows_[row] != RowIndex::kFaulty) continue;
      const std::size_t first = row - 1;
      while (rows_[row] == RowIndex::kFaulty) ++row;
      fill_frames_between(capture_.clip, static_cast<int>(first), static_cast<int>(row));
    }
  }

  void report_rest_pose() {
    const RestPose rest = find_rest_pose(capture_.clip);
    tell(Severity::note, "bvh-reference", rest.reference);
    capture_.rest_frame_found = rest.first_frame_is_rest;
    const bool drop = capture_.clip.frame_count() > 0 &&
                      (options_.rest_frame == RestFrame::drop ||
                       (options_.rest_frame == RestFrame::automatic && rest.first_frame_is_rest));
    if (drop) {
      Clip& clip = capture_.clip;
      const auto joints = static_cast<std::ptrdiff_t>(clip.joint_count());
      clip.positions.erase(clip.positions.begin(), clip.positions.begin() + joints);
      clip.orientations.erase(clip.orientations.begin(), clip.orientations.begin() + joints);
      clip.provenance.conversions.emplace_back("the first frame, a rest pose, was left out");
      capture_.rest_frame_dropped = true;
    }
    if (rest.first_frame_is_rest) {
      tell(drop ? Severity::note : Severity::warning, "bvh-rest-frame",
           fmt::format("{}; it {}", rest.reason, drop ? "was left out" : "was kept"),
           drop ? "" : "--skip-rest-frame auto leaves it out");
    } else if (drop) {
      tell(Severity::note, "bvh-rest-frame", "the first frame was left out, as asked");
    }
  }

  static constexpr std::size_t kRowsAtOnce = 64;

  std::string_view text_;
  const std::string& file_name_;
  const ReadOptions& options_;
  Hierarchy hierarchy_;
  MotionHeader header_;
  std::vector<std::size_t> rows_;
  bool careful_ = false;  // rows_ comes from the careful search
  std::atomic<bool> row_is_faulty_ = false;
  Positions positions_ = Positions::absolute;
  Conversion conversion_;
  Capture capture_;
};

}  // namespace

Result<Capture> read(std::string_view text, const std::string& file_name,
                     const ReadOptions& options) {
  if (Status rate = check_rate(options.rate, "bvh-frame-time"); !rate) return rate.error();
  return Reader(text, file_name, options).read();
}

}  // namespace krok::bvh
