#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/sequences/sequences.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "tools/common/tool.h"
#include "tools/krok-edit/options.h"

// The steps of an edit. Each does nothing where its options do not ask for it, and otherwise notes
// what it did.

namespace krok::edit {

// A motion on its way through the steps.
struct Edit {
  Clip clip;
  RoleMap roles;
  int carrier = 0;  // the joint that stands for the figure's place
  // What its options speak of, read beforehand.
  std::optional<sequences::SequenceFile> sequences;
  std::string sequence;        // the one to cut out, or empty
  std::vector<Clip> appended;  // in the order of Options::append

  double speed = 1;   // asked for by options and sequence together
  bool loop = false;  // likewise
  Json steps = Json::array();
  std::vector<std::string> lines;  // what was done, for people and for provenance

  // `figures` are put under the step's name into the report.
  void note(const char* step, Json metrics, std::string line);
};

// "12.5 deg"; "0 deg" below 1e-4 degrees.
std::string in_degrees(double radians);

// Whether all parts that the sequences' file names lie within the motion.
Status check_sequences(const Options& options, const Edit& edit);

Status clean(const Options& options, ToolContext& context, Edit& edit);
Status cut_out(const Options& options, ToolContext& context, Edit& edit);
Status mirror_sides(const Options& options, ToolContext& context, Edit& edit);
Status change_timing(const Options& options, ToolContext& context, Edit& edit);
Status append_motions(const Options& options, ToolContext& context, Edit& edit);
Status make_loop(const Options& options, ToolContext& context, Edit& edit);
Status take_out_travel(const Options& options, ToolContext& context, Edit& edit);
Status change_size(const Options& options, ToolContext& context, Edit& edit);
Status change_place(const Options& options, ToolContext& context, Edit& edit);

}  // namespace krok::edit
