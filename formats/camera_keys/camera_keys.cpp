#include "formats/camera_keys/camera_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/numbers.h"
#include "core/quantity.h"
#include "core/text.h"
#include "formats/json/members.h"
#include "scene/frame_moment.h"

namespace krok::camera_keys {

namespace {

using json::Value;
using Kind = Value::Kind;

constexpr std::string_view kSchema = "krok.camera-keys/1";
constexpr std::size_t kMaxKeys = 100'000;
constexpr double kFurthest = 1e6;       // metres
constexpr double kLatest = 1e6;         // seconds
constexpr double kSensorHeight = 24.0;  // millimetres
constexpr double kNearest = 1e-6;       // metres, min distance of camera and target

class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text), in_(text, "camera-keys") {}

  Result<CameraKeyFile> read() {
    const auto root = json::parse(text_);
    if (!root) return root.error();
    if (Status status = in_.only(*root, kWhole,
                                 {"schema", "comment", "length_unit", "angle_unit", "rate",
                                  "between", "tension", "closed", "keys"});
        !status) {
      return status.error();
    }
    if (Status status = in_.has_schema(*root, kWhole, kSchema); !status) return status.error();
    for (const auto part :
         {&Reader::read_units, &Reader::read_defaults, &Reader::read_keys, &Reader::check_closed}) {
      if (Status status = (this->*part)(*root); !status) return status.error();
    }
    return std::move(file_);
  }

 private:
  static constexpr std::string_view kWhole = "the file";

  Status read_units(const Value& root) {
    const auto length = in_.find(root, kWhole, "length_unit", Kind::string);
    if (!length) return length.error();
    if (*length != nullptr) {
      const std::string& name = (*length)->text;
      const bool letters =
          !name.empty() && std::ranges::all_of(name, [](char c) { return c >= 'a' && c <= 'z'; });
      const auto unit = parse_length("1" + name);
      if (!letters || !unit) {
        return in_.wrong(**length, fmt::format("'{}' is not a length unit", shown(name)),
                         "use m, cm, mm, in or ft");
      }
      metres_ = *unit;
    }
    const auto angle = in_.choice(root, kWhole, "angle_unit", {"deg", "rad"});
    if (!angle) return angle.error();
    if (*angle && **angle == 1) radians_ = 1;
    return {};
  }

  Status read_defaults(const Value& root) {
    if (root.find("rate") != nullptr) {
      const auto rate = in_.number(root, kWhole, "rate", kMinRate, kMaxRate);
      if (!rate) return rate.error();
      rate_ = *rate;
      file_.rate = *rate;
    }
    const auto closed = in_.find(root, kWhole, "closed", Kind::boolean);
    if (!closed) return closed.error();
    file_.camera.closed = *closed != nullptr && (*closed)->truth;
    return read_join(root, kWhole, usual_);
  }

  // Optional "between" and "tension".
  Status read_join(const Value& object, std::string_view what, CameraKey& key) const {
    static constexpr std::array kJoins = {Between::smooth, Between::linear, Between::ease,
                                          Between::step};
    const auto between = in_.choice(object, what, "between", {"smooth", "linear", "ease", "step"});
    if (!between) return between.error();
    if (*between) key.between = kJoins[**between];
    if (object.find("tension") == nullptr) return {};
    const auto tension = in_.number(object, what, "tension", 0, 1);
    if (!tension) return tension.error();
    key.tension = *tension;
    return {};
  }

  Result<Vec3> place(const Value& list, std::string_view what, std::string_view key) const {
    const auto values = in_.numbers(list, what, key, 3);
    if (!values) return values.error();
    const Vec3 place = metres_ * Vec3((*values)[0], (*values)[1], (*values)[2]);
    if (place.cwiseAbs().maxCoeff() <= kFurthest) return place;
    return in_.wrong(list, fmt::format("\"{}\" of {} is farther away than 1000 km", key, what));
  }

  Status read_direction(const Value& item, std::string_view what, CameraKey& key) const {
    const auto target = in_.find(item, what, "target", Kind::array);
    if (!target) return target.error();
    const auto orientation = in_.find(item, what, "orientation", Kind::array);
    if (!orientation) return orientation.error();
    if ((*target == nullptr) == (*orientation == nullptr)) {
      return in_.structure(item,
                           fmt::format("{} needs one of \"target\" and \"orientation\"", what));
    }
    if (*target != nullptr) {
      const auto at = place(**target, what, "target");
      if (!at) return at.error();
      if ((*at - key.position).norm() < kNearest) {
        return in_.wrong(**target,
                         fmt::format("\"target\" of {} is at the camera's position", what),
                         "the camera needs a direction to look in");
      }
      key.target = *at;
      return {};
    }
    const auto values = in_.numbers(**orientation, what, "orientation", 4);
    if (!values) return values.error();
    const Quat turn((*values)[3], (*values)[0], (*values)[1], (*values)[2]);
    // Hand-written quaternions have few digits.
    if (!(std::abs(turn.norm() - 1) < 0.01)) {
      return in_.wrong(**orientation,
                       fmt::format("\"orientation\" of {} has length {}, expected 1", what,
                                   readable(turn.norm())),
                       "it is a unit quaternion: x, y, z, w");
    }
    key.orientation = turn.normalized();
    return {};
  }

  Status read_lens(const Value& item, std::string_view what, CameraKey& key) const {
    const bool by_angle = item.find("field_of_view") != nullptr;
    const bool by_length = item.find("focal_length") != nullptr;
    if (by_angle && by_length) {
      return in_.structure(item,
                           fmt::format("{} has both \"field_of_view\" and \"focal_length\"", what));
    }
    if (by_angle) {
      const double straight = kPi / radians_;
      const auto view = in_.number(item, what, "field_of_view", straight * 1e-4, straight * 0.9999);
      if (!view) return view.error();
      key.field_of_view = *view * radians_;
    } else if (by_length) {
      const auto length = in_.number(item, what, "focal_length", 0.1, 1e5);
      if (!length) return length.error();
      key.field_of_view = 2 * std::atan(kSensorHeight / 2 / *length);
    }
    return {};
  }

  Result<CameraKey> read_key(const Value& item, std::size_t index) const {
    const std::string what = fmt::format("key {}", index);
    if (Status status =
            in_.only(item, what,
                     {"time", "position", "target", "orientation", "roll", "field_of_view",
                      "focal_length", "between", "tension", "comment"});
        !status) {
      return status.error();
    }
    CameraKey key = usual_;
    const auto when = in_.moment(item, what, "time", rate_, kLatest);
    if (!when) return when.error();
    key.time = *when;
    const auto position = in_.get(item, what, "position", Kind::array);
    if (!position) return position.error();
    const auto at = place(**position, what, "position");
    if (!at) return at.error();
    key.position = *at;
    if (Status status = read_direction(item, what, key); !status) return status.error();
    if (item.find("roll") != nullptr) {
      const auto roll = in_.number(item, what, "roll", -1e4, 1e4);
      if (!roll) return roll.error();
      key.roll = *roll * radians_;
    }
    if (Status status = read_lens(item, what, key); !status) return status.error();
    if (Status status = read_join(item, what, key); !status) return status.error();
    return key;
  }

  Status read_keys(const Value& root) {
    const auto list = in_.get(root, kWhole, "keys", Kind::array);
    if (!list) return list.error();
    const std::size_t count = (*list)->items.size();
    if (count == 0 || count > kMaxKeys) {
      return in_.wrong(**list, fmt::format("{} keys, expected 1 to {}", count, kMaxKeys));
    }
    std::vector<CameraKey>& keys = file_.camera.keys;
    for (std::size_t i = 0; i < count; ++i) {
      const Value& item = (*list)->items[i];
      auto key = read_key(item, i);
      if (!key) return key.error();
      if (i > 0 && !(key->time > keys.back().time)) {
        return json::error_at(
            text_, item.find("time")->offset, "camera-keys-time",
            fmt::format("key {} is at {} s, not after the previous key at {} s", i,
                        readable(key->time, 9), readable(keys.back().time, 9)));
      }
      keys.push_back(*key);
    }
    return {};
  }

  Status check_closed(const Value& root) {
    if (!file_.camera.closed) return {};
    const std::vector<CameraKey>& keys = file_.camera.keys;
    const Value& list = *root.find("keys");
    for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
      if (keys[i].between == Between::smooth) continue;
      return in_.wrong(list.items[i], fmt::format("key {} of a closed path is not smooth", i));
    }
    if (keys.size() > 2 && (keys.back().position - keys.front().position).norm() < 1e-3) return {};
    return in_.wrong(list.items.back(),
                     "the path is closed, but its last key is not at the position of the first",
                     "the last key must repeat the first");
  }

  std::string_view text_;
  json::Members in_;
  CameraKeyFile file_;
  CameraKey usual_;
  std::optional<double> rate_;  // if the file has one
  double metres_ = 1, radians_ = kRadiansPerDegree;
};

}  // namespace

Result<CameraKeyFile> read(std::string_view text) {
  return Reader(text).read();
}

}  // namespace krok::camera_keys
