#pragma once

#include <span>
#include <vector>

#include "contacts/contacts.h"
#include "contacts/gait_metrics.h"
#include "plant/legs_internal.h"
#include "plant/plant_feet.h"
#include "plant/smooth_curve_internal.h"

// Which points are fixed in which frames, and where.

namespace krok::plant {

// Drift of standing heels and balls, in leg lengths, up to which they need no correction.
inline constexpr double kMaxDrift = 0.0004;

// Frames of a stance before its first stay or after its last one, in which the foot rolls over one
// point after another.
struct Roll {
  int from = 0, step = 1;   // the frame of the stay that it begins beside, and the way from there
  std::vector<int> points;  // [frames from there on], index into the leg's points
  double slide = 0;         // metres along the ground, of these points as captured
};

// One leg's points over the frames, as captured, and the stays that fix them.
struct Footing {
  std::vector<FootPart> parts;  // [points]
  std::vector<double> jitter;   // [points], deviation of the height while it stands, metres
  std::vector<std::vector<Vec3>> tracks;  // [points][frames], metres, world
  std::vector<FixedStay> stays;           // by point, then frame
  std::vector<std::vector<int>> stay_at;  // [points][frames], index into stays or -1
  std::vector<Roll> rolls;

  std::size_t index_of(FootPart part) const;  // of parts
};

// The stays in whole frames, without frames in which a point is far from its place. Points that are
// joints take their stays from `contacts` where given. `before` has the stays of the clip before
// jitter was removed, with the captured variation of heights; empty in the first round.
std::vector<Footing> fix_stays(const Clip& clip, const PlantedBody& body,
                               const std::vector<Stay>& found,
                               const std::vector<PointTrack>& tracks,
                               const std::optional<std::span<const Contact>>& contacts,
                               const std::vector<Footing>& before = {});

// Finds what is left of stances, from strike to toe-off, beside the stays of heel and ball. In each
// frame the point is in contact that is lowest, compared with a flat foot. Frames from where it has
// slid by more than 0.07 of the leg are of a step.
void find_rolls(std::span<const StanceTimes> stances, double rate, double leg_length,
                Footing& footing);

// The largest slide of all rolls, metres.
double slide_of(const std::vector<Footing>& footings);

// How far apart the positions of a stay are, metres: from the one farthest from the first to the
// one farthest from it. Whichever way the body faces.
double drift_of(std::span<const Vec3> track, int first, int last);

// Where fixed points bring each foot.

// Flexion of a knee, radians, below which a leg is not stretched further than captured: there a
// small move of the ankle turns the knee far.
inline constexpr double kNearlyStraight = 20 * kRadiansPerDegree;

// The correction of one foot, [frames]; world space.
struct FootPath {
  std::vector<Vec3> turn;       // rotation vectors, to be put on the foot from the left
  std::vector<Vec3> shift;      // metres, of the ankle
  bool extends_softly = false;  // the foot lags behind where its leg is too short
};

FootPath foot_path(const Clip& clip, const PlantedBody& body, const Leg& leg,
                   const Footing& footing);

// The same shift before it is interpolated over frames in which nothing stands.
KnownCurve needed_shift(const Clip& clip, const PlantedBody& body, const Leg& leg,
                        const Footing& footing);

// Leaves stays as they are and lets the foot roll where it rolls.
FootPath rolling_path(const Clip& clip, const PlantedBody& body, const Leg& leg,
                      const Footing& footing);

// The toes lie on the ground while the heel comes up: of the foot's turn they take the part about
// the vertical.
inline Vec3 turn_of_toes(const Vec3& turn) {
  return {0, turn.y(), 0};
}

// Legs from where the pelvis and the feet are.

// Metres by which the pelvis is lowered, >= 0, [frames], so that legs that are nearly straight are
// not stretched further.
std::vector<double> lowering(const Clip& clip, const PlantedBody& body,
                             const std::vector<FootPath>& paths);

// Applies the corrections to the clip. Returns the number of frames in which a leg does not reach
// its place.
int apply(const PlantedBody& body, const std::vector<FootPath>& paths,
          const std::vector<double>& lowered, Clip& clip);

}  // namespace krok::plant
