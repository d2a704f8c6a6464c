#include "core/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace krok {

namespace {

constexpr std::size_t kMaxLetters = 64;

// Levenshtein distance, row by row, in which two letters in the wrong order are one mistake.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    row[0] = i + 1;
    for (std::size_t k = 0; k < b.size(); ++k) {
      row[k + 1] = std::min({last[k] + (a[i] == b[k] ? 0 : 1), last[k + 1] + 1, row[k] + 1});
      if (i > 0 && k > 0 && a[i] == b[k - 1] && a[i - 1] == b[k]) {
        row[k + 1] = std::min(row[k + 1], before[k - 1] + 1);
      }
    }
    before = last;
    last = row;
  }
  return last.back();
}

}  // namespace

std::string nearest_name(std::string_view word, std::span<const std::string> names) {
  const std::string wanted = ascii_lower(word.substr(0, kMaxLetters));
  const std::size_t dashes = wanted.starts_with("--") ? 2 : 0;
  std::string best;
  std::size_t least = 0;
  // One that has the whole word, or begins with it, is nearer than any with another letter: "hand"
  // is no head.
  constexpr std::size_t kWord = 4, kBeginning = 3;
  for (const std::string& name : names) {
    // "--max-influences" has more words than --influences.
    if (dashes > 0 && name.size() > dashes + kWord && wanted.ends_with(name.substr(1))) return name;
    const std::size_t found = ascii_lower(name).find(wanted);
    const std::size_t letters = found == 0 ? kBeginning : kWord;
    if (found == std::string::npos || wanted.size() < letters + dashes) continue;
    if (best.empty() || name.size() < best.size()) best = name;
  }
  if (!best.empty()) return best;
  // The same words in another order: "hand_left".
  const std::size_t under = wanted.rfind('_');
  for (const std::string& name : names) {
    if (under == std::string::npos || under == 0) break;
    if (name == wanted.substr(under + 1) + "_" + wanted.substr(0, under)) return name;
  }
  for (const std::string& name : names) {
    const std::string other = ascii_lower(std::string_view(name).substr(0, kMaxLetters));
    const std::size_t found = distance(wanted, other);
    const std::size_t longer = std::max(wanted.size(), other.size());
    // A third of the letters; of options, whose short words share many, without their dashes and
    // from the same first letter if more than one differs.
    const std::size_t near = std::max<std::size_t>(dashes > 0 ? 1 : 2, (longer - dashes) / 3);
    if (dashes > 0 && found > 1 && wanted[dashes] != other[dashes]) continue;
    const bool half = 2 * found + (found > 1 ? 1 : 0) > longer - dashes;
    if (found > near || half || (!best.empty() && found >= least)) continue;
    best = name;
    least = found;
  }
  return best;
}

std::string nearest_hint(std::string_view word, std::span<const std::string> names) {
  const std::string nearest = nearest_name(word, names);
  if (!nearest.empty()) return fmt::format("did you mean '{}'?", nearest);
  return fmt::format("expected one of {}", fmt::join(names, ", "));
}

}  // namespace krok
