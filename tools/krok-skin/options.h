#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/numbers.h"
#include "core/result.h"
#include "formats/pc2/pc2.h"
#include "scene/clip.h"
#include "skin/skin.h"
#include "tools/cli/tool.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::skin {

enum class Influences { all = 0, four = 4, eight = 8 };

enum class As { automatic, rig, motion, baked, pose, frames };

// In the name of --weights, the path of each motion without its ending.
inline constexpr std::string_view kClipInName = "{clip}";

// Command-line options.
struct Options {
  std::string subject;                      // a model or a character
  std::vector<std::string> motions;         // none: the reference pose
  std::vector<std::string> clip_names;      // of `motions`; empty: after its file
  bool retarget = false;                    // motions of other skeletons are moved to the mesh's
  std::string morphs;                       // --morph, empty: none
  std::string weights;                      // --weights, empty: none
  std::string correctives;                  // --correctives, empty: none
  std::vector<std::string> attached;        // --attach: PLACE=IN
  As as = As::automatic;                    // see what_to_write()
  SkinMethod method = SkinMethod::linear;   // always for --as rig
  std::optional<ClipTime> time;             // --as pose; empty: the start
  std::optional<ClipTime> from, to;         // time range; empty: the ends; not --as pose
  int every = 1;                            // frame step; not --as pose
  pc2::Up up = pc2::Up::y;                  // of a point cache
  TwistJoints twist;                        // to add to the model
  Influences influences = Influences::all;  // per vertex at most
  std::optional<double> reduce;             // --as rig: the tolerance, metres; empty: all keys
  bool quantize = false, compress = false;  // --as rig
  bool minify = false;                      // --as rig

  bool has_weights_by_clip() const { return weights.find(kClipInName) != std::string::npos; }
};

// What --as stands for: baked for a point cache (.pc2), else a rig, where it is not given.
As what_to_write(const Options& options, const std::string& output);

// Checks the options with what is written, once the output is known.
Status check_for(As as, const Options& options);

// The frames of a motion selected by --from, --to and --every; codes skin-no-frames, skin-time.
struct Range {
  int first = 0, last = 0, every = 1;
};
Result<std::optional<Range>> chosen_range(const Options& options, double rate, int frames);

// The time of --as pose in seconds; code skin-time.
Result<double> pose_time(const Options& options, const Clip& clip);

// The tool. Each call has options of its own.
ToolSpec make_spec();

// Reads the subject and its motion, skins it, and writes the output.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::skin
