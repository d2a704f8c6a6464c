#include <fmt/format.h>

#include "formats/gltf/reader_words_internal.h"

namespace krok::gltf {

std::string label(const char* kind, std::size_t index, const std::string& name) {
  return name.empty() ? fmt::format("{} {}", kind, index)
                      : fmt::format("{} {} ({})", kind, index, name);
}

void warn(Diagnostics& diagnostics, std::string code, std::string message, std::string hint) {
  Diagnostic diagnostic;
  diagnostic.severity = Severity::warning;
  diagnostic.code = std::move(code);
  diagnostic.message = std::move(message);
  diagnostic.hint = std::move(hint);
  diagnostics.push_back(std::move(diagnostic));
}

}  // namespace krok::gltf
