#include "formats/bvh/bvh_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <memory>
#include <mutex>
#include <vector>

#include "capture/far_values.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "core/text.h"
#include "formats/bvh/choose_conventions_internal.h"
#include "formats/bvh/hierarchy.h"
#include "formats/bvh/kinematics.h"
#include "formats/bvh/motion_rows.h"
#include "formats/bvh/row_frames.h"
#include "formats/bvh/row_lines_internal.h"
#include "scene/clip.h"
#include "scene/skeleton.h"

namespace krok::bvh {

namespace {

class FarRows {
 public:
  FarRows(std::string_view text, const RowFrames& frames, const Hierarchy& hierarchy,
          const std::string& file_name)
      : text_(text),
        frames_(frames),
        hierarchy_(hierarchy),
        file_name_(file_name),
        values_(hierarchy.channels.size()) {}

  Error rotation(std::size_t row, std::size_t count) {
    take(row);
    const auto found = frames_.kinematics().far_rotation(values_.data(), 1);
    const std::size_t channel = found ? found->channel : 0;
    Error failure = far_rotation("bvh-far-rotation", hierarchy_.channel_name(channel),
                                 found ? found->degrees : 0, count);
    return placed(std::move(failure), row, channel, hierarchy_.channels[channel].joint);
  }

  Error position(std::size_t row, std::size_t count) {
    take(row);
    const Kinematics& kinematics = frames_.kinematics();
    std::vector<Transform> pose(kinematics.joint_count());
    kinematics.pose(values_, pose);
    // The first far joint is the one that was moved; due to rounding there may be none.
    std::size_t joint = 0;
    for (std::size_t j = 0; j < pose.size(); ++j) {
      if (pose[joint].position.norm() > kinematics.farthest()) break;
      if (pose[j].position.norm() > pose[joint].position.norm()) joint = j;
    }
    const std::size_t channel = moving_channel(static_cast<int>(joint));
    const std::string number =
        fmt::format("{} is {}", hierarchy_.channel_name(channel), readable(values_[channel]));
    const bool moves = hierarchy_.channels[channel].kind == ChannelKind::position;
    const bool only_unusual =
        !(pose[joint].position.norm() > farthest_position(kinematics.reference()));
    Error failure =
        far_position("bvh-far-position", hierarchy_.joints[joint].name, pose[joint].position, count,
                     moves ? number : "",
                     only_unusual ? std::optional(kinematics.usual_distance()) : std::nullopt);
    return placed(std::move(failure), row, channel, static_cast<int>(joint));
  }

 private:
  void take(std::size_t row) { parse_row(text_, frames_.rows()[row], values_); }

  // The largest position channel of the joint, or of its nearest ancestor that has any.
  std::size_t moving_channel(int joint) const {
    for (; joint >= 0; joint = hierarchy_.joints[static_cast<std::size_t>(joint)].parent) {
      const auto& own = hierarchy_.joints[static_cast<std::size_t>(joint)];
      std::optional<std::size_t> largest;
      for (std::size_t c = own.first_channel; c < own.first_channel + own.channel_count; ++c) {
        if (hierarchy_.channels[c].kind != ChannelKind::position) continue;
        if (!largest || std::abs(values_[c]) > std::abs(values_[*largest])) largest = c;
      }
      if (largest) return *largest;
    }
    return 0;
  }

  Error placed(Error failure, std::size_t row, std::size_t channel, int joint) const {
    std::size_t at = frames_.rows()[row];
    for (std::size_t c = 0; c < channel; ++c) {
      at += word_at(text_, at).size();
      while (at < text_.size() && is_space(text_[at])) ++at;
    }
    failure.where = locate(text_, at, file_name_);
    failure.joint = hierarchy_.joints[static_cast<std::size_t>(joint)].name;
    failure.frame = static_cast<std::int64_t>(row);
    return failure;
  }

  std::string_view text_;
  const RowFrames& frames_;
  const Hierarchy& hierarchy_;
  const std::string& file_name_;
  std::vector<double> values_;
};

// Diagnostics for implausibly large values in rows, `far` of `frames`: the first rotation and the
// first position, each with joint, frame and location. Codes bvh-far-rotation, bvh-far-position.
std::vector<Error> far_row_faults(std::string_view text, const RowFrames& frames,
                                  const FarValues& far, const Hierarchy& hierarchy,
                                  const std::string& file_name) {
  FarRows rows(text, frames, hierarchy, file_name);
  std::vector<Error> faults;
  if (far.rotations > 0) faults.push_back(rows.rotation(far.first_rotation, far.rotations));
  if (far.positions > 0) faults.push_back(rows.position(far.first_position, far.positions));
  return faults;
}

class Reader {
 public:
  Reader(std::string_view text, const std::string& file_name, const ReadOptions& options)
      : text_(text), file_name_(file_name), options_(options) {}

  // Reads the hierarchy and header and indexes the lines; false if the lines are not one row each.
  Result<bool> begin(const std::function<void(std::size_t)>& release = {}) {
    auto hierarchy = parse_hierarchy(text_, file_name_, options_, capture_.diagnostics);
    if (!hierarchy) return std::move(hierarchy).error();
    hierarchy_ = std::move(*hierarchy);
    if (hierarchy_.no_motion) return true;
    auto header =
        parse_motion_header(text_, hierarchy_.end, file_name_, options_, capture_.diagnostics);
    if (!header) return std::move(header).error();
    header_ = *header;
    capture_.frames_announced = header_.frames;
    capture_.frame_time = header_.frame_time;

    // Nearly every file has one valid row per line. That is assumed first; the careful search runs
    // only if a row turns out to be faulty.
    rows_ = index_lines(text_, header_.end, options_.jobs, release);
    return !hierarchy_.channels.empty() && static_cast<long long>(rows_.size()) == header_.frames;
  }

  Result<Capture> read() {
    const auto one_row_a_line = begin();
    if (!one_row_a_line) return one_row_a_line.error();
    const Diagnostics before = capture_.diagnostics;
    if (*one_row_a_line) {
      Status status = convert();
      if (!row_is_faulty_) {
        if (!status) return std::move(status).error();
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
    if (Status status = convert(); !status) return std::move(status).error();
    assert(!row_is_faulty_);
    return std::move(capture_);
  }

  std::optional<OpenedCapture> open(std::function<void(std::size_t)> release) {
    const auto one_row_a_line = begin(release);
    if (!one_row_a_line || !*one_row_a_line || hierarchy_.no_motion) return std::nullopt;
    if (!choose() || !check_size()) return std::nullopt;
    make_frames();
    // The first frames are enough to detect a rest frame.
    FrameSource head = source(0, nullptr, {});
    head.frame_count = std::min(head.frame_count, kFramesOfRestPose);
    auto clip = load(head, 1);
    if (!clip) return std::nullopt;
    auto conversions = std::move(capture_.clip.provenance.conversions);
    capture_.clip = *std::move(clip);
    capture_.clip.provenance.conversions = std::move(conversions);
    report_rest_pose();
    OpenedCapture opened;
    opened.frames =
        source(capture_.rest_frame_dropped ? 1 : 0, options_.progress, std::move(release));
    capture_.clip.resize(0);
    static_cast<Capture&>(opened) = std::move(capture_);
    if (options_.progress != nullptr) options_.progress->begin("frames", opened.frames.frame_count);
    return opened;
  }

 private:
  // Converts the indexed rows to the clip.
  Status convert() {
    if (Status status = choose(); !status) return status;
    if (Status status = fill_clip(); !status) return status;
    if (row_is_faulty_) return {};
    if (Status status = report_far_values(); !status) return status;
    report_rest_pose();
    return {};
  }

  Status choose() {
    auto chosen =
        choose_conventions({text_, file_name_, options_, header_, rows_}, hierarchy_, capture_);
    if (!chosen) return std::move(chosen).error();
    positions_ = chosen->positions;
    conversion_ = chosen->conversion;
    usual_distance_ = chosen->usual_distance;
    return {};
  }

  Status report_far_values() {
    for (Error& fault : far_row_faults(text_, *frames_, far_, hierarchy_, file_name_)) {
      if (options_.strictness == Strictness::strict) return std::move(fault);
      fault.severity = Severity::warning;
      capture_.diagnostics.push_back(std::move(fault));
    }
    return {};
  }

  Status check_size() const {
    const double transforms =
        static_cast<double>(rows_.size()) * static_cast<double>(hierarchy_.joints.size());
    const double bytes = transforms * (sizeof(Vec3f) + sizeof(Quatf));
    constexpr double kSmall = 1 << 26;
    if (bytes > kSmall + options_.max_expansion * static_cast<double>(text_.size()) ||
        rows_.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      return Error("bvh-limit",
                   fmt::format("{} frames of {} joints are out of proportion to the size of the "
                               "file",
                               rows_.size(), hierarchy_.joints.size()))
          .in_file(file_name_);
    }
    return {};
  }

  // Makes the skeleton and the converter from rows to frames.
  void make_frames() {
    Kinematics kinematics(hierarchy_, positions_, conversion_);
    kinematics.expect_within(usual_distance_);
    capture_.clip.skeleton = skeleton_of(hierarchy_, kinematics);
    frames_ = std::make_shared<const RowFrames>(text_, std::move(rows_), hierarchy_.channels.size(),
                                                std::move(kinematics), careful_);
    rows_.clear();
  }

  // The frames from row `skip` on. Keeps everything it needs alive except the text.
  FrameSource source(int skip, Progress* progress, std::function<void(std::size_t)> release) const {
    FrameSource result;
    result.skeleton = capture_.clip.skeleton;
    result.rate = capture_.clip.rate;
    result.frame_count = static_cast<int>(frames_->rows().size()) - skip;
    result.read = [frames = frames_, skip, progress](int first, int count,
                                                     std::span<Vec3f> positions,
                                                     std::span<Quatf> orientations) -> Status {
      const auto outcome = frames->read(static_cast<std::size_t>(first + skip),
                                        static_cast<std::size_t>(count), positions, orientations);
      // read() reports far values.
      if (outcome.row_is_faulty || outcome.overflow || outcome.far.any()) {
        return Error("bvh-channel-count", "a row is incomplete, or its numbers are too large");
      }
      if (progress != nullptr) progress->advance(static_cast<std::uint64_t>(count));
      return {};
    };
    if (release) {
      result.release = [frames = frames_, skip, release = std::move(release)](int frame) {
        const auto row = static_cast<std::size_t>(frame + skip);
        if (row < frames->rows().size()) release(frames->rows()[row]);
      };
    }
    return result;
  }

  Status fill_clip() {
    if (Status status = check_size(); !status) return status;
    make_frames();
    Clip& clip = capture_.clip;
    for (std::size_t j = 0; j < clip.skeleton.reference.size(); ++j) {
      if (is_near(clip.skeleton.reference[j].position)) continue;
      Error far("bvh-number",
                fmt::format("the OFFSETs are so large that {} is over 1e9 m away in the reference "
                            "pose",
                            shown(clip.skeleton.names[j])),
                "check the OFFSETs, and the unit if --unit was given");
      far.joint = clip.skeleton.names[j];
      return std::move(far).in_file(file_name_);
    }
    const std::size_t count = frames_->rows().size();
    const auto joints = static_cast<std::size_t>(clip.joint_count());
    clip.resize(static_cast<int>(count));
    if (options_.progress != nullptr) options_.progress->begin("reading frames", count);
    std::atomic<std::size_t> first_overflow = count;
    std::mutex of_far;
    far_ = {};
    parallel_for(count, kRowsAtOnce, options_.jobs, [&](std::size_t begin, std::size_t end) {
      const auto outcome = frames_->read(
          begin, end - begin,
          std::span(clip.positions).subspan(begin * joints, (end - begin) * joints),
          std::span(clip.orientations).subspan(begin * joints, (end - begin) * joints));
      if (outcome.row_is_faulty) {
        row_is_faulty_ = true;
        return;
      }
      if (outcome.overflow) {
        std::size_t first = first_overflow;
        while (*outcome.overflow < first &&
               !first_overflow.compare_exchange_weak(first, *outcome.overflow)) {
        }
      }
      if (outcome.far.any()) {
        const std::lock_guard lock(of_far);
        far_.add(outcome.far);
      }
      if (options_.progress != nullptr) options_.progress->advance(end - begin);
    });
    if (options_.progress != nullptr) options_.progress->end();
    if (row_is_faulty_) return {};
    if (first_overflow < count) {
      Error overflow("bvh-number", "the numbers are so large that a joint is over 1e9 m away",
                     "check the frame's position channels, and the unit if --unit was given");
      overflow.where = locate(text_, frames_->rows()[first_overflow], file_name_);
      overflow.frame = static_cast<std::int64_t>(first_overflow);
      return overflow;
    }
    fill_faulty_frames();
    return {};
  }

  // Frames without a row are always between complete ones.
  void fill_faulty_frames() {
    const auto& rows = frames_->rows();
    for (std::size_t row = 0; row < rows.size(); ++row) {
      if (rows[row] != RowIndex::kFaulty) continue;
      const std::size_t first = row - 1;
      while (rows[row] == RowIndex::kFaulty) ++row;
      fill_frames_between(capture_.clip, static_cast<int>(first), static_cast<int>(row));
    }
  }

  void report_rest_pose() {
    const RestPose rest = find_rest_pose(capture_.clip, capture_.roles);
    Error note =
        Error("bvh-reference",
              fmt::format("the reference pose (OFFSETs, no rotations) is {}", rest.reference))
            .in_file(file_name_);
    note.severity = Severity::note;
    capture_.diagnostics.push_back(std::move(note));
    capture_.rest_frame_found = rest.first_frame_is_rest;
    capture_.rest_frame_dropped =
        settle_rest_frame(rest, options_.rest_frame, "bvh", file_name_, capture_);
  }

  static constexpr std::size_t kRowsAtOnce = 64;
  static constexpr int kFramesOfRestPose = 16;

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
  double usual_distance_ = 0;
  std::shared_ptr<const RowFrames> frames_;
  FarValues far_;
  Capture capture_;
};

// Puts a change of numbers before what was reported about the changed text. `what` has a place for
// their count.
void add_repair(fmt::format_string<std::string> what, std::string_view text,
                const MendedText& mended, const std::string& file_name, Capture& capture) {
  Error repair("bvh-repair",
               fmt::format(what, counted(static_cast<long long>(mended.count), "place")));
  repair.where = locate(text, mended.first, file_name);
  repair.severity = Severity::warning;
  capture.repairs.insert(capture.repairs.begin(),
                         fmt::format("line {}: {}", repair.where.line, repair.message));
  capture.diagnostics.insert(capture.diagnostics.begin(), std::move(repair));
}

}  // namespace

Result<Capture> read(std::string_view text, const std::string& file_name,
                     const ReadOptions& options) {
  if (Status status = check_rate(options.rate, "bvh-frame-time"); !status) return status.error();
  if (options.strictness != Strictness::repair) return Reader(text, file_name, options).read();
  const auto split = with_split_numbers(text);
  const std::string_view apart = split ? std::string_view(split->text) : text;
  const auto pointed = with_decimal_points(apart);
  auto capture = Reader(pointed ? pointed->text : apart, file_name, options).read();
  if (!capture) return capture;
  if (pointed)
    add_repair("decimal commas were read as points in {}", apart, *pointed, file_name, *capture);
  if (split)
    add_repair("numbers without a blank between them were split in {}", text, *split, file_name,
               *capture);
  return capture;
}

std::optional<OpenedCapture> open(std::string_view text, const std::string& file_name,
                                  const ReadOptions& options,
                                  std::function<void(std::size_t)> release) {
  if (!check_rate(options.rate, "bvh-frame-time")) return std::nullopt;
  return Reader(text, file_name, options).open(std::move(release));
}

}  // namespace krok::bvh
