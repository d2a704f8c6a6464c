#include "tracks/retime_on_curves.h"

#include <algorithm>
#include <cmath>

#include "tracks/keyed_clip.h"

namespace krok {

Result<Clip> retime_on_curves(const Clip& clip, double rate, double speed, double tension,
                              bool keep_last) {
  if (!(speed > 0) || !std::isfinite(speed) || !(tension >= 0 && tension <= 1)) {
    return Error("motion-speed", "the speed must be positive, the tension from 0 to 1");
  }
  KeyedClip keyed = keyed_clip(clip);
  double span = keyed.duration / speed;
  if (keep_last && span > 0) span = std::max(1.0, std::round(span * rate)) / rate;
  const double scale = keyed.duration > 0 ? span / keyed.duration : 1;
  for (KeyedJoint& joint : keyed.joints) {
    for (auto* times : {&joint.position.times, &joint.rotation.times}) {
      for (double& time : *times) time = std::min(time * scale, span);
    }
    set_curve(joint.position, VectorCurve::hermite, tension);
    set_curve(joint.rotation, RotationCurve::squad, tension);
  }
  keyed.duration = span;
  return uniform_clip(keyed, rate);
}

}  // namespace krok
