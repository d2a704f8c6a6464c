#pragma once

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

// Reads values back from a plot, by its lines and the labels at its ticks, as a person would.

namespace krok::draw {

// The numbers that stand at each % of `pattern`, for each place in the text that it fits.
inline std::vector<std::vector<double>> numbers_of(const std::string& text,
                                                   const std::string& pattern) {
  std::vector<std::vector<double>> found;
  for (std::size_t start = 0; start < text.size(); ++start) {
    std::vector<double> row;
    const char* at = text.c_str() + start;
    bool fits = true;
    for (std::size_t i = 0; i < pattern.size() && fits; ++i) {
      if (pattern[i] != '%') {
        fits = *at == pattern[i];
        if (fits) ++at;
        continue;
      }
      char* end = nullptr;
      fits = std::isdigit(static_cast<unsigned char>(*at)) != 0;
      if (!fits) break;
      row.push_back(std::strtod(at, &end));
      at = end;
    }
    if (fits) found.push_back(row);
  }
  return found;
}

// One panel of a figure.
inline std::string panel_text(const std::string& svg, int panel) {
  const std::string mark = "<clipPath id=\"panel-";
  const auto begin = svg.find(mark + std::to_string(panel) + "\"");
  if (begin == std::string::npos) return {};
  return svg.substr(begin, svg.find(mark, begin + 1) - begin);
}

// How often `part` stands in a text.
inline int count_of(const std::string& text, const std::string& part) {
  int count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

// The element of the line at a place in the panel.
inline std::string line_text(const std::string& svg, int place = 0) {
  auto at = svg.find("class=\"line\"");
  for (int i = 0; i < place; ++i) at = svg.find("class=\"line\"", at + 1);
  return at == std::string::npos ? std::string() : svg.substr(at, svg.find('>', at) - at);
}

// Its corners.
inline std::vector<std::vector<double>> line_of(const std::string& svg, int place = 0) {
  std::string path = line_text(svg, place);
  std::replace(path.begin(), path.end(), 'M', 'L');
  return numbers_of(path, "L% %");
}

// How an axis maps values to pixels, read back from two of its tick labels as a person would.
struct Ruler {
  double value_a, pixel_a, value_b, pixel_b;
  bool logarithmic = false;
  double value_at(double pixel) const {
    const double share = (pixel - pixel_a) / (pixel_b - pixel_a);
    return logarithmic ? value_a * std::pow(value_b / value_a, share)
                       : value_a + share * (value_b - value_a);
  }
};

inline Ruler x_ruler(const std::string& svg) {
  const auto ticks = numbers_of(svg, "text-anchor=\"middle\" x=\"%\" y=\"%\">%<");
  return {ticks.front()[2], ticks.front()[0], ticks.back()[2], ticks.back()[0]};
}

inline Ruler y_ruler(const std::string& svg) {
  const auto ticks = numbers_of(svg, "text-anchor=\"end\" x=\"%\" y=\"%\">%<");
  // The text's base line is 0.35 of its size below the value.
  return {ticks.front()[2], ticks.front()[1] - 4.2, ticks.back()[2], ticks.back()[1] - 4.2};
}

}  // namespace krok::draw
