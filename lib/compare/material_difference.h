#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scene/material.h"

namespace krok::compare {

// The largest difference of a channel of two images' pixels, 0 to 1; nullopt if they have other
// sizes or cannot be decoded.
using ImageDistance =
    std::function<std::optional<double>(const EncodedImage& first, const EncodedImage& second)>;

// Differences in material properties, one phrase each: "base colour 1, 0, 0, 1 and 0, 0, 1, 1",
// "another normal texture". Empty if there are none. Numbers may differ by `tolerance`; images are
// equal if their bytes are, whatever their source, or with `images` their pixels within the
// tolerance; material names are ignored.
std::vector<std::string> differences(const Material& first, const Material& second,
                                     double tolerance, const ImageDistance& images = {});

// The same for parameters of glTF extensions. A property that only one has is compared with its
// default; textures by image, wrapping and texture coordinate set.
std::vector<std::string> differences(std::span<const MaterialParameter> first,
                                     std::span<const MaterialParameter> second, double tolerance,
                                     const ImageDistance& images = {});

}  // namespace krok::compare
