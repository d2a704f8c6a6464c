#include <fmt/format.h>

#include <algorithm>

#include "formats/prints/prints.h"
#include "math/types.h"

namespace krok::prints {

namespace {

// Up to six decimals, without trailing zeros or negative zero.
std::string six_decimals(double value) {
  std::string text = fmt::format("{:.6f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string degrees(const gait::Print& print) {
  return six_decimals(print.heading / kRadiansPerDegree);
}

}  // namespace

Status write_csv(std::span<const gait::Print> prints, OutputFile& file) {
  const bool heights = std::ranges::any_of(prints, [](const auto& one) { return !!one.height; });
  const bool times = std::ranges::any_of(prints, [](const auto& one) { return !!one.time; });
  std::string text = "side,x [m],z [m],heading [deg]";
  if (heights) text += ",height [m]";
  if (times) text += ",time [s]";
  text += '\n';
  for (const gait::Print& print : prints) {
    text += fmt::format("{},{},{},{}", name_of(print.side), six_decimals(print.x),
                        six_decimals(print.z), degrees(print));
    if (heights) text += ',' + (print.height ? six_decimals(*print.height) : std::string());
    if (times) text += ',' + (print.time ? six_decimals(*print.time) : std::string());
    text += '\n';
  }
  return file.write(text);
}

Status write_json(std::span<const gait::Print> prints, OutputFile& file) {
  std::string text = "{\n  \"schema\": \"krok.prints/1\",\n  \"prints\": [";
  const char* between = "\n";
  for (const gait::Print& print : prints) {
    text += fmt::format("{}    {{\"side\": \"{}\", \"x\": {}, \"z\": {}, \"heading\": {}", between,
                        name_of(print.side), six_decimals(print.x), six_decimals(print.z),
                        degrees(print));
    if (print.height) text += ", \"height\": " + six_decimals(*print.height);
    if (print.time) text += ", \"time\": " + six_decimals(*print.time);
    text += '}';
    between = ",\n";
  }
  text += prints.empty() ? "]\n}\n" : "\n  ]\n}\n";
  return file.write(text);
}

}  // namespace krok::prints
