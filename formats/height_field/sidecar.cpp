#include <fmt/format.h>

#include "core/quantity.h"
#include "formats/height_field/height_image.h"
#include "formats/json/members.h"

namespace krok::height_field {

namespace {

using json::Value;

constexpr std::string_view kSchema = "krok.ground/1";
constexpr std::string_view kTheFile = "the file";
constexpr std::size_t kLargestSidecar = std::size_t{64} << 10;

// Two lengths: numbers in metres, or strings with a unit.
Result<std::optional<std::array<double, 2>>> two_lengths(const json::Members& members,
                                                         const Value& object,
                                                         std::string_view key) {
  const auto list = members.find(object, kTheFile, key, Value::Kind::array);
  if (!list) return list.error();
  if (*list == nullptr) return std::optional<std::array<double, 2>>();
  std::array<double, 2> lengths{};
  if ((*list)->items.size() != 2) {
    return members.wrong(
        **list, fmt::format("\"{}\" has {} values, expected 2", key, (*list)->items.size()));
  }
  for (std::size_t i = 0; i < 2; ++i) {
    const Value& item = (*list)->items[i];
    if (item.kind == Value::Kind::number) {
      const auto number = members.within(item, fmt::format("\"{}\"", key), -1e6, 1e6);
      if (!number) return number.error();
      lengths[i] = *number;
      continue;
    }
    const auto length = parse_length(item.kind == Value::Kind::string ? item.text : "");
    if (!length) {
      return members.wrong(item, fmt::format("\"{}\" has a value that is no length", key),
                           "write metres, or a string such as \"20cm\"");
    }
    lengths[i] = *length;
  }
  return std::optional(lengths);
}

}  // namespace

Result<Placement> read_sidecar(std::string_view text) {
  const json::Members members(text, "ground");
  const auto root = json::parse(text, kLargestSidecar);
  if (!root) return root.error();
  Status status = members.only(*root, kTheFile, {"schema", "comment", "size", "range", "centre"});
  if (!status) return status.error();
  status = members.has_schema(*root, kTheFile, kSchema);
  if (!status) return status.error();
  const auto size = two_lengths(members, *root, "size");
  if (!size) return size.error();
  const auto range = two_lengths(members, *root, "range");
  if (!range) return range.error();
  const auto centre = two_lengths(members, *root, "centre");
  if (!centre) return centre.error();
  return Placement{*size, *range, *centre};
}

}  // namespace krok::height_field
