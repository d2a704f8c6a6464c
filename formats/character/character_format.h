#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "scene/character.h"

// Reads and writes .character files, which reference a character's other files; see SPEC.md.

namespace krok::character_file {

// A character that passes check(). Paths are relative, without "..". Whoever opens them must check
// for links that leave the folder (core/path_inside.h). Codes, each with line and column:
// json-syntax, json-limit, character-structure, character-value, character-path.
Result<Character> read(std::string_view text);

// The file's text. Output is deterministic and reads back the same. Codes: those of check(),
// character-path.
Result<std::string> write(const Character& character);

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::character_file
