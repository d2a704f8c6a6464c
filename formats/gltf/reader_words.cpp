#include <fmt/format.h>

#include "formats/gltf/reader_words_internal.h"

namespace krok::gltf {

std::string label(const char* kind, std::size_t index, const std::string& name) {
  return name.empty() ? fmt::format("{} {}", kind, index)
                      : fmt::format("{} {} ({})", kind, index, name);
}

void warn(Diagnostics& diagnostics, std::string code, std::string message, std::string hint) {
  diagnostics.push_back(make_warning(std::move(code), std::move(message), std::move(hint)));
}

}  // namespace krok::gltf
