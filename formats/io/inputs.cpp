#include "formats/io/inputs.h"

namespace krok::io {

Inputs::~Inputs() = default;

void Inputs::diagnose(const Diagnostics& diagnostics) {
  for (const Diagnostic& diagnostic : diagnostics) diagnose(diagnostic);
}

Result<InputFile> PlainInputs::open_input(const std::string& path) {
  return InputFile::open(path);
}

void PlainInputs::diagnose(Diagnostic diagnostic) {
  diagnostics.push_back(std::move(diagnostic));
}

}  // namespace krok::io
