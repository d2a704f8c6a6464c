#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/result.h"
#include "parametric/footprint.h"
#include "parametric/parameter.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"

// A library of variations of one motion, such as steps of different lengths: what is common to
// them, and the examples with their measured parameters.

namespace krok::parametric {

// A motion as seen from the footprint of its stance foot at the first keytime: the heel is at the
// origin, the toes point to +Z.
struct Example {
  std::string name;               // for people: "walk_07 2 left"
  Clip motion;                    // of the library's skeleton, without provenance
  std::vector<double> keytimes;   // seconds from the motion's first frame, rising, [keytimes]
  std::vector<Contact> contacts;  // in the motion's frame and time
  bool mirrored = false;
  std::vector<double> parameters;  // measured, [parameters]: metres, radians, seconds
};

struct Library {
  Skeleton skeleton;
  FootSide swing = FootSide::left;    // the foot that steps; the other one is the stance foot
  std::array<FootShape, 2> feet;      // [FootSide]
  std::vector<std::string> keytimes;  // names, at least two: "stance_strike", ...
  std::vector<Parameter> parameters;  // what is measured
  double rate = 30;                   // frames a second of the motions that are made
  std::vector<Example> examples;

  FootSide stance() const { return swing == FootSide::left ? FootSide::right : FootSide::left; }
  const FootShape& foot(FootSide side) const { return feet[static_cast<std::size_t>(side)]; }
  int dimensions() const { return static_cast<int>(parameters.size()); }
};

// What no interval between keytimes may fall below, seconds: two frames of the library's rate, or
// 10 ms where those last longer. (Who walks fast lifts the foot 10 to 30 ms after the other one
// strikes, which is less than two frames of most captures.)
double shortest_interval(const Library& library);

// Whether two skeletons are one to a library: names, order, parents, and the reference poses'
// offsets up to a hundredth of the figure's extent. Code parametric-skeleton, with the joint.
Status same_skeleton(const Skeleton& library, const Skeleton& other);

// A motion with its keytimes (seconds) made an example: brought into the stance foot's frame, its
// parameters measured. `contacts` are the motion's. Codes: parametric-skeleton; parametric-keytimes
// where times do not fit the library, do not rise by shortest_interval(), or lie outside the
// motion; parametric-foot as Measure.
Result<Example> make_example(const Library& library, std::string name, const Clip& motion,
                             std::vector<double> keytimes, std::vector<Contact> contacts = {});

// Whether what the comments above promise holds, feet have joints, all examples have frames and
// finite parameters, and no name is empty or longer than 1,000 bytes. A library may have no
// examples. Codes: those of check(Skeleton), check(Clip), check(MotionKeys) and check(parameters),
// parametric-feet, parametric-keytimes, parametric-example.
Status check(const Library& library);

// Left and right exchanged, parameters the same: how a library of steps to the left makes steps to
// the right. `roles` are those of the library's skeleton. Codes: parametric-feet where a foot has
// no partner.
Result<Library> mirrored(const Library& library, const RoleMap& roles);

}  // namespace krok::parametric
