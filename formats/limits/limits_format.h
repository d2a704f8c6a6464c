#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "ik/limits.h"
#include "scene/skeleton.h"

// Reader and writer for joint limits (JSON); see formats/limits/SPEC.md.

namespace krok::limits {

// The limits of a skeleton's joints; joints that the file does not name are free. Safe for
// untrusted input. Codes, each with line and column: json-syntax, json-limit, limits-structure,
// limits-value, limits-joint (no joint of that name; the hint names the nearest).
Result<ik::Limits> read(std::string_view text, const Skeleton& skeleton);

// A file that read() gives the same limits from (angles to about 1e-15 rad). Free joints are left
// out. Needs limits that pass ik::check.
std::string write(const ik::Limits& limits, const Skeleton& skeleton);

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::limits
