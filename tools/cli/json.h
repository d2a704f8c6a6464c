#pragma once

#include "core/json_internal.h"

namespace krok::cli {

// JSON of reports and journals: members keep insertion order.
using Json = nlohmann::ordered_json;

}  // namespace krok::cli
