#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "math/transform.h"

// Curves of FBX and COLLADA, one number over time. Assimp 5.2 reads their keys alone, interpolates
// each curve linearly and rotations by slerp; resample() adds the keys that make this correct.
// Sources: COLLADA 1.4.1, "Curve Interpolation"; KFCurve in the FBX SDK's documentation.

namespace krok::assimp {

enum class Shape : unsigned char { linear, hold, hold_next, bezier };

// From a key to the next one: along the chord; the value of this key, or of the next; a Bezier
// curve.
struct Segment {
  Shape shape = Shape::linear;
  Vec2 out = Vec2::Zero(), in = Vec2::Zero();  // the inner points, time and value
};

struct Curve {
  std::vector<double> times{};      // seconds
  std::vector<double> values{};     // angles in degrees
  std::vector<Segment> segments{};  // [times - 1]
  double metres = 0;                // per unit of a length; 0 for other values
  bool turns = false;               // one axis of a rotation; set by resample()
  bool changed = false;             // by resample()

  // Clamped to the first and last key.
  double at(double time) const;
};

// A factor of a rotation; the product has the order of the list.
struct Turn {
  Vec3 axis = Vec3::UnitX();  // unit
  double degrees = 0;         // without a curve
  int curve = -1;
};

struct Resampling {
  double rate = 0;     // of the new keys, per second; 0 if there are none
  double frames = 0;   // per second, whose whole number that is: those of the curves' own keys
  double degrees = 0;  // the largest deviation of a rotation between them
  double metres = 0;   // and of a length
  double gap = 0;      // seconds, the longest between keys of curves whose rule is not known
};

struct CurveSet {
  std::vector<Curve> curves{};
  std::vector<std::vector<Turn>> rotations{};
  bool pivots = false;  // rotations about other points than joints: they move these along arcs
  Resampling result{};
};

// Equal one metre from a joint.
inline constexpr double kCurveDegrees = 0.02, kCurveMetres = 3.5e-4;

// Adds keys if linear interpolation, or slerp of a rotation, deviates from the curves, on the
// frames of 1, 2, 4 or 8 times the rate on whose frames the keys are (60 for uneven ones): the
// lowest that holds both tolerances and takes at most a million keys. A step gets a key beside its
// jump. Keys less than 1.5 frames apart are baked and stay as they are. Curves whose times do not
// increase or whose numbers are not finite are left alone.
void resample(CurveSet& set);

// The items of a list, separated by spaces or commas; NaN for what is no number.
std::vector<std::string_view> words_of(std::string_view text);
std::vector<double> numbers_of(std::string_view text);

struct ResampledFile {
  std::string text;  // empty if nothing changes
  Resampling result;
};

// ASCII or binary FBX 7; nullopt if its structure cannot be followed.
std::optional<ResampledFile> resample_fbx(std::string_view text);

ResampledFile resample_collada(std::string_view text);

}  // namespace krok::assimp
