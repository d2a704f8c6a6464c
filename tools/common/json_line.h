#pragma once

#include <string>

#include "tools/common/report.h"

namespace krok {

// The JSON text of a value in one line without spaces, names in their order. Bytes that are no
// UTF-8 are replaced (U+FFFD).
std::string json_line(const Json& value);

}  // namespace krok
