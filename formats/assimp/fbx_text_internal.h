#pragma once

#include <string_view>
#include <vector>

namespace krok::assimp {

// Default weights of all morph targets (DeformPercent / 100), in file order; ASCII or binary FBX.
std::vector<double> fbx_target_weights(std::string_view text);

// Number of objects of a kind ("AnimationLayer"); ASCII or binary FBX.
std::size_t fbx_object_count(std::string_view text, std::string_view kind);

}  // namespace krok::assimp
