#include "formats/sequences/sequences.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "formats/json/fields.h"
#include "scene/clip.h"

namespace krok::sequences {

namespace {

using json::Given;

constexpr std::size_t kLargestFile = std::size_t{1} << 20;
constexpr std::size_t kLongestName = 200;

// Sequences become files, so the name must be a valid file name.
Status check_name(const Given& sequence, Sequence& of) {
  const std::string& text = of.name;
  const bool plain = text.find_first_of("/\\") == std::string::npos && printable(text) == text;
  if (!text.empty() && text != "." && text != ".." && plain && text.size() <= kLongestName) {
    return {};
  }
  return sequence.member("name").wrong(
      fmt::format("'{}' is not a valid sequence name", shown(text)),
      fmt::format("use 1 to {} bytes, no slashes and no control characters", kLongestName));
}

Status check_frames(const Given& sequence, Sequence& of) {
  if (of.last >= of.first) return {};
  return sequence.member("last").wrong(fmt::format(
      "{} ends at frame {}, before it begins at frame {}", sequence.what, of.last, of.first));
}

Status check_unique(const Given& sequence, std::vector<Sequence>& all) {
  const auto first = std::ranges::find(all, all.back().name, &Sequence::name);
  if (first == all.end() - 1) return {};
  return sequence.member("name").wrong(
      fmt::format("duplicate sequence name '{}'", shown(first->name)));
}

json::Object<SequenceFile> table() {
  json::Object<Sequence> sequence;
  const auto frame = json::whole(0, 1e9, "a frame (integer from 0)");
  sequence.field("name", &Sequence::name, json::text()).required().check(check_name);
  sequence.described([](const Sequence& of) { return fmt::format("'{}'", shown(of.name)); });
  sequence.field("first", &Sequence::first, frame).required();
  sequence.field("last", &Sequence::last, frame, "inclusive").required().check(check_frames);
  sequence.field("speed", &Sequence::speed, json::positive());
  sequence.field("loop", &Sequence::loop, json::boolean());
  json::Object<SequenceFile> file;
  file.file("krok.sequences/1", "Named parts of a motion (krok.sequences/1)");
  file.field("rate", &SequenceFile::rate, json::checked_rate(), "frames per second");
  file.field("sequences", &SequenceFile::sequences,
             json::list<Sequence>(
                 json::object(sequence),
                 {"a sequence", 0, 10'000, "{0} sequences, at most {3} are allowed"}, check_unique))
      .required();
  return file;
}

}  // namespace

const Sequence* SequenceFile::find(std::string_view name) const {
  const auto found = std::ranges::find(sequences, name, &Sequence::name);
  return found == sequences.end() ? nullptr : &*found;
}

Result<SequenceFile> read(std::string_view text) {
  return table().read_text(text, "sequences", kLargestFile);
}

std::string schema() {
  return table().schema();
}

}  // namespace krok::sequences
