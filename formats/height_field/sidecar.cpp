#include <fmt/format.h>

#include "formats/height_field/height_image.h"
#include "formats/json/fields.h"

namespace krok::height_field {

namespace {

using json::Given;
using JsonKind = json::Value::Kind;
using Lengths = std::array<double, 2>;

// Two lengths: numbers in metres, or strings with a unit.
Status read_lengths(const Given& given, Lengths& to) {
  if (Status status = given.is(JsonKind::array); !status) return status;
  const auto& items = given.value.items;
  if (items.size() != 2) {
    return given.wrong(fmt::format("\"{}\" has {} values, expected 2", given.key, items.size()));
  }
  const std::string what = fmt::format("\"{}\"", given.key);
  for (std::size_t i = 0; i < 2; ++i) {
    const Given item{given.source, items[i], {}, what};
    if (items[i].kind == JsonKind::number) {
      if (Status status = json::number(-1e6, 1e6).read(item, &to[i]); !status) return status;
      continue;
    }
    const auto length = parse_length(items[i].kind == JsonKind::string ? items[i].text : "");
    if (!length) {
      return item.wrong(fmt::format("{} has a value that is no length", what),
                        "write metres, or a string such as \"20cm\"");
    }
    to[i] = *length;
  }
  return {};
}

json::Object<Placement> table() {
  const auto lengths = json::kind<Lengths>(
      json::schema_of_list(json::quantity(parse_length, "metres").schema(), 2, 2), read_lengths);
  json::Object<Placement> file;
  file.file("krok.ground/1", "Place and size of a height image (krok.ground/1)").comment();
  file.field("size", &Placement::size, lengths, "along x and z");
  file.field("range", &Placement::range, lengths, "height of black and white");
  file.field("centre", &Placement::centre, lengths, "x and z");
  return file;
}

}  // namespace

Result<Placement> read_sidecar(std::string_view text) {
  return table().read_text(text, "ground", std::size_t{64} << 10);
}

std::string schema() {
  return table().schema();
}

}  // namespace krok::height_field
