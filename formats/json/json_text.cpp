#include "formats/json/json_text.h"

#include "core/json_internal.h"

namespace krok::json {

std::string in_quotes(std::string_view text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace krok::json
