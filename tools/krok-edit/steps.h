#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "formats/sequences/sequences.h"
#include "motion/loop.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "scene/model.h"
#include "scene/motion_keys.h"
#include "terrain/terrain.h"
#include "tools/cli/tool.h"
#include "tools/krok-edit/options.h"

// The steps of an edit. A step does nothing unless its options are given, and notes what it did.

namespace krok::cli::edit {

// The state of an edit.
struct Edit {
  Clip clip;
  // Of a long take: its frames, of which `clip` has only the first. See is_streamed().
  std::optional<FrameSource> frames;
  // Adds what is known only when the frames are written to the steps and lines. May be empty.
  std::function<void(Edit&)> when_written;
  RoleMap roles;
  int carrier = 0;  // the joint whose position is the actor's position
  // Inputs of options, read beforehand.
  std::optional<sequences::SequenceFile> sequences;
  std::string sequence;                          // to cut out, or empty
  std::optional<std::vector<Contact>> contacts;  // of the input; none: to be found
  std::vector<Keytime> keytimes;                 // of the input, for ends that are keytimes
  std::vector<FrameSource> appended;             // in the order of Options::append
  std::shared_ptr<const Terrain> ground;         // to settle on
  std::shared_ptr<const Model> model;            // to settle, or none

  double speed = 1;        // of options and sequence together
  bool loop = false;       // of options or sequence
  bool kept_loop = false;  // it is a loop in place already, and stays as it is
  double turn_rate = 0;    // radians per second that straightening a loop took out
  double climb_rate = 0;   // metres per second that a loop for an engine gains in height
  Json steps = Json::array();
  std::vector<std::string> lines;  // what was done, for display and provenance

  int frame_count() const { return frames ? frames->frame_count : clip.frame_count(); }
  // The motion so far.
  FrameSource source() const { return frames ? *frames : frames_of(clip); }
  // Takes the motion that a step makes of source().
  Status take(Result<FrameSource> made);

  // Loads all frames, for a step that needs them at once.
  Status hold(int jobs);

  // Adds `metrics` to the report under the step's name.
  void note(const char* step, Json metrics, std::string line);
  // Completes the last note when the frames are written: its metrics, and its line, which is
  // returned.
  void complete_note(std::function<std::string(Edit&, Json& metrics)> complete);
};

// "12.5 deg"; "0 deg" below 1e-4 degrees.
std::string in_degrees(double radians);

// The options that --game-loop sets, where they are not given. A motion that is a loop in place
// already is neither cut nor changed at its seam; the velocity at which its feet stay on the ground
// becomes its root motion.
void complete_game_loop(Options& options, Edit& edit);

// Whether all steps can do without the whole motion in memory: those that change Edit::frames where
// it is set. All others are listed there.
bool is_streamed(const Options& options);

// Checks that all sequences of the sequences file are within the motion.
Status check_sequences(const Options& options, const Edit& edit);

// Spikes, filter and foot planting.
Status clean(const Options& options, ToolContext& context, Edit& edit);
Status plant(const Options& options, ToolContext& context, Edit& edit);
// With --plant: closing the seam moves feet that stood, so they are planted again, over three
// cycles, of which the one in the middle repeats.
// Returns how far heels and balls drift in what it makes while they stand, metres.
Result<double> plant_loop(const Options& options, const Edit& edit, Looped& looped);
Status cut_out(const Options& options, ToolContext& context, Edit& edit);
Status mirror_sides(const Options& options, ToolContext& context, Edit& edit);
Status change_timing(const Options& options, ToolContext& context, Edit& edit);
Status append_motions(const Options& options, ToolContext& context, Edit& edit);
Status make_loop(const Options& options, ToolContext& context, Edit& edit);
Status take_out_travel(const Options& options, ToolContext& context, Edit& edit);
Status change_size(const Options& options, ToolContext& context, Edit& edit);
Status change_place(const Options& options, ToolContext& context, Edit& edit);
Status settle_on_ground(const Options& options, ToolContext& context, Edit& edit);

}  // namespace krok::cli::edit
