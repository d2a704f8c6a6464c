#include "tools/krok-fit/fit_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "parametric/style_groups.h"
#include "tools/krok-fit/library_input.h"

namespace krok::cli::fit {

namespace {

using parametric::WeightCandidate;
using rbf::Kernel;

// From almost none to affine.
constexpr double kSeries[] = {1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3, 1, 3, 10, 100};
// Min examples left out that the others can predict, and min captures they are from, for a choice.
constexpr int kMinInside = 5;
constexpr int kMinCaptures = 3;
// The cubic kernel without smoothing is used unless the best is better by this factor.
constexpr double kGain = 1.03;
constexpr double kOfSeveralStyles = 1;  // smoothing, where captures are too few to choose one
constexpr Kernel kKernels[] = {Kernel::cubic, Kernel::linear, Kernel::gaussian, Kernel::bspline,
                               Kernel::wendland};

bool has_several_styles(const parametric::Library& library) {
  return std::ranges::any_of(library.examples, [&](const parametric::Example& example) {
    return example.style != library.examples.front().style;
  });
}

// The first is used in case of doubt.
std::vector<WeightCandidate> candidates_for(const LibraryInput& input, const Options& options) {
  std::vector<WeightCandidate> list;
  // Several styles contradict each other.
  const bool contradicts = !options.smooth && has_several_styles(input.library);
  const auto may_use = [&](Kernel kernel) { return !options.kernel || *options.kernel == kernel; };
  const bool thins =
      !options.smooth && input.exact_spacing < kUsualSpacing && !input.all_examples.empty();
  for (const Kernel kernel : kKernels) {
    if (!may_use(kernel) || contradicts || (options.smooth && *options.smooth > 0)) continue;
    list.push_back({kernel, 0, input.exact_spacing});
    if (thins) list.push_back({kernel, 0, kUsualSpacing});
  }
  for (const Kernel kernel : kKernels) {
    if (!may_use(kernel)) continue;
    if (options.smooth) {
      if (*options.smooth > 0) list.push_back({kernel, *options.smooth, kSmoothedSpacing});
      continue;
    }
    if (!options.kernel && rbf::has_radii(kernel)) continue;
    for (const double smoothing : kSeries) {
      list.push_back({kernel, smoothing, kSmoothedSpacing});
    }
  }
  return list;
}

}  // namespace

bool contradict_each_other(const parametric::LeftOutMeans& exact) {
  return exact.examples >= kMinInside && exact.weighted > exact.linear;
}

WeightsChoice choose_weights(LibraryInput& input, const Options& options, ToolContext& context) {
  WeightsChoice choice;
  choice.kernel = options.kernel.value_or(Kernel::cubic);
  choice.smoothing =
      options.smooth.value_or(has_several_styles(input.library) ? kOfSeveralStyles : 0);
  const auto candidates = candidates_for(input, options);
  parametric::Library all = input.library;
  if (!input.all_examples.empty()) all.examples = input.all_examples;
  // A library that cannot be fitted is reported by fit_library().
  if (auto trials =
          parametric::try_weights(all, parametric::captures_of(all), candidates, context.jobs)) {
    choice.trials = *std::move(trials);
  }
  double spacing = input.exact_spacing;
  if (choice.trials.examples >= kMinInside && choice.trials.groups >= kMinCaptures) {
    choice.is_chosen = true;
    // The first is only preferred if it reproduces the examples.
    const bool reproduces = candidates.front().smoothing == 0 || options.smooth;
    const std::size_t used = parametric::trial_to_use(choice.trials, reproduces ? kGain : 0);
    const WeightCandidate& candidate = choice.trials.tried[used].candidate;
    choice.kernel = candidate.kernel;
    choice.smoothing = candidate.smoothing;
    spacing = candidate.spacing;
  }
  if (choice.smoothing > 0) {
    take_smoothed_examples(input);
  } else if (spacing > input.exact_spacing) {
    take_examples(input, spacing);
  }
  return choice;
}

// Finds out whether examples are of several people or moods.

namespace {

using parametric::Library;

constexpr double kOnePerson = 0.06;  // metres: captures of one person in one mood differ by less
constexpr double kNaming = 0.7;      // F1 score of a word as a name
constexpr std::size_t kShownGroups = 8, kShownOfGroup = 2;

// Of a file's name, without its ending.
std::set<std::string> words_in(const std::string& name) {
  std::set<std::string> words;
  std::string word;
  for (const char c : name.substr(0, name.size() - extension(name).size()) + " ") {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || byte >= 0x80) {
      word += c;
    } else if (!word.empty()) {
      words.insert(std::move(word));
      word.clear();
    }
  }
  return words;
}

// [groups] their captures.
using Groups = std::vector<std::set<std::string>>;

std::vector<std::string> names_of(const Groups& groups) {
  std::map<std::string, double> uses;
  for (const auto& group : groups) {
    for (const std::string& capture : group) {
      for (const std::string& word : words_in(capture)) ++uses[word];
    }
  }
  std::vector<std::string> names;
  for (const auto& group : groups) {
    std::map<std::string, double> own;
    for (const std::string& capture : group) {
      for (const std::string& word : words_in(capture)) ++own[word];
    }
    std::string best = fmt::format("group {}", names.size() + 1);
    double score = kNaming;
    for (const auto& [word, count] : own) {
      const double f1 = 2 * count / (static_cast<double>(group.size()) + uses[word]);
      if (f1 <= score) continue;
      score = f1;
      best = word;
    }
    if (std::ranges::find(names, best) != names.end()) {
      best += fmt::format(" {}", names.size() + 1);
    }
    names.push_back(std::move(best));
  }
  return names;
}

std::string shown_groups(const Groups& groups, const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t g = 0; g < std::min(groups.size(), kShownGroups); ++g) {
    text += fmt::format("{}'{}' ({}: ", g == 0 ? "" : ", ", shown(names[g]),
                        counted(groups[g].size(), "capture"));
    std::size_t listed = 0;
    for (const std::string& capture : groups[g]) {
      if (listed == kShownOfGroup) break;
      text += (listed++ == 0 ? "" : ", ") + shown(capture);
    }
    text += groups[g].size() > kShownOfGroup ? ", ...)" : ")";
  }
  return text + (groups.size() > kShownGroups ? ", ..." : "");
}

void warn_of_groups(const parametric::StyleGroups& found, const Groups& groups,
                    const std::vector<std::string>& names, ToolContext& context) {
  context.warn(
      "fit-mixed",
      fmt::format("steps with the same parameters differ by {} mm at their joints, those of one "
                  "person in one mood by less than {}; alike, within {} mm, are {}",
                  readable(1e3 * found.spread, 3), readable(1e3 * kOnePerson),
                  readable(1e3 * found.within, 3), shown_groups(groups, names)),
      "krok-walk --style walks in one of them; a \"style\" of examples in the description names "
      "them as you would");
}

}  // namespace

Status name_styles(LibraryInput& input, ToolContext& context) {
  std::map<std::string, std::vector<std::size_t>> by_style;
  auto& all = input.library.examples;
  for (std::size_t i = 0; i < all.size(); ++i) by_style[all[i].style].push_back(i);
  for (const auto& [style, members] : by_style) {
    std::vector<parametric::Example> own;
    for (const std::size_t i : members) own.push_back(all[i]);
    const Library library = input.library.with(std::move(own));
    const auto found = parametric::group_styles(library, parametric::captures_of(library));
    if (!found) return found.error();
    Groups groups(at(found->count));
    for (std::size_t k = 0; k < members.size(); ++k) {
      groups[at(found->of_example[k])].emplace(parametric::capture_of(library.examples[k].name));
    }
    // Of one mood, too, steps may differ more: then few groups are not much more alike.
    const bool mixed = style.empty() && found->spread > kOnePerson &&
                       found->within <= parametric::kAlikeSteps && found->count > 1;
    const std::vector<std::string> names =
        mixed ? names_of(groups) : std::vector<std::string>(groups.size(), style);
    if (mixed) warn_of_groups(*found, groups, names, context);
    Json groups_json = Json::array();
    for (std::size_t g = 0; g < groups.size() && mixed; ++g) {
      groups_json.push_back({{"name", names[g]}, {"captures", groups[g]}});
    }
    input.styles.push_back({{"name", style},
                            {"examples", members.size()},
                            {"spread", found->spread},
                            {"within", found->within},
                            {"groups", std::move(groups_json)}});
    if (!mixed) continue;
    for (std::size_t k = 0; k < members.size(); ++k) {
      all[members[k]].style = names[at(found->of_example[k])];
    }
  }
  return {};
}

}  // namespace krok::cli::fit
