#pragma once

#include <string>

#include "samples/generator/walk.h"

namespace krok::samples {

// Ground truth of a walk as JSON (schema krok.walk/1, described in samples/captures/README.md):
// parameters, keytimes, footprints, contacts. Metres, seconds and degrees, in Krok's frame.
std::string ground_truth_json(const Walk& walk, const std::string& capture_name);

}  // namespace krok::samples
