#include "formats/library/library_description.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/json/members.h"
#include "scene/frame_moment.h"

namespace krok::library {

namespace {

using json::Value;
using Kind = Value::Kind;

constexpr std::string_view kSchema = "krok.library/1";
constexpr std::size_t kLargestFile = std::size_t{4} << 20;
constexpr std::size_t kMaxParameters = 8;
constexpr std::size_t kMaxExamples = 10'000;
constexpr std::size_t kMaxKeytimes = 100;
constexpr std::size_t kLongestName = 200;

json::Members::Parser parser_of(std::string_view measures) {
  if (measures == "duration") {
    return [](std::string_view text) -> Result<double> {
      const auto time = parse_clip_time(text);
      if (!time) return time.error();
      if (time->in_frames)
        return Error("quantity-unit", "frames are not a valid unit here", "use s or ms");
      return time->value;
    };
  }
  const bool is_angle = measures.starts_with("step.turn") || measures.starts_with("step.path_turn");
  return is_angle ? parse_angle : parse_length;
}

class Reader {
 public:
  Reader(std::string_view text, const std::string& path)
      : text_(text), path_(path), members_(text, "library") {}

  Result<LibraryDescription> read() {
    const auto root = json::parse(text_, kLargestFile);
    if (!root) return root.error();
    Status status = members_.only(
        *root, "the file",
        {"schema", "comment", "name", "skeleton", "map", "swing", "mirror", "keytimes", "rate",
         "outlier_deviations", "spacing", "parameters", "steps", "examples"});
    if (status) status = members_.has_schema(*root, "the file", kSchema);
    if (status) status = read_general(*root);
    if (status) status = read_list(*root, "parameters", kMaxParameters, &Reader::read_parameter);
    if (status) status = read_list(*root, "examples", kMaxExamples, &Reader::read_example);
    if (!status) return status.error();
    return std::move(library_);
  }

 private:
  Location place_of(const Value& value) const { return locate(text_, value.offset, path_); }

  // Optional strings that must not be empty.
  Status take(const Value& object, std::string_view what, std::string_view key,
              std::string& text) const {
    const auto found = members_.find(object, what, key, Kind::string);
    if (!found) return found.error();
    if (*found == nullptr) return {};
    const std::string& given = (*found)->text;
    const bool plain = std::ranges::none_of(
        given, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
    if (given.empty() || !plain) {
      return members_.wrong(
          **found, fmt::format("\"{}\" of {} is empty or has control characters", key, what));
    }
    text = given;
    return {};
  }

  Status take_flag(const Value& object, std::string_view what, std::string_view key,
                   bool& flag) const {
    const auto found = members_.find(object, what, key, Kind::boolean);
    if (!found) return found.error();
    if (*found != nullptr) flag = (*found)->truth;
    return {};
  }

  Status take_positive(const Value& object, std::string_view what, std::string_view key,
                       std::optional<double>& number) const {
    const auto found = members_.find(object, what, key, Kind::number);
    if (!found) return found.error();
    if (*found == nullptr) return {};
    number = (*found)->number;
    if (*number > 0 && std::isfinite(*number)) return {};
    return members_.wrong(**found, fmt::format("\"{}\" of {} is {}, expected more than 0", key,
                                               what, readable(*number)));
  }

  Status take_rate(const Value& root) {
    if (Status status = take_positive(root, "the file", "rate", library_.rate); !status) {
      return status;
    }
    if (!library_.rate) return {};
    if (const Status status = check_frame_rate(*library_.rate, "rate"); !status) {
      return members_.wrong(*root.find("rate"), status.error().message);
    }
    return {};
  }

  Status take_moment(const Value& object, std::string_view what, std::string_view key,
                     std::optional<ClipTime>& time) const {
    const Value* value = object.find(key);
    if (value == nullptr) return {};
    const auto parsed = moment(*value, what, key);
    if (!parsed) return parsed.error();
    time = *parsed;
    return {};
  }

  Result<ClipTime> moment(const Value& value, std::string_view what, std::string_view key) const {
    if (value.kind != Kind::number && value.kind != Kind::string) {
      return members_.wrong(value,
                            fmt::format("\"{}\" of {} is {}, expected a time", shown(key), what,
                                        json::kind_name(value.kind)),
                            "use seconds as a number, or a string such as \"1.5s\" or \"90f\"");
    }
    if (value.kind == Kind::number) {
      if (value.number >= 0) return ClipTime{value.number, false};
      return members_.wrong(value, fmt::format("\"{}\" of {} is before 0", shown(key), what));
    }
    const auto time = parse_clip_time(value.text);
    if (!time || time->value < 0) {
      return members_.wrong(value,
                            fmt::format("\"{}\" of {}: {}", shown(key), what,
                                        time ? "a time before 0" : time.error().message),
                            time ? "" : time.error().hint);
    }
    return *time;
  }

  Status read_general(const Value& root) {
    Status status = take(root, "the file", "name", library_.name);
    if (status) status = take(root, "the file", "skeleton", library_.skeleton);
    if (status) status = take(root, "the file", "map", library_.map);
    if (status) status = take_flag(root, "the file", "mirror", library_.mirror);
    if (status) status = take_rate(root);
    if (status) status = read_swing(root);
    if (status) status = read_kind(root);
    if (status && library_.kind == StepKind::walks)
      status = read_steps(root, "the file", all_automatic_);
    if (status) status = read_keytimes(root);
    if (status) {
      status = take_positive(root, "the file", "outlier_deviations", library_.outlier_deviations);
    }
    if (status) status = read_spacing(root);
    return status;
  }

  Status read_spacing(const Value& root) {
    const auto found = members_.find(root, "the file", "spacing", Kind::number);
    if (!found) return found.error();
    if (*found == nullptr) return {};
    library_.spacing = (*found)->number;
    if (*library_.spacing >= 0 && *library_.spacing <= 1) return {};
    return members_.wrong(
        **found, fmt::format("\"spacing\" is {}, expected 0 to 1", readable(*library_.spacing)));
  }

  Status read_swing(const Value& root) {
    const auto found = members_.find(root, "the file", "swing", Kind::string);
    if (!found) return found.error();
    if (*found == nullptr || (*found)->text == "left") return {};
    if ((*found)->text != "right") {
      return members_.wrong(
          **found, fmt::format("\"swing\" is '{}', expected left or right", shown((*found)->text)));
    }
    library_.swing = Side::right;
    return {};
  }

  // "steps": "runs" and the like, for the whole file alone: keytimes differ.
  Status read_kind(const Value& root) {
    const auto found = members_.find(root, "the file", "steps", Kind::string);
    if (!found) return found.error();
    if (*found == nullptr) return {};
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
      if ((*found)->text == name) library_.kind = kind;
    }
    all_automatic_ = library_.kind != StepKind::walks;
    return {};
  }

  // "steps": "auto".
  Status read_steps(const Value& object, std::string_view what, bool& automatic) const {
    const auto found = members_.find(object, what, "steps", Kind::string);
    if (!found) return found.error();
    if (*found == nullptr) return {};
    automatic = (*found)->text == "auto";
    if (automatic || (*found)->text == "one") return {};
    return members_.wrong(
        **found,
        fmt::format("\"steps\" of {} is '{}', expected {}", what, shown((*found)->text),
                    what == "the file" ? "auto, runs, starts, stops, stands, backward, side, "
                                         "side_closing, turns, turns_closing or one"
                                       : "auto or one"));
  }

  Status read_keytimes(const Value& root) {
    const auto found = members_.find(root, "the file", "keytimes", Kind::array);
    if (!found) return found.error();
    if (*found == nullptr) return {};
    const auto& items = (*found)->items;
    if (items.size() < 2 || items.size() > kMaxKeytimes) {
      return members_.wrong(
          **found, fmt::format("{} keytimes, expected 2 to {}", items.size(), kMaxKeytimes));
    }
    for (const Value& item : items) {
      if (item.kind != Kind::string || item.text.empty() || item.text.size() > kLongestName) {
        return members_.wrong(item, "a keytime name must be a non-empty string");
      }
      if (std::ranges::find(library_.keytimes, item.text) != library_.keytimes.end()) {
        return members_.wrong(item, fmt::format("duplicate keytime '{}'", shown(item.text)));
      }
      library_.keytimes.push_back(item.text);
    }
    return {};
  }

  using ReadEntry = Status (Reader::*)(const Value&);
  Status read_list(const Value& root, std::string_view key, std::size_t most, ReadEntry entry) {
    const auto list = members_.get(root, "the file", key, Kind::array);
    if (!list) return list.error();
    if ((*list)->items.empty() || (*list)->items.size() > most) {
      return members_.wrong(
          **list, fmt::format("{} {}, expected 1 to {}", (*list)->items.size(), key, most));
    }
    for (const Value& item : (*list)->items) {
      if (Status status = (this->*entry)(item); !status) return status;
    }
    return {};
  }

  Status read_parameter(const Value& item) {
    Status status =
        members_.only(item, "a parameter", {"name", "measures", "tolerance", "from", "to"});
    if (!status) return status;
    ParameterEntry entry;
    entry.place = place_of(item);
    const auto measures = members_.get(item, "a parameter", "measures", Kind::string);
    if (!measures) return measures.error();
    status = take(item, "a parameter", "measures", entry.measures);
    entry.name = entry.measures.substr(entry.measures.rfind('.') + 1);
    if (status) status = take(item, "a parameter", "name", entry.name);
    if (!status) return status;
    if (entry.name.find('=') != std::string::npos || entry.name.size() > kLongestName) {
      return members_.wrong(item,
                            fmt::format("'{}' is not a valid parameter name", shown(entry.name)),
                            "use at most 200 bytes and no =");
    }
    const auto same = [&](const ParameterEntry& other) { return other.name == entry.name; };
    if (std::ranges::any_of(library_.parameters, same)) {
      return members_.wrong(item, fmt::format("duplicate parameter name '{}'", shown(entry.name)),
                            "give one of them another \"name\"");
    }
    if (Status step = read_range(item, entry); !step) return step;
    library_.parameters.push_back(std::move(entry));
    return {};
  }

  Status read_range(const Value& item, ParameterEntry& entry) const {
    const std::string what = fmt::format("'{}'", shown(entry.name));
    const struct {
      const char* key;
      std::optional<double>& value;
    } numbers[] = {{"tolerance", entry.tolerance}, {"from", entry.least}, {"to", entry.most}};
    for (const auto& number : numbers) {
      const auto found = members_.quantity(item, what, number.key, parser_of(entry.measures));
      if (!found) return found.error();
      number.value = *found;
    }
    if (entry.tolerance && !(*entry.tolerance > 0)) {
      return members_.wrong(*item.find("tolerance"),
                            fmt::format("the tolerance of {} is not positive", what));
    }
    if (entry.least.has_value() != entry.most.has_value()) {
      return members_.wrong(item, fmt::format("{} has only one end of a range", what),
                            "give both \"from\" and \"to\", or neither");
    }
    if (entry.least && !(*entry.least < *entry.most)) {
      return members_.wrong(*item.find("to"), fmt::format("the range of {} is empty", what));
    }
    return {};
  }

  Status read_example(const Value& item) {
    Status status = members_.only(item, "an example",
                                  {"name", "clip", "steps", "from", "to", "keys", "keytimes"});
    if (!status) return status;
    ExampleEntry entry;
    entry.place = place_of(item);
    entry.automatic = all_automatic_;
    const auto clip = members_.get(item, "an example", "clip", Kind::string);
    if (!clip) return clip.error();
    status = take(item, "an example", "clip", entry.clip);
    if (status) status = take(item, "an example", "name", entry.name);
    if (status) status = take(item, "an example", "keys", entry.keys);
    if (status) status = read_steps(item, "an example", entry.automatic);
    if (status) status = take_moment(item, "an example", "from", entry.from);
    if (status) status = take_moment(item, "an example", "to", entry.to);
    if (status) status = read_given_keytimes(item, entry);
    if (!status) return status;
    library_.examples.push_back(std::move(entry));
    return {};
  }

  Status read_given_keytimes(const Value& item, ExampleEntry& entry) const {
    const auto found = members_.find(item, "an example", "keytimes", Kind::object);
    if (!found) return found.error();
    if (*found == nullptr) return {};
    if (entry.automatic) {
      return members_.wrong(**found, "an example with \"steps\": \"auto\" cannot have keytimes",
                            "\"steps\": \"one\" makes the clip one example");
    }
    for (const Value::Member& member : (*found)->members) {
      const auto time = moment(member.value, "an example", member.key);
      if (!time) return time.error();
      entry.keytimes.push_back({member.key, *time});
    }
    return {};
  }

  std::string_view text_;
  const std::string& path_;
  json::Members members_;
  LibraryDescription library_;
  bool all_automatic_ = false;
};

}  // namespace

Result<LibraryDescription> read(std::string_view text, const std::string& path) {
  auto library = Reader(text, path).read();
  if (!library) return std::move(library).error().in_file(path);
  return library;
}

}  // namespace krok::library
