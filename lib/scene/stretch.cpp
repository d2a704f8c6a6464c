#include "scene/stretch.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/index.h"

namespace krok {

Stretch Stretch::of(const Mat3& symmetric) {
  const auto entry = [&](int row, int column) {
    return static_cast<float>(0.5 * (symmetric(row, column) + symmetric(column, row)));
  };
  return {entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2)};
}

Mat3 Stretch::matrix() const {
  Eigen::Matrix3f result;
  result << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return result.cast<double>();
}

Status check(std::span<const Stretch> stretches, const Clip& clip) {
  if (stretches.empty()) return {};
  if (stretches.size() != clip.positions.size()) {
    return Error("stretch-shape", fmt::format("{} stretches for {} joint positions",
                                              stretches.size(), clip.positions.size()));
  }
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    if (stretches[i].matrix().allFinite()) continue;
    const std::size_t joints = clip.skeleton.names.size();
    Error error("stretch-value", fmt::format("the stretch of joint {} in frame {} is not finite",
                                             clip.skeleton.names[i % joints], i / joints));
    error.joint = clip.skeleton.names[i % joints];
    error.frame = static_cast<std::int64_t>(i / joints);
    return error;
  }
  return {};
}

LargestStretch largest_stretch(std::span<const Stretch> stretches, int joints) {
  LargestStretch worst;
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    if (stretches[i] == Stretch()) continue;
    const double size = (stretches[i].matrix() - Mat3::Identity()).colwise().norm().maxCoeff();
    if (!(size > worst.size * (1 + 1e-6))) continue;
    worst = {size, static_cast<int>(i % at(joints)), static_cast<int>(i / at(joints))};
  }
  return worst;
}

Mat4 joint_to_world(const Transform& rigid, const Stretch& stretch) {
  Mat4 result = rigid.matrix();
  if (stretch == Stretch()) return result;
  result.topLeftCorner<3, 3>() = (result.topLeftCorner<3, 3>() * stretch.matrix()).eval();
  return result;
}

Stretches cut(std::span<const Stretch> stretches, int joints, int first, int last, int step) {
  Stretches result;
  if (stretches.empty()) return result;
  for (int frame = first; frame <= last; frame += step) {
    const auto row = stretches.subspan(at(frame) * at(joints), at(joints));
    result.insert(result.end(), row.begin(), row.end());
  }
  return result;
}

void sample(std::span<const Stretch> stretches, double place, std::span<Stretch> joints) {
  const auto last = static_cast<double>(stretches.size() / joints.size() - 1);
  const double clamped = place > 0 ? std::min(place, last) : 0.0;
  const auto before = static_cast<std::size_t>(clamped);
  const std::size_t after = std::min(before + 1, static_cast<std::size_t>(last));
  const double share = clamped - static_cast<double>(before);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const Stretch& a = stretches[before * joints.size() + j];
    const Stretch& b = stretches[after * joints.size() + j];
    joints[j] = share > 0 ? Stretch::of((1 - share) * a.matrix() + share * b.matrix()) : a;
  }
}

}  // namespace krok
