#pragma once

#include <memory>
#include <string_view>

#include "core/result.h"
#include "terrain/terrain.h"

namespace krok::terrain {

// Ground from a short text: a kind, a colon and values separated by commas, in any order.
//   level[:height=10cm]
//   stairs[:rise=17cm,run=29cm,count=20,begin=1m]    rise below 0: down
//   slope:12deg, slope:20% (a grade), slope:angle=12deg[,begin=1m]    below 0: down
//   rough[:seed=1,height=8cm]
// Without a unit lengths are metres and angles degrees.
// Codes: ground-kind, ground-key, ground-value, with the nearest name or what is allowed.
Result<std::unique_ptr<Terrain>> from_spec(std::string_view spec);

// Whether the part of `text` before a colon is the name of a kind.
bool is_spec(std::string_view text);

// What from_spec() takes, in a line, for messages and help.
inline constexpr std::string_view kSpecForms =
    "level[:height=H], stairs[:rise=R,run=R,count=N,begin=Z], slope:ANGLE[,begin=Z], "
    "rough[:seed=N,height=H]";

}  // namespace krok::terrain
