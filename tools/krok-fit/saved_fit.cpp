#include "tools/krok-fit/saved_fit.h"

#include <optional>

#include "tools/common/report.h"

namespace krok::fit_tool {

namespace {

using fit::ParameterError;
using fit::RefineFigures;

// Members are taken by name; one that is missing or of another kind throws, which is caught once.
std::vector<ParameterError> errors_of(const Json& json, const LibraryInput& input) {
  std::vector<ParameterError> errors;
  for (const library::ParameterEntry& entry : input.description.parameters) {
    const Json& one = json.at(entry.name);
    errors.push_back({one.at("largest").get<double>(), one.at("mean").get<double>(),
                      one.at("most_95").get<double>()});
  }
  return errors;
}

RefineFigures figures_of(const Json& json, const LibraryInput& input) {
  RefineFigures figures;
  figures.within = errors_of(json.at("within"), input);
  figures.outside = errors_of(json.at("extrapolated"), input);
  figures.largest = json.at("largest_of_range").get<double>();
  figures.mean_square = json.at("mean_square_of_range").get<double>();
  figures.failed = json.at("not_measured").get<int>();
  figures.least_weight = json.at("least_weight").get<double>();
  figures.largest_weight = json.at("largest_weight").get<double>();
  figures.roughness = json.at("roughness").get<double>();
  figures.condition = json.at("condition").get<double>();
  return figures;
}

fit::Refusal refusal_named(const std::string& name) {
  using fit::Refusal;
  for (const Refusal refusal :
       {Refusal::weights, Refusal::residual, Refusal::near, Refusal::system}) {
    if (fit::refusal_name(refusal) == name) return refusal;
  }
  return Refusal::growth;
}

fit::Refined refinement_of(const Json& json, const LibraryInput& input) {
  fit::Refined refined;
  refined.example_error = json.at("example_error_of_range").get<double>();
  refined.before = figures_of(json.at("before"), input);
  for (const Json& entry : json.at("rounds")) {
    fit::RefineRound round;
    round.inserted = entry.at("inserted").get<int>();
    round.refused = entry.at("refused").get<int>();
    round.by_point = entry.at("by_other_parameters").get<int>();
    round.sought = entry.at("sought_of_range").get<double>();
    round.after = figures_of(entry.at("after"), input);
    refined.rounds.push_back(std::move(round));
  }
  for (const Json& entry : json.at("refused_points")) {
    refined.refused.push_back(
        {entry.at("round").get<int>(), entry.at("point").get<std::vector<double>>(),
         refusal_named(entry.at("reason").get<std::string>()), entry.at("value").get<double>()});
    if (refined.refused.back().point.size() != input.lower.size()) {
      throw std::out_of_range("a point of other dimensions");
    }
  }
  return refined;
}

}  // namespace

Result<fit::Refined> read_refinement(const std::string& text, const LibraryInput& input,
                                     const rbf::WeightFunction& function) {
  try {
    fit::Refined refined = refinement_of(Json::parse(text), input);
    refined.function = function;
    return refined;
  } catch (const std::exception&) {
    return Error("fit-resume",
                 "its report does not tell how it was refined, or not of these parameters",
                 "fit it anew, without --resume");
  }
}

}  // namespace krok::fit_tool
