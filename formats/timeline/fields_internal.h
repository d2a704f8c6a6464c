#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/quantity.h"
#include "formats/json/members.h"

// Reads values of the objects in a timeline file.

namespace krok::timeline_file {

// A value with its key and a description of its object for messages, "the item 'walk'".
struct Field {
  const json::Value* value = nullptr;
  std::string_view key;
  std::string_view what;
};

class Fields {
 public:
  explicit Fields(std::string_view text) : in_(text, "timeline") {}

  const json::Members& members() const { return in_; }

  // Checks that `object` is an object without any other keys. The error suggests the nearest key.
  Status only(const json::Value& object, std::string_view what,
              std::initializer_list<std::string_view> keys) const;

  Error wrong(const Field& field, const std::string& expected, const std::string& hint = {}) const;

  // Numbers, or strings with units: time in seconds or frames, lengths in metres, angles in
  // radians (degrees if the file has no unit).
  Result<ClipTime> time(const Field& field) const;
  Result<double> length(const Field& field) const;
  Result<double> angle(const Field& field) const;
  Result<double> number(const Field& field) const;
  Result<int> whole(const Field& field, int low, int high) const;
  Result<bool> truth(const Field& field) const;
  // Seconds, >= 0. Frames are converted with `rate`, that of the result; 0 if it is not known.
  Result<double> duration(const Field& field, double rate) const;
  // Not empty, no control characters, at most 200 bytes.
  Result<std::string> name(const Field& field) const;

  // One of several words; the error suggests the nearest one.
  template <typename T>
  Result<T> choice(const Field& field, const std::vector<std::pair<std::string, T>>& words) const {
    std::vector<std::string> names;
    names.reserve(words.size());
    for (const auto& [word, value] : words) names.push_back(word);
    const auto index = word_index(field, names);
    if (!index) return index.error();
    return words[*index].second;
  }
  Result<std::size_t> word_index(const Field& field, const std::vector<std::string>& words) const;

  // Calls use(entry), which returns a Status, for each entry of an optional array.
  template <typename Use>
  Status each(const json::Value& object, std::string_view what, std::string_view key,
              const Use& use) const {
    const auto list = entries(object, what, key);
    if (!list) return list.error();
    if (*list == nullptr) return {};
    for (const json::Value& entry : (*list)->items) {
      if (Status status = use(entry); !status) return status;
    }
    return {};
  }

 private:
  Result<const json::Value*> entries(const json::Value& object, std::string_view what,
                                     std::string_view key) const;

  // A number, or a string with a unit.
  template <typename T, typename Parse, typename Make>
  Result<T> quantity(const Field& field, const Parse& parse, const Make& make) const;

  json::Members in_;
};

// Reads values of one object in turn, until the first error.
class Taker {
 public:
  // Both must outlive it.
  Taker(const json::Value& object, std::string_view what) : object_(object), what_(what) {}

  // target = read(field), if the key exists and there was no error before.
  template <typename Target, typename Read>
  Taker& operator()(std::string_view key, Target& target, const Read& read) {
    return check(key, [&](const Field& field) -> Status {
      auto found = read(field);
      if (!found) return std::move(found).error();
      target = std::move(*found);
      return {};
    });
  }

  // Calls use(field), which returns a Status, under the same conditions.
  template <typename Use>
  Taker& check(std::string_view key, const Use& use) {
    const json::Value* value = object_.find(key);
    if (value != nullptr && status_) status_ = use(Field{value, key, what_});
    return *this;
  }

  Status done() { return std::move(status_); }

 private:
  const json::Value& object_;
  std::string_view what_;
  Status status_;
};

}  // namespace krok::timeline_file
