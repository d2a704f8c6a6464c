#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/numbers.h"
#include "core/result.h"
#include "formats/registry/registry.h"
#include "math/transform.h"
#include "tools/cli/command_options.h"
#include "tools/cli/usage.h"

// Kinds of values for CommandOptions::add(). Messages quote the value.

namespace krok::cli {

// The numbers that an option takes. `above`: more than `low`.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool above = false;
};
inline constexpr Range kNotNegative = {.low = 0};
inline constexpr Range kPositive = {.low = 0, .above = true};

// Quantities, see core/numbers.h for their units; codes are those of there, and usage beyond the
// range.
ValueKind<double> length(Range metres = {});
ValueKind<double> length_with_unit(Range metres = {});
ValueKind<double> angle(Range degrees = {});  // radians; what looks like those needs a unit
ValueKind<double> seconds(Range seconds = kNotNegative);   // not in frames
ValueKind<ClipTime> clip_time(Range time = kNotNegative);  // seconds or frames
ValueKind<double> frequency(Range hertz = kPositive);
// A finite number; code usage. `unit` may follow it, where that is m/s also km/h.
ValueKind<double> number(Range range = {}, const std::string& unit = {});
// A frame rate in frames per second, from 0.001 to 1000000. Code usage.
ValueKind<double> rate();
// A decimal integer. Code usage.
ValueKind<long long> whole(long long low, long long high);

// Values separated by commas (or `between`): "1m,0,-20cm". `least` is how many there must be. Codes
// usage, and those of the quantities.
ValueKind<std::vector<double>> numbers(const std::vector<ValueKind<double>>& kinds,
                                       std::size_t least, char between = ',');
// The same for a T of fixed size, a Vec3 or a std::array; values that may be missing are 0.
template <typename T>
ValueKind<T> numbers_as(const std::vector<ValueKind<double>>& kinds, std::size_t least,
                        char between = ',') {
  const auto list = numbers(kinds, least, between);
  return {list.name,
          list.value_name,
          [read = list.read](const std::string& text) -> Result<T> {
            const auto values = read(text);
            if (!values) return values.error();
            T all{};
            for (std::size_t i = 0; i < static_cast<std::size_t>(all.size()); ++i) {
              all[static_cast<decltype(all.size())>(i)] = i < values->size() ? (*values)[i] : 0;
            }
            return all;
          },
          {}};
}
template <typename T>
ValueKind<T> lengths(char between = ',') {
  const std::size_t count = static_cast<std::size_t>(T{}.size());
  return numbers_as<T>(std::vector(count, length()), count, between);
}

// "1.5s" or "120f".
std::string written(const ClipTime& time);
// For a time beyond a clip that may be meant as a frame: "45f is frame 45", else nothing.
std::string frame_hint(const ClipTime& time, int frame_count);

// A file to write, of one of these extensions: ".svg". Code usage.
ValueKind<std::string> output(const std::vector<std::string>& endings);

// Hint which tool writes files with this ending, ".mp4"; empty if unknown.
std::string maker_of(const std::string& ending);

// "a, b or c".
std::string either_of(const std::vector<std::string>& words);

// "'dq' is not linear, dual-quaternion or rigid", and which is near.
std::string not_one_of(const std::string& text, const std::vector<std::string>& words);

// One of a list of words, case-sensitive; messages list them in this order.
template <typename T>
ValueKind<T> choice(std::vector<std::pair<std::string, T>> words) {
  std::vector<std::string> names;
  for (const auto& [word, value] : words) names.push_back(word);
  auto read = [words = std::move(words), names](const std::string& text) -> Result<T> {
    for (const auto& [word, value] : words) {
      if (text == word) return value;
    }
    return usage(not_one_of(text, names));
  };
  return {"choice", "WORD", std::move(read), std::move(names)};
}
// The same for the word itself, in any case.
ValueKind<std::string> words(const std::vector<std::string>& words);

// `word`, or a value of `kind`: read as none for the word, as by "auto|N".
template <typename T>
ValueKind<std::optional<T>> or_word(const std::string& word, const ValueKind<T>& kind) {
  return {kind.name,
          word + "|" + kind.value_name,
          [word, read = kind.read](const std::string& text) -> Result<std::optional<T>> {
            if (text == word) return std::optional<T>();
            auto value = read(text);
            if (!value) return std::move(value).error();
            return std::optional<T>(*std::move(value));
          },
          {}};
}

// Fails (code usage) if `path` has another extension than files of kind `written`; none is allowed.
// `option` is the option that gave the path, "-o".
Status check_output_kind(const std::string& path, const std::string& option,
                         registry::Kind written);

// The same as a kind of value.
ValueKind<std::string> output_of(registry::Kind written);

}  // namespace krok::cli
