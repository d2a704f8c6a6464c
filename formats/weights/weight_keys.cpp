#include <algorithm>
#include <array>
#include <cmath>

#include "core/numbers.h"
#include "formats/json/members.h"
#include "formats/weights/weights_internal.h"
#include "scene/frame_moment.h"

// Reader for weights as keys (JSON).

namespace krok::weights {

namespace {

using json::Value;
using Kind = Value::Kind;

constexpr std::string_view kSchema = "krok.weights/1";
constexpr std::size_t kMaxKeys = 1'000'000;  // of all curves

struct Join {
  WeightJoin join = WeightJoin::linear;
  double tension = 0;
};

class Reader {
 public:
  Reader(std::string_view text, std::span<const std::string> targets)
      : text_(text), in_(text, "weights"), targets_(targets) {}

  Result<WeightFile> read() {
    const auto root = json::parse(text_);
    if (!root) return root.error();
    if (Status status =
            in_.only(*root, kWhole, {"schema", "comment", "rate", "between", "tension", "curves"});
        !status) {
      return status.error();
    }
    if (Status status = in_.has_schema(*root, kWhole, kSchema); !status) return status.error();
    if (root->find("rate") != nullptr) {
      const auto rate = in_.number(*root, kWhole, "rate", kMinRate, kMaxRate);
      if (!rate) return rate.error();
      file_.rate = *rate;
    }
    if (Status status = read_join(*root, kWhole, usual_); !status) return status.error();
    if (Status status = read_curves(*root); !status) return status.error();
    return std::move(file_);
  }

 private:
  static constexpr std::string_view kWhole = "the file";

  // Optional "between" and "tension".
  Status read_join(const Value& object, std::string_view what, Join& join) const {
    static constexpr std::array kJoins = {WeightJoin::linear, WeightJoin::smooth,
                                          WeightJoin::monotone};
    const auto between = in_.choice(object, what, "between", {"linear", "smooth", "monotone"});
    if (!between) return between.error();
    if (*between) join.join = kJoins[**between];
    if (object.find("tension") == nullptr) return {};
    const auto tension = in_.number(object, what, "tension", 0, 1);
    if (!tension) return tension.error();
    join.tension = *tension;
    return {};
  }

  Status read_curves(const Value& root) {
    const auto list = in_.get(root, kWhole, "curves", Kind::array);
    if (!list) return list.error();
    file_.curves.names.assign(targets_.begin(), targets_.end());
    file_.curves.curves.resize(targets_.size());
    for (std::size_t i = 0; i < (*list)->items.size(); ++i) {
      if (Status status = read_curve((*list)->items[i], fmt::format("curve {}", i)); !status) {
        return status;
      }
    }
    return {};
  }

  Status read_curve(const Value& item, const std::string& what) {
    if (Status status = in_.only(item, what, {"target", "between", "tension", "keys", "comment"});
        !status) {
      return status;
    }
    const auto name = in_.get(item, what, "target", Kind::string);
    if (!name) return name.error();
    const auto target = std::ranges::find(targets_, (*name)->text);
    if (target == targets_.end()) {
      Error unknown = unknown_target((*name)->text, targets_);
      return json::error_at(text_, (*name)->offset, unknown.code, unknown.message, unknown.hint);
    }
    MorphCurve& curve = file_.curves.curves[static_cast<std::size_t>(target - targets_.begin())];
    if (!curve.times.empty()) {
      return json::error_at(text_, (*name)->offset, "weights-structure",
                            fmt::format("duplicate curve of the target '{}'", shown(*target)));
    }
    Join join = usual_;
    if (Status status = read_join(item, what, join); !status) return status;
    if (Status status = read_keys(item, what, curve); !status) return status;
    join_keys(curve, join.join, join.tension);
    return {};
  }

  Status read_keys(const Value& item, const std::string& what, MorphCurve& curve) {
    const auto list = in_.get(item, what, "keys", Kind::array);
    if (!list) return list.error();
    const std::size_t count = (*list)->items.size();
    keys_ += count;
    if (count == 0 || keys_ > kMaxKeys) {
      return in_.wrong(
          **list, fmt::format("{} has {}, expected 1 to {} in all", what,
                              counted(static_cast<long long>(count), "key"), grouped(kMaxKeys)));
    }
    for (std::size_t i = 0; i < count; ++i) {
      const Value& pair = (*list)->items[i];
      const std::string name = fmt::format("key {} of {}", i, what);
      if (pair.kind != Kind::array || pair.items.size() != 2) {
        return json::error_at(text_, pair.offset, "weights-structure",
                              fmt::format("{} must be [time, weight]", name));
      }
      const auto time = in_.moment(pair.items[0], "the time of " + name, file_.rate, kLatest);
      if (!time) return time.error();
      const auto weight =
          in_.within(pair.items[1], "the weight of " + name, -kLargestWeight, kLargestWeight);
      if (!weight) return weight.error();
      if (i > 0 && !(*time > curve.times.back())) {
        return json::error_at(text_, pair.items[0].offset, "weights-time",
                              fmt::format("{} is at {} s, not after the previous key at {} s", name,
                                          readable(*time, 9), readable(curve.times.back(), 9)));
      }
      curve.times.push_back(*time);
      curve.weights.push_back(*weight);
    }
    return {};
  }

  std::string_view text_;
  json::Members in_;
  std::span<const std::string> targets_;
  WeightFile file_;
  Join usual_;
  std::size_t keys_ = 0;
};

}  // namespace

Result<WeightFile> read_keys(std::string_view text, std::span<const std::string> targets) {
  return Reader(text, targets).read();
}

}  // namespace krok::weights
