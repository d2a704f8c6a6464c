#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/command_options.h"

// Finds options by what they do, for whoever does not know what they are called.

namespace krok::cli {

struct ToolOption {
  std::string tool;
  OptionFacts facts;
};

// Those whose names, values and descriptions share most with the words of `text` ("--skip-frames"),
// best first; at most `max_count`. A word counts more the fewer options have it, in a name more
// than in a description, and for an option of `tool` (may be empty) more than for one of another.
// Words are the same if they begin alike ("scale", "scaling"). Empty if no option has half of the
// words.
std::vector<ToolOption> options_about(std::string_view text, std::string_view tool,
                                      std::span<const ToolOption> options, std::size_t max_count);

// What an option does, in a few words: the description's first sentence without what it adds in
// parentheses or brackets.
std::string first_sentence(const std::string& description);

// "--cutoff FREQUENCY (Cutoff frequency)".
std::string shown_option(const OptionFacts& facts);

}  // namespace krok::cli
