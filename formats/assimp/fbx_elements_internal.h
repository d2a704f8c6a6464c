#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

// The elements of an ASCII or binary FBX file of version 7, without their nesting. Source: "FBX
// binary file format specification", Blender developers' blog, 2013.

namespace krok::assimp {

struct FbxElement {
  std::string_view name{};
  std::size_t begin = 0, end = 0;  // in the file, with children
  // As in the file: in binary files with a letter for the type, in ASCII files strings with quotes
  // and a list of numbers as the first value. Equal ids are equal values.
  std::vector<std::string_view> values{};

  std::string_view value(std::size_t index) const {
    return index < values.size() ? values[index] : std::string_view();
  }
};

struct FbxElements {
  std::string_view file;
  std::size_t word = 0;            // bytes of a number in an element's header; 0: ASCII
  std::vector<FbxElement> list{};  // in file order

  // Empty or 0 if `value` is damaged or something else.
  std::vector<double> numbers(std::string_view value) const;
  double number(std::string_view value) const;

  // The file with other numbers in place of some lists, by element; times become integers.
  std::string with(const std::map<std::size_t, std::vector<double>>& lists) const;
};

// nullopt for other versions, and if a binary file is damaged.
std::optional<FbxElements> fbx_elements(std::string_view file);

// Default weights of all morph targets (DeformPercent / 100), in file order; ASCII or binary FBX.
std::vector<double> fbx_target_weights(std::string_view text);

// The version of an FBX file, 7400 for 7.4; 0 if it is not said. ASCII or binary.
int fbx_version(std::string_view text);

// Number of objects of a kind ("AnimationLayer"); ASCII or binary FBX.
std::size_t fbx_object_count(std::string_view text, std::string_view kind);

// Names of all models of type LimbNode, which are joints; ASCII or binary FBX.
std::set<std::string> fbx_limb_names(std::string_view text);

}  // namespace krok::assimp
