#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "correctives/correctives.h"

// Krok's format for correctives, .correctives (JSON); see formats/correctives/SPEC.md.

namespace krok::correctives_file {

// Reads correctives; they pass check(Correctives). Safe for untrusted input. Codes: json-syntax,
// json-limit, correctives-structure, correctives-value, with line and column; those of
// check(Correctives).
Result<Correctives> read(std::string_view text);

// The text of a file. Offsets are rounded to a micrometre, those of normals to 1e-4; what was read
// from a file gives its text. An Error if check() fails, or if weights are of another kernel than
// cubic, smoothed or with inserted points (code correctives-shape).
Result<std::string> write(const Correctives& correctives);

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::correctives_file
