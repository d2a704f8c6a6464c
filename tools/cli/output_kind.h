#pragma once

#include <string>

#include "core/result.h"
#include "formats/registry/registry.h"
#include "tools/cli/command_options.h"

namespace krok::cli {

// Fails (code usage) if `path` has another extension than files of kind `written`; none is allowed.
// `option` is the option that gave the path, "-o".
Status check_output_kind(const std::string& path, const std::string& option,
                         registry::Kind written);

// The same as a kind of value.
ValueKind<std::string> output_of(registry::Kind written);

}  // namespace krok::cli
