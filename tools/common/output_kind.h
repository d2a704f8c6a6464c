#pragma once

#include <string>

#include "core/result.h"
#include "formats/registry/registry.h"

namespace krok {

// Whether a file of kind `written` may be called `path`: an Error (code usage) where the extension
// is that of another kind that Krok knows, whose readers would refuse it. Other extensions and none
// are the user's choice. `option` is what the path was given with, "-o".
Status check_output_kind(const std::string& path, const std::string& option,
                         registry::Kind written);

}  // namespace krok
