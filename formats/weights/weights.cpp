#include "formats/weights/weights.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/csv/table.h"
#include "formats/json/fields.h"

namespace krok::weights {

namespace {

constexpr double kUsualRate = 30;
constexpr double kMinTableRate = 10;    // frames per second
constexpr double kLatest = 1e6;         // seconds
constexpr double kLargestWeight = 1e6;  // of either sign

// An error for an unknown target, without a location.
Error unknown_target(std::string_view name, std::span<const std::string> targets) {
  const std::string nearest = nearest_name(name, targets);
  if (targets.empty()) {
    return Error("weights-target",
                 fmt::format("there is no target '{}': the mesh has none", shown(name)),
                 "weights move morph targets, which a character, glTF or an .exr may have");
  }
  constexpr std::size_t kNamed = 5;
  const std::size_t count = std::min(targets.size(), kNamed);
  return Error("weights-target", fmt::format("there is no target '{}'", shown(name)),
               nearest.empty()
                   ? fmt::format("targets are {}{}", fmt::join(targets.first(count), ", "),
                                 count < targets.size() ? ", ..." : "")
                   : fmt::format("did you mean '{}'?", shown(nearest)));
}

// As keys (JSON).

using json::Given;

constexpr std::size_t kMaxKeys = 1'000'000;  // of all curves

struct Curve {
  std::size_t target = 0;
  WeightJoin join = WeightJoin::linear;
  double tension = 0;
  MorphCurve keys;
};

struct File {
  std::span<const std::string> targets;
  std::optional<double> rate = {};
  Curve usual = {};
  std::vector<MorphCurve> curves = {};
  std::size_t key_count = 0;

  Status read_target(const Given& given, std::size_t& to) const {
    if (Status status = given.is(json::Value::Kind::string); !status) return status;
    const auto target = std::ranges::find(targets, given.value.text);
    to = static_cast<std::size_t>(target - targets.begin());
    if (target == targets.end()) {
      const Error unknown = unknown_target(given.value.text, targets);
      return given.error("target", unknown.message, unknown.hint);
    }
    if (curves[to].times.empty()) return {};
    return given.structure(fmt::format("duplicate curve of the target '{}'", shown(*target)));
  }

  Status read_keys(const Given& given, MorphCurve& curve) {
    if (Status status = given.is(json::Value::Kind::array); !status) return status;
    const auto& items = given.value.items;
    key_count += items.size();
    if (items.empty() || key_count > kMaxKeys) {
      return given.wrong(fmt::format("{} has {}, expected 1 to {} in all", given.what,
                                     counted(static_cast<long long>(items.size()), "key"),
                                     grouped(kMaxKeys)));
    }
    for (std::size_t i = 0; i < items.size(); ++i) {
      const std::string name = fmt::format("key {} of {}", i, given.what);
      if (items[i].kind != json::Value::Kind::array || items[i].items.size() != 2) {
        return Given{given.source, items[i], {}, {}}.structure(
            fmt::format("{} must be [time, weight]", name));
      }
      const std::string time_name = "the time of " + name, weight_name = "the weight of " + name;
      const Given time{given.source, items[i].items[0], {}, time_name};
      double& at = curve.times.emplace_back();
      Status status = json::moment(rate, kLatest).read(time, &at);
      if (status) {
        status = json::number(-kLargestWeight, kLargestWeight)
                     .read({given.source, items[i].items[1], {}, weight_name},
                           &curve.weights.emplace_back());
      }
      if (!status) return status;
      if (i > 0 && !(at > curve.times[i - 1])) {
        return time.error("time",
                          fmt::format("{} is at {} s, not after the previous key at {} s", name,
                                      readable(at, 9), readable(curve.times[i - 1], 9)));
      }
    }
    return {};
  }

  template <typename T, typename Access>
  void add_join(json::Object<T>& table, const Access& of) const {
    table.field(
        "between", [of](T& to) -> WeightJoin& { return of(to).join; },
        json::choice<WeightJoin>({{"linear", WeightJoin::linear},
                                  {"smooth", WeightJoin::smooth},
                                  {"monotone", WeightJoin::monotone}}));
    table.field(
        "tension", [of](T& to) -> double& { return of(to).tension; }, json::number(0, 1));
  }

  json::Object<WeightFile> table() {
    json::Object<Curve> curve;
    curve.check([this](const Given&, Curve& to) { return to = usual, Status(); });
    curve
        .field("target", &Curve::target,
               json::kind<std::size_t>(
                   R"({"type": "string"})",
                   [this](const Given& given, std::size_t& to) { return read_target(given, to); }))
        .required();
    add_join(curve, [](Curve& of) -> Curve& { return of; });
    curve
        .field(
            "keys", &Curve::keys,
            json::kind<MorphCurve>(
                R"({"description": "[time, weight]", "type": "array", "minItems": 1, "items": {"type": "array", "minItems": 2, "maxItems": 2, "prefixItems": [{"type": ["number", "string"]}, {"type": "number"}]}})",
                [this](const Given& given, MorphCurve& to) { return read_keys(given, to); }))
        .required()
        .comment();
    json::Object<WeightFile> file;
    file.file("krok.weights/1", "Weights of morph targets (krok.weights/1)").comment();
    file.context("rate", rate, json::frame_rate(), "frames per second");
    add_join(file, [this](WeightFile&) -> Curve& { return usual; });
    file.field("curves",
               json::kind<WeightFile>(
                   json::schema_of_list(json::object(curve).schema(), 0, SIZE_MAX),
                   [this, list = json::list<Curve>(json::object(curve), {"curve {0}"},
                                                   [this](const Given&, std::vector<Curve>& read) {
                                                     Curve& last = read.back();
                                                     join_keys(last.keys, last.join, last.tension);
                                                     curves[last.target] = std::move(last.keys);
                                                     return Status();
                                                   })](const Given& given, WeightFile&) {
                     curves.resize(targets.size());
                     std::vector<Curve> read;
                     return list.read(given, &read);
                   }))
        .required();
    return file;
  }
};

Result<WeightFile> read_keys(std::string_view text, std::span<const std::string> targets) {
  File file{targets};
  auto weights = file.table().read_text(text, "weights");
  if (!weights) return weights;
  weights->rate = file.rate;
  weights->curves.names.assign(targets.begin(), targets.end());
  weights->curves.curves = std::move(file.curves);
  return weights;
}

// As a table: one row per time, one column per target.

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

Error at(Error error, const Location& place) {
  error.where = place;
  return error;
}

// The meaning of the columns of a table.
struct Columns {
  std::size_t time = kNone;  // in seconds or milliseconds, or
  std::size_t frame = kNone;
  std::vector<std::size_t> weights;  // columns, and ...
  std::vector<std::size_t> targets;  // ... their targets
};

Result<Columns> find_columns(const csv::Table& table, std::span<const std::string> targets) {
  Columns columns;
  const auto& names = table.columns();
  for (std::size_t c = 0; c < names.size(); ++c) {
    const bool seconds = names[c].unit.empty() || names[c].unit == "s" || names[c].unit == "ms";
    if (columns.frame == kNone && names[c].header == "frame") {
      columns.frame = c;
    } else if (columns.time == kNone && names[c].label == "time" && seconds) {
      columns.time = c;
    } else {
      const auto target = std::ranges::find(targets, names[c].header);
      if (target == targets.end() && columns.time == kNone &&
          same_word(names[c].label, "timecode")) {
        return at(Error("weights-structure", "there is no column 'time'",
                        "write times in seconds in place of Timecode, and leave out "
                        "BlendShapeCount"),
                  table.header_location(c));
      }
      if (target == targets.end()) {
        return at(unknown_target(names[c].header, targets), table.header_location(c));
      }
      const auto index = static_cast<std::size_t>(target - targets.begin());
      if (std::ranges::find(columns.targets, index) != columns.targets.end()) {
        return at(Error("weights-structure",
                        fmt::format("duplicate column '{}'", shown(names[c].header))),
                  table.header_location(c));
      }
      columns.weights.push_back(c);
      columns.targets.push_back(index);
    }
  }
  if (columns.time == kNone) {
    return at(Error("weights-structure", "there is no column 'time'",
                    "it has times in seconds; krok-import --morph-weights writes such tables"),
              table.header_location(0));
  }
  return columns;
}

Status check_times(const csv::Table& table, std::size_t column, const std::vector<double>& times) {
  for (std::size_t row = 0; row < times.size(); ++row) {
    if (!(times[row] >= 0 && times[row] <= kLatest)) {
      return at(Error("weights-value", fmt::format("the time is {}, expected 0 to {} s",
                                                   std::isnan(times[row]) ? std::string("missing")
                                                                          : readable(times[row]),
                                                   readable(kLatest))),
                table.place(row, column));
    }
    if (row > 0 && !(times[row] > times[row - 1])) {
      return at(
          Error("weights-time", fmt::format("{} s is not after the previous row at {} s",
                                            readable(times[row], 9), readable(times[row - 1], 9))),
          table.place(row, column));
    }
  }
  return {};
}

// The rate if times are i / rate within float precision. Fewer rows a second are keys.
std::optional<double> rate_of(const std::vector<double>& times) {
  if (times.size() < 2 || times[0] != 0) return std::nullopt;
  double rate = static_cast<double>(times.size() - 1) / times.back();
  const double whole = std::round(rate);
  if (whole >= 1 && std::abs(rate - whole) < 1e-6 * whole) rate = whole;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!(std::abs(times[i] * rate - static_cast<double>(i)) < 1e-3)) return std::nullopt;
  }
  return rate >= kMinTableRate && rate <= 1e6 ? std::optional(rate) : std::nullopt;
}

Result<WeightFile> read_table(std::string_view text, const std::string& path,
                              std::span<const std::string> targets) {
  const auto table = csv::Table::read(text, path);
  if (!table) return table.error();
  const auto columns = find_columns(*table, targets);
  if (!columns) return columns.error();
  std::vector<std::size_t> wanted = columns->weights;
  wanted.push_back(columns->time);
  const auto numbers = table->numbers(wanted);
  if (!numbers) return numbers.error();
  std::vector<double> times = numbers->back();
  const bool milliseconds = table->columns()[columns->time].unit == "ms";
  for (double& time : times) time /= milliseconds ? 1000 : 1;
  if (Status status = check_times(*table, columns->time, times); !status) return status.error();

  WeightFile file;
  file.rate = rate_of(times);
  file.curves.names.assign(targets.begin(), targets.end());
  file.curves.curves.resize(targets.size());
  for (std::size_t i = 0; i < columns->targets.size(); ++i) {
    MorphCurve& curve = file.curves.curves[columns->targets[i]];
    const std::vector<double>& values = (*numbers)[i];
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (std::isnan(values[row])) continue;  // a gap: no key here
      if (!(std::abs(values[row]) <= kLargestWeight)) {
        return at(Error("weights-value",
                        fmt::format("the weight {} is out of range", readable(values[row]))),
                  table->place(row, columns->weights[i]));
      }
      curve.times.push_back(times[row]);
      curve.weights.push_back(values[row]);
    }
  }
  return file;
}

}  // namespace

Result<WeightFile> read(std::string_view text, const std::string& path,
                        std::span<const std::string> targets) {
  const std::string_view begin = trimmed(without_byte_order_mark(text));
  const bool is_json = begin.starts_with('{') || begin.starts_with('[');
  if (!is_json) return read_table(text, path, targets);
  auto file = read_keys(text, targets);
  if (!file) return std::move(file).error().in_file(path);
  return file;
}

std::optional<Diagnostic> implausible_weight(const MorphCurves& curves) {
  constexpr double kMaxPlausible = 10;
  for (std::size_t t = 0; t < curves.curves.size(); ++t) {
    for (const double weight : curves.curves[t].weights) {
      if (std::abs(weight) <= kMaxPlausible) continue;
      return make_warning("morph-weights",
                          fmt::format("the weight of {} is {}, where 1 is the whole target",
                                      curves.names[t], readable(weight)),
                          "divide per cent by 100");
    }
  }
  return std::nullopt;
}

Result<MorphWeights> read_weights(std::string_view text, const std::string& path,
                                  const MorphSet& morphs, std::optional<double> rate) {
  const auto file = read(text, path, morphs.names);
  if (!file) return file.error();
  return sampled(*file, path, rate);
}

Result<MorphWeights> sampled(const WeightFile& file, const std::string& path,
                             std::optional<double> rate) {
  const double chosen = rate.value_or(file.rate.value_or(kUsualRate));
  const auto frames = frames_of(file.curves, chosen);
  if (!frames) return Error(frames.error()).in_file(path);
  auto weights = sample(file.curves, chosen, *frames);
  if (!weights) return std::move(weights).error().in_file(path);
  return weights;
}

std::string schema() {
  return File{{}}.table().schema();
}

}  // namespace krok::weights
