#include "formats/library/library_description.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "formats/json/fields.h"

namespace krok::library {

namespace {

using json::Given;
using JsonKind = json::Value::Kind;

constexpr std::size_t kLargestFile = std::size_t{4} << 20;
constexpr std::size_t kLongestName = 200;

json::Parser parser_of(std::string_view measures) {
  if (measures == "duration") {
    return [](std::string_view text) -> Result<double> {
      const auto time = parse_clip_time(text);
      if (!time) return time.error();
      if (time->in_frames) {
        return Error("quantity-unit", "frames are not a valid unit here", "use s or ms");
      }
      return time->value;
    };
  }
  const bool is_angle = measures.starts_with("step.turn") || measures.starts_with("step.path_turn");
  return is_angle ? parse_angle : parse_length;
}

json::Kind<std::string> text() {
  return json::plain_text(SIZE_MAX, "{0} is empty or has control characters");
}

json::Kind<double> rate() {
  return json::kind<double>(json::frame_rate().schema(),
                            [](const Given& given, double& to) -> Status {
                              if (Status status = json::positive().read(given, &to); !status) {
                                return status;
                              }
                              return json::checked_rate().read(given, &to);
                            });
}

json::Kind<double> spacing() {
  return json::kind<double>(R"({"type": "number", "minimum": 0, "maximum": 1})",
                            [](const Given& given, double& to) -> Status {
                              if (Status status = given.is(JsonKind::number); !status) {
                                return status;
                              }
                              return json::number(0, 1).read(given.as("\"spacing\""), &to);
                            });
}

json::Kind<Side> swing() {
  return json::kind<Side>(
      R"({"enum": ["left", "right"]})", [](const Given& given, Side& to) -> Status {
        if (Status status = given.is(JsonKind::string); !status) return status;
        const std::string& side = given.value.text;
        to = side == "right" ? Side::right : Side::left;
        if (side == "left" || side == "right") return {};
        return given.wrong(fmt::format("\"swing\" is '{}', expected left or right", shown(side)));
      });
}

// A name of a keytime of the file.
json::Kind<std::string> keytime() {
  return json::kind<std::string>(
      R"({"type": "string", "minLength": 1, "maxLength": 200})",
      [](const Given& given, std::string& to) -> Status {
        to = given.value.text;
        const bool good =
            given.value.kind == JsonKind::string && !to.empty() && to.size() <= kLongestName;
        return good ? Status() : given.wrong("a keytime name must be a non-empty string");
      });
}

json::Kind<ClipTime> moment() {
  return json::kind<ClipTime>(
      json::schema_of_either({R"({"type": "number", "minimum": 0})",
                              R"({"description": "1.5s, 250ms or 45f", "type": "string"})"}),
      [](const Given& given, ClipTime& to) -> Status {
        const json::Value& value = given.value;
        if (value.kind == JsonKind::number) {
          to = {value.number, false};
          return to.value >= 0 ? Status()
                               : given.wrong(fmt::format("{} is before 0", given.name()));
        }
        if (value.kind != JsonKind::string) {
          return given.wrong(
              fmt::format("{} is {}, expected a time", given.name(), json::kind_name(value.kind)),
              "use seconds as a number, or a string such as \"1.5s\" or \"90f\"");
        }
        const auto time = parse_clip_time(value.text);
        if (!time || time->value < 0) {
          return given.wrong(
              fmt::format("{}: {}", given.name(), time ? "a time before 0" : time.error().message),
              time ? "" : time.error().hint);
        }
        to = *time;
        return {};
      });
}

struct File {
  const std::string& path;
  bool all_automatic = false;

  Location place_of(const Given& given) const {
    Location place = given.where();
    place.file = path;
    return place;
  }

  static Status check_name(const Given& given, ParameterEntry& to) {
    if (!given.has("name")) to.name = to.measures.substr(to.measures.rfind('.') + 1);
    if (to.name.find('=') == std::string::npos && to.name.size() <= kLongestName) return {};
    return given.wrong(fmt::format("'{}' is not a valid parameter name", shown(to.name)),
                       "use at most 200 bytes and no =");
  }

  static Status check_range(const Given& given, ParameterEntry& to) {
    if (to.tolerance && !(*to.tolerance > 0)) {
      return given.member("tolerance")
          .wrong(fmt::format("the tolerance of {} is not positive", given.what));
    }
    if (to.least.has_value() != to.most.has_value()) {
      return given.wrong(fmt::format("{} has only one end of a range", given.what),
                         "give both \"from\" and \"to\", or neither");
    }
    if (!to.least || *to.least < *to.most) return {};
    return given.member("to").wrong(fmt::format("the range of {} is empty", given.what));
  }

  // A number of what the parameter measures.
  static json::Kind<ParameterEntry> amount(std::optional<double> ParameterEntry::*to) {
    return json::kind<ParameterEntry>(
        json::quantity(parse_length, "metres, degrees or seconds").schema(),
        [to](const Given& given, ParameterEntry& entry) {
          return json::quantity(parser_of(entry.measures), {}).read(given, &(entry.*to).emplace());
        });
  }

  json::Object<ParameterEntry> parameter_table() const {
    json::Object<ParameterEntry> parameter;
    parameter.field("name", &ParameterEntry::name, text());
    parameter.field("measures", &ParameterEntry::measures, text()).required();
    parameter.check([this](const Given& given, ParameterEntry& to) {
      to.place = place_of(given);
      return check_name(given, to);
    });
    parameter.described(
        [](const ParameterEntry& of) { return fmt::format("'{}'", shown(of.name)); });
    parameter.field("tolerance", amount(&ParameterEntry::tolerance));
    parameter.field("from", amount(&ParameterEntry::least));
    parameter.field("to", amount(&ParameterEntry::most)).check(check_range);
    return parameter;
  }

  static Status check_unique(const Given& given, std::vector<ParameterEntry>& all) {
    const auto first = std::ranges::find(all, all.back().name, &ParameterEntry::name);
    if (first == all.end() - 1) return {};
    return given.wrong(fmt::format("duplicate parameter name '{}'", shown(first->name)),
                       "give one of them another \"name\"");
  }

  // "auto" or "one".
  static Status read_steps(const Given& given, bool& automatic, std::string_view expected) {
    if (Status status = given.is(JsonKind::string); !status) return status;
    automatic = given.value.text == "auto";
    if (automatic || given.value.text == "one") return {};
    return given.wrong(
        fmt::format("{} is '{}', expected {}", given.name(), shown(given.value.text), expected));
  }

  // The kind of all steps of the file, as keytimes differ, or whether they are to be found.
  Status read_kind(const Given& given, StepKind& to) {
    if (Status status = given.is(JsonKind::string); !status) return status;
    constexpr std::pair<std::string_view, StepKind> kKinds[] = {
        {"runs", StepKind::runs},
        {"starts", StepKind::starts},
        {"stops", StepKind::stops},
        {"stands", StepKind::stands},
        {"backward", StepKind::backward},
        {"side", StepKind::side},
        {"side_closing", StepKind::side_closing},
        {"turns", StepKind::turns},
        {"turns_closing", StepKind::turns_closing}};
    for (const auto& [name, kind] : kKinds) {
      if (given.value.text == name) to = kind;
    }
    all_automatic = to != StepKind::walks;
    if (all_automatic) return {};
    return read_steps(given, all_automatic,
                      "auto, runs, starts, stops, stands, backward, side, side_closing, turns, "
                      "turns_closing or one");
  }

  json::Object<ExampleEntry> example_table() const {
    json::Object<ExampleEntry> example;
    example.check([this](const Given& given, ExampleEntry& to) {
      to.place = place_of(given);
      to.automatic = all_automatic;
      return Status();
    });
    example.field("name", &ExampleEntry::name, text());
    example.field("style", &ExampleEntry::style, text(), "a person, a mood");
    example.field("clip", &ExampleEntry::clip, text(), "a path").required();
    example.field(
        "steps", &ExampleEntry::automatic,
        json::kind<bool>(R"({"enum": ["auto", "one"]})", [](const Given& given, bool& to) {
          return read_steps(given, to, "auto or one");
        }));
    example.field("from", &ExampleEntry::from, moment());
    example.field("to", &ExampleEntry::to, moment());
    example.field("keys", &ExampleEntry::keys, text(), "a path");
    example.check([](const Given& given, const ExampleEntry& of) -> Status {
      const json::Value* const keytimes = given.value.find("keytimes");
      if (keytimes == nullptr || keytimes->kind != JsonKind::object || !of.automatic) return {};
      return given.member("keytimes")
          .wrong("an example with \"steps\": \"auto\" cannot have keytimes",
                 "\"steps\": \"one\" makes the clip one example");
    });
    using Keytimes = std::vector<KeytimeEntry>;
    const auto time =
        json::kind<KeytimeEntry>(moment().schema(), [](const Given& given, KeytimeEntry& to) {
          return moment().read({given.source, given.value, to.name, "an example"}, &to.time);
        });
    example.field("keytimes", &ExampleEntry::keytimes,
                  json::keyed<Keytimes>(
                      time, "", [](const Given& key, Keytimes& to) -> Result<KeytimeEntry*> {
                        return &to.emplace_back(KeytimeEntry{std::string(key.key), {}});
                      }));
    return example;
  }

  json::Object<LibraryDescription> table() {
    using Library = LibraryDescription;
    json::Object<Library> file;
    file.file("krok.library/1", "Description of a step library (krok.library/1)").comment();
    file.field("name", &Library::name, text());
    file.field("skeleton", &Library::skeleton, text(), "a path");
    file.field("map", &Library::map, text(), "path of a role map");
    file.field("swing", &Library::swing, swing(), "the swing foot");
    file.field("mirror", &Library::mirror, json::boolean());
    file.field(
        "keytimes", &Library::keytimes,
        json::list<std::string>(
            keytime(), {"", 2, 100}, [](const Given& given, const std::vector<std::string>& all) {
              return std::ranges::find(all, all.back()) == all.end() - 1
                         ? Status()
                         : given.wrong(fmt::format("duplicate keytime '{}'", shown(all.back())));
            }));
    file.field("rate", &Library::rate, rate(), "frames per second");
    file.field("outlier_deviations", &Library::outlier_deviations, json::positive());
    file.field("spacing", &Library::spacing, spacing());
    file.field("parameters", &Library::parameters,
               json::list<ParameterEntry>(json::object(parameter_table()), {"a parameter", 1, 8},
                                          check_unique))
        .required();
    file.field(
        "steps", &Library::kind,
        json::kind<StepKind>(
            R"({"enum": ["auto", "one", "runs", "starts", "stops", "stands", "backward", "side", )"
            R"("side_closing", "turns", "turns_closing"]})",
            [this](const Given& given, StepKind& to) { return read_kind(given, to); }));
    file.field("examples", &Library::examples,
               json::list<ExampleEntry>(json::object(example_table()), {"an example", 1, 10'000}))
        .required();
    return file;
  }
};

}  // namespace

Result<LibraryDescription> read(std::string_view text, const std::string& path) {
  auto library = File{path}.table().read_text(text, "library", kLargestFile);
  if (!library) return std::move(library).error().in_file(path);
  return library;
}

std::string schema() {
  const std::string none;
  return File{none}.table().schema();
}

}  // namespace krok::library
