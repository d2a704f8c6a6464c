#include "tools/batch/made_with.h"

#include "core/hash.h"
#include "tools/cli/json_line.h"
#include "tools/cli/json_object.h"

namespace krok::cli::batch {

std::string made_with(const BatchFile& file, const BatchList& list,
                      const std::vector<std::string>& fixed_positionals,
                      const ToolContext& context) {
  const std::vector<GivenOption>& options = list.option_sets[file.options].options;
  Json all = object_for(6);
  all["tool"] = context.report.tool;
  all["version"] = context.report.version;
  all["input"] = base_name(file.input);  // it is in the result's provenance
  all["options"] = context.result_options;
  // Other inputs by full path: the journal has checksums of their content under these paths.
  all["inputs"] = fixed_positionals;
  for (const GivenOption& option : options) {
    if (!option.names_input) continue;
    for (const std::string& value : option.values) all["inputs"].push_back(value);
  }
  all["outputs"] = Json::array();
  for (const GivenOption& option : options) {
    if (!option.names_output) continue;
    for (const std::string& value : option.values) {
      all["outputs"].push_back(expanded(value, file, ""));
    }
  }
  const std::string text = json_line(all);
  return hex(xxh3(std::as_bytes(std::span(text))));
}

}  // namespace krok::cli::batch
