#include "tools/krok-render/frame_names.h"

#include <fmt/format.h>

#include "tools/cli/usage.h"

namespace krok::cli::film {

Result<FrameNames> FrameNames::parse(const std::string& pattern) {
  const auto refused = [&pattern] {
    return usage(fmt::format("-o {}: a file per frame needs a number in its name", pattern),
                 "such as 'frame_%04d.png'; or write .mp4, .gif or .webp");
  };
  const std::size_t begin = pattern.find('%');
  if (begin == std::string::npos || pattern.find('%', begin + 1) != std::string::npos) {
    return refused();
  }
  std::size_t end = begin + 1;
  FrameNames names;
  if (end < pattern.size() && pattern[end] == '0') ++end;
  int digits = 0;
  for (; end < pattern.size() && pattern[end] >= '0' && pattern[end] <= '9'; ++end) {
    digits = 10 * digits + (pattern[end] - '0');
    if (digits > 9) return refused();
  }
  if (end >= pattern.size() || pattern[end] != 'd') return refused();
  if (digits > 0) names.digits_ = digits;
  names.before_ = pattern.substr(0, begin);
  names.after_ = pattern.substr(end + 1);
  return names;
}

std::string FrameNames::of(int frame) const {
  return fmt::format("{}{:0{}}{}", before_, frame, digits_, after_);
}

}  // namespace krok::cli::film
