#include "tools/common/json_line.h"

namespace krok {

std::string json_line(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace krok
