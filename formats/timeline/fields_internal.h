#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/quantity.h"
#include "formats/json/members.h"

// Takes values out of a timeline's objects.

namespace krok::timeline_file {

// A value with the words for what it is in, "the item 'walk'".
struct Field {
  const json::Value* value = nullptr;
  std::string_view key;
  std::string_view what;
};

class Fields {
 public:
  explicit Fields(std::string_view text) : in_(text, "timeline") {}

  const json::Members& members() const { return in_; }

  // Whether `object` is one, with none but these keys. A key that is nearly one of them is told.
  Status only(const json::Value& object, std::string_view what,
              std::initializer_list<std::string_view> keys) const;

  Error wrong(const Field& field, const std::string& expected, const std::string& hint = {}) const;

  // Numbers, or texts with units: seconds or frames, seconds, metres, degrees.
  Result<ClipTime> time(const Field& field) const;
  Result<double> length(const Field& field) const;
  Result<double> angle(const Field& field) const;
  Result<double> number(const Field& field) const;
  Result<int> whole(const Field& field, int low, int high) const;
  Result<bool> truth(const Field& field) const;
  // Seconds, 0 or more. Frames are those of the result, at `rate`; 0 where that is not known.
  Result<double> duration(const Field& field, double rate) const;
  // Not empty, no control characters, at most 200 bytes.
  Result<std::string> name(const Field& field) const;

  // One of several words; the nearest one is told where it is none.
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

  // The entries of a list, which may be left out, one by one: use(entry) gives a Status.
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

  // A number, or what a text with a unit stands for.
  template <typename T, typename Parse, typename Make>
  Result<T> quantity(const Field& field, const Parse& parse, const Make& make) const;

  json::Members in_;
};

// Takes values out of one object, one after the other, until one is wrong.
class Taker {
 public:
  // Both must outlive it.
  Taker(const json::Value& object, std::string_view what) : object_(object), what_(what) {}

  // Where the key is there and nothing was wrong before: target = read(field).
  template <typename Target, typename Read>
  Taker& operator()(std::string_view key, Target& target, const Read& read) {
    return check(key, [&](const Field& field) -> Status {
      auto found = read(field);
      if (!found) return std::move(found).error();
      target = std::move(*found);
      return {};
    });
  }

  // The same where the value is used in another way, which gives a Status.
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
