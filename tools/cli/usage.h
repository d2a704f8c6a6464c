#pragma once

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

}  // namespace krok::cli
