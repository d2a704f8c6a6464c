#pragma once

#include <span>
#include <vector>

#include "contacts/contacts.h"
#include "plant/legs_internal.h"
#include "plant/plant_feet.h"

// Which points are fixed in which frames, and where. Used by plant_feet().

namespace krok::plant {

// One leg's points over the frames, as captured, and the stays that fix them.
struct Footing {
  std::vector<std::vector<Vec3>> tracks;  // [points][frames], metres, world
  std::vector<FixedStay> stays;           // by point, then frame
  std::vector<std::vector<int>> stay_at;  // [points][frames], index into stays or -1
};

// The stays as whole frames, frames in which a point is far from its place left out. Those of a
// point that has a joint are `contacts`, where given.
std::vector<Footing> fix_stays(const Clip& clip, const PlantedBody& body,
                               const std::vector<Stay>& found,
                               const std::vector<PointTrack>& tracks,
                               const std::optional<std::span<const Contact>>& contacts);

// The diagonal of the box that positions of a stay span, metres.
double drift_of(std::span<const Vec3> track, int first, int last);

}  // namespace krok::plant
