#pragma once

#include <string>

#include "tools/cli/report.h"

namespace krok::cli {

// JSON text of a value on one line, without spaces, members in order. Invalid UTF-8 is replaced by
// U+FFFD.
std::string json_line(const Json& value);

}  // namespace krok::cli
