#pragma once

#include <cstddef>

#include "tools/cli/report.h"

namespace krok::cli {

// An empty object with memory reserved for this many members; growing an object copies all its
// members.
inline Json object_for(std::size_t members) {
  Json object = Json::object();
  object.get_ref<Json::object_t&>().reserve(members);
  return object;
}

}  // namespace krok::cli
