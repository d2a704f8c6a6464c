#pragma once

#include <string_view>

// Options by the names that they had before version 0.2, or that one expects from other tools. They
// are refused with the name as hint; in a script, one idea then has one name in all tools.

namespace krok::cli {

struct RenamedOption {
  std::string_view tool, before, now;
};

inline constexpr RenamedOption kRenamedOptions[] = {
    {"krok-blend", "--align", "--match-root"},
    {"krok-blend", "--keys", "--contacts"},
    {"krok-diff", "--html", "--summary OUT.html"},
    {"krok-diff", "--joints", "--joint-tolerance"},
    {"krok-diff", "--junit", "--summary OUT.xml"},
    {"krok-diff", "--sides", "--view"},
    {"krok-diff", "--size", "--actor-size"},
    {"krok-edit", "--fps", "--rate"},
    {"krok-edit", "--ground", "--on-ground"},
    {"krok-edit", "--order", "--filter-order"},
    {"krok-edit", "--resample", "--rate"},
    {"krok-edit", "--speed", "--playback-speed"},
    {"krok-fit", "--plots", "--plot"},
    {"krok-fit", "--smooth", "--smoothing"},
    {"krok-fit", "--until", "--max-error"},
    {"krok-ik", "--margin", "--limit-margin"},
    {"krok-ik", "--method", "--solver"},
    {"krok-ik", "--write-limits", "--save-limits"},
    {"krok-import", "--cam", "--save-cam"},
    {"krok-import", "--character", "--save-character"},
    {"krok-import", "--model", "--save-model"},
    {"krok-import", "--morphs", "--save-morphs"},
    {"krok-import", "--resample", "--rate"},
    {"krok-keys", "--csv", "--table"},
    {"krok-keys", "--keys", "--contacts"},
    {"krok-keys", "--set", "--keytime"},
    {"krok-lint", "--csv", "--table"},
    {"krok-mix", "--keys", "--contacts"},
    {"krok-morph", "--by-order", "--match order"},
    {"krok-plot", "--keys", "--contacts"},
    {"krok-plot", "--sides", "--view"},
    {"krok-plot", "--size", "--actor-size"},
    {"krok-plot", "--table", "--as-table"},
    {"krok-render", "--fps", "--rate"},
    {"krok-render", "--sides", "--view"},
    {"krok-render", "--together", "--layout together"},
    {"krok-synth", "--duration", "--set duration=VALUE"},
    {"krok-synth", "--length", "--set length=VALUE"},
    {"krok-synth", "--table", "--points"},
    {"krok-synth", "--turn", "--set turn=VALUE"},
    {"krok-view", "--keys", "--contacts"},
    {"krok-walk", "--from", "--start"},
    {"krok-walk", "--to", "--goal"},
    {"krok-walk", "--view", "--save-page"},
};

}  // namespace krok::cli
