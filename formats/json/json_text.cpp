#include "formats/json/json_text.h"

#include "core/json_internal.h"

namespace krok::json {

std::string in_quotes(std::string_view text) {
  return krok::json_text(nlohmann::json(text));
}

}  // namespace krok::json
