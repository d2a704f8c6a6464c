#pragma once

#include <cmath>
#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/numbers.h"
#include "core/result.h"
#include "formats/json/located_json.h"
#include "math/transform.h"

// Field tables: one declaration of the fields of an object gives its reader, its writer and its
// JSON Schema.
//
//   json::Object<Fade> fade("a fade");
//   fade.field("duration", &Fade::duration, json::number(0, 10), "seconds").required();
//   fade.field("smooth", &Fade::smooth, json::boolean());
//
// Fields are read and checked in the order of the table, which stops at the first error. Errors
// name the object and the key, and have line and column and the codes FORMAT-structure (not an
// object, a member that is missing or not known), FORMAT-value and those of the format.

namespace krok::json {

// A file that is read.
struct Source {
  std::string_view text;    // the argument of parse()
  std::string_view format;  // begins the codes of errors: "limits"
};

// A value that is read: the member `key` of the object `what` ("goal 3"), or `what` itself if the
// key is empty.
struct Given {
  const Source& source;
  const Value& value;
  std::string_view key, what;
  std::size_t offset = value.offset;  // where errors are reported

  std::string name() const;  // "\"to\" of goal 3"
  bool has(std::string_view member) const { return value.find(member) != nullptr; }
  Given member(std::string_view member) const;  // one that it has
  Given as(std::string_view named) const { return {source, value, {}, named}; }
  Location where() const;  // without the file's name

  // Errors with the codes FORMAT-kind, FORMAT-value and FORMAT-structure.
  Error error(std::string_view kind, std::string message, std::string hint = {}) const;
  Error wrong(std::string message, std::string hint = {}) const;
  Error structure(std::string message) const;
  Status is(Value::Kind kind) const;
};

// How values of a type are read, written as JSON, and described as a JSON Schema. `write` may be
// missing; what it leaves empty is not written.
struct AnyKind {
  std::function<Status(const Given&, void* to)> read;
  std::function<std::string(const void* from)> write;
  std::function<std::string()> schema;
};

template <typename T>
struct Kind : AnyKind {
  // The same with another writer: std::string(const T&).
  template <typename Write>
  Kind written(Write write_value) && {
    write = [write_value](const void* from) -> std::string {
      return write_value(*static_cast<const T*>(from));
    };
    return std::move(*this);
  }
};

// A kind with a reader of its own: Status(const Given&, T& to).
template <typename T, typename Read>
Kind<T> kind(std::string schema, Read read) {
  Kind<T> made;
  made.read = [read](const Given& given, void* to) -> Status {
    return read(given, *static_cast<T*>(to));
  };
  made.schema = [text = std::move(schema)] { return text; };
  return made;
}

Kind<std::string> text();
Kind<std::string> plain_text(std::size_t most, std::string_view wrong,
                             const std::string& hint = {});
// One that is_name() accepts, of what the object describes.
Kind<std::string> name();
Kind<bool> boolean();
Kind<double> number(double least, double most);
// More than 0.
Kind<double> positive();
Kind<float> single(double least, double most);
// An integer; `expected` is for the message about others.
Kind<int> whole(double least, double most, const std::string& expected);
// Frames per second; checked_rate() with the message of check_frame_rate().
Kind<double> frame_rate();
Kind<double> checked_rate();
// A path inside the file's folder. `expected` is for the message about other values.
Kind<std::string> path(std::string_view expected = "a string");
// A time from 0: seconds, or a string such as "250ms", or "120f" if there is a rate.
Kind<double> moment(const std::optional<double>& rate, double latest);
// A number in the default unit of `parse`, or a string with a unit. `unit` is for the schema.
using Parser = Result<double> (*)(std::string_view);
Kind<double> quantity(Parser parse, std::string_view unit);
// Seconds, for quantity().
Result<double> parse_seconds(std::string_view text);

// x, y, z, each within +-most.
Kind<Vec3> vector(double most = HUGE_VAL);
// The same in units of `metres`, at most 1000 km.
Kind<Vec3> place(const double& metres, double most = HUGE_VAL);
// Of length 1 within 0.01, normalised.
Kind<Vec3> direction();
// A unit quaternion x, y, z, w: of length 1 within `tolerance`, normalised unless it is so within
// `exact`.
Kind<Quat> rotation(double tolerance = 0.01, double exact = 1e-14);
// `count` finite numbers that are the value of `given`.
Result<std::vector<double>> numbers(const Given& given, std::size_t count, double most = HUGE_VAL);

// "[1, 2, 3]"
std::string list_text(std::span<const std::string> items);
std::string list_text(std::span<const double> numbers);
std::string list_text(const Vec3& vector);
std::string list_text(const Quat& rotation);  // x, y, z, w

// For list(): whether the `time` of an item is after that of the item before it.
Status check_increase(const Given& item, double time, double before);
template <typename T>
Status times_increase(const Given& item, const std::vector<T>& items) {
  const std::size_t n = items.size();
  return n < 2 ? Status() : check_increase(item, items[n - 1].time, items[n - 2].time);
}

// JSON Schemas.
std::string schema_of_words(std::span<const std::string> words);
std::string schema_of_either(std::initializer_list<std::string> schemas);
std::string schema_of_list(const std::string& item, std::size_t least, std::size_t most);
std::string schema_of_numbers(std::size_t count);
std::string schema_of_one(std::string_view key, std::string_view other);  // for Object::also()

// One of several words; reads its index. `nearest`: the hint names the word that is near.
Kind<std::size_t> word(std::vector<std::string> words, bool nearest = false);

template <typename T>
Kind<T> choice(std::vector<std::pair<std::string, T>> words, bool nearest = false) {
  std::vector<std::string> names;
  std::vector<T> values;
  for (auto& [name, value] : words) {
    names.push_back(name);
    values.push_back(value);
  }
  Kind<std::size_t> index = word(std::move(names), nearest);
  Kind<T> made;
  made.read = [values, read = index.read](const Given& given, void* to) -> Status {
    std::size_t i = 0;
    if (Status status = read(given, &i); !status) return status;
    *static_cast<T*>(to) = values[i];
    return {};
  };
  made.write = [values, write = index.write](const void* from) -> std::string {
    std::size_t i = 0;
    while (i + 1 < values.size() && !(values[i] == *static_cast<const T*>(from))) ++i;
    return write(&i);
  };
  made.schema = index.schema;
  return made;
}

// A list of items, described by `each`, of {0} the index, {1} what has the list and {2} its key.
struct ListOf {
  std::string each;
  std::size_t least = 0, most = SIZE_MAX;
  // The message for other counts, of {0} the count, {1} the key, {2} least, {3} most, {4} the name.
  std::string wrong = "{0} {1}, expected {2} to {3}";
  bool lines = false;  // whether each item is written on a line of its own
};
Status read_list(const Given& given, const ListOf& list, const AnyKind& item,
                 const std::function<void*()>& add,
                 const std::function<Status(const Given& item)>& added);
std::string write_list(const ListOf& list, std::span<const std::string> items);

// `added`, Status(const Given& item, std::vector<T>& items), is called after each item.
template <typename T>
Kind<std::vector<T>> list(
    Kind<T> item, ListOf of,
    std::function<Status(const Given& item, std::vector<T>& items)> added = {}) {
  Kind<std::vector<T>> made;
  made.read = [item, of, added](const Given& given, void* to) -> Status {
    auto& items = *static_cast<std::vector<T>*>(to);
    return read_list(
        given, of, item, [&]() -> void* { return &items.emplace_back(); },
        [&](const Given& one) { return added ? added(one, items) : Status(); });
  };
  made.write = [item, of](const void* from) -> std::string {
    std::vector<std::string> texts;
    for (const T& one : *static_cast<const std::vector<T>*>(from))
      texts.push_back(item.write(&one));
    return write_list(of, texts);
  };
  made.schema = [item, of] { return schema_of_list(item.schema(), of.least, of.most); };
  return made;
}

// An object with any keys. `find`, Result<Item*>(const Given& key, Container&), gives where the
// value of a key is read to; its errors are reported at the key. `each` is of {0} the key, {1} the
// name of the object and {2} its key.
Status read_keyed(const Given& given, const std::string& each, const AnyKind& item,
                  const std::function<Result<void*>(const Given& key)>& find);
std::string schema_of_keyed(const std::string& item);

template <typename Container, typename Item, typename Find>
Kind<Container> keyed(Kind<Item> item, std::string each, Find find) {
  Kind<Container> made;
  made.read = [item, each, find](const Given& given, void* to) -> Status {
    return read_keyed(given, each, item, [&](const Given& key) -> Result<void*> {
      const Result<Item*> found = find(key, *static_cast<Container*>(to));
      if (!found) return found.error();
      return static_cast<void*>(*found);
    });
  };
  made.schema = [item] { return schema_of_keyed(item.schema()); };
  return made;
}

// The fields of an object, whatever its type.
class Table {
 public:
  explicit Table(std::string what) : what_(std::move(what)) {}

  Status read(const Given& given, void* to) const;
  Status read_file(std::string_view text, std::string_view format, std::size_t largest,
                   void* to) const;
  std::string write(const void* from) const;
  std::string schema() const;

 protected:
  // A field; without a key, a check, or another description of the object.
  struct Step {
    std::string_view key, says;
    bool required = false;
    std::string_view with;  // used only where this member is one of `words`; "" is none
    std::vector<std::string_view> words;
    std::string separator = ", ";  // written before the next field
    AnyKind kind;
    std::function<void*(void* of, bool reading)> access;
    std::function<Status(const Given& object, void* of)> check;
    std::function<std::string(const void* of)> describe;
    std::function<bool(const void* of)> written;
  };

  Step& add(std::string_view key, AnyKind kind, std::string_view says);

  std::string what_;  // empty: what the value is given as
  std::string title_, more_;
  std::string unused_ = "{0} has \"{1}\", which its kind does not use", unused_hint_;
  std::size_t indent_ = 0;  // written: of each field on a line of its own; 0: one line
  std::vector<Step> steps_;

 private:
  Status check_keys(const Given& object) const;
  Status read_field(const Given& object, const Step& step, void* to) const;
  static bool is_used(const Step& step, std::string_view word);
};

template <typename T>
class Object : public Table {
 public:
  // `what` describes it in messages; empty: what it is a member of, or its list, do.
  explicit Object(std::string what = {}) : Table(std::move(what)) {}

  Result<T> read_text(std::string_view text, std::string_view format,
                      std::size_t largest = std::size_t{16} << 20) const {
    T made{};
    if (Status status = read_file(text, format, largest, &made); !status) return status.error();
    return made;
  }

  // A field: `access` is a pointer to a member, optional or not, or a function T& -> U&.
  template <typename Access, typename U>
  Object& field(std::string_view key, Access access, Kind<U> kind, std::string_view says = {}) {
    add(key, std::move(kind), says).access = [access](void* of, bool reading) -> void* {
      auto& target = std::invoke(access, *static_cast<T*>(of));
      using Target = std::remove_cvref_t<decltype(target)>;
      if constexpr (std::is_same_v<Target, std::optional<U>>) {
        if (reading) return &target.emplace();
        return target ? &*target : nullptr;
      } else {
        static_assert(std::is_same_v<Target, U>);
        return &target;
      }
    };
    return *this;
  }
  // A field that is read to and written from the whole object.
  Object& field(std::string_view key, Kind<T> kind, std::string_view says = {}) {
    add(key, std::move(kind), says);
    return *this;
  }
  // A field that is read to `value`, which must outlive this.
  template <typename U>
  Object& context(std::string_view key, U& value, Kind<std::type_identity_t<U>> kind,
                  std::string_view says = {}) {
    return field(
        key, [&value](T&) -> U& { return value; }, std::move(kind), says);
  }
  template <typename U>
  Object& context(std::string_view key, std::optional<U>& value, Kind<std::type_identity_t<U>> kind,
                  std::string_view says = {}) {
    return field(
        key, [&value](T&) -> std::optional<U>& { return value; }, std::move(kind), says);
  }
  // Members "schema", which must be `name`, and "comment", of any value.
  Object& file(std::string_view name, std::string_view title);
  Object& comment() {
    add("comment", {}, "anything");
    return *this;
  }

  // Of the field before.
  Object& required() { return last().required = true, *this; }
  Object& with(std::string_view key, std::initializer_list<std::string_view> words) {
    last().with = key;
    last().words = words;
    return *this;
  }
  // The next field is written on another line.
  Object& line(std::size_t indent) {
    last().separator = ",\n" + std::string(indent, ' ');
    return *this;
  }
  // Written only if condition(object).
  template <typename Condition>
  Object& written_if(Condition condition) {
    last().written = [condition](const void* of) -> bool {
      return std::invoke(condition, *static_cast<const T*>(of));
    };
    return *this;
  }

  // Status(const Given& object, T&), after the fields before.
  template <typename Check>
  Object& check(Check checks) {
    add({}, {}, {}).check = [checks](const Given& given, void* of) -> Status {
      return checks(given, *static_cast<T*>(of));
    };
    return *this;
  }
  // From here on messages describe the object as describe(const T&).
  template <typename Describe>
  Object& described(Describe describe) {
    add({}, {}, {}).describe = [describe](const void* of) -> std::string {
      return describe(*static_cast<const T*>(of));
    };
    return *this;
  }

  // Of all fields. The message for a field that is not used: of {0} the object, {1} the key and {2}
  // the word that excludes it.
  Object& unused(const std::string& message, const std::string& hint = {}) {
    unused_ = message;
    unused_hint_ = hint;
    return *this;
  }
  Object& lines(std::size_t indent) { return indent_ = indent, *this; }
  // Members of the JSON Schema for what no field says.
  Object& also(std::string schema) { return more_ += ", " + std::move(schema), *this; }

 private:
  Step& last() { return steps_.back(); }
};

AnyKind schema_name(std::string_view name);

template <typename T>
Object<T>& Object<T>::file(std::string_view name, std::string_view title) {
  title_ = title;
  add("schema", schema_name(name), {}).required = true;
  return *this;
}

// An object as the value of a field or the item of a list.
template <typename T>
Kind<T> object(Object<T> table) {
  Kind<T> made;
  made.read = [table](const Given& given, void* to) { return table.read(given, to); };
  made.write = [table](const void* from) { return table.write(from); };
  made.schema = [table = std::move(table)] { return table.schema(); };
  return made;
}

}  // namespace krok::json
