#pragma once

#include <string>

#include "core/result.h"
#include "formats/registry/registry.h"

namespace krok::cli {

// Fails (code usage) if the extension of `path` belongs to another known file kind than `written`,
// whose readers would reject the file. Unknown extensions and none are allowed. `option` is the
// option that gave the path, "-o".
Status check_output_kind(const std::string& path, const std::string& option,
                         registry::Kind written);

}  // namespace krok::cli
