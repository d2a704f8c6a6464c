#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "core/result.h"

namespace krok::cli {

// What is wrong with the options given. Code usage; `message` names the option.
inline Error usage(std::string message, std::string hint = {}) {
  return {"usage", std::move(message), std::move(hint)};
}

// -o is missing.
inline Error no_output(std::string hint = "add -o OUTPUT") {
  return usage("no output given", std::move(hint));
}

// The same, where a folder would be an input of batch mode.
inline Error no_output_for(const std::string& input) {
  std::error_code unknown;
  const bool folder = std::filesystem::is_directory(input, unknown);
  return folder ? no_output("add --out-dir DIR, for an output for each file of the folder")
                : no_output();
}

// Of several inputs, with --keep-going.
inline Error none_can_be_used() {
  return {"inputs-none", "none of the inputs can be used"};
}

}  // namespace krok::cli
