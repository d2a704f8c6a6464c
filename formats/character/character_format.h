#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "scene/character.h"

// A character as a text file that names its other files, .character; SPEC.md describes it.

namespace krok::character_file {

// A character that passes check(). Paths are relative, without a step up; whether a link leads out
// of the folder is for whoever opens them (core/path_inside.h). Codes, each with line and column:
// json-syntax, json-limit, character-structure, character-value, character-path.
Result<Character> read(std::string_view text);

// The file's text. The same character gives the same bytes, and what was written reads back the
// same. Codes: those of check(), character-path.
Result<std::string> write(const Character& character);

}  // namespace krok::character_file
