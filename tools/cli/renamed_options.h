#pragma once

#include <algorithm>
#include <functional>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

// Options by the names that they had before version 0.2, or that one expects from other tools. They
// are refused with the name as hint; in a script, one idea then has one name in all tools.

namespace krok::cli {

struct RenamedOption {
  std::string_view tool, before, now;  // no tool: any; names before, with spaces between

  bool was(std::string_view name) const {
    const auto spaced = [](std::string_view words) { return ' ' + std::string(words) + ' '; };
    return spaced(before).find(spaced(name)) != std::string::npos;
  }
};

inline constexpr RenamedOption kRenamedOptions[] = {
    // Of any tool; options only where the tool has them.
    {"", "--fps --rate", "krok-edit IN --rate N -o IN.anim first"},
    {"", "--fps --frame-rate --framerate -r", "--rate"},
    {"", "--format", "-o with that ending"},
    {"", "--output-format", "-o with that ending; krok-import writes .anim, krok-export others"},
    {"", "--in --input -i", "inputs without an option"},
    {"", "--animation", "--clip"},
    {"", "--config", "--profile"},
    {"", "--from --start --end", "krok-edit --from TIME --to TIME on the motion"},
    {"", "--footprints", "--prints"},
    {"", "--take --clip --clips", "'IN#NAME' as the input, in quotes: one animation of a file"},
    {"", "--mapping", "--map"},
    {"", "--mirror", "krok-edit --mirror on the motion"},
    {"", "--precision", "--digits"},
    {"", "--terrain", "--ground"},
    {"", "--start -ss", "--from"},
    {"", "-to -t --end", "--to"},
    {"", "--frames", "--from TIME --to TIME; 120f is frame 120"},
    {"", "--out", "-o"},
    {"", "--out", "--out-dir for a folder or several files, -o for one"},
    {"", "--out-folder --outdir --output-dir --output-folder", "--out-dir"},
    {"", "--overwrite", "-o alone: files are replaced, unless --no-clobber is given"},
    {"", "--recursive", "a folder: its sub-folders are read, too"},
    {"", "--threads --workers", "--jobs"},
    // How a capture is read is for krok-import; other tools read it as that does without options.
    {"", "--unit", "krok-import IN --unit UNIT -o IN.anim first, and then that file"},
    {"", "--up", "krok-import IN --up AXIS -o IN.anim first, and then that file"},
    {"", "--forward", "krok-import IN --forward AXIS -o IN.anim first, and then that file"},
    {"", "--positions", "krok-import IN --positions KIND -o IN.anim first, and then that file"},
    {"", "--axes-from", "krok-import IN --axes-from TAKE -o IN.anim first, and then that file"},
    {"", "--skip-rest-frame", "krok-import IN --skip-rest-frame auto -o IN.anim first"},
    {"", "--skeleton", "krok-import IN --skeleton NAME -o IN.anim first, and then that file"},
    {"", "--onto", "krok-retarget IN --onto TARGET -o IN.anim first"},
    {"", "--plant", "krok-edit IN --plant -o IN.anim first"},
    {"", "--in-place", "krok-edit IN --in-place -o IN.anim"},
    {"krok-blend", "--align", "--match-root"},
    {"krok-blend", "--keys", "--contacts"},
    {"krok-blend", "--at", "krok-edit A --append B --blend TIME for one motion after the other"},
    {"krok-blend", "--duration", "krok-edit A --append B --blend TIME for one after the other"},
    {"krok-blend", "--alpha --weight --weights", "IN:WEIGHT, such as walk.anim:0.7 run.anim:0.3"},
    {"krok-body", "--height", "krok-edit --height before"},
    {"krok-body", "--gender", "joints of that build: the body follows the skeleton"},
    {"krok-body", "--resolution", "--detail"},
    {"krok-cam", "--focal-length", "--lens"},
    {"krok-cam", "--height", "--elevation, the angle from which it looks down"},
    {"krok-cam", "--joint --look-at --target --track", "--follow"},
    {"krok-cam", "--zoom", "--lens MM, --fov or --distance"},
    {"krok-diff", "-o --output", "--summary OUT.html, OUT.xml (JUnit) or OUT.md"},
    {"krok-diff", "--epsilon --threshold --eps", "--tolerance"},
    {"krok-diff", "--ignore-order", "--match name, or --match nearest for vertices"},
    {"krok-diff", "--ignore", "--exclude"},
    {"krok-diff", "--ignore-root", "krok-edit --in-place on both before"},
    {"krok-diff", "--html --report", "--summary OUT.html"},
    {"krok-diff", "--joints", "--joint-tolerance"},
    {"krok-diff", "--junit --xml", "--summary OUT.xml"},
    {"krok-diff", "--sides", "--view"},
    {"krok-diff", "--size", "--actor-size"},
    {"krok-edit", "--duration --crop --cut --trim", "--from TIME --to TIME"},
    {"krok-edit", "--end", "--to"},
    {"krok-edit", "--flip", "--mirror"},
    {"krok-edit", "--fps --resample", "--rate"},
    {"krok-edit", "--lowpass", "--filter butterworth --cutoff 6Hz"},
    {"krok-edit", "--foot-lock --fix-feet", "--plant"},
    {"krok-edit", "--offset --translate", "--move"},
    {"krok-edit", "--remove-root-motion", "--in-place, or --treadmill"},
    {"krok-edit", "--root-motion", "--in-place, --treadmill or --game-loop"},
    {"krok-edit", "--reverse", "a timeline of krok-mix: {\"source\": \"walk\", \"speed\": -1}"},
    {"krok-edit", "--order", "--filter-order"},
    {"krok-edit", "--rotate", "--turn"},
    {"krok-edit", "--smooth", "--filter auto"},
    {"krok-edit", "--speed", "--playback-speed"},
    {"krok-edit", "--start", "--from"},
    {"krok-edit", "--no-root --remove-root", "--in-place"},
    {"krok-edit", "--unit --units", "krok-import --unit; a motion is in metres"},
    {"krok-export", "--angles", "--what angles"},
    {"krok-export", "--axis-up --up", "the importer's axes: what is written has y up"},
    {"krok-export", "--draco", "krok-skin --compress, for a mesh; krok-skin --reduce drops keys"},
    {"krok-export", "--end --from --start", "krok-edit --from TIME --to TIME before"},
    {"krok-export", "--joint --joints", "the rows or columns you need: all joints are written"},
    {"krok-export", "--every --fps --rate", "krok-edit --rate before"},
    {"krok-export", "--forward", "the importer's axes: what is written faces z"},
    {"krok-export", "--frames", "krok-edit --from TIME --to TIME before; 120f is frame 120"},
    {"krok-export", "--rotate-mode --rotation-order", "--order"},
    {"krok-export", "--scale", "--unit, or krok-edit --scale before"},
    {"krok-export", "--to", "--format"},
    {"krok-fit", "--out-dir", "-o OUT.steps: one library of all inputs"},
    {"krok-fit", "--parameters", "\"parameters\" of a description (formats/library/SPEC.md)"},
    {"krok-fit", "--plots", "--plot"},
    {"krok-fit", "--smooth", "--smoothing"},
    {"krok-fit", "--until", "--max-error"},
    {"krok-ik", "--look", "--look-at"},
    {"krok-ik", "--at --time", "--reach JOINT=PLACE@TIME"},
    {"krok-ik", "--from", "--reach JOINT=PLACE@FROM..TO"},
    {"krok-ik", "--margin", "--limit-margin"},
    {"krok-ik", "--method", "--solver"},
    {"krok-ik", "--pole", "a goal of kind pole (--goals), see formats/goals/SPEC.md"},
    {"krok-ik", "--pin", "--reach JOINT=PLACE@FROM..TO; feet without goals stay by themselves"},
    {"krok-ik", "--target", "--reach"},
    {"krok-ik", "--write-limits", "--save-limits"},
    {"krok-import", "--axis-up --up-axis", "--up"},
    {"krok-import", "--axis-forward --forward-axis", "--forward"},
    {"krok-import", "--cam", "--save-cam"},
    {"krok-import", "--character", "--save-character"},
    {"krok-import", "--frame-rate --framerate",
     "--fps, the file's rate, or --rate, which resamples"},
    {"krok-import", "--frame-time", "--fps 120, which is 1 / 0.00833, or --rate, which resamples"},
    {"krok-import", "--global-scale --scale", "--unit: m, cm, mm, in or ft"},
    {"krok-import", "--model", "--save-model"},
    {"krok-import", "--morphs", "--save-morphs"},
    {"krok-import", "--resample", "--rate"},
    {"krok-import", "--root", "--map IN.json, which says what part of the body a joint is"},
    {"krok-import", "--units", "--unit"},
    {"krok-import", "--frames", "krok-edit --from TIME --to TIME; 120f is frame 120"},
    {"krok-import", "--format", "krok-export --format; krok-import writes .anim"},
    {"krok-import", "--list-clips", "krok-info, which lists them"},
    {"krok-info", "--format --csv --table", "--json"},
    {"krok-info", "--frames", "krok-export -o OUT.csv, which writes the values of each frame"},
    {"krok-info", "--joints", "-v, which lists the joints with their roles"},
    {"krok-keys", "--csv --gait", "--table"},
    {"krok-keys", "--events", "-o OUT.csv, or -o OUT.keys.json"},
    {"krok-keys", "--fps", "krok-import --fps before"},
    {"krok-keys", "--keys", "--contacts"},
    {"krok-keys", "--set", "--keytime"},
    {"krok-keys", "--threshold", "--contacts or --keytime"},
    {"krok-keys", "--foot-height --height --velocity",
     "--add-contact and --remove-contact: thresholds are found"},
    {"krok-lint", "-o", "--html OUT.html, --table OUT.csv or --junit OUT.xml"},
    {"krok-lint", "--csv", "--table"},
    {"krok-lint", "--disable --exclude", "--ignore"},
    {"krok-lint", "--severity", "--quiet, which prints only errors, or --ignore RULE"},
    {"krok-lint", "--report", "--html"},
    {"krok-lint", "--format", "--sarif, --junit, --html or --table, each with a file"},
    {"krok-lint", "--max --max-skate --max-slide --threshold --tolerance",
     "--profile IN.json, with the limits of the rules"},
    {"krok-lint", "--fail-on", "--ignore RULE, or --baseline: what is found is exit code 1"},
    {"krok-lint", "--keep-going",
     "inputs alone: files that cannot be read are faults (unreadable)"},
    {"krok-lint", "--rule", "--only"},
    {"krok-mix", "--keys", "--contacts"},
    {"krok-mix", "--fade --crossfade --transition --blend",
     "\"change\" of an item of the timeline; krok-edit A --append B --blend TIME"},
    {"krok-mix", "--fps --rate", "\"rate\" of the timeline"},
    {"krok-morph", "--by-order", "--match order"},
    {"krok-plot", "--angles", "--show angles"},
    {"krok-plot", "--contact-sheet", "--sheet"},
    {"krok-plot", "--cycles --mean --per-cycle", "--show cycles"},
    {"krok-plot", "--gait", "--show cycles; krok-keys has --table"},
    {"krok-plot", "--joints",
     "--joint NAME; cycles and angles draw hips, knees, ankles, shoulders, elbows"},
    {"krok-plot", "--keys", "--contacts"},
    {"krok-plot", "--sides", "--view"},
    {"krok-plot", "--save", "-o OUT.svg"},
    {"krok-plot", "--size", "--actor-size"},
    {"krok-plot", "--style", "--draw"},
    {"krok-plot", "--table", "--as-table"},
    {"krok-plot", "--what", "--show"},
    {"krok-plot", "--mean-only", "--show cycles, which draws mean and deviation"},
    {"krok-ragdoll", "--force", "the impulse --push Spine2=100Ns,0,0"},
    {"krok-ragdoll", "--from", "--at"},
    {"krok-ragdoll", "--gravity", "another --mass or --friction; gravity is 9.81 m/s2"},
    {"krok-ragdoll", "--impulse", "--push"},
    {"krok-render", "-s --resolution", "--size"},
    {"krok-render", "--background",
     "krok-skin -o OUT.glb and another renderer: this background is always the same"},
    {"krok-render", "--codec --crf", "-o NAME.mp4 (H.264), .webp or .gif; ffmpeg recodes films"},
    {"krok-render", "--duration", "--from TIME --to TIME"},
    {"krok-render", "--fps", "--rate"},
    {"krok-render", "--frame", "--from 60f -o OUT.png, one frame"},
    {"krok-render", "--sides", "--view"},
    {"krok-render", "--together", "--layout together"},
    {"krok-render", "--camera", "--view, or --cam IN.cam"},
    {"krok-retarget", "--character --model --target --dst --to", "--onto"},
    {"krok-retarget", "--source --src",
     "the motion without an option: krok-retarget IN --onto TARGET"},
    {"krok-retarget", "--fps --rate", "krok-edit --rate after it"},
    {"krok-skin", "--keep-animations", "'MESH.glb#CLIP' as a motion, beside the others"},
    {"krok-skin", "--map", "krok-retarget IN --onto TARGET --map MAP -o IN.anim first"},
    {"krok-skin", "--onto-map", "krok-retarget IN --onto TARGET --onto-map MAP -o IN.anim first"},
    {"krok-skin", "--onto", "--retarget: the mesh's skeleton is the target"},
    {"krok-skin", "--feet", "krok-retarget before, without --retarget"},
    {"krok-skin", "--scale", "krok-edit --scale before"},
    {"krok-retarget", "--retarget", "the command without it"},
    {"krok-retarget", "--ik", "the command without it: contacts keep their places"},
    {"krok-retarget", "--plant", "krok-edit --plant after it"},
    {"krok-skin", "--fps --rate", "--every N, or krok-edit --rate before"},
    {"krok-skin", "--draco", "--compress"},
    {"krok-skin", "--tolerance", "--reduce"},
    {"krok-skin", "--simplify", "a simpler mesh; --quantize and --compress make the file smaller"},
    {"krok-skin", "--clip-name --clip-names", "NAME=FILE, such as walk=take_7.anim"},
    {"krok-synth", "--duration", "--set duration=VALUE"},
    {"krok-synth", "--length", "--set length=VALUE"},
    {"krok-synth", "--table", "--points"},
    {"krok-synth", "--turn", "--set turn=VALUE"},
    {"krok-view", "--output-dir --out-dir", "-o OUT.html: one page with all inputs"},
    {"krok-view", "--keys", "--contacts"},
    {"krok-view", "--open", "-o OUT.html, and open that in a browser"},
    {"krok-view", "--camera", "the .cam file as another input"},
    {"krok-view", "--port", "-o OUT.html: the page is a file"},
    {"krok-walk", "--from", "--start"},
    {"krok-walk", "--style-of", "--style"},
    {"krok-walk", "--target --to", "--goal"},
    {"krok-walk", "--view", "--save-page"},
    {"krok-walk", "--way", "--path"},
    {"krok-walk", "--distance", "--goal 0m,LENGTH"},
};

// The row of an option that a tool refuses; its own rows, which come after those of any tool, win.
// `has` is whether the tool has an option. nullptr for none.
inline const RenamedOption* renamed_option(
    std::string_view tool, std::string_view before,
    const std::function<bool(const std::string& option)>& has) {
  const auto fits = [&](const RenamedOption& option) {
    if (!option.was(before) || (!option.tool.empty() && option.tool != tool)) return false;
    const std::string now(option.now.substr(0, option.now.find(' ')));
    return !option.tool.empty() || !now.starts_with('-') || has(now);
  };
  const auto none = std::rend(kRenamedOptions);
  const auto row = std::find_if(std::rbegin(kRenamedOptions), none, fits);
  return row == none ? nullptr : &*row;
}

// What helps who gives a tool more inputs than it takes, or others; empty for most tools.
inline std::string too_many_hint(std::string_view tool, const std::vector<std::string>& arguments) {
  const auto named = [&](std::string_view ending) {
    const auto found = std::ranges::find_if(
        arguments, [&](const std::string& word) { return word.ends_with(ending); });
    return found == arguments.end() ? std::string() : *found;
  };
  if (tool == "krok-import" && !named(".asf").empty() && !named(".amc").empty()) {
    return "an .asf is the skeleton of the .amc: write " + named(".amc") + " --skeleton " +
           named(".asf");
  }
  if (tool == "krok-fit") {
    return "the clips are named in a description (.json, formats/library/SPEC.md): {\"schema\": "
           "\"krok.library/1\", \"steps\": \"auto\", \"parameters\": [...], \"examples\": "
           "[{\"clip\": \"takes/*.bvh\"}]}";
  }
  if (tool == "krok-edit") {
    return "a file to be written is given with -o, a motion to go on with --append; for several "
           "inputs, use --out-dir DIR";
  }
  if (tool != "krok-mix") return {};
  return "a timeline is JSON that names its motions (formats/timeline/SPEC.md); krok-blend A B "
         "blends two motions, krok-edit A --append B puts one after the other";
}

}  // namespace krok::cli
