#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "capture/conventions.h"
#include "formats/io/inputs.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "scene/morph_set.h"
#include "scene/skeleton.h"
#include "scene/stretch.h"

// Motions from any file that holds one: .anim, BVH, AMC with the ASF beside it, scenes (glTF, FBX
// and so on) with their skeleton and the best of their animations. Captures and scenes are read
// with their conventions detected, as krok-import reads them without options; what was detected or
// looks wrong is reported to `inputs`. The clip's provenance has the conversions.
//
// Errors: those of the format's reader; usage for an ASF alone; motion-missing for a scene without
// animations; what is in no known format is refused as the .anim reader refuses it.

namespace krok::io {

struct MotionOptions {
  // That the first frame looks like a rest pose is a note rather than a warning: for callers that
  // use only a part of the motion, which it is not in.
  bool rest_frame_is_note = false;

  // Gets the morph weights of an animation of a scene that moves any, at the frames of the motion.
  MorphWeights* weights = nullptr;

  // Gets the stretches of the joints, none for rigid ones. Without it they are dropped with a
  // warning (code anim-stretch): the one place where an operation on rigid joints says so.
  Stretches* stretches = nullptr;

  // Gets what gives the motion's provenance while stream_motion() runs; a capture's is complete
  // once all frames were read.
  std::function<Provenance()>* provenance = nullptr;
};

Result<Clip> open_motion(const std::string& path, Inputs& inputs,
                         const MotionOptions& options = {});
// The same of a file that is open already.
Result<Clip> open_motion(const InputFile& file, Inputs& inputs, const MotionOptions& options = {});

// What is known of a motion once its frames were used.
struct MotionSummary {
  Skeleton skeleton;
  double rate = 30.0;  // frames per second
  int frame_count = 0;
  double duration = 0;                                 // seconds
  std::vector<std::string> conversions;                // those of reading a capture
  std::optional<RootMotion> removed_root_motion = {};  // of a motion in place, see Provenance
};

// Passes the frames of a motion to `use`, without holding a long capture in memory. `use` is called
// a second time where a capture proves damaged on the way, then with what can be read of the file,
// and has to discard what it did before. The error of `use` is passed on. Stretches that the
// options ask for are there when `use` is called.
Result<MotionSummary> stream_motion(const std::string& path, Inputs& inputs,
                                    const std::function<Status(const FrameSource& frames)>& use,
                                    const MotionOptions& options = {});
// The same of a file that is open already.
Result<MotionSummary> stream_motion(const InputFile& file, Inputs& inputs,
                                    const std::function<Status(const FrameSource& frames)>& use,
                                    const MotionOptions& options = {});

// Takes the checksum of a file opened by open_long_input() at the end of the scope. Both arguments
// must outlive it.
class ChecksumAtEnd {
 public:
  ChecksumAtEnd(const InputFile& input, Inputs& inputs) : input_(input), inputs_(inputs) {}
  ~ChecksumAtEnd();
  ChecksumAtEnd(const ChecksumAtEnd&) = delete;

 private:
  const InputFile& input_;
  Inputs& inputs_;
};

using FindRoles = std::function<Result<RoleMap>(const Skeleton& skeleton)>;

// Opens a role map (formats/role_map). The result maps a skeleton's joints to roles as the file
// says and may be used on several skeletons and threads; for an empty path it is find_roles(). Its
// errors are those of role_map::read().
Result<FindRoles> open_role_map(const std::string& path, Inputs& inputs);

// The BVH files of a batch, in which takes of one skeleton are to have the same axes: one that
// lies or crawls does not show them by itself. Thread-safe; the answers depend on neither the
// order of the questions nor the number of threads.
class Takes {
 public:
  // Of all shards, in any order; files that are no BVH do no harm.
  explicit Takes(std::vector<std::string> paths) : paths_(std::move(paths)) {}

  struct Axes {
    Direction up, forward, reference_up, reference_forward;
    Confidence confidence, forward_confidence;  // at most likely
    std::string reason;                         // a sentence without a full stop
    std::vector<std::string> from;              // the takes that were asked
  };

  // What most takes with the hierarchy of `text` show, each weighted by its confidence. At most 8
  // are asked, spread over the sorted paths. The root's OFFSET may differ. Empty without another.
  std::optional<Axes> axes_for(std::string_view text);

 private:
  struct Group {
    std::vector<std::string> paths;
    std::optional<Axes> axes;
  };

  void find_groups();

  std::mutex mutex_;
  std::vector<std::string> paths_;
  bool found_ = false;
  std::map<std::uint64_t, Group> groups_;
};

}  // namespace krok::io
