#include "formats/timeline/timeline_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/json/fields.h"
#include "scene/clip.h"

namespace krok::timeline_file {

namespace {

using json::Given;
using timeline::BaseItem;
using timeline::Change;
using timeline::ChangeKind;
using timeline::Easing;
using timeline::Fade;
using timeline::Layer;
using timeline::LayerItem;
using timeline::LayerMode;
using timeline::Mark;
using timeline::MaskRule;
using JsonKind = json::Value::Kind;

constexpr std::size_t kLongestName = 200;
constexpr std::size_t kMaxEntries = 10'000;
constexpr double kMax = 1e9;  // of any number

Error wrong(const Given& given, std::string_view expected, std::string hint = {}) {
  std::string found(json::kind_name(given.value.kind));
  if (given.value.kind == JsonKind::number) found = readable(given.value.number);
  if (given.value.kind == JsonKind::string) found = fmt::format("'{}'", shown(given.value.text));
  return given.wrong(fmt::format("{} is {}, expected {}", given.name(), found, expected),
                     std::move(hint));
}

// A number within +-1e9, or what `parse` makes of a string.
template <typename T, typename Parse>
Status read_quantity(const Given& given, const Parse& parse, const T& number, T& to) {
  if (given.value.kind == JsonKind::number) {
    to = number;
    return std::abs(given.value.number) <= kMax ? Status() : wrong(given, "a number within +-1e9");
  }
  if (given.value.kind != JsonKind::string) {
    return wrong(given, "a number, or a string with a unit");
  }
  const auto parsed = parse(given.value.text);
  if (!parsed) {
    const Error& error = parsed.error();
    return wrong(given, "a number with a unit",
                 error.message + (error.hint.empty() ? "" : "; " + error.hint));
  }
  to = *parsed;
  return {};
}

std::string quantity_schema(std::string_view says, std::string_view units) {
  return fmt::format(R"({{"description": "{}", "oneOf": [{{"type": "number"}}, )"
                     R"({{"type": "string", "pattern": "^[-+.0-9eE]+ ?({})?$"}}]}})",
                     says, units);
}

json::Kind<ClipTime> time() {
  return json::kind<ClipTime>(quantity_schema("seconds, or a string: 1.5s, 250ms, 120f", "s|ms|f"),
                              [](const Given& given, ClipTime& to) -> Status {
                                const ClipTime seconds{given.value.number, false};
                                Status status = read_quantity(given, parse_clip_time, seconds, to);
                                if (!status || std::abs(to.value) <= kMax) return status;
                                return wrong(given, "a time within +-1e9");
                              });
}

json::Kind<double> length() {
  return json::kind<double>(quantity_schema("metres, or a string: 5cm", "m|dm|cm|mm|um|in|ft"),
                            [](const Given& given, double& to) -> Status {
                              Status status =
                                  read_quantity(given, parse_length, given.value.number, to);
                              if (!status || std::abs(to) <= 1e6) return status;
                              return wrong(given, "at most 1000 km");
                            });
}

json::Kind<double> angle() {
  return json::kind<double>(quantity_schema("degrees, or a string: 0.3rad", "deg|rad"),
                            [](const Given& given, double& to) -> Status {
                              const double radians = given.value.number * kRadiansPerDegree;
                              Status status = read_quantity(given, parse_angle, radians, to);
                              if (!status || std::abs(to) <= 1e6) return status;
                              return wrong(given, "an angle within +-1e6 rad");
                            });
}

// `expected` is for numbers that are not from min to max.
json::Kind<double> number(double min = -kMax, double max = kMax,
                          const std::string& expected = "a number") {
  return json::kind<double>(R"({"type": "number"})", [=](const Given& given, double& to) -> Status {
    to = given.value.number;
    if (given.value.kind != JsonKind::number || !(std::abs(to) <= kMax)) {
      return wrong(given, "a number");
    }
    return to >= min && to <= max ? Status() : wrong(given, expected);
  });
}

json::Kind<int> whole(int min, int max) {
  return json::kind<int>(
      fmt::format(R"({{"type": "integer", "minimum": {}, "maximum": {}}})", min, max),
      [=](const Given& given, int& to) -> Status {
        const double value = given.value.number;
        if (given.value.kind != JsonKind::number || value != std::floor(value) || value < min ||
            value > max) {
          return wrong(given, fmt::format("an integer from {} to {}", min, max));
        }
        to = static_cast<int>(value);
        return {};
      });
}

json::Kind<bool> truth() {
  return json::kind<bool>(R"({"type": "boolean"})", [](const Given& given, bool& to) -> Status {
    to = given.value.truth;
    return given.value.kind == JsonKind::boolean ? Status() : wrong(given, "true or false");
  });
}

// `needed`: the message for what is no string names the kind alone.
json::Kind<std::string> name(bool needed = false) {
  return json::kind<std::string>(
      fmt::format(R"({{"type": "string", "minLength": 1, "maxLength": {}}})", kLongestName),
      [needed](const Given& given, std::string& to) -> Status {
        if (Status status = given.is(JsonKind::string); needed && !status) return status;
        to = given.value.text;
        const bool plain = std::ranges::none_of(
            to, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
        if (given.value.kind == JsonKind::string && !to.empty() && plain &&
            to.size() <= kLongestName) {
          return {};
        }
        return wrong(given, fmt::format("a name of 1 to {} bytes", kLongestName));
      });
}

Result<std::size_t> word_index(const Given& given, const std::vector<std::string>& words) {
  if (given.value.kind != JsonKind::string) {
    return wrong(given, "a known value", fmt::format("use one of {}", fmt::join(words, ", ")));
  }
  const auto found = std::ranges::find(words, given.value.text);
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  return wrong(given, "a known value", nearest_hint(given.value.text, words));
}

template <typename T>
json::Kind<T> choice(std::initializer_list<std::pair<const char*, T>> words) {
  std::vector<std::string> names;
  std::vector<T> values;
  for (const auto& [word, value] : words) {
    names.emplace_back(word);
    values.push_back(value);
  }
  return json::kind<T>(json::schema_of_words(names), [=](const Given& given, T& to) -> Status {
    const auto index = word_index(given, names);
    if (!index) return index.error();
    to = values[*index];
    return {};
  });
}

json::Kind<Easing> easing() {
  return json::kind<Easing>(
      R"({"type": "string", "pattern": "^(linear|smooth|smoother|(quad|cubic|quart|sine|expo|circ|)"
      R"(back|elastic|bounce)(-in|-out|-in-out)?)$"})",
      [](const Given& given, Easing& to) -> Status {
        auto parsed = timeline::parse_easing(given.value.text);
        if (given.value.kind != JsonKind::string || !parsed) {
          const auto names = timeline::easing_names();
          const auto index = word_index(given, names);
          if (!index) return index.error();
          parsed = timeline::parse_easing(names[*index]);
        }
        to = *parsed;
        return {};
      });
}

template <typename T>
json::Kind<std::vector<T>> entries(
    json::Object<T> table, std::function<Status(const Given&, std::vector<T>&)> added = {}) {
  return json::list<T>(json::object(std::move(table)),
                       {"", 0, kMaxEntries, "\"{1}\" has {0} entries, at most {3} are allowed"},
                       std::move(added));
}

// Exactly one of two keys.
template <typename T>
void need_one(json::Object<T>& table, std::string_view key, std::string_view other,
              const char* message) {
  table.check([=](const Given& given, T&) {
    return given.has(key) != given.has(other) ? Status() : given.wrong(message);
  });
  table.also(json::schema_of_one(key, other));
}

json::Object<Mark> mark_table() {
  json::Object<Mark> mark("a mark");
  mark.field("name", &Mark::name, name(true)).required();
  need_one(mark, "at", "source_at", "a mark has either \"at\" or \"source_at\"");
  mark.field("at", &Mark::at, time(), "since the start of the item");
  mark.field("source_at", &Mark::at, time(), "of the motion");
  mark.check([](const Given& given, Mark& to) {
    to.of_source = given.has("source_at");
    return Status();
  });
  return mark;
}

json::Object<GroundFrame> place_table() {
  json::Object<GroundFrame> place("\"place\"");
  place.field("x", &GroundFrame::x, length()).field("z", &GroundFrame::z, length());
  return place.field("heading", &GroundFrame::heading, angle());
}

struct File {
  const std::string& path;
  std::vector<std::size_t> lines = {0};  // offsets; many locations are stored
  double rate = 0;                       // of the result; 0 if the file has none
  std::vector<std::string> names = {};   // of the sources
  std::size_t base_items = 0, layers = 0;

  void find_lines(std::string_view text) {
    const std::string_view content = without_byte_order_mark(text);
    for (std::size_t i = 0; i < content.size(); ++i) {
      const bool pair = content[i] == '\r' && i + 1 < content.size() && content[i + 1] == '\n';
      if (is_line_end(content[i]) && !pair) lines.push_back(i + 1);
    }
  }

  Location place_of(const Given& given) const {
    const auto line = std::ranges::upper_bound(lines, given.offset) - lines.begin();
    const std::size_t begin = lines[static_cast<std::size_t>(line - 1)];
    return {path, line, static_cast<std::int64_t>(given.offset - begin) + 1};
  }

  json::Kind<double> duration() const {
    json::Kind<double> made;
    made.schema = time().schema;
    made.read = [this](const Given& given, void* to) -> Status {
      ClipTime found;
      if (Status status = time().read(given, &found); !status) return status;
      if (found.in_frames && rate == 0) {
        return wrong(given, "seconds", "durations in frames need a \"rate\" in the file");
      }
      if (!(found.value >= 0)) return wrong(given, "0 s or more");
      *static_cast<double*>(to) = found.seconds(rate);
      return {};
    };
    return made;
  }

  json::Kind<int> source() const {
    return json::kind<int>(R"({"type": "string"})", [this](const Given& given, int& to) -> Status {
      if (Status status = given.is(JsonKind::string); !status) return status;
      const auto index = word_index(given, names);
      if (!index) return index.error();
      to = static_cast<int>(*index);
      return {};
    });
  }

  static json::Kind<int> rounds() {
    return json::kind<int>(json::schema_of_either({truth().schema(), whole(1, 100'000).schema()}),
                           [](const Given& given, int& to) {
                             if (given.value.kind != JsonKind::boolean) {
                               return whole(1, 100'000).read(given, &to);
                             }
                             to = given.value.truth ? 0 : 1;
                             return Status();
                           });
  }

  // Members shared by items of the base and of layers.
  template <typename Item>
  json::Object<Item> item_table(std::string what) const {
    using timeline::Play;
    const auto of_play = [](auto member) {
      return [member](Item & item) -> auto& {
        return item.play.*member;
      };
    };
    json::Object<Item> item(std::move(what));
    item.check([this](const Given& given, Item& to) {
      to.where = place_of(given);
      return Status();
    });
    item.field("name", &Item::name, name());
    item.field("source", of_play(&Play::source), source(), "a name of \"sources\"").required();
    item.field("sequence", of_play(&Play::part), name(), "of the source");
    item.check([](const Given& given, Item& to) -> Status {
      if (!given.has("name")) {
        to.name = given.member("source").value.text;
        if (given.has("sequence")) to.name += ":" + to.play.part;
      }
      if (!given.has("sequence") || (!given.has("from") && !given.has("to"))) return {};
      return given.member("sequence").wrong("a sequence has its own \"from\" and \"to\"");
    });
    item.also(R"("not": {"required": ["sequence"], "anyOf": [{"required": ["from"]}, )"
              R"({"required": ["to"]}]})");
    item.field("from", of_play(&Play::from), time()).field("to", of_play(&Play::to), time());
    item.field("speed", of_play(&Play::speed), number());
    item.field("loop", of_play(&Play::rounds), rounds());
    return item.field("until", of_play(&Play::until), time(), "of the result");
  }

  // "cut", or an object.
  json::Kind<Change> change() {
    json::Object<Change> table("a change");
    table.unused("a change of kind {2} has no \"{1}\"");
    auto kind = choice<ChangeKind>({{"cut", ChangeKind::cut},
                                    {"crossfade", ChangeKind::crossfade},
                                    {"smooth", ChangeKind::smooth},
                                    {"inertial", ChangeKind::inertial}});
    const auto read_kind = kind.read;
    kind.read = [read_kind](const Given& given, void* to) {
      Status status = given.is(JsonKind::string);
      return status ? read_kind(given, to) : status;
    };
    table.field("kind", &Change::kind, kind).required();
    table.check([](const Given& given, const Change& of) {
      return of.kind == ChangeKind::cut || given.has("duration")
                 ? Status()
                 : given.wrong(fmt::format("a change of kind {} needs a \"duration\"",
                                           timeline::change_name(of.kind)));
    });
    table.field("duration", &Change::duration, duration())
        .required()
        .with("kind", {"crossfade", "smooth", "inertial"})
        .check([](const Given& given, const Change& of) {
          return !given.has("duration") || of.duration > 0
                     ? Status()
                     : wrong(given.member("duration"), "more than 0 s");
        });
    table.field("easing", &Change::easing, easing()).with("kind", {"crossfade", "smooth"});
    table
        .field("sync", &Change::sync,
               choice<timeline::Sync>({{"auto", timeline::Sync::automatic},
                                       {"keytimes", timeline::Sync::keytimes},
                                       {"clock", timeline::Sync::clock}}))
        .with("kind", {"crossfade"});
    table.field("align", &Change::align,
                choice<timeline::Align>(
                    {{"root", timeline::Align::root}, {"stance", timeline::Align::stance}}));
    table.field("guard", &Change::guard, truth()).with("kind", {"inertial"});
    return json::kind<Change>(
        json::schema_of_either({R"({"const": "cut"})", table.schema()}),
        [this, table, read_kind](const Given& given, Change& to) -> Status {
          if (base_items == 1) {
            return given.wrong("the first item cannot have a change: there is no item before it");
          }
          if (given.value.kind != JsonKind::string) return table.read(given, &to);
          if (Status status = read_kind(given, &to.kind); !status) return status;
          if (to.kind == ChangeKind::cut) return {};
          const std::string& word = given.value.text;
          return given.wrong(
              fmt::format("a change of kind {} needs a duration", word),
              fmt::format("write {{\"kind\": \"{}\", \"duration\": \"0.3s\"}}", word));
        });
  }

  json::Object<BaseItem> base_table() {
    auto item = item_table<BaseItem>("an item");
    item.check([this](const Given&, BaseItem&) { return ++base_items, Status(); });
    item.field("at", &BaseItem::at, time(), "of the result");
    item.field("place", &BaseItem::place, json::object(place_table()));
    item.field("change", &BaseItem::change, change());
    return item.field("marks", &BaseItem::marks, entries(mark_table())).comment();
  }

  // A duration, or an object.
  json::Kind<Fade> fade() const {
    json::Object<Fade> table;
    table.field("duration", &Fade::duration, duration());
    table.field("easing", &Fade::easing, easing());
    return json::kind<Fade>(json::schema_of_either({duration().schema(), table.schema()}),
                            [table, seconds = duration()](const Given& given, Fade& to) {
                              return given.value.kind == JsonKind::object
                                         ? table.read(given.as(given.key), &to)
                                         : seconds.read(given, &to.duration);
                            });
  }

  // A number, or a list of [time, weight].
  json::Kind<blend::WeightCurve> weight() const {
    const std::string point =
        fmt::format(R"({{"type": "array", "minItems": 2, "maxItems": 2, "prefixItems": [{}, {}]}})",
                    duration().schema(), number().schema());
    return json::kind<blend::WeightCurve>(
        json::schema_of_either({number().schema(), json::schema_of_list(point, 1, kMaxEntries)}),
        [this](const Given& given, blend::WeightCurve& to) { return read_weight(given, to); });
  }

  Status read_weight(const Given& given, blend::WeightCurve& to) const {
    const auto& items = given.value.items;
    if (given.value.kind != JsonKind::array) {
      to = blend::WeightCurve::constant(0);
      return number().read(given, to.weights.data());
    }
    if (items.empty() || items.size() > kMaxEntries) {
      return given.wrong(fmt::format("a weight needs 1 to {} points", grouped(kMaxEntries)));
    }
    to = {};
    for (const json::Value& point : items) {
      if (point.kind != JsonKind::array || point.items.size() != 2) {
        return Given{given.source, point, {}, {}}.wrong(
            "a point of a weight must be [time, weight]");
      }
      const Given at{given.source, point.items[0], "time", "a weight"};
      double time = 0, value = 0;
      Status status = duration().read(at, &time);
      if (status) {
        status = number().read({given.source, point.items[1], "value", "a weight"}, &value);
      }
      if (!status) return status;
      if (!to.generic.empty() && time <= to.generic.back()) {
        return wrong(at, "a time after the previous one");
      }
      to.generic.push_back(time);
      to.weights.push_back(value);
    }
    return {};
  }

  json::Object<LayerItem> layer_item_table() const {
    auto item = item_table<LayerItem>("an item of a layer");
    item.field("at", &LayerItem::at, time(), "of the result");
    item.field("fade_in", &LayerItem::fade_in, fade());
    item.field("fade_out", &LayerItem::fade_out, fade());
    item.field("weight", &LayerItem::weight, weight());
    return item.field("marks", &LayerItem::marks, entries(mark_table())).comment();
  }

  json::Object<MaskRule> rule_table() const {
    json::Object<MaskRule> rule("a rule of a mask");
    need_one(rule, "joints", "below", "a rule of a mask needs either \"joints\" or \"below\"");
    rule.field("joints", &MaskRule::joints, name(), "a name or a pattern");
    rule.field("below", &MaskRule::below, name(), "a joint");
    rule.field("weight", &MaskRule::weight, number(0, 1, "0 to 1"));
    rule.check([this](const Given& given, MaskRule& to) -> Status {
      to.where = place_of(given);
      if (!given.has("soft") || given.has("below")) return {};
      return given.member("soft").wrong("\"soft\" needs \"below\"");
    });
    rule.field("soft", &MaskRule::soft, whole(0, 1000), "joints over which the weight rises");
    return rule;
  }

  // A time, or "pose".
  static json::Kind<Layer> reference() {
    return json::kind<Layer>(
        json::schema_of_either({R"({"const": "pose"})", time().schema()}),
        [](const Given& given, Layer& to) {
          to.reference_pose = given.value.kind == JsonKind::string && given.value.text == "pose";
          return to.reference_pose ? Status() : time().read(given, &to.reference.emplace());
        });
  }

  json::Object<Layer> layer_table() {
    json::Object<Layer> layer("a layer");
    layer.check([this](const Given& given, Layer& to) {
      to.where = place_of(given);
      to.name = fmt::format("layer {}", ++layers);
      return Status();
    });
    layer.field("name", &Layer::name, name());
    layer.field("mode", &Layer::mode,
                choice<LayerMode>({{"override", LayerMode::override},
                                   {"additive", LayerMode::additive},
                                   {"modifier", LayerMode::modifier}}));
    layer.check([](const Given& given, const Layer& of) -> Status {
      const bool overrides = of.mode == LayerMode::override;
      if (given.has("space") && !overrides) {
        return given.member("space").wrong("only override layers have a \"space\"");
      }
      if (!given.has("reference") || !overrides) return {};
      return given.member("reference")
          .wrong("only additive and modifier layers have a \"reference\"");
    });
    layer.field("space", &Layer::space,
                choice<timeline::Space>(
                    {{"parent", timeline::Space::parent}, {"model", timeline::Space::model}}));
    layer.field("mask", &Layer::mask, entries(rule_table()));
    layer.field("reference", reference());
    layer.field("items", &Layer::items, entries(layer_item_table())).required();
    return layer.comment();
  }

  // By name: a path, or an object.
  json::Kind<std::vector<SourceFile>> sources() {
    json::Object<SourceFile> table;
    table.field("file", &SourceFile::path, name(true), "path").required();
    table.field("sequences", &SourceFile::sequences, name(), "path");
    auto source = json::kind<SourceFile>(
        json::schema_of_either({name().schema(), table.schema()}),
        [this, table](const Given& given, SourceFile& to) {
          to.where = place_of(given);
          if (given.value.kind != JsonKind::string) return table.read(given, &to);
          return name().read({given.source, given.value, "file", given.what}, &to.path);
        });
    return json::keyed<std::vector<SourceFile>>(
        source, "the source '{0}'",
        [this](const Given& key, std::vector<SourceFile>& to) -> Result<SourceFile*> {
          if (key.key.empty()) return key.as({}).wrong("a source has no name");
          names.emplace_back(key.key);
          to.emplace_back().name = key.key;
          return &to.back();
        });
  }

  // By name: weights of targets, or symbols.
  template <typename T>
  static json::Kind<std::vector<std::pair<std::string, T>>> by_name(json::Kind<T> value) {
    using List = std::vector<std::pair<std::string, T>>;
    return json::keyed<List>(value, "'{0}'", [](const Given& key, List& to) -> Result<T*> {
      to.emplace_back(key.key, T());
      return &to.back().second;
    });
  }

  static json::Kind<std::vector<FaceItem::Shape>> shapes() {
    using Weights = std::vector<std::pair<std::string, double>>;
    return json::keyed<std::vector<FaceItem::Shape>>(
        by_name(number(0, 1, "0 to 1")), "the shape of '{0}'",
        [](const Given& key, std::vector<FaceItem::Shape>& to) -> Result<Weights*> {
          const auto names = face::viseme_names();
          if (std::ranges::find(names, key.key) == names.end()) {
            return key.as({}).wrong(fmt::format("there is no viseme '{}'", shown(key.key)),
                                    fmt::format("they are {}", fmt::join(names, ", ")));
          }
          to.push_back({std::string(key.key), {}});
          return &to.back().weights;
        });
  }

  json::Object<FaceItem> face_table() const {
    using Kind = FaceItem::Kind;
    constexpr std::pair<const char*, Kind> kKinds[] = {{"weights", Kind::weights},
                                                       {"expression", Kind::expression},
                                                       {"phonemes", Kind::phonemes},
                                                       {"blinks", Kind::blinks}};
    json::Object<FaceItem> item("an item of the face");
    item.check([this, kKinds](const Given& given, FaceItem& to) -> Status {
      to.where = place_of(given);
      int found = 0;
      for (const auto& [key, kind] : kKinds) {
        if (given.has(key)) ++found, to.kind = kind;
      }
      if (found != 1) {
        return given.wrong(
            "an item of the face has one of \"weights\", \"expression\", "
            "\"phonemes\" and \"blinks\"");
      }
      for (const auto& [key, kind] : {std::pair{"tier", Kind::phonemes},
                                      {"alphabet", Kind::phonemes},
                                      {"symbols", Kind::phonemes},
                                      {"shapes", Kind::phonemes},
                                      {"seed", Kind::blinks},
                                      {"target", Kind::blinks}}) {
        if (given.has(key) && kind != to.kind) {
          return given.member(key).wrong(
              fmt::format("\"{}\" is for {}", key, kind == Kind::blinks ? "blinks" : "phonemes"));
        }
      }
      if (to.kind != Kind::blinks || given.has("target")) return {};
      return given.wrong("blinks need a \"target\", which closes the lids");
    });
    item.field("weights", &FaceItem::file, name(), "path");
    item.field("expression", &FaceItem::target, name());
    item.field("phonemes", &FaceItem::file, name(), "path");
    item.field(
        "blinks", [](FaceItem& of) -> double& { return of.blinks.per_minute; },
        number(0.1, 60, "0.1 to 60"), "per minute");
    item.field(
        "seed", [](FaceItem& of) -> std::uint64_t& { return of.blinks.seed; }, seed());
    item.field("target", &FaceItem::target, name());
    item.field("tier", &FaceItem::tier, name());
    item.field("alphabet", &FaceItem::alphabet,
               choice<face::Alphabet>({{"arpabet", face::Alphabet::arpabet},
                                       {"ipa", face::Alphabet::ipa},
                                       {"sampa", face::Alphabet::sampa}}));
    item.field("symbols", &FaceItem::symbols, by_name(name()));
    item.field("shapes", &FaceItem::shapes, shapes(), "by viseme, weights by target");
    item.field("at", &FaceItem::at, time(), "of the result");
    item.field("until", &FaceItem::until, time(), "of the result");
    item.field("fade_in", &FaceItem::fade_in, fade());
    item.field("fade_out", &FaceItem::fade_out, fade());
    item.field("weight", &FaceItem::weight, weight());
    item.field(
        "mode", [](FaceItem& of) -> bool& { return of.additive; },
        choice<bool>({{"override", false}, {"additive", true}}));
    return item.comment();
  }

  static json::Kind<std::uint64_t> seed() {
    return json::kind<std::uint64_t>(whole(0, 1'000'000'000).schema(),
                                     [](const Given& given, std::uint64_t& to) -> Status {
                                       int value = 0;
                                       Status status = whole(0, 1'000'000'000).read(given, &value);
                                       to = static_cast<std::uint64_t>(value);
                                       return status;
                                     });
  }

  // A point, or "ahead".
  static json::Kind<GazeKey> gaze_target() {
    return json::kind<GazeKey>(
        json::schema_of_either({R"({"const": "ahead"})", json::vector(1e6).schema()}),
        [](const Given& given, GazeKey& to) {
          const bool ahead = given.value.kind == JsonKind::string && given.value.text == "ahead";
          return ahead ? Status() : json::vector(1e6).read(given, &to.target.emplace());
        });
  }

  static json::Object<GazeKey> gaze_table() {
    json::Object<GazeKey> key("a key of the gaze");
    key.field("at", &GazeKey::at, time(), "of the result").required();
    key.field("target", gaze_target(), "metres, in the world, or ahead").required();
    return key.comment();
  }

  json::Object<Document> table() {
    const auto of_timeline = [](auto member) {
      return [member](Document & of) -> auto& {
        return of.timeline.*member;
      };
    };
    json::Object<Document> file;
    file.file("krok.timeline/1", "A timeline of motions (krok.timeline/1)").comment();
    file.context("rate", rate,
                 number(kMinRate, kMaxRate,
                        fmt::format("frames per second from {} to {}", readable(kMinRate),
                                    readable(kMaxRate))),
                 "frames per second of the result");
    file.field("sources", &Document::sources, sources(), "motions by name").required();
    file.field("base", of_timeline(&timeline::Timeline::base), entries(base_table())).required();
    file.field("layers", of_timeline(&timeline::Timeline::layers), entries(layer_table()));
    file.field("character", &Document::character, name(), "path; for face and gaze");
    file.field("face", &Document::face, entries(face_table()));
    file.field("gaze", &Document::gaze, entries(gaze_table()));
    file.check([this](const Given& given, Document& to) -> Status {
      to.timeline.rate = rate;
      if (to.face.empty() || !to.character.empty()) return {};
      return given.member("face").wrong("a face needs a \"character\" with the expressions");
    });
    return file;
  }
};

}  // namespace

Result<Document> read(std::string_view text, const std::string& path) {
  File file{path};
  file.find_lines(text);
  auto document = file.table().read_text(text, "timeline");
  if (!document) {
    Error error = std::move(document).error();
    const auto names = [&](const char* words) {
      return error.message.find(words) != std::string::npos;
    };
    if (names("unknown key 'transition'") || names("unknown key 'blend'") ||
        names("a change is a number") || names("of kind cut has no")) {
      error.hint = R"(a cross-fade is "change": {"kind": "crossfade", "duration": "0.3s"})";
    } else if (names("the file")) {
      error.hint += std::string(error.hint.empty() ? "" : "; ") +
                    R"(a small one: {"schema": "krok.timeline/1", "sources": {"a": "walk.anim"}, )"
                    R"("base": [{"source": "a"}]})";
    }
    return std::move(error).in_file(path);
  }
  return document;
}

std::string schema() {
  const std::string none;
  return File{none}.table().schema();
}

}  // namespace krok::timeline_file
