#pragma once

#include <cstddef>

#include "tools/common/report.h"

namespace krok {

// An empty object with room for so many members. One without copies all that it holds, again and
// again, while it grows.
inline Json object_for(std::size_t members) {
  Json object = Json::object();
  object.get_ref<Json::object_t&>().reserve(members);
  return object;
}

}  // namespace krok
