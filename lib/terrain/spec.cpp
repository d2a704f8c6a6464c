#include "terrain/spec.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "core/numbers.h"
#include "core/text.h"
#include "terrain/shapes.h"

namespace krok::terrain {

namespace {

const std::vector<std::string> kKinds = {"level", "stairs", "slope", "rough"};

// A value that a kind takes: its name, and what becomes of its text.
struct Key {
  std::string name;
  std::function<Status(std::string_view)> set;
};

Key length_key(std::string name, double& into) {
  return {std::move(name), [&into](std::string_view text) -> Status {
            const auto value = parse_length(text);
            if (!value) return value.error();
            into = *value;
            return {};
          }};
}

// An angle, or a grade: "12%" rises by 12 m over 100 m.
Key angle_key(std::string name, double& into) {
  return {std::move(name), [&into](std::string_view text) -> Status {
            if (const auto grade = parse_finite(text.substr(0, text.size() - 1));
                grade && text.ends_with('%')) {
              into = std::atan(*grade / 100);
              return {};
            }
            const auto value = parse_angle(text);
            if (!value) return value.error();
            into = *value;
            return {};
          }};
}

template <typename Integer>
Key integer_key(std::string name, Integer& into, long long least, long long most) {
  return {std::move(name), [&into, least, most](std::string_view text) -> Status {
            const auto value = parse_integer(text);
            if (!value || *value < least || *value > most) {
              return Error("ground-value", fmt::format("'{}' is not a whole number from {} to {}",
                                                       shown(text), least, most));
            }
            into = static_cast<Integer>(*value);
            return {};
          }};
}

// Reads `values` as name=value pairs. The first may be a value alone, that of the first key, if
// `first_bare`.
Status read_values(std::string_view kind, std::string_view values, std::vector<Key> keys,
                   bool first_bare = false) {
  std::vector<std::string> names, seen;
  for (const Key& key : keys) names.push_back(key.name);
  bool first = true;
  while (!values.empty()) {
    const std::size_t comma = values.find(',');
    const std::string_view pair = trimmed(values.substr(0, comma));
    const bool last = comma == std::string_view::npos;
    values = last ? std::string_view{} : values.substr(comma + 1);
    const std::size_t equals = pair.find('=');
    const bool bare = equals == std::string_view::npos;
    if (pair.empty() || (bare && !(first && first_bare)) || (!last && trimmed(values).empty())) {
      return Error("ground-key", fmt::format("'{}' of {} is not NAME=VALUE", shown(pair), kind),
                   fmt::format("write {}", kSpecForms));
    }
    first = false;
    const std::string name(bare ? keys.front().name : std::string(trimmed(pair.substr(0, equals))));
    const auto key =
        std::find_if(keys.begin(), keys.end(), [&](const Key& one) { return one.name == name; });
    if (key == keys.end()) {
      return Error("ground-key", fmt::format("{} has no '{}'", kind, shown(name)),
                   nearest_hint(name, names));
    }
    if (std::find(seen.begin(), seen.end(), name) != seen.end()) {
      return Error("ground-key", fmt::format("{} is given '{}' twice", kind, name));
    }
    seen.push_back(name);
    if (const Status set = key->set(bare ? pair : trimmed(pair.substr(equals + 1))); !set) {
      Error error = set.error();
      error.code = "ground-value";
      error.message = fmt::format("{} of {}: {}", name, kind, error.message);
      return error;
    }
  }
  return {};
}

std::string_view kind_of(std::string_view spec) {
  return trimmed(spec.substr(0, spec.find(':')));
}

Result<std::unique_ptr<Terrain>> slope_from(std::string_view values) {
  if (trimmed(values).empty()) {
    return Error("ground-key", "slope needs an angle", "write slope:12deg");
  }
  double angle = 0, begin = 1;
  const Status read =
      read_values("slope", values, {angle_key("angle", angle), length_key("begin", begin)}, true);
  if (!read) return read.error();
  return slope(angle, begin);
}

Result<std::unique_ptr<Terrain>> stairs_from(std::string_view values) {
  StairsOptions options;
  const Status read = read_values(
      "stairs", values,
      {length_key("rise", options.rise), length_key("run", options.run),
       integer_key("count", options.count, 1, 100000), length_key("begin", options.begin)});
  if (!read) return read.error();
  return stairs(options);
}

}  // namespace

bool is_spec(std::string_view text) {
  return std::find(kKinds.begin(), kKinds.end(), kind_of(text)) != kKinds.end();
}

Result<std::unique_ptr<Terrain>> from_spec(std::string_view spec) {
  const std::string_view kind = kind_of(spec);
  const std::size_t colon = spec.find(':');
  const std::string_view values =
      colon == std::string_view::npos ? std::string_view{} : spec.substr(colon + 1);
  if (kind == "slope") return slope_from(values);
  if (kind == "stairs") return stairs_from(values);
  if (kind == "level") {
    double height = 0;
    const Status read = read_values(kind, values, {length_key("height", height)});
    if (!read) return read.error();
    return level(height);
  }
  if (kind == "rough") {
    RoughOptions options;
    const Status read = read_values(kind, values,
                                    {integer_key("seed", options.seed, 0, 1'000'000'000),
                                     length_key("height", options.height)});
    if (!read) return read.error();
    return rough(options);
  }
  return Error("ground-kind", fmt::format("'{}' is no kind of ground", shown(kind)),
               nearest_hint(kind, kKinds));
}

}  // namespace krok::terrain
