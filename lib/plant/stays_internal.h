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
  std::vector<FootPart> parts;  // [points]
  std::vector<double> jitter;   // [points], deviation of the height while it stands, metres
  std::vector<std::vector<Vec3>> tracks;  // [points][frames], metres, world
  std::vector<FixedStay> stays;           // by point, then frame
  std::vector<std::vector<int>> stay_at;  // [points][frames], index into stays or -1

  std::size_t index_of(FootPart part) const;  // of parts
};

// The stays as whole frames, frames in which a point is far from its place left out. Those of a
// point that has a joint are `contacts`, where given. `before` are those of the clip before jitter
// was taken out, which moves heights as much as ever; empty for the first time.
std::vector<Footing> fix_stays(const Clip& clip, const PlantedBody& body,
                               const std::vector<Stay>& found,
                               const std::vector<PointTrack>& tracks,
                               const std::optional<std::span<const Contact>>& contacts,
                               const std::vector<Footing>& before = {});

// The diagonal of the box that positions of a stay span, metres.
double drift_of(std::span<const Vec3> track, int first, int last);

}  // namespace krok::plant
