#include "formats/json/fields.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/path_inside.h"
#include "core/text.h"
#include "scene/clip.h"

namespace krok::json {

namespace {

template <typename... Arguments>
std::string filled(std::string_view pattern, const Arguments&... arguments) {
  return fmt::format(fmt::runtime(pattern), arguments...);
}

// The limits of a JSON Schema that are finite.
std::string limits(std::string_view type, double least, double most) {
  std::string schema = fmt::format("{{\"type\": \"{}\"", type);
  if (std::isfinite(least)) schema += fmt::format(", \"minimum\": {}", least);
  if (std::isfinite(most)) schema += fmt::format(", \"maximum\": {}", most);
  return schema + "}";
}

std::string counts(std::size_t least, std::size_t most) {
  std::string schema;
  if (least > 0) schema += fmt::format(", \"minItems\": {}", least);
  if (most < SIZE_MAX) schema += fmt::format(", \"maxItems\": {}", most);
  return schema;
}

Status within(const Given& given, double number, double least, double most) {
  if (number >= least && number <= most) return {};
  return given.wrong(fmt::format("{} is {}, expected {} to {}", given.name(), readable(number),
                                 readable(least), readable(most)));
}

// A quaternion or direction of length 1, of `count` numbers.
Result<std::vector<double>> unit(const Given& given, std::size_t count, double tolerance,
                                 const std::string& hint) {
  auto values = numbers(given, count);
  if (!values) return values;
  double squares = 0;
  for (const double value : *values) squares += value * value;
  const double length = std::sqrt(squares);
  if (std::abs(length - 1) < tolerance) return values;
  return given.wrong(fmt::format("{} has length {}, expected 1", given.name(), readable(length)),
                     hint);
}

// A value that a JSON Schema allows, with what it needs alone and "..." for words.
std::string example_of(const Value& schema, int levels = 5) {
  if (const Value* only = schema.find("const")) return in_quotes(only->text);
  if (const Value* words = schema.find("enum")) return in_quotes(words->items.front().text);
  const Value* type = schema.find("type");
  const Value* either = schema.find("oneOf");
  if (type == nullptr && either != nullptr) return example_of(either->items.front(), levels);
  if (type != nullptr && !type->items.empty()) type = &type->items.front();
  const std::string word = type == nullptr ? "" : type->text;
  std::vector<std::string> parts;
  if (const Value* each = schema.find("items"); each != nullptr && levels > 0) {
    const Value* min = schema.find("minItems");
    const double count = min == nullptr ? 1 : std::clamp(min->number, 1.0, 4.0);
    parts.assign(static_cast<std::size_t>(count), example_of(*each, levels - 1));
  }
  if (const Value* each = schema.find("prefixItems"); each != nullptr && levels > 0) {
    for (const Value& item : each->items) parts.push_back(example_of(item, levels - 1));
  }
  const Value* required = schema.find("required");
  if (const Value* fields = schema.find("properties"); fields != nullptr && levels > 0) {
    for (const Value::Member& field : fields->members) {
      const auto is_it = [&](const Value& one) { return one.text == field.key; };
      const bool needed = required == nullptr ? parts.empty() && field.key != "name"
                                              : std::ranges::any_of(required->items, is_it);
      if (needed)
        parts.push_back(in_quotes(field.key) + ": " + example_of(field.value, levels - 1));
    }
    if (required == nullptr && !parts.empty()) parts.emplace_back("...");
  }
  const std::string inside = parts.empty() ? "..." : fmt::format("{}", fmt::join(parts, ", "));
  if (word == "array") return "[" + inside + "]";
  if (word == "object") return "{" + inside + "}";
  return word == "number" || word == "integer" ? "1" : word == "boolean" ? "true" : "\"...\"";
}

// The hint of a value of another shape than a schema says, beside its key.
Error with_example(Error error, const Given& given, const std::string& schema) {
  const auto parsed = parse(schema);
  if (!parsed) return error;
  error.hint = fmt::format("write {}{}", given.key.empty() ? "" : in_quotes(given.key) + ": ",
                           example_of(*parsed));
  return error;
}

}  // namespace

std::string Given::name() const {
  return key.empty() ? std::string(what) : fmt::format("\"{}\" of {}", shown(key), what);
}

Given Given::member(std::string_view member) const {
  return {source, *value.find(member), member, what};
}

Location Given::where() const {
  return locate(without_byte_order_mark(source.text), offset, {});
}

Error Given::error(std::string_view code, std::string message, std::string hint) const {
  return error_at(source.text, offset, fmt::format("{}-{}", source.format, code),
                  std::move(message), std::move(hint));
}

Error Given::wrong(std::string message, std::string hint) const {
  return error("value", std::move(message), std::move(hint));
}

Error Given::structure(std::string message) const {
  return error("structure", std::move(message));
}

Status Given::is(Value::Kind kind) const {
  if (value.kind == kind) return {};
  return wrong(
      fmt::format("{} is {}, expected {}", name(), kind_name(value.kind), kind_name(kind)));
}

Kind<std::string> text() {
  return kind<std::string>("{\"type\": \"string\"}",
                           [](const Given& given, std::string& to) -> Status {
                             if (Status status = given.is(Value::Kind::string); !status) {
                               return status;
                             }
                             to = given.value.text;
                             return {};
                           })
      .written([](const std::string& from) { return in_quotes(from); });
}

Kind<std::string> plain_text(std::size_t most, std::string_view wrong, const std::string& hint) {
  Kind<std::string> made = text();
  made.schema = [most] {
    return most == SIZE_MAX
               ? std::string("{\"type\": \"string\", \"minLength\": 1}")
               : fmt::format("{{\"type\": \"string\", \"minLength\": 1, \"maxLength\": {}}}", most);
  };
  made.read = [read = made.read, most, pattern = std::string(wrong), hint](const Given& given,
                                                                           void* to) -> Status {
    if (Status status = read(given, to); !status) return status;
    const std::string& text = given.value.text;
    const bool plain = std::ranges::none_of(
        text, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
    if (!text.empty() && plain && text.size() <= most) return {};
    return given.wrong(filled(pattern, given.name(), shown(text)), hint);
  };
  return made;
}

Kind<std::string> name() {
  Kind<std::string> made = text();
  made.schema = [] {
    return fmt::format("{{\"type\": \"string\", \"minLength\": 1, \"maxLength\": {}}}",
                       kLongestName);
  };
  made.read = [read = made.read](const Given& given, void* to) -> Status {
    Status status = read(given, to);
    if (!status || is_name(given.value.text)) return status;
    return given.wrong(
        fmt::format("the name of {} is empty, longer than {} bytes or has a zero byte", given.what,
                    kLongestName));
  };
  return made;
}

Kind<bool> boolean() {
  return kind<bool>("{\"type\": \"boolean\"}",
                    [](const Given& given, bool& to) -> Status {
                      if (Status status = given.is(Value::Kind::boolean); !status) return status;
                      to = given.value.truth;
                      return {};
                    })
      .written([](bool from) { return std::string(from ? "true" : "false"); });
}

Kind<double> number(double least, double most) {
  return kind<double>(limits("number", least, most),
                      [=](const Given& given, double& to) -> Status {
                        if (Status status = given.is(Value::Kind::number); !status) return status;
                        to = given.value.number;
                        return within(given, to, least, most);
                      })
      .written([](double from) { return shortest(from); });
}

Kind<double> positive() {
  return kind<double>("{\"type\": \"number\", \"exclusiveMinimum\": 0}",
                      [](const Given& given, double& to) -> Status {
                        if (Status status = given.is(Value::Kind::number); !status) return status;
                        to = given.value.number;
                        if (to > 0 && std::isfinite(to)) return {};
                        return given.wrong(fmt::format("{} is {}, expected more than 0",
                                                       given.name(), readable(to)));
                      });
}

Kind<float> single(double least, double most) {
  return kind<float>(limits("number", least, most),
                     [of = number(least, most)](const Given& given, float& to) -> Status {
                       double value = 0;
                       Status status = of.read(given, &value);
                       to = static_cast<float>(value);
                       return status;
                     })
      .written([](float from) { return shortest(from); });
}  // NOLINT(clang-analyzer-cplusplus.NewDeleteLeaks): a std::function frees what it holds

Kind<int> whole(double least, double most, const std::string& expected) {
  return kind<int>(limits("integer", least, most),
                   [=](const Given& given, int& to) -> Status {
                     if (Status status = given.is(Value::Kind::number); !status) return status;
                     const double value = given.value.number;
                     if (!(value >= least && value <= most) || value != std::floor(value)) {
                       return given.wrong(fmt::format("{} is {}, expected {}", given.name(),
                                                      readable(value, 12), expected));
                     }
                     to = static_cast<int>(value);
                     return {};
                   })
      .written([](int from) { return fmt::format("{}", from); });
}

Kind<std::string> path(std::string_view expected) {
  return kind<std::string>(
             "{\"type\": \"string\", \"minLength\": 1}",
             [expected](const Given& given, std::string& to) -> Status {
               if (given.value.kind != Value::Kind::string) {
                 return given.wrong(fmt::format("{} is {}, expected {}", given.name(),
                                                kind_name(given.value.kind), expected));
               }
               to = given.value.text;
               const std::string fault = path_fault(to);
               if (fault.empty()) return {};
               return given.error("path",
                                  fmt::format("{}, '{}', {}", given.name(), shown(to), fault),
                                  "paths are relative to the file and must stay in its folder");
             })
      .written([](const std::string& from) { return in_quotes(from); });
}

Kind<double> moment(const std::optional<double>& rate, double latest) {
  return kind<double>(
      schema_of_either({limits("number", 0, latest),
                        "{\"description\": \"1.5s, 250ms or 45f\", \"type\": \"string\"}"}),
      [&rate, latest](const Given& given, double& to) -> Status {
        if (given.value.kind != Value::Kind::string) {
          if (Status status = given.is(Value::Kind::number); !status) return status;
          to = given.value.number;
          return within(given, to, 0, latest);
        }
        const auto parsed = parse_clip_time(given.value.text);
        if (!parsed) {
          return given.wrong(fmt::format("{}: {}", given.name(), parsed.error().message),
                             "write 1.5, \"1.5s\", \"250ms\" or \"120f\"");
        }
        if (parsed->in_frames && !rate) {
          return given.wrong(
              fmt::format("{} is in frames, but the file has no \"rate\"", given.name()));
        }
        to = parsed->seconds(rate.value_or(1));
        return within(given, to, 0, latest);
      });
}

Kind<double> quantity(Parser parse, std::string_view unit) {
  return kind<double>(
      fmt::format("{{\"description\": \"{}, or a string with a unit\", \"type\": [\"number\", "
                  "\"string\"]}}",
                  unit),
      [parse](const Given& given, double& to) -> Status {
        const Value& value = given.value;
        if (value.kind != Value::Kind::number && value.kind != Value::Kind::string) {
          return given.wrong(fmt::format("{} is {}, expected a number or a string with a unit",
                                         given.name(), kind_name(value.kind)));
        }
        const auto found =
            parse(value.kind == Value::Kind::number ? fmt::format("{}", value.number) : value.text);
        if (!found) {
          return given.wrong(fmt::format("{}: {}", given.name(), found.error().message),
                             found.error().hint);
        }
        to = *found;
        return {};
      });
}

Result<double> parse_seconds(std::string_view text) {
  const auto time = parse_clip_time(text);
  if (!time) return time.error();
  if (time->in_frames) return Error("quantity-unit", "the unit cannot be frames", "use s or ms");
  return time->value;
}

Result<std::vector<double>> numbers(const Given& given, std::size_t count, double most) {
  if (Status status = given.is(Value::Kind::array); !status) {
    return with_example(std::move(status).error(), given, schema_of_numbers(count));
  }
  std::vector<double> found;
  for (const Value& item : given.value.items) {
    if (item.kind != Value::Kind::number || !std::isfinite(item.number)) break;
    if (!(std::abs(item.number) <= most)) break;
    found.push_back(item.number);
  }
  if (found.size() == count && given.value.items.size() == count) return found;
  return given.wrong(fmt::format("{} must be {} numbers", given.name(), count));
}

Kind<Vec3> vector(double most) {
  return kind<Vec3>(schema_of_numbers(3),
                    [most](const Given& given, Vec3& to) -> Status {
                      const auto values = numbers(given, 3, most);
                      if (!values) return values.error();
                      to = Vec3((*values)[0], (*values)[1], (*values)[2]);
                      return {};
                    })
      .written([](const Vec3& from) { return list_text(from); });
}

Kind<Vec3> place(const double& metres, double most) {
  return kind<Vec3>(
      schema_of_numbers(3), [&metres, of = vector(most)](const Given& given, Vec3& to) -> Status {
        if (Status status = of.read(given, &to); !status) return status;
        to *= metres;
        if (to.cwiseAbs().maxCoeff() <= 1e6) return {};
        return given.wrong(fmt::format("{} is farther away than 1000 km", given.name()));
      });
}  // NOLINT(clang-analyzer-cplusplus.NewDeleteLeaks): the same

Kind<Vec3> direction() {
  return kind<Vec3>(schema_of_numbers(3),
                    [](const Given& given, Vec3& to) -> Status {
                      const auto values = unit(given, 3, 0.01, {});
                      if (!values) return values.error();
                      to = Vec3((*values)[0], (*values)[1], (*values)[2]);
                      // What is of length 1 stays bit for bit.
                      const double length = to.norm();
                      if (!(std::abs(length - 1) < 1e-14)) to /= length;
                      return {};
                    })
      .written([](const Vec3& from) { return list_text(from); });
}

Kind<Quat> rotation(double tolerance, double exact) {
  return kind<Quat>(schema_of_numbers(4),
                    [=](const Given& given, Quat& to) -> Status {
                      const auto values =
                          unit(given, 4, tolerance, "it is a unit quaternion: x, y, z, w");
                      if (!values) return values.error();
                      to = Quat((*values)[3], (*values)[0], (*values)[1], (*values)[2]);
                      if (!(std::abs(to.norm() - 1) < exact)) to.normalize();
                      return {};
                    })
      .written([](const Quat& from) { return list_text(from); });
}

Kind<double> frame_rate() {
  return number(kMinRate, kMaxRate);
}

Kind<double> checked_rate() {
  return kind<double>(limits("number", kMinRate, kMaxRate),
                      [](const Given& given, double& to) -> Status {
                        if (Status status = given.is(Value::Kind::number); !status) return status;
                        to = given.value.number;
                        const Status status = check_frame_rate(to, "rate");
                        return status ? Status() : given.wrong(status.error().message);
                      });
}

Status check_increase(const Given& item, double time, double before) {
  if (time > before) return {};
  return item.member("time").error(
      "time", fmt::format("{} is at {} s, not after the previous key at {} s", item.what,
                          readable(time, 9), readable(before, 9)));
}

std::string list_text(std::span<const std::string> items) {
  return fmt::format("[{}]", fmt::join(items, ", "));
}

std::string list_text(std::span<const double> numbers) {
  std::vector<std::string> texts;
  for (const double number : numbers) texts.push_back(shortest(number));
  return list_text(texts);
}

std::string list_text(const Vec3& vector) {
  return list_text(std::span(vector.data(), 3));
}

std::string list_text(const Quat& rotation) {
  return list_text(std::span(rotation.coeffs().data(), 4));
}

std::string schema_of_words(std::span<const std::string> words) {
  std::vector<std::string> texts;
  for (const std::string& word : words) texts.push_back(in_quotes(word));
  return fmt::format("{{\"enum\": {}}}", list_text(texts));
}

std::string schema_of_either(std::initializer_list<std::string> schemas) {
  return fmt::format("{{\"oneOf\": [{}]}}", fmt::join(schemas, ", "));
}

std::string schema_of_list(const std::string& item, std::size_t least, std::size_t most) {
  return fmt::format("{{\"type\": \"array\"{}, \"items\": {}}}", counts(least, most), item);
}

std::string schema_of_numbers(std::size_t count) {
  return schema_of_list("{\"type\": \"number\"}", count, count);
}

std::string schema_of_one(std::string_view key, std::string_view other) {
  return fmt::format("\"oneOf\": [{{\"required\": [\"{}\"]}}, {{\"required\": [\"{}\"]}}]", key,
                     other);
}

std::string schema_of_keyed(const std::string& item) {
  return fmt::format("{{\"type\": \"object\", \"additionalProperties\": {}}}", item);
}

Kind<std::size_t> word(std::vector<std::string> words, bool nearest) {
  return kind<std::size_t>(schema_of_words(words),
                           [words, nearest](const Given& given, std::size_t& to) -> Status {
                             if (Status status = given.is(Value::Kind::string); !status)
                               return status;
                             const auto found = std::ranges::find(words, given.value.text);
                             to = static_cast<std::size_t>(found - words.begin());
                             if (found != words.end()) return {};
                             return given.wrong(
                                 fmt::format("{} is '{}'", given.name(), shown(given.value.text)),
                                 nearest
                                     ? nearest_hint(given.value.text, words)
                                     : fmt::format("use {} or {}",
                                                   fmt::join(words.begin(), words.end() - 1, ", "),
                                                   words.back()));
                           })
      .written([words](std::size_t index) { return in_quotes(words[index]); });
}

Status read_list(const Given& given, const ListOf& list, const AnyKind& item,
                 const std::function<void*()>& add,
                 const std::function<Status(const Given& item)>& added) {
  if (Status status = given.is(Value::Kind::array); !status) {
    return with_example(std::move(status).error(), given,
                        schema_of_list(item.schema ? item.schema() : "{}", list.least, list.most));
  }
  const std::size_t count = given.value.items.size();
  if (count < list.least || count > list.most) {
    return given.wrong(filled(list.wrong, count, given.key, list.least, list.most, given.name()));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::string what = filled(list.each, i, given.what, given.key);
    const Given one{given.source, given.value.items[i], {}, what};
    Status status = item.read(one, add());
    if (status) status = added(one);
    if (!status) return status;
  }
  return {};
}

std::string write_list(const ListOf& list, std::span<const std::string> items) {
  if (!list.lines || items.empty()) return list_text(items);
  return fmt::format("[\n    {}\n  ]", fmt::join(items, ",\n    "));
}

Status read_keyed(const Given& given, const std::string& each, const AnyKind& item,
                  const std::function<Result<void*>(const Given& key)>& find) {
  if (Status status = given.is(Value::Kind::object); !status) return status;
  for (const Value::Member& member : given.value.members) {
    const std::string what = filled(each, shown(member.key), given.what, given.key);
    const auto to = find({given.source, member.value, member.key, given.what, member.key_offset});
    if (!to) return to.error();
    const Given value{given.source, member.value, {}, what};
    if (Status status = item.read(value, *to); !status) return status;
  }
  return {};
}

// Where a file goes that was given as one of another kind.
std::string home_of(std::string_view schema) {
  static constexpr std::pair<std::string_view, std::string_view> kHomes[] = {
      {"krok.alignment/1", "krok-retarget --alignment"},
      {"krok.camera-keys/1", "krok-cam"},
      {"krok.character/1", "krok-skin, instead of a model"},
      {"krok.correctives/1", "krok-skin --correctives"},
      {"krok.goals/1", "krok-ik --goals"},
      {"krok.key-shapes/1", "krok-morph frames"},
      {"krok.keys/1", "--contacts of tools, or beside its motion as NAME.keys.json"},
      {"krok.library/1", "krok-fit"},
      {"krok.limits/1", "krok-ik --limits"},
      {"krok.lint-baseline/1", "krok-lint --baseline"},
      {"krok.lint-profile/1", "krok-lint --profile"},
      {"krok.lint-suppressions/1", "krok-lint, beside a motion as NAME.lint.json"},
      {"krok.path/1", "krok-walk --path"},
      {"krok.prints/1", "krok-walk, and --prints"},
      {"krok.role-map/1", "--map"},
      {"krok.sequences/1", "krok-edit, and \"sequences\" of a timeline"},
      {"krok.timeline/1", "krok-mix"},
      {"krok.weights/1", "krok-skin --weights, and \"face\" of a timeline"}};
  const auto found =
      std::ranges::find(kHomes, schema, &std::pair<std::string_view, std::string_view>::first);
  return found == std::end(kHomes) ? "" : fmt::format("such files are for {}", found->second);
}

AnyKind schema_name(std::string_view name) {
  AnyKind made = kind<int>(
      fmt::format("{{\"const\": \"{}\"}}", name), [name](const Given& given, int&) -> Status {
        if (Status status = given.is(Value::Kind::string); !status) {
          return status;
        }
        if (given.value.text == name) return {};
        Error error = given.structure(
            fmt::format("the schema is '{}', expected {}", shown(given.value.text), name));
        error.hint = home_of(given.value.text);
        return error;
      });
  made.write = [name](const void*) { return in_quotes(name); };
  return made;
}

Table::Step& Table::add(std::string_view key, AnyKind kind, std::string_view says) {
  Step& step = steps_.emplace_back();
  step.key = key;
  step.kind = std::move(kind);
  step.says = says;
  return step;
}

Status Table::check_keys(const Given& object) const {
  if (object.value.kind != Value::Kind::object) {
    return with_example(object.structure(fmt::format("{} is {}, expected an object", object.what,
                                                     kind_name(object.value.kind))),
                        object, schema());
  }
  for (const Value::Member& member : object.value.members) {
    if (std::ranges::find(steps_, member.key, &Step::key) != steps_.end() && !member.key.empty()) {
      continue;
    }
    std::vector<std::string> known;
    for (const Step& step : steps_) {
      if (!step.key.empty()) known.emplace_back(step.key);
    }
    return Given{object.source, member.value, {}, {}, member.key_offset}.error(
        "structure", fmt::format("{} has an unknown key '{}'", object.what, shown(member.key)),
        nearest_hint(member.key, known));
  }
  return {};
}

bool Table::is_used(const Step& step, std::string_view word) {
  return step.with.empty() || std::ranges::find(step.words, word) != step.words.end();
}

Status Table::read_field(const Given& object, const Step& step, void* to) const {
  const Value* const value = object.value.find(step.key);
  const Value* const with = step.with.empty() ? nullptr : object.value.find(step.with);
  const std::string_view word = with == nullptr ? "" : std::string_view(with->text);
  if (value != nullptr && !is_used(step, word)) {
    return object.member(step.key).wrong(filled(unused_, object.what, step.key, word),
                                         unused_hint_);
  }
  if (value != nullptr) {
    return step.kind.read
               ? step.kind.read(object.member(step.key), step.access ? step.access(to, true) : to)
               : Status();
  }
  if (!step.required || !is_used(step, word)) return {};
  Error error = object.structure(fmt::format("{} is missing \"{}\"", object.what, step.key));
  if (step.key == "schema")
    error.hint = fmt::format("add \"schema\": {}", step.kind.write(nullptr));
  return error;
}

Status Table::read(const Given& given, void* to) const {
  std::string what = !what_.empty() ? what_ : given.name();
  Given object{given.source, given.value, {}, what};
  Status status;
  // A file of another kind says so before the first of its keys is unknown here.
  const auto schema = std::ranges::find(steps_, "schema", &Step::key);
  if (schema != steps_.end() && object.value.find("schema") != nullptr) {
    status = read_field(object, *schema, to);
  }
  if (status) status = check_keys(object);
  for (auto step = steps_.begin(); status && step != steps_.end(); ++step) {
    if (step->describe) {
      what = step->describe(to);
      object.what = what;
    } else {
      status = step->check ? step->check(object, to) : read_field(object, *step, to);
    }
  }
  return status;
}

Status Table::read_file(std::string_view text, std::string_view format, std::size_t largest,
                        void* to) const {
  const auto root = parse(text, largest);
  if (!root) return root.error();
  const Source source{text, format};
  return read({source, *root, {}, "the file"}, to);
}

std::string Table::write(const void* from) const {
  const std::string line = indent_ > 0 ? '\n' + std::string(indent_, ' ') : std::string();
  std::string text = "{" + line;
  std::vector<std::pair<std::string_view, std::string>> written;
  std::string separator;
  for (const Step& step : steps_) {
    if (!step.kind.write || (step.written && !step.written(from))) continue;
    std::string_view word;
    for (const auto& [key, value] : written) {
      if (key == step.with) word = std::string_view(value).substr(1, value.size() - 2);
    }
    if (!is_used(step, word)) continue;
    // Nothing is changed.
    const void* const value = step.access ? step.access(const_cast<void*>(from), false) : from;
    std::string value_text = value != nullptr ? step.kind.write(value) : std::string();
    if (value_text.empty()) continue;
    text += fmt::format("{}\"{}\": {}", separator, step.key, value_text);
    separator = indent_ > 0 ? "," + line : step.separator;
    written.emplace_back(step.key, std::move(value_text));
  }
  if (indent_ > 0) text += '\n' + std::string(indent_ - 2, ' ');
  return text + "}";
}

std::string Table::schema() const {
  std::vector<std::string> required, properties, rules;
  for (const Step& step : steps_) {
    if (step.key.empty()) continue;
    std::string schema = step.kind.schema ? step.kind.schema() : std::string("{}");
    if (!step.says.empty()) {
      const bool more = schema.size() > 2;
      schema.insert(1,
                    fmt::format("\"description\": {}{}", in_quotes(step.says), more ? ", " : ""));
    }
    properties.push_back(fmt::format("\"{}\": {}", step.key, schema));
    const std::string needed = fmt::format("{{\"required\": [\"{}\"]}}", step.key);
    if (step.with.empty()) {
      if (step.required) required.push_back(fmt::format("\"{}\"", step.key));
      continue;
    }
    // A schema of "properties" holds without the property, too.
    std::vector<std::string> words;
    for (const std::string_view word : step.words) {
      if (!word.empty()) words.emplace_back(word);
    }
    const bool by_default = words.size() < step.words.size();
    rules.push_back(
        fmt::format("{{\"if\": {{\"properties\": {{\"{}\": {}}}{}}}{}, \"else\": {{\"not\": {}}}}}",
                    step.with, schema_of_words(words),
                    by_default ? "" : fmt::format(", \"required\": [\"{}\"]", step.with),
                    step.required ? fmt::format(", \"then\": {}", needed) : "", needed));
  }
  std::string schema = "{";
  if (!title_.empty()) {
    schema += fmt::format(
        "\"$schema\": \"https://json-schema.org/draft/2020-12/schema\", \"title\": {}, ",
        in_quotes(title_));
  }
  schema += "\"type\": \"object\"";
  if (!required.empty()) schema += fmt::format(", \"required\": {}", list_text(required));
  schema += fmt::format(", \"additionalProperties\": false, \"properties\": {{{}}}",
                        fmt::join(properties, ", "));
  if (!rules.empty()) schema += fmt::format(", \"allOf\": {}", list_text(rules));
  return schema + more_ + "}";
}

}  // namespace krok::json
