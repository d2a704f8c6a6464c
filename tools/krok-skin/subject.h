#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "scene/character.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "scene/material.h"
#include "scene/model.h"
#include "scene/morph_set.h"
#include "scene/stretch.h"
#include "tools/cli/tool.h"
#include "tools/krok-skin/options.h"

namespace krok::cli::skin {

// The input of skinning: a mesh and a motion on one skeleton, with morph targets.
struct Subject {
  Model model;  // on the motion's skeleton, with triangles
  Clip clip;    // the selected range
  // Of a long take: its frames, of which `clip` then has none; for --as rig and motion.
  std::optional<FrameSource> frames;
  Stretches stretches;             // of the joints in `clip`; none if they are rigid
  std::string clip_name;           // of its file; empty without a motion
  int first_frame = 0, every = 1;  // of the motion as read, for file names

  std::vector<Material> materials;   // of the model's parts; for characters
  bool unnamed_is_none = false;      // gltf::WriteOptions
  std::vector<Character::Eye> eyes;  // at joints of the model; for characters
  std::vector<Character::Socket> sockets;

  // A mesh that a joint carries.
  struct Thing {
    std::string name;    // of its file, without ending
    int joint = 0;       // of the model
    std::string socket;  // of `sockets`; empty: in the joint's frame
    Model model;         // its materials are in `materials`
  };
  std::vector<Thing> things;

  struct Motion {
    std::string name;
    Clip clip;
    Stretches stretches;   // of the joints in `clip`; none if they are rigid
    MorphWeights weights;  // at the frames of `clip`, or empty
  };
  std::vector<Motion> others;  // on the same skeleton, for --as rig and motion; names are unique

  MorphSet morphs;       // may have no targets
  MorphWeights weights;  // at the frames of `clip`, for the targets of `morphs`; or empty

  // The motions that --as rig and motion write: none for the reference pose, unless shapes change
  // in it, which then is called `still_name`.
  struct NamedMotion {
    std::string name;
    const Clip& clip;
    const FrameSource* frames;  // of a long take
    const Stretches& stretches;
    const MorphWeights& weights;
  };
  std::vector<NamedMotion> all_motions(const std::string& still_name) const;

  int frame_count() const { return frames ? frames->frame_count : clip.frame_count(); }
  double duration() const { return frames ? frames->duration() : clip.duration(); }
  bool changes_shape() const { return !weights.values.empty(); }
};

// Reads the input files. Codes: those of their readers, of bind_to() and chosen_range(),
// skin-empty-model, skin-morphs, skin-attach; with --retarget of transfer(). Motions that
// --keep-going leaves out are removed from the options. `take`: the only motion, without frames,
// and its frames, if they are not to be held in memory.
struct LongTake {
  const InputFile& subject;
  Clip clip;
  const FrameSource& frames;
};
Result<Subject> load(Options& options, ToolContext& context, const LongTake* take = nullptr);

}  // namespace krok::cli::skin
