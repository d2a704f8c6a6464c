#include "formats/acclaim/far_frames_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "core/text.h"

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

}  // namespace

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

}  // namespace krok::acclaim
