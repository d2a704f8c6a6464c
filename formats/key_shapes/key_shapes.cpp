#include "formats/key_shapes/key_shapes.h"

#include <fmt/format.h>

#include "core/numbers.h"
#include "formats/json/members.h"
#include "scene/frame_moment.h"

namespace krok::key_shapes {

namespace {

using json::Value;
using Kind = Value::Kind;

constexpr std::string_view kSchema = "krok.key-shapes/1";
constexpr std::string_view kWhole = "the file";
constexpr std::size_t kMaxKeys = 100'000;
constexpr double kLatest = 1e6;  // seconds

Status read_join(const Value& root, const json::Members& in, KeyShapeFile& file) {
  const auto between = in.choice(root, kWhole, "between", {"linear", "hermite"});
  if (!between) return between.error();
  if (*between) file.join = **between == 0 ? ShapeJoin::linear : ShapeJoin::hermite;
  if (root.find("tension") == nullptr) return {};
  const auto tension = in.number(root, kWhole, "tension", 0, 1);
  if (!tension) return tension.error();
  file.tension = *tension;
  return {};
}

Status read_key(std::string_view text, const Value& item, const json::Members& in,
                KeyShapeFile& file) {
  const std::string what = fmt::format("key {}", file.times.size());
  if (Status status = in.only(item, what, {"time", "shape", "comment"}); !status) return status;
  const auto time = in.moment(item, what, "time", file.rate, kLatest);
  if (!time) return time.error();
  if (!file.times.empty() && !(*time > file.times.back())) {
    return json::error_at(text, item.find("time")->offset, "key-shapes-time",
                          fmt::format("{} is at {} s, not after the previous key at {} s", what,
                                      readable(*time, 9), readable(file.times.back(), 9)));
  }
  const auto shape = in.get(item, what, "shape", Kind::string);
  if (!shape) return shape.error();
  auto path = in.path(**shape, "\"shape\" of " + what);
  if (!path) return path.error();
  file.times.push_back(*time);
  file.shapes.push_back(*std::move(path));
  return {};
}

}  // namespace

Result<KeyShapeFile> read(std::string_view text) {
  const auto root = json::parse(text);
  if (!root) return root.error();
  const json::Members in(text, "key-shapes");
  if (Status status =
          in.only(*root, kWhole, {"schema", "comment", "rate", "between", "tension", "keys"});
      !status) {
    return status.error();
  }
  if (Status status = in.has_schema(*root, kWhole, kSchema); !status) return status.error();
  KeyShapeFile file;
  if (root->find("rate") != nullptr) {
    const auto rate = in.number(*root, kWhole, "rate", kMinRate, kMaxRate);
    if (!rate) return rate.error();
    file.rate = *rate;
  }
  if (Status status = read_join(*root, in, file); !status) return status.error();
  const auto list = in.get(*root, kWhole, "keys", Kind::array);
  if (!list) return list.error();
  const std::size_t count = (*list)->items.size();
  if (count == 0 || count > kMaxKeys) {
    return in.wrong(**list, fmt::format("{} keys, expected 1 to {}", count, grouped(kMaxKeys)));
  }
  for (const Value& item : (*list)->items) {
    if (Status status = read_key(text, item, in, file); !status) return status.error();
  }
  return file;
}

}  // namespace krok::key_shapes
