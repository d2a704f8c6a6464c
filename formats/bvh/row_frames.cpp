#include "formats/bvh/row_frames.h"

#include <algorithm>

#include "core/text.h"
#include "formats/bvh/number_kernel.h"
#include "scene/skeleton.h"

namespace krok::bvh {

namespace {

constexpr std::size_t kAtOnce = Kinematics::kFramesAtOnce;

// 64-byte aligned doubles, all zero.
class AlignedDoubles {
 public:
  explicit AlignedDoubles(std::size_t count) : lines_((count + 7) / 8) {}
  double* data() { return lines_.data()->values; }

 private:
  struct alignas(64) Line {
    double values[8] = {};
  };
  std::vector<Line> lines_;
};

// The first frame with a float that is not finite or farther away than positions may be.
std::optional<std::size_t> first_overflow(std::size_t frames, std::size_t joints,
                                          std::span<const Vec3f> positions,
                                          std::span<const Quatf> orientations) {
  for (std::size_t i = 0; i < frames * joints; ++i) {
    if (!is_near(positions[i]) || !orientations[i].coeffs().allFinite()) return i / joints;
  }
  return std::nullopt;
}

}  // namespace

RowFrames::Outcome RowFrames::read(std::size_t first, std::size_t count, std::span<Vec3f> positions,
                                   std::span<Quatf> orientations) const {
  Outcome outcome;
  const std::size_t joints = kinematics_.joint_count();
  AlignedDoubles values(channels_ * kAtOnce);
  std::vector<double> scratch;
  std::vector<std::uint32_t> edges(number_kernel::edges_for(channels_));
  for (std::size_t done = 0; done < count; done += kAtOnce) {
    const std::size_t frames = std::min(kAtOnce, count - done);
    for (std::size_t i = 0; i < frames; ++i) {
      const std::size_t row = first + done + i;
      if (rows_[row] == RowIndex::kFaulty) continue;
      if (parse_plain_row(row, values.data() + i, edges)) continue;
      if (parse_whole_row(row, values.data() + i)) continue;
      outcome.row_is_faulty = true;
      return outcome;
    }
    const auto block_positions = positions.subspan(done * joints, frames * joints);
    const auto block_orientations = orientations.subspan(done * joints, frames * joints);
    const bool sound = kinematics_.poses({values.data(), channels_ * kAtOnce}, frames, scratch,
                                         block_positions, block_orientations);
    if (sound || outcome.overflow) continue;
    const auto bad = first_overflow(frames, joints, block_positions, block_orientations);
    if (bad) {
      outcome.overflow = first + done + *bad;
    } else {
      look_at_frames(first + done, frames, values.data(), block_positions, outcome);
    }
  }
  return outcome;
}

void RowFrames::look_at_frames(std::size_t first, std::size_t frames, const double* values,
                               std::span<const Vec3f> positions, Outcome& outcome) const {
  const std::size_t joints = kinematics_.joint_count();
  for (std::size_t i = 0; i < frames; ++i) {
    const std::size_t row = first + i;
    if (rows_[row] == RowIndex::kFaulty) continue;
    if (kinematics_.far_rotation(values + i, kAtOnce)) outcome.far.add_rotation(row);
    const auto frame = positions.subspan(i * joints, joints);
    const bool far = std::any_of(frame.begin(), frame.end(), [&](const Vec3f& p) {
      return p.cast<double>().norm() > kinematics_.farthest();
    });
    if (far) outcome.far.add_position(row);
  }
}

// False if the row needs the general parser.
bool RowFrames::parse_plain_row(std::size_t row, double* values,
                                std::vector<std::uint32_t>& edges) const {
  if (careful_ || row + 1 == rows_.size()) return false;
  const std::size_t begin = rows_[row];
  const std::size_t end = rows_[row + 1];
  if (begin < number_kernel::kBefore || text_.size() - end < number_kernel::kAfter) return false;
  return number_kernel::parse_plain_row(text_.data() + begin, text_.data() + end, channels_, values,
                                        kAtOnce, edges.data());
}

// False if the row is incomplete, or if there is more text before the next row.
bool RowFrames::parse_whole_row(std::size_t row, double* values) const {
  std::size_t after = parse_row(text_, rows_[row], values, channels_, kAtOnce);
  if (after == RowIndex::kFaulty) return false;
  if (careful_) return true;
  const std::size_t end = row + 1 < rows_.size() ? rows_[row + 1] : text_.size();
  while (after < end && is_space(text_[after])) ++after;
  return after == end;
}

}  // namespace krok::bvh
