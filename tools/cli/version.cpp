#include "build_state.h"
#include "tools/cli/tool.h"

namespace krok::cli {

std::string version() {
  return KROK_VERSION;
}

std::string version_of_build() {
  return KROK_VERSION KROK_BUILD_STATE;
}

}  // namespace krok::cli
