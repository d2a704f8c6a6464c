#pragma once

#include <optional>
#include <string>
#include <vector>

#include "character/mesh.h"
#include "character/motion.h"
#include "character/space.h"
#include "core/file.h"
#include "core/result.h"
#include "nodes/evaluate.h"
#include "tools/cli/output_set.h"
#include "tools/cli/tool.h"
#include "tools/krok-import/facts.h"
#include "tools/krok-import/options.h"

namespace krok::cli::import {

// Converts a scene to Krok's formats.
class SceneImporter {
 public:
  SceneImporter(const InputFile& input, const Options& options, const CaptureOptions& how,
                const nodes::Scene& scene, const nodes::Evaluator& evaluator, ToolContext& context)
      : path_(input.path()),
        options_(options),
        how_(how),
        context_(context),
        scene_(scene),
        evaluator_(evaluator),
        outputs_(context) {}

  // Runs the import; no outputs are left if it fails.
  Result<int> run();

 private:
  bool wants_motion() const { return !context_.output.empty() && !still_; }
  bool wants_model() const { return !options_.model.empty(); }
  bool wants_character() const { return !options_.character.empty(); }
  bool wants_camera() const { return !options_.cam.empty(); }
  bool wants_morphs() const { return !options_.morphs.empty() || !options_.weights.empty(); }
  void warn(const char* code, std::string message, std::string hint = {},
            Severity severity = Severity::warning);
  static Error missing(const std::string& what, const std::string& option, std::string hint);

  // Selects the parts to import; determines unit and axes (scene_importer.cpp).
  Status choose();
  Status choose_camera();
  Status choose_animations();
  Status find_rig();
  Status find_space();

  // Writes the outputs (scene_outputs.cpp).
  Status add_actor();
  Status add_model();
  void report_model();
  Status add_whole_character();
  Status add_morphs();
  Status add_weights(const ChosenClip& clip, const character::ChosenSampling& sampling);
  Status add_clips();
  Status add_clip(const ChosenClip& clip);
  void report_sampling(const ChosenClip& chosen, const nodes::Animation& animation,
                       const character::Sampling& sampling, Json& facts);
  Status add_camera(const ChosenClip& clip, const character::ChosenSampling& sampling);

  void report_what_else_is_there();
  void report();

  const std::string path_;
  const Options& options_;
  const CaptureOptions& how_;
  ToolContext& context_;
  const nodes::Scene& scene_;
  const nodes::Evaluator& evaluator_;
  NewFolders textures_;  // declared before the files in it
  OutputSet outputs_;

  std::vector<ChosenClip> clips_;
  std::vector<int> cameras_;               // nodes
  bool still_ = false;                     // in a batch: a file without animations
  int camera_ = -1;                        // node of the camera to write
  std::optional<ChosenClip> camera_clip_;  // if it is not that of the motion
  std::optional<character::Rig> rig_;
  RoleMap roles_;  // of the rig's joints
  character::SceneActor actor_;
  character::ScenePlace place_;
  Json result_ = Json::object(), clip_facts_ = Json::array();
  std::string line_;
};

}  // namespace krok::cli::import
