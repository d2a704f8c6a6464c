#pragma once

#include <optional>
#include <string>
#include <vector>

#include "blend/time_map.h"
#include "core/quantity.h"
#include "core/result.h"
#include "motion/ground_frame.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"
#include "timeline/easing.h"

// What an animation controller is told: motions one after the other and how one goes over into the
// next, and layers of others on top, for parts of the body. mix() (mix.h) makes one motion of it.
//
// Times are seconds of the result unless something else is said; ClipTimes in frames count those of
// the motion or of the result that they are a time of. A `where` is for messages.

namespace krok::timeline {

// Seconds by which moments that should be equal may differ.
inline constexpr double kTimeRounding = 1e-6;

// A named stretch of a motion; both ends belong to it.
struct Part {
  std::string name;
  ClipTime from, to;  // of the motion
  double speed = 1;
  bool loop = false;  // whether it is made to repeat
};

struct Source {
  std::string name;
  const Clip* clip = nullptr;        // a frame or more
  const MotionKeys* keys = nullptr;  // may be null
  std::vector<Part> parts;
};

// Which stretch of a motion is played, and how.
struct Play {
  int source = 0;
  std::string part;                  // of the source's; empty: by `from` and `to`
  std::optional<ClipTime> from, to;  // of the source; left out, the part's or the motion's ends
  // 2 is twice as fast, negative plays from `to` back to `from`; left out, the part's or 1.
  std::optional<double> speed;
  // How often it is played, each round going on where the one before left the figure. 0: until it
  // is ended by `until` or by what follows. Left out: 0 for a part that loops where `until` or what
  // follows ends it, otherwise 1.
  std::optional<int> rounds;
  std::optional<ClipTime> until;  // when it ends, in the result
};

struct Mark {
  std::string name;
  ClipTime at;             // since the item began, or ...
  bool of_source = false;  // ... of the source; each time it is passed
};

enum class ChangeKind : unsigned char {
  cut,        // the next one takes over
  crossfade,  // both are played, the weight going over
  smooth,     // a transition is put in between the last pose and the next one's first
  inertial    // the next one takes over; what is missing to it decays
};

// Whether a crossfade goes by keytimes, so that both motions are in step.
enum class Sync : unsigned char { automatic, keytimes, clock };

// What makes the figure go on where it is: its carrying joint, or the feet that stand by the
// contacts of both motions; where none do, the carrying joint.
enum class Align : unsigned char { root, stance };

struct Change {
  ChangeKind kind = ChangeKind::cut;
  double duration = 0;  // seconds, > 0 but for a cut
  Easing easing;        // crossfade and smooth
  Sync sync = Sync::automatic;
  Align align = Align::stance;
  bool guard = true;  // inertial: what is missing does not go beyond nothing
};

// A motion that moves the whole figure.
struct BaseItem {
  std::string name;
  Play play;
  Change change;  // from the item before; of no meaning for the first
  // When the change into it begins. Left out: so that the one before is played to its end (a
  // crossfade ends there, others begin there). The first begins at 0.
  std::optional<ClipTime> at;
  // Where the figure stands in its first frame; left out, where the item before left it, the first
  // one where its motion has it.
  std::optional<GroundFrame> place;
  std::vector<Mark> marks;
  Location where;
};

struct Fade {
  double duration = 0;  // seconds, >= 0
  Easing easing;
};

struct LayerItem {
  std::string name;
  Play play;
  ClipTime at;
  Fade fade_in, fade_out;
  blend::WeightCurve weight = blend::WeightCurve::constant(1);  // by seconds since it began
  std::vector<Mark> marks;
  Location where;
};

// Which joints a layer moves, and how much. Rules count in order, later ones over earlier ones.
struct MaskRule {
  std::string joints;  // a name or a pattern with * and ?, or ...
  std::string below;   // ... a joint with all joints below it
  double weight = 1;   // 0 to 1
  // Of a sub-tree: over so many joints from its top the weight rises evenly, 1 / (soft + 1) of it
  // at the first.
  int soft = 0;
  Location where;
};

enum class LayerMode : unsigned char {
  override,  // takes the place of what is below it
  additive,  // what it differs by from its reference is put on top, weights 0 to 1
  modifier   // the same with any weight
};

// In what an overriding layer's rotations are kept.
enum class Space : unsigned char {
  parent,  // relative to the parent: an arm goes along with the trunk
  model    // relative to the figure's heading: a trunk stays upright whatever the hips do
};

struct Layer {
  std::string name;
  LayerMode mode = LayerMode::override;
  Space space = Space::parent;
  std::vector<MaskRule> mask;  // empty: all joints
  // What additive layers differ from: a moment of each item's source; left out, its first.
  std::optional<ClipTime> reference;
  bool reference_pose = false;  // the skeleton's reference pose instead
  std::vector<LayerItem> items;
  Location where;
};

struct Timeline {
  double rate = 0;  // frames a second; 0: the first item's motion's
  std::vector<BaseItem> base;
  std::vector<Layer> layers;
};

// The word for people.
std::string_view change_name(ChangeKind kind);

}  // namespace krok::timeline
