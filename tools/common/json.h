#pragma once

#include "core/json_internal.h"

namespace krok {

// The JSON of reports and journals: members keep the order in which they were put in.
using Json = nlohmann::ordered_json;

}  // namespace krok
