#pragma once

#include <optional>
#include <string>
#include <vector>

#include "blend/time_map.h"
#include "core/numbers.h"
#include "core/result.h"
#include "motion/hips_root.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"
#include "timeline/easing.h"

// A timeline: a sequence of motions with transitions between them, and layers on top for parts of
// the body. mix() (mix.h) evaluates it into one motion.
//
// Times are seconds of the result unless stated otherwise; a ClipTime in frames counts frames of
// the motion or of the result that it refers to. `where` members are for messages.

namespace krok::timeline {

// Tolerance for times that should be equal, seconds.
inline constexpr double kTimeRounding = 1e-6;

// A named range of a motion, both ends included.
struct Part {
  std::string name;
  ClipTime from, to;  // of the motion
  double speed = 1;
  bool loop = false;  // whether it is meant to repeat
};

struct Source {
  std::string name;
  const Clip* clip = nullptr;        // at least one frame
  const MotionKeys* keys = nullptr;  // may be null
  std::vector<Part> parts;
};

// Which range of a motion is played, and how.
struct Play {
  int source = 0;
  std::string part;                  // name of a part of the source; empty: `from` and `to`
  std::optional<ClipTime> from, to;  // of the source; default: the ends of the part or motion
  // 2 is twice as fast, negative plays from `to` back to `from`; default: the part's speed or 1.
  std::optional<double> speed;
  // Number of loop rounds; each continues from where the previous one left the character. 0: until
  // ended by `until` or the next item. Default: 0 for a looping part that `until` or the next item
  // ends, otherwise 1.
  std::optional<int> rounds;
  std::optional<ClipTime> until;  // end time in the result
};

struct Mark {
  std::string name;
  ClipTime at;             // since the start of the item, or
  bool of_source = false;  // of the source: fires each time it is passed
};

enum class ChangeKind : unsigned char {
  cut,        // switches to the next item
  crossfade,  // blends both items
  smooth,     // inserts a transition between the last pose and the next item's first pose
  inertial    // switches to the next item; the offset between the two decays (inertialization)
};

// Whether a crossfade aligns both motions in time by their keytimes.
enum class Sync : unsigned char { automatic, keytimes, clock };

// What positions the next motion: the carrying joint, or the feet that are in contact in both
// motions (the carrying joint if there are none).
enum class Align : unsigned char { root, stance };

struct Change {
  ChangeKind kind = ChangeKind::cut;
  double duration = 0;  // seconds, > 0 except for a cut
  Easing easing;        // crossfade and smooth
  Sync sync = Sync::automatic;
  Align align = Align::stance;
  bool guard = true;  // inertial: prevents overshoot of the decaying offset
};

// A full-body motion.
struct BaseItem {
  std::string name;
  Play play;
  Change change;  // from the previous item; ignored for the first
  // When the change into it begins. Default: the previous item plays to its end (a crossfade ends
  // there, other changes begin there). The first item begins at 0.
  std::optional<ClipTime> at;
  // Ground frame in its first frame. Default: continues from the previous item; the first item
  // keeps that of its motion.
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
  blend::WeightCurve weight = blend::WeightCurve::constant(1);  // over seconds since its start
  std::vector<Mark> marks;
  Location where;
};

// Which joints a layer moves, and their weight. Later rules override earlier ones.
struct MaskRule {
  std::string joints;  // a name or a pattern with * and ?, or
  std::string below;   // a joint with all its descendants
  double weight = 1;   // 0 to 1
  // For `below`: the weight ramps up linearly over this many joints from the top, starting with
  // weight / (soft + 1).
  int soft = 0;
  Location where;
};

enum class LayerMode : unsigned char {
  override,  // replaces the pose below it
  additive,  // adds the difference from its reference, weights 0 to 1
  modifier   // additive with any weight
};

// The space in which an override layer's rotations are applied.
enum class Space : unsigned char {
  parent,  // relative to the parent: an arm follows the trunk
  model    // relative to the character's heading: a trunk stays upright whatever the hips do
};

struct Layer {
  std::string name;
  LayerMode mode = LayerMode::override;
  Space space = Space::parent;
  std::vector<MaskRule> mask;  // empty: all joints
  // Reference of additive layers: a time of each item's source; default: the item's first pose.
  std::optional<ClipTime> reference;
  bool reference_pose = false;  // use the skeleton's reference pose instead
  std::vector<LayerItem> items;
  Location where;
};

struct Timeline {
  double rate = 0;  // frames per second; 0: that of the first item's motion
  std::vector<BaseItem> base;
  std::vector<Layer> layers;
};

// Name for display.
std::string_view change_name(ChangeKind kind);

}  // namespace krok::timeline
