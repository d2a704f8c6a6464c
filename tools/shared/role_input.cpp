#include "tools/shared/role_input.h"

namespace krok::cli {

CommandOption add_map_option(CommandOptions& command, std::string& path, const std::string& name,
                             const std::string& description) {
  return command.add_option(name, path, description).type_name("IN.json");
}

}  // namespace krok::cli
