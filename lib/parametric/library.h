#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "parametric/footprint.h"
#include "parametric/parameter.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"

// A library of variations of one motion, such as steps of different lengths: shared data, and the
// examples with their measured parameters.

namespace krok::parametric {

// A motion relative to the footprint of its stance foot at the first keytime: the heel is at the
// origin, the toes point to +Z.
struct Example {
  std::string name;               // display name: "walk_07 2 left"
  std::string style;              // of its capture: a person, a mood; empty if not known
  Clip motion;                    // on the library's skeleton, without provenance
  std::vector<double> keytimes;   // [keytimes], seconds from the motion's first frame, rising
  std::vector<Contact> contacts;  // in the frame and time of `motion`
  bool mirrored = false;
  std::vector<double> parameters;  // measured, [parameters]: metres, radians, seconds
  double ground = 0;  // height of that footprint in the capture, metres; not saved in a file
};

struct Library {
  Skeleton skeleton;
  std::vector<GivenRole> given_roles;  // those that a role map gave; the others are detected
  FootSide swing = FootSide::left;     // the stepping foot; the other is the stance foot
  std::array<FootShape, 2> feet;       // [FootSide]
  std::vector<std::string> keytimes;   // names, at least two: "stance_strike", ...
  std::vector<Parameter> parameters;   // what is measured
  double rate = 30;                    // frames per second of synthesised motions
  std::vector<Example> examples;
  // Height of footprints in the captures, metres: of soles, which are estimated, above the origin.
  // Motions are relative to the footprint, and lie where the captures do if moved up by this.
  double ground = 0;

  FootSide stance() const { return swing == FootSide::left ? FootSide::right : FootSide::left; }
  const FootShape& foot(FootSide side) const { return feet[static_cast<std::size_t>(side)]; }
  int dimensions() const { return static_cast<int>(parameters.size()); }
  // The same with other examples; this one's are not copied, which may be thousands.
  Library with(std::vector<Example> others) const;
};

// Min interval between keytimes, seconds: two frames at the library's rate, at most 10 ms. (In fast
// walks the foot lifts 10 to 30 ms after the other one strikes, less than two frames of most
// captures.)
double shortest_interval(const Library& library);

// The roles of the library's joints: those given, and the others by find_roles().
RoleMap roles_of(const Library& library);
// The roles in `map` that were given, for Library::given_roles.
std::vector<GivenRole> given_roles(const RoleMap& map);

// The capture that an example was cut from, by its name: without the number and the side.
std::string_view capture_of(std::string_view example);

// [examples] which capture each is of, from 0.
std::vector<int> captures_of(const Library& library);

// The joint that carries the motions: the hips, or the root.
int carrying_joint(const Library& library);

// Whether two skeletons can share a library: same names, order and parents; offsets of joints below
// the hips in the reference poses equal to within a hundredth of the skeleton's extent, but for end
// sites that are not of a foot. Code: parametric-skeleton, naming the joint.
Status same_skeleton(const Skeleton& library, const Skeleton& other);

// Makes an example of a motion with keytimes (seconds): moves it into the stance foot's frame and
// measures its parameters. `contacts` are those of the motion. Codes: parametric-skeleton;
// parametric-keytimes if times do not match the library, do not rise by at least
// shortest_interval(), or lie outside the motion; parametric-foot as in Measure.
Result<Example> make_example(const Library& library, std::string name, const Clip& motion,
                             std::vector<double> keytimes, std::vector<Contact> contacts = {});

// The footprint of a foot in a motion, at `time` (seconds).
Footprint print_at(const FootShape& foot, const Clip& motion, double time);

// The median height of the examples' footprints; 0 if they are not on one level (over 5 cm apart).
double ground_of(const Library& library);

// Validates a library: the invariants above hold, feet have joints, all examples have frames and
// finite parameters, and names have 1 to 1,000 bytes. A library may be empty. Codes: those of
// check(Skeleton), check(Clip), check(MotionKeys) and check(parameters), parametric-feet,
// parametric-keytimes, parametric-example.
Status check(const Library& library);

// Swaps left and right and keeps the parameters, so that a library of left steps makes right steps.
// Code: parametric-feet if a foot has no mirror joint.
Result<Library> mirrored(const Library& library);

}  // namespace krok::parametric
