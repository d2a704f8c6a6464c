#include "compare/material_difference.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <tuple>
#include <utility>

namespace krok::compare {

namespace {

std::string text_of(float value) {
  return fmt::format("{}", value);
}

template <int N>
std::string text_of(const Eigen::Matrix<float, N, 1>& values) {
  std::string text;
  for (const float value : values) text += (text.empty() ? "" : ", ") + text_of(value);
  return text;
}

double distance(float first, float second) {
  return std::abs(static_cast<double>(first) - static_cast<double>(second));
}

template <int N>
double distance(const Eigen::Matrix<float, N, 1>& first, const Eigen::Matrix<float, N, 1>& second) {
  return (first.template cast<double>() - second.template cast<double>())
      .template lpNorm<Eigen::Infinity>();
}

const char* word_of(Material::Alpha alpha) {
  switch (alpha) {
    case Material::Alpha::mask:
      return "mask";
    case Material::Alpha::blend:
      return "blend";
    case Material::Alpha::opaque:
      break;
  }
  return "opaque";
}

const char* word_of(bool value) {
  return value ? "yes" : "no";
}

bool same_image(const EncodedImage& first, const EncodedImage& second) {
  if (first.bytes.empty() && second.bytes.empty()) return first.path == second.path;
  return first.bytes == second.bytes;
}

class Comparison {
 public:
  explicit Comparison(double tolerance) : tolerance_(tolerance) {}

  template <typename Value>
  void number(const char* what, const Value& first, const Value& second) {
    // False for NaN.
    if (distance(first, second) <= tolerance_) return;
    say(fmt::format("{} {} and {}", what, text_of(first), text_of(second)));
  }

  template <typename Value>
  void word(const char* what, Value first, Value second) {
    if (first != second) say(fmt::format("{} {} and {}", what, word_of(first), word_of(second)));
  }

  void texture(const char* what, const Texture& first, const Texture& second) {
    if (!first && !second) return;
    if (!first || !second) {
      const char* const article = *what == 'o' || *what == 'e' ? "an" : "a";
      say(fmt::format("only the {} has {} {} texture", first ? "first" : "second", article, what));
    } else if (!same_image(*first.image, *second.image)) {
      say(fmt::format("another {} texture", what));
    } else if (first.wrap_u != second.wrap_u || first.wrap_v != second.wrap_v ||
               first.smooth != second.smooth) {
      say(fmt::format("the {} texture has another sampler", what));
    }
  }

  std::vector<std::string> result() && { return std::move(phrases_); }

 private:
  void say(std::string phrase) { phrases_.push_back(std::move(phrase)); }

  double tolerance_;
  std::vector<std::string> phrases_;
};

}  // namespace

std::vector<std::string> differences(const Material& first, const Material& second,
                                     double tolerance) {
  Comparison comparison(tolerance);
  comparison.number("base colour", first.base_color, second.base_color);
  comparison.number("metallic", first.metallic, second.metallic);
  comparison.number("roughness", first.roughness, second.roughness);
  comparison.number("emissive", first.emissive, second.emissive);
  constexpr std::array kTextures = {"base colour", "metallic-roughness", "normal", "occlusion",
                                    "emissive"};
  const auto ours = textures_of(first), theirs = textures_of(second);
  static_assert(kTextures.size() == std::tuple_size_v<decltype(ours)>);
  for (std::size_t i = 0; i < kTextures.size(); ++i) {
    comparison.texture(kTextures[i], *ours[i], *theirs[i]);
  }
  if (first.normal_texture && second.normal_texture) {
    comparison.number("normal scale", first.normal_scale, second.normal_scale);
  }
  if (first.occlusion_texture && second.occlusion_texture) {
    comparison.number("occlusion strength", first.occlusion_strength, second.occlusion_strength);
  }
  comparison.word("alpha", first.alpha, second.alpha);
  if (first.alpha == Material::Alpha::mask && second.alpha == Material::Alpha::mask) {
    comparison.number("alpha cutoff", first.alpha_cutoff, second.alpha_cutoff);
  }
  comparison.word("double sided", first.double_sided, second.double_sided);
  comparison.word("unlit", first.unlit, second.unlit);
  return std::move(comparison).result();
}

}  // namespace krok::compare
