#include <fmt/format.h>

#include <cmath>

#include "core/index.h"
#include "core/numbers.h"
#include "formats/ragdoll/values_internal.h"

namespace krok::ragdoll_file {

namespace {

using json::Value;

// Numbers written by hand have few digits.
constexpr double kHandWritten = 0.01;

Result<std::vector<double>> numbers(const json::Members& in, const Value& list,
                                    std::string_view what, std::string_view key,
                                    std::size_t count) {
  std::vector<double> found;
  for (const Value& item : list.items) {
    if (item.kind == Value::Kind::number && std::isfinite(item.number)) {
      found.push_back(item.number);
    }
  }
  if (found.size() == count && list.items.size() == count) return found;
  return in.wrong(list, fmt::format("\"{}\" of {} must be {} numbers", key, what, count));
}

}  // namespace

Status Values::vector(const Value& object, const std::string& what, std::string_view key,
                      bool needed, Vec3& vector) const {
  const auto list = needed ? in_.get(object, what, key, Value::Kind::array)
                           : in_.find(object, what, key, Value::Kind::array);
  if (!list) return list.error();
  if (*list == nullptr) return {};
  const auto values = numbers(in_, **list, what, key, 3);
  if (!values) return values.error();
  vector = Vec3((*values)[0], (*values)[1], (*values)[2]);
  return {};
}

Status Values::rotation(const Value& object, const std::string& what, std::string_view key,
                        Quat& rotation) const {
  const auto list = in_.find(object, what, key, Value::Kind::array);
  if (!list) return list.error();
  if (*list == nullptr) return {};
  const auto values = numbers(in_, **list, what, key, 4);
  if (!values) return values.error();
  const Quat given((*values)[3], (*values)[0], (*values)[1], (*values)[2]);
  if (!(std::abs(given.norm() - 1) < kHandWritten)) {
    return in_.wrong(
        **list,
        fmt::format("\"{}\" of {} has length {}, expected 1", key, what, readable(given.norm())),
        "it is a unit quaternion: x, y, z, w");
  }
  // What is of length 1 stays bit for bit.
  rotation = std::abs(given.norm() - 1) < 1e-14 ? given : given.normalized();
  return {};
}

Status Values::direction(const Value& object, const std::string& what, std::string_view key,
                         Vec3& direction) const {
  Vec3 given = Vec3::Zero();
  if (Status status = vector(object, what, key, true, given); !status) return status;
  const double length = given.norm();
  if (!(std::abs(length - 1) < kHandWritten)) {
    return in_.wrong(*object.find(key), fmt::format("\"{}\" of {} has length {}, expected 1", key,
                                                    what, readable(length)));
  }
  direction = std::abs(length - 1) < 1e-14 ? given : Vec3(given / length);
  return {};
}

Result<ragdoll::Range> Values::range(const Value& list, const std::string& what,
                                     std::string_view key, double unit, double lowest,
                                     double highest) const {
  ragdoll::Range range;
  bool good = list.kind == Value::Kind::array && list.items.size() == 2;
  for (std::size_t i = 0; good && i < 2; ++i) {
    const Value& item = list.items[i];
    if (item.kind == Value::Kind::null) continue;
    good = item.kind == Value::Kind::number && std::isfinite(item.number);
    (i == 0 ? range.min : range.max) = item.number * unit;
  }
  if (!good) {
    return in_.wrong(list, fmt::format("\"{}\" of {} must be a min and a max", key, what),
                     "write [-30, 45], or null for an end that does not limit");
  }
  if (range.min > range.max) {
    return in_.wrong(list, fmt::format("\"{}\" of {} has its min {} above its max {}", key, what,
                                       readable(range.min / unit), readable(range.max / unit)));
  }
  const auto outside = [&](double end) {
    return std::isfinite(end) && (end < lowest - 1e-9 || end > highest + 1e-9);
  };
  if (outside(range.min) || outside(range.max)) {
    return in_.wrong(list, fmt::format("\"{}\" of {} exceeds {} to {}", key, what,
                                       readable(lowest / unit), readable(highest / unit)));
  }
  return range;
}

}  // namespace krok::ragdoll_file
