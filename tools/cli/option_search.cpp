#include "tools/cli/option_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>

#include "core/text.h"

namespace krok::cli {

namespace {

using Words = std::set<std::string>;

// The words of a text that say something, in small letters and in the singular.
Words words_in(std::string_view text) {
  Words words;
  std::string word;
  const auto end_word = [&] {
    if (word == "feet") word = "foot";
    if (word.size() > 3 && word.ends_with('s')) word.pop_back();
    constexpr std::string_view kEmpty =
        " the and for with not from out its are set use add all that this only each which ";
    if (word.size() > 2 && kEmpty.find(" " + word + " ") == std::string_view::npos) {
      words.insert(word);
    }
    word.clear();
  };
  for (const char c : text) {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      word += ascii_lower(c);
    } else {
      end_word();
    }
  }
  end_word();
  return words;
}

// "scale" and "scaling": the shorter one but for a letter, and all but three of the longer one.
bool alike(const std::string& a, const std::string& b) {
  if (a == b) return true;
  const auto end = std::ranges::mismatch(a, b).in1;
  const auto shared = static_cast<std::size_t>(end - a.begin());
  return shared >= 4 && shared + 1 >= std::min(a.size(), b.size()) &&
         shared + 3 >= std::max(a.size(), b.size());
}

bool has(const Words& words, const std::string& word) {
  return std::ranges::any_of(words, [&](const std::string& one) { return alike(one, word); });
}

struct OptionWords {
  Words name, sentence, rest;

  explicit OptionWords(const OptionFacts& facts) : rest(words_in(facts.description)) {
    for (const std::string& one : facts.names) name.merge(words_in(one));
    sentence = words_in(first_sentence(facts.description) + " " + facts.value_name);
    for (const std::string& one : facts.words) rest.merge(words_in(one));
  }
  double weight_of(const std::string& word) const {
    return has(name, word) ? 2 : has(sentence, word) ? 1 : has(rest, word) ? 0.4 : 0;
  }
};

}  // namespace

std::string first_sentence(const std::string& description) {
  // "keep: hands touch the ground; free: ..." says nothing without its second word.
  const std::size_t end = description.find_first_of(".;:");
  const std::string first =
      description.substr(0, end < 20 ? description.find_first_of(".;", end + 1) : end);
  return first.substr(0, std::min(first.find(" ("), first.find(" [")));
}

std::string shown_option(const OptionFacts& facts) {
  return fmt::format("{}{}{} ({})", facts.names.back(), facts.value_name.empty() ? "" : " ",
                     facts.value_name, first_sentence(facts.description));
}

std::vector<ToolOption> options_about(std::string_view text, std::string_view tool,
                                      std::span<const ToolOption> options, std::size_t max_count) {
  const Words wanted = words_in(text);
  std::vector<OptionWords> words;
  words.reserve(options.size());
  for (const ToolOption& one : options) words.emplace_back(one.facts);

  std::vector<std::pair<double, double>> scores(options.size());  // and the number of words
  for (const std::string& word : wanted) {
    std::vector<double> weights(options.size());
    for (std::size_t i = 0; i < options.size(); ++i) weights[i] = words[i].weight_of(word);
    const auto with_it = std::ranges::count_if(weights, [](double weight) { return weight > 0; });
    const double rarity =
        std::log(1 + static_cast<double>(options.size()) /
                         static_cast<double>(std::max<std::ptrdiff_t>(1, with_it)));
    for (std::size_t i = 0; i < options.size(); ++i) {
      constexpr double kOfThisTool = 1.5;
      scores[i].first += weights[i] * rarity * (options[i].tool == tool ? kOfThisTool : 1);
      scores[i].second += weights[i] > 0 ? 1 : 0;
    }
  }
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < options.size(); ++i) {
    const bool enough = scores[i].second * 2 >= static_cast<double>(wanted.size());
    if (enough && scores[i].first > 0 && !options[i].facts.positional) order.push_back(i);
  }
  std::ranges::stable_sort(order, std::greater<>(), [&](std::size_t i) { return scores[i].first; });

  std::vector<ToolOption> found;
  for (const std::size_t i : order) {
    constexpr double kNearBest = 0.6;
    if (found.size() == max_count || scores[i].first < kNearBest * scores[order[0]].first) break;
    const bool seen = std::ranges::any_of(found, [&](const ToolOption& one) {
      return one.facts.names == options[i].facts.names;  // of many tools, once
    });
    if (!seen) found.push_back(options[i]);
  }
  return found;
}

}  // namespace krok::cli
