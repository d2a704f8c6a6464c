#include "capture/unique_names.h"

#include <fmt/format.h>

#include "core/text.h"

namespace krok {

std::string UniqueNames::make(const std::string& name) {
  if (claim(name)) return name;
  int& number = numbers_.try_emplace(name, 1).first->second;
  for (;;) {
    std::string candidate = fmt::format("{}_{}", name, ++number);
    if (claim(candidate)) return candidate;
  }
}

std::string readable_joint_name(std::string_view bytes) {
  std::string name = to_utf8(bytes);
  for (char& c : name) {
    const auto code = static_cast<unsigned char>(c);
    if ((code < 32 && c != '\t') || code == 127) c = '_';
  }
  return name;
}

}  // namespace krok
