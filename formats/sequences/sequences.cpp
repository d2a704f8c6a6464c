#include "formats/sequences/sequences.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/json/members.h"
#include "scene/frame_moment.h"

namespace krok::sequences {

namespace {

using json::Value;
using Kind = Value::Kind;

constexpr std::string_view kSchema = "krok.sequences/1";
constexpr std::size_t kLargestFile = std::size_t{1} << 20;
constexpr std::size_t kLongestName = 200;
constexpr double kLastFrame = 1e9;
constexpr std::size_t kMaxSequences = 10'000;

class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text), members_(text, "sequences") {}

  Result<SequenceFile> read() {
    const auto root = json::parse(text_, kLargestFile);
    if (!root) return root.error();
    if (Status status = members_.only(*root, "the file", {"schema", "rate", "sequences"});
        !status) {
      return status.error();
    }
    if (Status status = members_.has_schema(*root, "the file", kSchema); !status) {
      return status.error();
    }
    SequenceFile file;
    if (root->find("rate") != nullptr) {
      const auto rate = members_.get(*root, "the file", "rate", Kind::number);
      if (!rate) return rate.error();
      if (const Status status = check_frame_rate((*rate)->number, "rate"); !status) {
        return members_.wrong(**rate, status.error().message);
      }
      file.rate = (*rate)->number;
    }
    const auto list = members_.get(*root, "the file", "sequences", Kind::array);
    if (!list) return list.error();
    if ((*list)->items.size() > kMaxSequences) {
      return members_.wrong(**list, fmt::format("{} sequences, at most {} are allowed",
                                                (*list)->items.size(), kMaxSequences));
    }
    for (const Value& item : (*list)->items) {
      auto sequence = read_sequence(item, file);
      if (!sequence) return sequence.error();
      file.sequences.push_back(std::move(*sequence));
    }
    return file;
  }

 private:
  Result<double> positive(const Value& object, std::string_view what, std::string_view key) const {
    const auto value = members_.get(object, what, key, Kind::number);
    if (!value) return value.error();
    if (!((*value)->number > 0) || !std::isfinite((*value)->number)) {
      return members_.wrong(**value, fmt::format("\"{}\" of {} is {}, expected more than 0", key,
                                                 what, readable((*value)->number)));
    }
    return (*value)->number;
  }

  Result<int> frame(const Value& object, std::string_view what, std::string_view key) const {
    const auto value = members_.get(object, what, key, Kind::number);
    if (!value) return value.error();
    const double number = (*value)->number;
    if (!(number >= 0) || number > kLastFrame || number != std::floor(number)) {
      return members_.wrong(
          **value, fmt::format("\"{}\" of {} is {}, expected a frame (integer from 0)", key, what,
                               readable(number, 12)));
    }
    return static_cast<int>(number);
  }

  // Sequences become files, so the name must be a valid file name.
  Status check_name(const Value& name, const SequenceFile& file) const {
    const std::string& text = name.text;
    const bool plain = text.find_first_of("/\\") == std::string::npos && printable(text) == text;
    if (text.empty() || text == "." || text == ".." || !plain || text.size() > kLongestName) {
      return members_.wrong(
          name, fmt::format("'{}' is not a valid sequence name", shown(text)),
          fmt::format("use 1 to {} bytes, no slashes and no control characters", kLongestName));
    }
    if (file.find(text) != nullptr) {
      return members_.wrong(name, fmt::format("duplicate sequence name '{}'", shown(text)));
    }
    return {};
  }

  Result<Sequence> read_sequence(const Value& item, const SequenceFile& file) const {
    if (Status status =
            members_.only(item, "a sequence", {"name", "first", "last", "speed", "loop"});
        !status) {
      return status.error();
    }
    const auto name = members_.get(item, "a sequence", "name", Kind::string);
    if (!name) return name.error();
    if (Status status = check_name(**name, file); !status) return status.error();
    Sequence sequence;
    sequence.name = (*name)->text;
    const std::string what = fmt::format("'{}'", shown(sequence.name));
    const auto first = frame(item, what, "first");
    if (!first) return first.error();
    const auto last = frame(item, what, "last");
    if (!last) return last.error();
    if (*last < *first) {
      return members_.wrong(
          *item.find("last"),
          fmt::format("{} ends at frame {}, before it begins at frame {}", what, *last, *first));
    }
    sequence.first = *first;
    sequence.last = *last;
    if (item.find("speed") != nullptr) {
      const auto speed = positive(item, what, "speed");
      if (!speed) return speed.error();
      sequence.speed = *speed;
    }
    if (item.find("loop") != nullptr) {
      const auto loop = members_.get(item, what, "loop", Kind::boolean);
      if (!loop) return loop.error();
      sequence.loop = (*loop)->truth;
    }
    return sequence;
  }

  std::string_view text_;
  json::Members members_;
};

}  // namespace

const Sequence* SequenceFile::find(std::string_view name) const {
  const auto found = std::ranges::find(sequences, name, &Sequence::name);
  return found == sequences.end() ? nullptr : &*found;
}

Result<SequenceFile> read(std::string_view text) {
  return Reader(text).read();
}

}  // namespace krok::sequences
