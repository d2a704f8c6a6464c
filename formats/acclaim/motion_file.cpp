#include "formats/acclaim/files_internal.h"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>
#include <system_error>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/acclaim/source_text_internal.h"

namespace krok::acclaim {

namespace {

// Splits one line into words; ends at a comment.
class LineCursor {
 public:
  LineCursor(const char* position, const char* end) : position_(position), end_(end) {}

  bool at_end() {
    while (position_ < end_ && is_separator(*position_)) ++position_;
    return position_ == end_ || *position_ == '#';
  }
  std::string_view word() {
    if (at_end()) return {};
    const char* begin = position_;
    while (position_ < end_ && !is_separator(*position_)) ++position_;
    return {begin, static_cast<std::size_t>(position_ - begin)};
  }
  // Consumes the next word if it is a finite number.
  bool number(double& value) {
    if (at_end()) return false;
    const auto parsed = fast_float::from_chars(position_, end_, value);
    if (parsed.ec == std::errc() && std::isfinite(value) &&
        (parsed.ptr == end_ || is_separator(*parsed.ptr))) {
      position_ = parsed.ptr;
      return true;
    }
    LineCursor ahead = *this;  // has a plus sign, or is not a number
    const auto whole = parse_finite(ahead.word());
    if (!whole) return false;
    value = *whole;
    *this = ahead;
    return true;
  }
  const char* position() const { return position_; }

 private:
  const char* position_;
  const char* end_;
};

constexpr const char* kRepairHint = "--repair skips the line";
constexpr const char* kCutHint = "the file is truncated; export or copy it again";

class MotionParser {
 public:
  MotionParser(SourceText& source, const SkeletonFile& skeleton, std::size_t joint_count,
               const ReadOptions& options)
      : source_(source), skeleton_(skeleton), text_(source.text()) {
    first_channel_.reserve(skeleton.joints.size() + 1);
    for (const auto& joint : skeleton.joints) {
      first_channel_.push_back(motion_.channel_count);
      motion_.channel_count += joint.channels.size();
      moving_ += joint.channels.empty() ? 0 : 1;
      // Default values, used before the first values of a bone.
      for (const Channel channel : joint.channels) {
        current_.push_back(channel == Channel::length ? joint.length : 0.0);
      }
    }
    last_seen_.assign(skeleton.joints.size(), 0);
    lines_.assign(skeleton.joints.size(), 0);
    most_frames_ = most_frames(text_.size(), motion_.channel_count, joint_count, options);
  }

  Result<MotionFile> parse() {
    while (line_begin_ < text_.size()) {
      std::size_t end = line_begin_;
      while (end < text_.size() && !is_line_end(text_[end])) ++end;
      if (Status status = parse_line(end); !status) {
        const bool unfinished = end == text_.size();
        if (Status handled = handle_fault(std::move(status).error(), unfinished); !handled) {
          return handled.error();
        }
        if (cut_) break;
      }
      const bool pair = end + 1 < text_.size() && text_[end] == '\r' && text_[end + 1] == '\n';
      line_begin_ = end + (pair ? 2 : 1);
      ++line_number_;
    }
    if (Status status = finish_last_frame(); !status) return status.error();
    if (lines_left_out_ > kMaxRepairs) {
      motion_.repairs.push_back(
          fmt::format("{} more lines skipped", lines_left_out_ - kMaxRepairs));
    }
    if (Status status = report_oddities(); !status) return status.error();
    return std::move(motion_);
  }

 private:
  // A location in the current line.
  SourceText::TextLocation place_of(const char* position) const {
    return {line_number_, position - text_.data() - static_cast<std::ptrdiff_t>(line_begin_) + 1};
  }

  // An error in a last line without a line end means that the file is truncated.
  Status handle_fault(Error error, bool unfinished) {
    if (error.code == "acclaim-limit" || source_.strictness() == Strictness::strict) return error;
    if (unfinished && in_frame_) {
      cut_ = true;
      return {};
    }
    // Only lines with values inside a frame can be skipped.
    if (source_.strictness() != Strictness::repair || !in_frame_ ||
        error.code == "acclaim-syntax") {
      return error;
    }
    if (++lines_left_out_ <= kMaxRepairs) {
      motion_.repairs.push_back(
          fmt::format("line {} skipped: {}", error.where.line, error.message));
    }
    source_.warn({error.where.line, error.where.column}, "acclaim-repair",
                 "line skipped: " + error.message);
    return {};
  }

  Status parse_line(std::size_t end) {
    LineCursor line(text_.data() + line_begin_, text_.data() + end);
    if (line.at_end()) return {};
    if (*line.position() == ':') return parse_keyword(line);
    const char* name_begin = line.position();
    const std::string_view name = line.word();
    const bool digits_first = name[0] >= '0' && name[0] <= '9';
    if ((digits_first || name[0] == '-') && line.at_end()) {
      if (const auto number = parse_integer(name))
        return begin_frame(*number, place_of(name_begin));
    }
    if (!in_frame_) {
      return source_.error(
          place_of(name_begin), "acclaim-syntax",
          fmt::format("'{}' where the number of the first frame is expected", shown(name)));
    }
    return parse_values(name, place_of(name_begin), line);
  }

  Status parse_keyword(LineCursor& line) {
    const SourceText::TextLocation place = place_of(line.position());
    const std::string_view word = line.word();
    const std::string keyword = ascii_lower(word);
    if (in_frame_) {
      return source_.error(place, "acclaim-syntax",
                           fmt::format("{} between the frames", shown(word)));
    }
    if (keyword == ":fully-specified") {
      specified_ = true;
    } else if (keyword == ":degrees" || keyword == ":radians") {
      motion_.degrees = keyword == ":degrees";
    } else if (keyword == ":samples-per-second") {
      double rate = 0;
      if (!line.number(rate) || !(rate > 0)) {
        return source_.error(place, "acclaim-rate",
                             fmt::format("{} is not followed by a positive number", shown(word)));
      }
      motion_.rate = rate;
    } else if (keyword != ":frame-range" && keyword != ":asf-file" && keyword != ":asf-path") {
      return source_.fault(place, "acclaim-keyword",
                           fmt::format("'{}' is unknown and ignored", shown(word)));
    }
    return {};
  }

  Status begin_frame(long long number, const SourceText::TextLocation& place) {
    if (in_frame_) {
      if (Status status = finish_frame(); !status) return status;
    }
    if (motion_.frame_count() >= most_frames_) {
      return source_.error(place, "acclaim-limit",
                           fmt::format("more than {} frames of {} joints are out of proportion to "
                                       "the size of the file",
                                       most_frames_, skeleton_.joints.size()));
    }
    in_frame_ = true;
    number_ = number;
    frame_place_ = place;
    seen_ = 0;
    place_ = 0;
    ++stamp_;
    return {};
  }

  // Bones are in the same order in every frame, so the next one is nearly always the same as in the
  // previous frame.
  int joint_of(std::string_view name) {
    if (place_ < order_.size() && order_[place_].name == name) return order_[place_++].joint;
    const int joint = skeleton_.find(name);
    if (joint == SkeletonFile::kUnknown) return joint;
    if (stamp_ == 1) {
      order_.push_back({name, joint});
      place_ = order_.size();
      return joint;
    }
    // If bones are missing, the order continues nearby.
    for (std::size_t i = place_; i < std::min(order_.size(), place_ + kSearch); ++i) {
      if (order_[i].joint != joint) continue;
      place_ = i + 1;
      break;
    }
    return joint;
  }

  Status parse_values(std::string_view name, const SourceText::TextLocation& place,
                      LineCursor& line) {
    const int joint = joint_of(name);
    if (joint == SkeletonFile::kLeftOut) return {};
    if (joint == SkeletonFile::kUnknown) {
      return source_.error(place, "acclaim-unknown-bone",
                           fmt::format("the skeleton has no bone {}", shown(name)),
                           "the motion belongs to another skeleton; give its ASF");
    }
    const auto j = static_cast<std::size_t>(joint);
    if (last_seen_[j] == stamp_) {
      return source_.error(place, "acclaim-frame",
                           fmt::format("frame {} has {} twice", number_, shown(name)),
                           "perhaps a frame number is missing between the two");
    }
    const std::vector<Channel>& channels = skeleton_.joints[j].channels;
    values_.clear();
    double value = 0;
    while (line.number(value)) values_.push_back(value);
    if (!line.at_end()) {
      const SourceText::TextLocation place_of_value = place_of(line.position());
      return source_.error(place_of_value, "acclaim-number",
                           fmt::format("'{}' in the values of {} is not a finite number",
                                       shown(line.word()), shown(name)),
                           kRepairHint);
    }
    if (values_.size() != channels.size()) {
      return source_.error(place, "acclaim-values",
                           fmt::format("{} value{} for {}, expected {}{}", values_.size(),
                                       values_.size() == 1 ? "" : "s", shown(name), channels.size(),
                                       channel_list(channels)),
                           kRepairHint);
    }
    std::copy(values_.begin(), values_.end(),
              current_.begin() + static_cast<std::ptrdiff_t>(first_channel_[j]));
    last_seen_[j] = stamp_;
    if (!channels.empty()) {
      ++seen_;
      ++lines_[j];
    }
    return {};
  }

  static std::string channel_list(const std::vector<Channel>& channels) {
    std::string list;
    for (const Channel channel : channels) {
      list += list.empty() ? " (" : " ";
      list += channel_name(channel);
    }
    return list.empty() ? list : list + ")";
  }

  Status finish_frame() {
    if (seen_ < moving_) {
      if (source_.strictness() == Strictness::strict) {
        return source_.error(frame_place_, "acclaim-missing",
                             fmt::format("frame {} has no values for {}", number_,
                                         skeleton_.joints[first_missing()].name));
      }
      if (!short_place_ && seen_ < seen_before_) short_place_ = frame_place_;
    }
    seen_before_ = std::max(seen_before_, seen_);
    motion_.values.insert(motion_.values.end(), current_.begin(), current_.end());
    motion_.frame_numbers.push_back(number_);
    const auto& numbers = motion_.frame_numbers;
    if (numbers.size() == 1) {
      first_place_ = frame_place_;
    } else if (!odd_number_place_ && number_ <= numbers[numbers.size() - 2]) {
      odd_number_place_ = frame_place_;
    }
    return {};
  }

  std::size_t first_missing() const {
    for (std::size_t j = 0; j < last_seen_.size(); ++j) {
      if (!skeleton_.joints[j].channels.empty() && last_seen_[j] != stamp_) return j;
    }
    return 0;
  }

  // The last frame is complete if it has as many bones as the frames before it.
  Status finish_last_frame() {
    if (!in_frame_) return {};
    const bool lacks = motion_.frame_count() > 0 && seen_ < seen_before_;
    if (!cut_ && !lacks) return finish_frame();
    motion_.repairs.push_back(fmt::format("truncated frame {} dropped", number_));
    return source_.fault(frame_place_, "acclaim-cut",
                         fmt::format("the file ends inside frame {}, which is dropped", number_),
                         kCutHint);
  }

  Status report_oddities() {
    if (!specified_) {
      if (Status status = source_.fault(0, "acclaim-keyword",
                                        "the motion has no :FULLY-SPECIFIED, which is assumed");
          !status) {
        return status;
      }
    }
    if (motion_.frame_count() == 0) {
      return source_.fault(text_.size(), "acclaim-frame", "the motion has no complete frame",
                           kCutHint);
    }
    if (odd_number_place_) {
      if (Status status = source_.fault(*odd_number_place_, "acclaim-frame",
                                        "the number of this frame is not greater than the one "
                                        "before; frames are read in file order");
          !status) {
        return status;
      }
    }
    return report_missing();
  }

  Status report_missing() {
    std::size_t never = 0, now_and_then = 0;
    std::size_t first_never = 0, first_short = 0;
    for (std::size_t j = 0; j < lines_.size(); ++j) {
      if (skeleton_.joints[j].channels.empty() || lines_[j] >= motion_.frame_count()) continue;
      if (lines_[j] == 0) {
        if (never++ == 0) first_never = j;
      } else if (now_and_then++ == 0) {
        first_short = j;
      }
    }
    if (never > 0) {
      const std::string& name = skeleton_.joints[first_never].name;
      if (Status status = source_.fault(
              0, "acclaim-missing",
              fmt::format("the motion has no values for {} bone{} with a dof (the first: {}); "
                          "they stay in the reference pose",
                          never, never == 1 ? "" : "s", name),
              "perhaps it was made for another skeleton", name);
          !status) {
        return status;
      }
    }
    if (now_and_then == 0) return {};
    const std::string& name = skeleton_.joints[first_short].name;
    return source_.fault(
        short_place_.value_or(first_place_), "acclaim-missing",
        fmt::format("some frames have no values for {} bone{} that other frames have (the first: "
                    "{}); the last values are kept",
                    now_and_then, now_and_then == 1 ? "" : "s", name),
        {}, name);
  }

  static constexpr std::size_t kSearch = 64;
  static constexpr std::size_t kMaxRepairs = 1000;

  SourceText& source_;
  const SkeletonFile& skeleton_;
  std::string_view text_;
  std::size_t line_begin_ = 0;
  std::int64_t line_number_ = 1;
  MotionFile motion_;
  std::size_t most_frames_ = 0;
  std::size_t moving_ = 0;  // joints with channels
  std::vector<std::size_t> first_channel_;

  struct OrderedJoint {
    std::string_view name;
    int joint;
  };
  std::vector<OrderedJoint> order_;  // as in the first frame
  std::size_t place_ = 0;

  // The frame being read.
  bool in_frame_ = false, cut_ = false, specified_ = false;
  long long number_ = 0;
  SourceText::TextLocation frame_place_ = 0;
  std::size_t stamp_ = 0;  // counts begun frames
  std::size_t seen_ = 0;   // moving joints
  std::vector<double> current_, values_;
  std::vector<std::size_t> last_seen_;  // [joints] stamp
  std::vector<std::size_t> lines_;      // [joints] frames with values

  std::size_t seen_before_ = 0;
  std::size_t lines_left_out_ = 0;
  SourceText::TextLocation first_place_ = 0;
  std::optional<SourceText::TextLocation> short_place_, odd_number_place_;
};

}  // namespace

std::size_t most_frames(std::size_t text_size, std::size_t channels, std::size_t joints,
                        const ReadOptions& options) {
  constexpr double kAlways = 1 << 26;  // bytes allowed for any file
  const double bytes =
      static_cast<double>(channels * sizeof(double) + joints * (sizeof(Vec3f) + sizeof(Quatf)));
  const double frames =
      (kAlways + options.max_expansion * static_cast<double>(text_size)) / std::max(bytes, 1.0);
  return static_cast<std::size_t>(
      std::min(frames, static_cast<double>(std::numeric_limits<int>::max())));
}

Result<MotionFile> parse_motion(SourceText& source, const SkeletonFile& skeleton,
                                std::size_t joint_count, const ReadOptions& options) {
  return MotionParser(source, skeleton, joint_count, options).parse();
}

}  // namespace krok::acclaim
