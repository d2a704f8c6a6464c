#include "formats/camera_keys/camera_keys.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "formats/json/fields.h"

namespace krok::camera_keys {

namespace {

using json::Given;

constexpr double kSensorHeight = 24.0;  // millimetres
constexpr double kNearest = 1e-6;       // metres, min distance of camera and target

// Metres of a unit by its name.
json::Kind<double> length_unit() {
  return json::kind<double>(
      R"({"enum": ["m", "dm", "cm", "mm", "um", "in", "ft"]})",
      [](const Given& given, double& to) -> Status {
        if (Status status = given.is(json::Value::Kind::string); !status) return status;
        const std::string& name = given.value.text;
        const bool letters =
            !name.empty() && std::ranges::all_of(name, [](char c) { return c >= 'a' && c <= 'z'; });
        const auto unit = parse_length("1" + name);
        if (!letters || !unit) {
          return given.wrong(fmt::format("'{}' is not a length unit", shown(name)),
                             "use m, cm, mm, in or ft");
        }
        to = *unit;
        return {};
      });
}

struct File {
  CameraKey usual = {};
  std::optional<double> rate = {};  // if the file has one
  double metres = 1, radians = kRadiansPerDegree;

  // In the file's unit of angles.
  json::Kind<double> angle(double min, double max) const {
    return json::kind<double>(R"({"type": "number"})", [=, this](const Given& given, double& to) {
      Status status = json::number(min / radians, max / radians).read(given, &to);
      to *= radians;
      return status;
    });
  }

  static json::Kind<double> focal_length() {
    return json::kind<double>(R"({"type": "number", "minimum": 0.1, "maximum": 1e5})",
                              [](const Given& given, double& to) {
                                Status status = json::number(0.1, 1e5).read(given, &to);
                                to = 2 * std::atan(kSensorHeight / 2 / to);
                                return status;
                              });
  }

  static Status one_direction(const Given& key, CameraKey&) {
    if (key.has("target") != key.has("orientation")) return {};
    return key.structure(fmt::format("{} needs one of \"target\" and \"orientation\"", key.what));
  }

  static Status look_away(const Given& key, CameraKey& to) {
    if (!to.target || (*to.target - to.position).norm() >= kNearest) return {};
    return key.member("target").wrong(
        fmt::format("\"target\" of {} is at the camera's position", key.what),
        "the camera needs a direction to look in");
  }

  static Status one_lens(const Given& key, CameraKey&) {
    if (!key.has("field_of_view") || !key.has("focal_length")) return {};
    return key.structure(
        fmt::format("{} has both \"field_of_view\" and \"focal_length\"", key.what));
  }

  static json::Kind<Between> between() {
    return json::choice<Between>({{"smooth", Between::smooth},
                                  {"linear", Between::linear},
                                  {"ease", Between::ease},
                                  {"step", Between::step}});
  }

  json::Object<CameraKey> key_table() {
    json::Object<CameraKey> key;
    key.check([this](const Given&, CameraKey& to) { return to = usual, Status(); });
    key.field("time", &CameraKey::time, json::moment(rate, 1e6)).required();
    key.field("position", &CameraKey::position, json::place(metres), "x, y, z").required();
    key.check(one_direction);
    key.field("target", &CameraKey::target, json::place(metres), "x, y, z").check(look_away);
    key.field("orientation", &CameraKey::orientation, json::rotation(0.01, 0), "x, y, z, w");
    key.field("roll", &CameraKey::roll, roll());
    key.check(one_lens);
    key.field("field_of_view", &CameraKey::field_of_view, angle(kPi * 1e-4, kPi * 0.9999));
    key.field("focal_length", &CameraKey::field_of_view, focal_length(), "millimetres");
    key.field("between", &CameraKey::between, between(), "to the next key");
    key.field("tension", &CameraKey::tension, json::number(0, 1)).comment();
    return key.also(json::schema_of_one("target", "orientation"));
  }

  json::Kind<double> roll() const {
    return json::kind<double>(R"({"type": "number", "minimum": -1e4, "maximum": 1e4})",
                              [this](const Given& given, double& to) {
                                Status status = json::number(-1e4, 1e4).read(given, &to);
                                to *= radians;
                                return status;
                              });
  }

  static Status check_closed(const Given& file, CameraKeyFile& to) {
    const std::vector<CameraKey>& keys = to.camera.keys;
    if (!to.camera.closed) return {};
    const json::Value& list = *file.value.find("keys");
    for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
      if (keys[i].between == Between::smooth) continue;
      return Given{file.source, list.items[i], {}, {}}.wrong(
          fmt::format("key {} of a closed path is not smooth", i));
    }
    if (keys.size() > 2 && (keys.back().position - keys.front().position).norm() < 1e-3) return {};
    return Given{file.source, list.items.back(), {}, {}}.wrong(
        "the path is closed, but its last key is not at the position of the first",
        "the last key must repeat the first");
  }

  json::Object<CameraKeyFile> table() {
    const auto in_camera = [](auto member) {
      return [member](CameraKeyFile & of) -> auto& {
        return of.camera.*member;
      };
    };
    json::Object<CameraKeyFile> file;
    file.file("krok.camera-keys/1", "Keys of a camera (krok.camera-keys/1)").comment();
    file.context("length_unit", metres, length_unit());
    file.context("angle_unit", radians,
                 json::choice<double>({{"deg", kRadiansPerDegree}, {"rad", 1}}));
    file.context("rate", rate, json::frame_rate(), "frames per second");
    file.context("between", usual.between, between());
    file.context("tension", usual.tension, json::number(0, 1));
    file.field("closed", in_camera(&KeyedCamera::closed), json::boolean());
    file.field("keys", in_camera(&KeyedCamera::keys),
               json::list<CameraKey>(json::object(key_table()), {"key {0}", 1, 100'000},
                                     json::times_increase<CameraKey>))
        .required();
    file.check(check_closed);
    file.check([this](const Given&, CameraKeyFile& to) {
      to.rate = rate.value_or(to.rate);
      return Status();
    });
    return file;
  }
};

}  // namespace

Result<CameraKeyFile> read(std::string_view text) {
  return File().table().read_text(text, "camera-keys");
}

std::string schema() {
  return File().table().schema();
}

}  // namespace krok::camera_keys
