#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/bvh/far_rows_internal.h"
#include "formats/bvh/row_lines_internal.h"

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

}  // namespace

std::vector<Error> far_row_faults(std::string_view text, const RowFrames& frames,
                                  const FarValues& far, const Hierarchy& hierarchy,
                                  const std::string& file_name) {
  FarRows rows(text, frames, hierarchy, file_name);
  std::vector<Error> faults;
  if (far.rotations > 0) faults.push_back(rows.rotation(far.first_rotation, far.rotations));
  if (far.positions > 0) faults.push_back(rows.position(far.first_position, far.positions));
  return faults;
}

}  // namespace krok::bvh
