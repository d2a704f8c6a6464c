#include "formats/steps/parameter_names.h"

#include "core/json_internal.h"

namespace krok::steps {

std::vector<std::string> parameter_names(const StepsFile& steps) {
  const parametric::Library& library = steps.library;
  const auto report = parse_json(steps.report);
  const auto list = report.is_object() ? report.value("parameters", nlohmann::json::array())
                                       : nlohmann::json::array();
  std::vector<std::string> names;
  for (std::size_t d = 0; d < library.parameters.size(); ++d) {
    const std::string measures = name_of(library.parameters[d], library.skeleton, library.keytimes);
    names.push_back(measures.substr(measures.rfind('.') + 1));
    if (!list.is_array() || d >= list.size() || !list[d].is_object()) continue;
    const auto name = list[d].find("name");
    if (name != list[d].end() && name->is_string()) names.back() = name->get<std::string>();
  }
  return names;
}

}  // namespace krok::steps
