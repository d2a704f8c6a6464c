#pragma once

#include <span>
#include <vector>

#include "parametric/library.h"

// Whether the captures of a library are of several people or moods: what the parameters do not say
// of them.

namespace krok::parametric {

// Metres: the spread within groups that are found, if not more than 20 are needed.
inline constexpr double kAlikeSteps = 0.05;

struct StyleGroups {
  std::vector<int> of_example;  // [examples], from 0
  int count = 1;
  // Root mean square distance of joints from the mean step with the same parameters, metres: of
  // all, and within the groups. Fingers and end sites are left out.
  double spread = 0, within = 0;
};

// Groups captures whose steps are alike once what changes with the parameters is taken out, by a
// plane that all groups share. Ward's clustering of the captures' means (J. Am. Stat. Assoc. 58,
// 1963), planes and groups found in turn: as few groups as bring the spread within them under
// kAlikeSteps, at most 20. One group if there are fewer than two captures, or more than 1,000.
// `captures`: [examples], from 0. Captures of one person in one mood have a spread of 30 to 60 mm
// (seven moods of Bandai Namco 2, each with straight walks and bends: 33 to 62 mm), all seven
// together 66 mm.
// Codes: those of check(Library); parametric-groups if their number is not that of the examples.
Result<StyleGroups> group_styles(const Library& library, std::span<const int> captures);

}  // namespace krok::parametric
