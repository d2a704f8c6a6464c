#include "tools/krok-fit/saved_fit.h"

#include <algorithm>
#include <cstdint>
#include <optional>

#include "tools/cli/report.h"
#include "tools/krok-fit/options.h"

namespace krok::cli::fit {

namespace {

using krok::fit::ParameterError;
using krok::fit::RefineMetrics;

// Missing members or wrong types throw; read_refinement() catches all.
std::vector<ParameterError> errors_of(const Json& json, const LibraryInput& input) {
  std::vector<ParameterError> errors;
  for (const library::ParameterEntry& entry : input.description.parameters) {
    const Json& one = json.at(entry.name);
    errors.push_back({one.at("largest").get<double>(), one.at("mean").get<double>(),
                      one.at("most_95").get<double>()});
  }
  return errors;
}

RefineMetrics metrics_of(const Json& json, const LibraryInput& input) {
  RefineMetrics metrics;
  metrics.within = errors_of(json.at("within"), input);
  metrics.outside = errors_of(json.at("extrapolated"), input);
  metrics.largest = json.at("largest_of_range").get<double>();
  metrics.mean_square = json.at("mean_square_of_range").get<double>();
  metrics.failed = json.at("not_measured").get<int>();
  metrics.least_weight = json.at("least_weight").get<double>();
  metrics.largest_weight = json.at("largest_weight").get<double>();
  metrics.roughness = json.at("roughness").get<double>();
  metrics.condition = json.at("condition").get<double>();
  return metrics;
}

krok::fit::Refusal refusal_named(const std::string& name) {
  using krok::fit::Refusal;
  for (const Refusal refusal :
       {Refusal::weights, Refusal::residual, Refusal::near, Refusal::system}) {
    if (krok::fit::refusal_name(refusal) == name) return refusal;
  }
  return Refusal::growth;
}

int count_of(const Json& json) {
  const int count = json.get<int>();
  if (count < 0) throw std::out_of_range("a negative number");
  return count;
}

// Whether the rounds match the points, as refinement counts them. A forged report could otherwise
// claim any number of points, each of which takes time.
bool adds_up(const krok::fit::Refined& refined) {
  std::int64_t inserted = 0, refused = 0;
  for (const krok::fit::RefineRound& round : refined.rounds) {
    if (round.inserted > krok::fit::RefineOptions().points_a_round) return false;
    inserted += round.inserted;
    refused += round.refused;
  }
  const auto rounds = static_cast<int>(refined.rounds.size());
  return inserted == refined.function.inserted() && inserted <= kMaxRefined &&
         refused == static_cast<std::int64_t>(refined.refused.size()) &&
         std::ranges::all_of(refined.refused,
                             [&](const auto& point) { return point.round < rounds; });
}

krok::fit::Refined refinement_of(const Json& json, const LibraryInput& input,
                                 const rbf::WeightFunction& function) {
  krok::fit::Refined refined;
  refined.function = function;
  refined.example_error = json.at("example_error_of_range").get<double>();
  refined.before = metrics_of(json.at("before"), input);
  for (const Json& entry : json.at("rounds")) {
    krok::fit::RefineRound round;
    round.inserted = count_of(entry.at("inserted"));
    round.refused = count_of(entry.at("refused"));
    round.by_point = count_of(entry.at("by_other_parameters"));
    round.sought = entry.at("sought_of_range").get<double>();
    round.after = metrics_of(entry.at("after"), input);
    refined.rounds.push_back(std::move(round));
  }
  for (const Json& entry : json.at("refused_points")) {
    refined.refused.push_back(
        {count_of(entry.at("round")), entry.at("point").get<std::vector<double>>(),
         refusal_named(entry.at("reason").get<std::string>()), entry.at("value").get<double>()});
    if (refined.refused.back().point.size() != input.lower.size()) {
      throw std::out_of_range("a point of other dimensions");
    }
  }
  if (const auto polished = json.find("polished"); polished != json.end()) {
    refined.polished = {polished->at("found_rows").get<std::vector<double>>(),
                        metrics_of(polished->at("after"), input)};
    if (refined.polished->found_rows.size() != function.inserted_rows.size()) {
      throw std::out_of_range("rows of other points");
    }
  }
  if (!adds_up(refined)) throw std::out_of_range("other points");
  return refined;
}

}  // namespace

Result<krok::fit::Refined> read_refinement(const std::string& text, const LibraryInput& input,
                                           const rbf::WeightFunction& function) {
  try {
    return refinement_of(parse_ordered_json(text), input, function);
  } catch (const std::exception&) {
    return Error("fit-resume", "the report has no refinement state for these parameters and points",
                 "fit without --resume");
  }
}

}  // namespace krok::cli::fit
