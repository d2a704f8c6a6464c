#include "formats/io/inputs.h"

namespace krok::io {

Inputs::~Inputs() = default;

void Inputs::diagnose(const Diagnostics& diagnostics) {
  for (const Diagnostic& diagnostic : diagnostics) diagnose(diagnostic);
}

void Inputs::diagnose_in(const std::string& path, const Diagnostics& diagnostics) {
  for (Diagnostic diagnostic : diagnostics) {
    if (diagnostic.where.file.empty()) diagnostic.where.file = path;
    diagnose(std::move(diagnostic));
  }
}

Result<InputFile> PlainInputs::open_input(const std::string& path) {
  return InputFile::open(path);
}

void PlainInputs::diagnose(Diagnostic diagnostic) {
  diagnostics.push_back(std::move(diagnostic));
}

}  // namespace krok::io
