#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace krok::assimp {

// Default weights of all morph targets (DeformPercent / 100), in file order; ASCII or binary FBX.
std::vector<double> fbx_target_weights(std::string_view text);

// The version of an FBX file, 7400 for 7.4; 0 if it is not said. ASCII or binary.
int fbx_version(std::string_view text);

// Number of objects of a kind ("AnimationLayer"); ASCII or binary FBX.
std::size_t fbx_object_count(std::string_view text, std::string_view kind);

// Names of all models of type LimbNode, which are joints; ASCII or binary FBX.
std::set<std::string> fbx_limb_names(std::string_view text);

}  // namespace krok::assimp
