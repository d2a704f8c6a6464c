#include <algorithm>

#include "core/numbers.h"
#include "formats/json/fields.h"
#include "formats/weights/weights_internal.h"

// Weights as keys (JSON).

namespace krok::weights {

namespace {

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

}  // namespace

Result<WeightFile> read_keys(std::string_view text, std::span<const std::string> targets) {
  File file{targets};
  auto weights = file.table().read_text(text, "weights");
  if (!weights) return weights;
  weights->rate = file.rate;
  weights->curves.names.assign(targets.begin(), targets.end());
  weights->curves.curves = std::move(file.curves);
  return weights;
}

std::string schema() {
  return File{{}}.table().schema();
}

}  // namespace krok::weights
