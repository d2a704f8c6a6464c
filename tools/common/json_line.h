#pragma once

#include <string>

#include "tools/common/report.h"

namespace krok {

// The JSON text of a value without spaces and line ends, names in their order. The same bytes as
// dump() of the JSON library with bytes that are no UTF-8 replaced (U+FFFD), in a fraction of its
// time: what batches write for each of their files is mostly short words, which need no second look
// at each of their letters.
std::string json_line(const Json& value);

}  // namespace krok
