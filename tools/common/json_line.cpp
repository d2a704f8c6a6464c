#include "tools/common/json_line.h"

namespace krok {

std::string json_line(const Json& value) {
  return json_text(value);
}

}  // namespace krok
