#include "tools/cli/alike_messages.h"

#include <fmt/format.h>

namespace krok::cli {

namespace {

// Max number of files whose messages of one code are printed.
constexpr std::size_t kShown = 3;

}  // namespace

bool AlikeMessages::is_shown(const std::string& code, const std::string& file) {
  if (code.empty()) return true;
  Said& said = by_code_[code];
  if (said.last != file) ++said.files;
  said.last = file;
  return said.files <= kShown;
}

std::string AlikeMessages::more() const {
  std::string text;
  for (const auto& [code, said] : by_code_) {
    if (said.files <= kShown) continue;
    const std::size_t more = said.files - kShown;
    text += fmt::format("  {} more {} such messages; -v and --json have all [{}]\n", more,
                        more == 1 ? "file has" : "files have", code);
  }
  return text;
}

}  // namespace krok::cli
