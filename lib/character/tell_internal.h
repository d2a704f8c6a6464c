#pragma once

#include <string>
#include <utility>

#include "core/result.h"

// Private to this folder.

namespace krok {

// Appends a diagnostic about the file as a whole.
inline void tell(Diagnostics& diagnostics, Severity severity, const char* code, std::string message,
                 std::string hint = {}) {
  Diagnostic diagnostic;
  diagnostic.severity = severity;
  diagnostic.code = code;
  diagnostic.message = std::move(message);
  diagnostic.hint = std::move(hint);
  diagnostics.push_back(std::move(diagnostic));
}

}  // namespace krok
