#pragma once

#include <string_view>
#include <vector>

namespace krok::assimp {

// The resting weights of all morph targets (DeformPercent / 100) in the order of the file, ASCII or
// binary.
std::vector<double> fbx_target_weights(std::string_view text);

// How many objects of a kind ("AnimationLayer") the file has, ASCII or binary.
std::size_t fbx_object_count(std::string_view text, std::string_view kind);

}  // namespace krok::assimp
