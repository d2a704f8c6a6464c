#include "capture/unique_names.h"

#include <fmt/format.h>

namespace krok {

std::string UniqueNames::make(const std::string& name) {
  if (claim(name)) return name;
  int& number = numbers_.try_emplace(name, 1).first->second;
  for (;;) {
    std::string candidate = fmt::format("{}_{}", name, ++number);
    if (claim(candidate)) return candidate;
  }
}

}  // namespace krok
