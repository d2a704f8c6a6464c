#include "tools/cli/json_line.h"

namespace krok::cli {

std::string json_line(const Json& value) {
  return json_text(value);
}

}  // namespace krok::cli
