#pragma once

#include <string>

namespace krok::guided {

// Writes small valid files of the formats that have no examples in their SPEC pages, as
// FOLDER/TARGET/NAME: what fuzzing starts from.
void write_seeds(const std::string& folder);

}  // namespace krok::guided
