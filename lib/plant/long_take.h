#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "plant/plant_feet.h"
#include "scene/frame_source.h"

// Foot skate clean-up of takes that do not fit in memory.

namespace krok {

struct PlantedFrames {
  FrameSource frames;
  // What was done in the parts that were read; of the clip the skeleton alone.
  std::function<PlantedFeet()> done;
};

// plant_feet(), or a function that calls it. `contacts`: those of the part, if any are given.
using PlantPart = std::function<Result<PlantedFeet>(
    const Clip& part, const std::optional<std::vector<Contact>>& contacts)>;

// Plants a take in parts of about 12 MB, each with the 10 seconds around it, as its frames are
// read; over half a second the one part goes over into the next, and feet that stand there with it
// (by a millimetre or two, as the height of the ground is found in each part). A take of one part
// is planted as a whole. A part in which no foot stands stays as it is. `removed`: root motion that
// was taken out of the take, see Provenance.
//
// Codes of the frames: those of the source and of `plant`; plant-contacts of a take of one part.
PlantedFrames plant_long_take(const FrameSource& source,
                              const std::optional<std::vector<Contact>>& contacts,
                              const std::optional<RootMotion>& removed, int jobs, PlantPart plant,
                              std::size_t part_bytes = std::size_t{12} << 20);

}  // namespace krok
