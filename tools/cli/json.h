#pragma once

#include <cstddef>

#include "core/json_internal.h"

namespace krok::cli {

// JSON of reports and journals: members keep insertion order.
using Json = nlohmann::ordered_json;

// An empty object with memory reserved for this many members; growing an object copies all its
// members.
inline Json object_for(std::size_t members) {
  Json object = Json::object();
  object.get_ref<Json::object_t&>().reserve(members);
  return object;
}

}  // namespace krok::cli
