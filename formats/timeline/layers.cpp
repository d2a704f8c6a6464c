#include <fmt/format.h>

#include "core/numbers.h"
#include "formats/timeline/items_internal.h"

namespace krok::timeline_file {

namespace {

using json::Value;
using timeline::Fade;
using timeline::Layer;
using timeline::LayerItem;
using timeline::LayerMode;
using timeline::MaskRule;
using timeline::Space;
using Kind = Value::Kind;

constexpr std::size_t kMaxPoints = 10'000;

}  // namespace

// A duration, or an object.
Result<Fade> Items::fade(const Field& field) const {
  Fade fade;
  const auto seconds = [&](const Field& inner) { return fields_.duration(inner, rate_); };
  if (field.value->kind != Kind::object) {
    const auto lasts = seconds(field);
    if (!lasts) return lasts.error();
    fade.duration = *lasts;
    return fade;
  }
  if (Status status = fields_.only(*field.value, field.key, {"duration", "easing"}); !status) {
    return status.error();
  }
  Taker take(*field.value, field.key);
  take("duration", fade.duration, seconds);
  take("easing", fade.easing, [&](const Field& inner) { return easing(inner); });
  if (Status status = take.done(); !status) return status.error();
  return fade;
}

// A number, or a list of [time, weight].
Result<blend::WeightCurve> Items::weight(const Field& field) const {
  if (field.value->kind != Kind::array) {
    const auto constant = fields_.number(field);
    if (!constant) return constant.error();
    return blend::WeightCurve::constant(*constant);
  }
  blend::WeightCurve curve;
  if (field.value->items.empty() || field.value->items.size() > kMaxPoints) {
    return fields_.members().wrong(
        *field.value, fmt::format("a weight needs 1 to {} points", grouped(kMaxPoints)));
  }
  for (const Value& point : field.value->items) {
    if (point.kind != Kind::array || point.items.size() != 2) {
      return fields_.members().wrong(point, "a point of a weight must be [time, weight]");
    }
    const Field at{&point.items[0], "time", "a weight"};
    const auto time = fields_.duration(at, rate_);
    if (!time) return time.error();
    const auto value = fields_.number({&point.items[1], "value", "a weight"});
    if (!value) return value.error();
    if (!curve.generic.empty() && *time <= curve.generic.back()) {
      return fields_.wrong(at, "a time after the previous one");
    }
    curve.generic.push_back(*time);
    curve.weights.push_back(*value);
  }
  return curve;
}

Result<LayerItem> Items::layer_item(const Value& value) const {
  constexpr std::string_view kItem = "an item of a layer";
  if (Status status =
          fields_.only(value, kItem,
                       {"name", "source", "sequence", "from", "to", "speed", "loop", "until", "at",
                        "fade_in", "fade_out", "weight", "marks", "comment"});
      !status) {
    return status.error();
  }
  LayerItem item;
  item.where = place_of(value);
  if (Status status = read_play(value, kItem, item.name, item.play, item.marks); !status) {
    return status.error();
  }
  const auto fading = [&](const Field& field) { return fade(field); };
  Taker take(value, kItem);
  take("at", item.at, [&](const Field& field) { return fields_.time(field); });
  take("fade_in", item.fade_in, fading)("fade_out", item.fade_out, fading);
  take("weight", item.weight, [&](const Field& field) { return weight(field); });
  if (Status status = take.done(); !status) return status.error();
  return item;
}

Result<MaskRule> Items::rule(const Value& value) const {
  constexpr std::string_view kRule = "a rule of a mask";
  if (Status status = fields_.only(value, kRule, {"joints", "below", "weight", "soft"}); !status) {
    return status.error();
  }
  MaskRule rule;
  rule.where = place_of(value);
  const bool by_name = value.find("joints") != nullptr;
  if (by_name == (value.find("below") != nullptr)) {
    return fields_.members().wrong(value, "a rule of a mask needs either \"joints\" or \"below\"");
  }
  const auto name = [&](const Field& field) { return fields_.name(field); };
  Taker take(value, kRule);
  take("joints", rule.joints, name)("below", rule.below, name);
  take("weight", rule.weight, [&](const Field& field) -> Result<double> {
    auto weight = fields_.number(field);
    if (weight && !(*weight >= 0 && *weight <= 1)) return fields_.wrong(field, "0 to 1");
    return weight;
  });
  take("soft", rule.soft, [&](const Field& field) -> Result<int> {
    if (!by_name) return fields_.whole(field, 0, 1000);
    return fields_.members().wrong(*field.value, "\"soft\" needs \"below\"");
  });
  if (Status status = take.done(); !status) return status.error();
  return rule;
}

Result<Layer> Items::layer(const Value& value, std::size_t number) const {
  constexpr std::string_view kLayer = "a layer";
  if (Status status = fields_.only(
          value, kLayer, {"name", "mode", "space", "mask", "reference", "items", "comment"});
      !status) {
    return status.error();
  }
  Layer layer;
  layer.where = place_of(value);
  layer.name = fmt::format("layer {}", number);
  Taker take(value, kLayer);
  take("name", layer.name, [&](const Field& field) { return fields_.name(field); });
  take("mode", layer.mode, [&](const Field& field) {
    return fields_.choice<LayerMode>(field, {{"override", LayerMode::override},
                                             {"additive", LayerMode::additive},
                                             {"modifier", LayerMode::modifier}});
  });
  take("space", layer.space, [&](const Field& field) -> Result<Space> {
    if (layer.mode != LayerMode::override) {
      return fields_.members().wrong(*field.value, "only override layers have a \"space\"");
    }
    return fields_.choice<Space>(field, {{"parent", Space::parent}, {"model", Space::model}});
  });
  take.check("reference", [&](const Field& field) -> Status {
    if (layer.mode == LayerMode::override) {
      return fields_.members().wrong(*field.value,
                                     "only additive and modifier layers have a \"reference\"");
    }
    layer.reference_pose = field.value->kind == Kind::string && field.value->text == "pose";
    if (layer.reference_pose) return {};
    const auto time = fields_.time(field);
    if (!time) return time.error();
    layer.reference = *time;
    return {};
  });
  if (Status status = take.done(); !status) return status.error();
  Status status = fields_.each(value, kLayer, "mask", [&](const Value& entry) -> Status {
    auto made = rule(entry);
    if (!made) return made.error();
    layer.mask.push_back(std::move(*made));
    return {};
  });
  if (!status) return status.error();
  const auto list = fields_.members().get(value, kLayer, "items", Kind::array);
  if (!list) return list.error();
  status = fields_.each(value, kLayer, "items", [&](const Value& entry) -> Status {
    auto item = layer_item(entry);
    if (!item) return item.error();
    layer.items.push_back(std::move(*item));
    return {};
  });
  if (!status) return status.error();
  return layer;
}

}  // namespace krok::timeline_file
