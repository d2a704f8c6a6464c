#pragma once

#include <string>
#include <string_view>

// Options by the names that they had before version 0.2, or that one expects from other tools. They
// are refused with the name as hint; in a script, one idea then has one name in all tools.

namespace krok::cli {

struct RenamedOption {
  std::string_view tool, before, now;  // no tool: any
};

inline constexpr RenamedOption kRenamedOptions[] = {
    // Of any tool; options only where the tool has them.
    {"", "--fps", "--rate"},
    {"", "--format", "-o with that ending"},
    {"", "--input", "inputs without an option"},
    {"", "--out", "-o"},
    {"", "--out-folder", "--out-dir"},
    {"", "--outdir", "--out-dir"},
    {"", "--output-dir", "--out-dir"},
    {"", "--output-folder", "--out-dir"},
    {"", "--overwrite", "-o alone: files are replaced, unless --no-clobber is given"},
    {"", "--recursive", "a folder: its sub-folders are read, too"},
    {"", "--threads", "--jobs"},
    {"", "--workers", "--jobs"},
    {"krok-blend", "--align", "--match-root"},
    {"krok-blend", "--keys", "--contacts"},
    {"krok-cam", "--joint", "--follow"},
    {"krok-cam", "--target", "--follow"},
    {"krok-cam", "--zoom", "--lens MM, --fov or --distance"},
    {"krok-diff", "-o", "--summary OUT.html, OUT.xml (JUnit) or OUT.md"},
    {"krok-diff", "--epsilon", "--tolerance"},
    {"krok-diff", "--ignore", "--exclude"},
    {"krok-diff", "--html", "--summary OUT.html"},
    {"krok-diff", "--joints", "--joint-tolerance"},
    {"krok-diff", "--junit", "--summary OUT.xml"},
    {"krok-diff", "--output", "--summary OUT.html, OUT.xml (JUnit) or OUT.md"},
    {"krok-diff", "--report", "--summary OUT.html"},
    {"krok-diff", "--sides", "--view"},
    {"krok-diff", "--size", "--actor-size"},
    {"krok-diff", "--threshold", "--tolerance"},
    {"krok-diff", "--xml", "--summary OUT.xml"},
    {"krok-edit", "--crop", "--from TIME --to TIME"},
    {"krok-edit", "--cut", "--from TIME --to TIME"},
    {"krok-edit", "--end", "--to"},
    {"krok-edit", "--flip", "--mirror"},
    {"krok-edit", "--fps", "--rate"},
    {"krok-edit", "--lowpass", "--filter butterworth --cutoff 6Hz"},
    {"krok-edit", "--order", "--filter-order"},
    {"krok-edit", "--resample", "--rate"},
    {"krok-edit", "--rotate", "--turn"},
    {"krok-edit", "--smooth", "--filter auto"},
    {"krok-edit", "--speed", "--playback-speed"},
    {"krok-edit", "--start", "--from"},
    {"krok-edit", "--translate", "--move"},
    {"krok-edit", "--trim", "--from TIME --to TIME"},
    {"krok-export", "--angles", "--what angles"},
    {"krok-fit", "--plots", "--plot"},
    {"krok-fit", "--smooth", "--smoothing"},
    {"krok-fit", "--until", "--max-error"},
    {"krok-ik", "--look", "--look-at"},
    {"krok-ik", "--margin", "--limit-margin"},
    {"krok-ik", "--method", "--solver"},
    {"krok-ik", "--target", "--reach"},
    {"krok-ik", "--write-limits", "--save-limits"},
    {"krok-import", "--cam", "--save-cam"},
    {"krok-import", "--character", "--save-character"},
    {"krok-import", "--forward-axis", "--forward"},
    {"krok-import", "--model", "--save-model"},
    {"krok-import", "--morphs", "--save-morphs"},
    {"krok-import", "--resample", "--rate"},
    {"krok-import", "--scale", "--unit: m, cm, mm, in or ft"},
    {"krok-import", "--units", "--unit"},
    {"krok-import", "--up-axis", "--up"},
    {"krok-keys", "--csv", "--table"},
    {"krok-keys", "--gait", "--table"},
    {"krok-keys", "--keys", "--contacts"},
    {"krok-keys", "--set", "--keytime"},
    {"krok-lint", "-o", "--html OUT.html, --table OUT.csv or --junit OUT.xml"},
    {"krok-lint", "--csv", "--table"},
    {"krok-lint", "--report", "--html"},
    {"krok-mix", "--keys", "--contacts"},
    {"krok-morph", "--by-order", "--match order"},
    {"krok-plot", "--angles", "--show angles"},
    {"krok-plot", "--contact-sheet", "--sheet"},
    {"krok-plot", "--cycles", "--show cycles"},
    {"krok-plot", "--gait", "--show cycles; krok-keys has --table"},
    {"krok-plot", "--keys", "--contacts"},
    {"krok-plot", "--mean", "--show cycles"},
    {"krok-plot", "--per-cycle", "--show cycles"},
    {"krok-plot", "--sides", "--view"},
    {"krok-plot", "--size", "--actor-size"},
    {"krok-plot", "--table", "--as-table"},
    {"krok-plot", "--what", "--show"},
    {"krok-render", "--duration", "--from TIME --to TIME"},
    {"krok-render", "--fps", "--rate"},
    {"krok-render", "--sides", "--view"},
    {"krok-render", "--together", "--layout together"},
    {"krok-retarget", "--character", "--onto"},
    {"krok-retarget", "--model", "--onto"},
    {"krok-retarget", "--target", "--onto"},
    {"krok-retarget", "--to", "--onto"},
    {"krok-skin", "--fps", "--every N, or krok-edit --rate before"},
    {"krok-skin", "--rate", "--every N, or krok-edit --rate before"},
    {"krok-synth", "--duration", "--set duration=VALUE"},
    {"krok-synth", "--length", "--set length=VALUE"},
    {"krok-synth", "--table", "--points"},
    {"krok-synth", "--turn", "--set turn=VALUE"},
    {"krok-view", "--keys", "--contacts"},
    {"krok-walk", "--from", "--start"},
    {"krok-walk", "--to", "--goal"},
    {"krok-walk", "--view", "--save-page"},
    {"krok-walk", "--way", "--path"},
};

// What helps who gives a tool more inputs than it takes, or others; empty for most tools.
inline std::string too_many_hint(std::string_view tool) {
  if (tool != "krok-mix") return {};
  return "a timeline is JSON that names its motions (formats/timeline/SPEC.md); krok-blend A B "
         "blends two motions, krok-edit A --append B puts one after the other";
}

}  // namespace krok::cli
