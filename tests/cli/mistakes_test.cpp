// Plausible mistakes on the command line, and what helps against them: near names, completion,
// colours. Would fail if a typing mistake were answered with a riddle.
#include <filesystem>

#include "cli/motion_fixture.h"
#include "support/this_build.h"
#include "tools/cli/console_progress.h"

namespace krok::test {
namespace {

class Mistakes : public MotionTest {
 protected:
  Mistakes() { put("in.bvh", capture(30)); }

  // The messages of a run that must end with 2 and leave nothing.
  std::string refused(const std::string& tool, std::vector<std::string> arguments) const {
    const ToolRun run = run_here(tool, std::move(arguments));
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_EQ(run.out, "");
    return run.err;
  }
};

TEST_F(Mistakes, UnknownOptionsGetTheNearestName) {
  EXPECT_THAT(refused("krok-import", {"in.bvh", "--ouput", "a.anim"}),
              AllOf(HasSubstr("unknown option '--ouput'"), HasSubstr("did you mean '--output'?")));
  // A tool that needs -o names the mistake, not what is missing by it.
  EXPECT_THAT(refused("krok-export", {"in.bvh", "--ouput=a.glb"}), HasSubstr("'--output'"));
  EXPECT_THAT(refused("krok-edit", {"in.bvh", "--mirorr", "-o", "a.anim"}), HasSubstr("--mirror"));
  EXPECT_THAT(refused("krok-edit", {"in.bvh", "-Z", "-o", "a.anim"}),
              HasSubstr("unknown option '-Z'"));
  // What is near to nothing shows what there is.
  EXPECT_THAT(refused("krok-edit", {"in.bvh", "--xyzzy", "-o", "a.anim"}),
              AllOf(HasSubstr("--help"), HasSubstr("--mirror"), Not(HasSubstr("--jobs"))));
  EXPECT_THAT(refused("krok-skin", {"a.model", "in.bvh", "--as", "rgi", "-o", "a.glb"}),
              HasSubstr("did you mean 'rig'?"));
}

// Would fail if an option took the next one for its value, and what is left got the blame.
TEST_F(Mistakes, OptionsWithoutTheirValue) {
  EXPECT_THAT(refused("krok-edit", {"in.bvh", "--from", "--to", "2s", "-o", "a.anim"}),
              AllOf(HasSubstr("--from has no value"), HasSubstr("write --from TIME")));
  EXPECT_THAT(refused("krok-edit", {"in.bvh", "--ground", "-o", "a.anim"}),
              HasSubstr("'-o' is the next option"));
  EXPECT_THAT(refused("krok-plot", {"in.bvh", "--sheet"}), HasSubstr("write --sheet OUT.png"));
  // A file after --json would be an input.
  EXPECT_THAT(run_here("krok-lint", {"in.bvh", "--json", "report.json"}).err,
              HasSubstr("write --json=report.json"));
  // Numbers below zero are values.
  EXPECT_EQ(run_here("krok-edit", {"in.bvh", "--heading", "-90deg", "-o", "a.anim"}).exit_code, 0);
}

// Would fail if a low-pass that flattens a motion, or a focal length as an angle, got no word.
TEST_F(Mistakes, ValuesOfAnotherKind) {
  EXPECT_THAT(refused("krok-cam", {"in.bvh", "--follow", "Root", "--fov", "50mm", "-o", "a.cam"}),
              HasSubstr("--lens 50mm"));
  const ToolRun run = run_here(
      "krok-edit", {"in.bvh", "--filter", "butterworth", "--cutoff", "0.2", "-o", "a.anim"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_TRUE(has_code(run.err, "edit-cutoff")) << run.err;
}

// Would fail if habits from other tools, or files that are something else, led nowhere.
TEST_F(Mistakes, HabitsOfOtherToolsLeadOn) {
  put("pointer.glb", "version https://git-lfs.github.com/spec/v1\noid sha256:12ab\nsize 99\n");
  put("unity.anim", "%YAML 1.1\n--- !u!74 &7400000\nAnimationClip:\n");
  put("clips.json", R"({"clips": [{"file": "in.bvh"}]})");
  put("fade.json", R"({"schema": "krok.timeline/1", "sources": {"a": "in.bvh"},
                       "base": [{"source": "a"}, {"source": "a", "transition": 0.3}]})");
  put("table.csv", "frame,time,joint\n0,0,Root\n");
  const struct {
    std::string tool;
    std::vector<std::string> arguments;
    const char* hint;
  } mistakes[] = {
      {"krok-edit", {"in.bvh", "--rate", "1/30", "-o", "a.anim"}, "frames per second: 30"},
      {"krok-edit", {"in.bvh", "--plant=left", "-o", "a.anim"}, "--plant takes no value"},
      {"krok-edit", {"in.bvh", "-t", "2s", "-o", "a.anim"}, "--to"},
      {"krok-skin", {"in.bvh", "--quantize", "16", "-o", "a.glb"}, "--quantize takes no value"},
      {"krok-info", {"--format", "json", "in.bvh"}, "--json"},
      {"krok-diff", {"--ignore-order", "in.bvh", "in.bvh"}, "--match"},
      {"krok-skin", {"pointer.glb", "in.bvh", "-o", "a.glb"}, "git lfs pull"},
      {"krok-import", {"unity.anim", "-o", "a.anim"}, "from Unity as FBX"},
      {"krok-import", {"table.csv", "-o", "a.anim"}, ".npz"},
      {"krok-lint", {"in.bvh", "--only", "foot-slide=50mm"}, "--profile"},
      {"krok-mix", {"clips.json", "-o", "a.anim"}, "\"base\": [{\"source\""},
      {"krok-mix", {"fade.json", "-o", "a.anim"}, "\"kind\": \"crossfade\""},
      {"krok-info", {"in.bvh:run"}, "'in.bvh#run'"},
      {"krok-plot", {"table.csv", "--y", "frane", "-o", "a.svg"}, "did you mean 'frame'?"},
      {"krok-plot", {"table.csv", "--y", "Root_Y", "-o", "a.svg"}, "--where joint=NAME"}};
  for (const auto& [tool, arguments, hint] : mistakes) {
    EXPECT_THAT(refused(tool, arguments), HasSubstr(hint));
  }
  EXPECT_THAT(refused("krok-export", {"in.bvh", "--what", "rotations", "-o", "a.csv"}),
              AllOf(HasSubstr("quaternions has"), Not(HasSubstr("did you mean"))));
  const ToolRun fast = run_here("krok-edit", {"in.bvh", "--playback-speed", "50", "-o", "a.anim"});
  EXPECT_TRUE(has_code(fast.err, "edit-speed")) << fast.err;
}

// Would fail if a folder as input led to an error about the folder, once -o were added.
TEST_F(Mistakes, FoldersAreForBatchesAndFoldersAreNoFiles) {
  std::filesystem::create_directory(path("takes"));
  EXPECT_THAT(refused("krok-edit", {path("takes"), "--mirror"}), HasSubstr("add --out-dir DIR"));
  EXPECT_THAT(refused("krok-export", {path("takes")}), HasSubstr("add --out-dir DIR"));
  EXPECT_THAT(refused("krok-lint", {"in.bvh", "--fix", "x.anim"}),
              HasSubstr("the output is a folder, not x.anim"));
}

// Would fail if a word were taken for one that shares half of its letters, or led nowhere.
TEST_F(Mistakes, AValueThatAnOptionDoesNotTakeShowsWhatTheOptionDoes) {
  const std::string cycle = refused("krok-edit", {"in.bvh", "--cycle", "best", "-o", "a.anim"});
  EXPECT_THAT(cycle, Not(HasSubstr("did you mean")));
  EXPECT_THAT(cycle, HasSubstr("hint: Keep one gait cycle"));
  EXPECT_THAT(refused("krok-edit", {"in.bvh", "--filter", "6Hz", "-o", "a.anim"}),
              HasSubstr("--filter butterworth --cutoff 6Hz"));
}

TEST_F(Mistakes, UnknownJointsToo) {
  EXPECT_THAT(refused("krok-plot", {"in.bvh", "--joint", "Spin", "-o", "a.svg"}),
              HasSubstr("did you mean 'Spine'?"));
  EXPECT_THAT(refused("krok-plot", {"in.bvh", "--show", "angle", "-o", "a.svg"}),
              HasSubstr("did you mean 'angles'?"));
  EXPECT_THAT(refused("krok-plot", {"in.bvh", "--view", "fornt", "--sheet", "a.png"}),
              HasSubstr("did you mean 'front'?"));
}

// Would fail if a number of another unit, or words of another form, were taken as they are.
TEST_F(Mistakes, ValuesThatMeanSomethingElse) {
  struct Row {
    std::string tool;
    std::vector<std::string> arguments;
    std::string hint;
  };
  const Row rows[] = {
      {"krok-edit", {"--move", "100,0,0", "-o", "a.anim"}, "write 100cm, or 100m"},
      {"krok-edit", {"--move", "1m,0", "-o", "a.anim"}, "write X,Y,Z"},
      {"krok-edit", {"--loop", "--loop-blend", "10", "-o", "a.anim"}, "write 10f for frames"},
      {"krok-edit", {"-from", "1s", "-o", "a.anim"}, "did you mean '--from'?"},
      {"krok-edit", {"--from", "1", "s", "-o", "a.anim"}, "as one word: 1s"},
      {"krok-edit", {"in.bvh", "-o", "a.anim"}, "--append"},
      {"krok-edit", {"--mirror", "--out-dir", "a.anim"}, "--out-dir DIR one for each input"},
      {"krok-cam", {"--follow", "hips", "--fov", "0.7", "-o", "a.cam"}, "write 0.7rad"},
      {"krok-cam", {"--orbit", "1", "-o", "a.cam"}, "1.5turns or 540deg"},
      {"krok-info", {"-json"}, "did you mean '--json'?"},
      {"krok-plot", {"--sheet", "s.png", "--show", "angles"}, "add -o OUT.svg"},
      {"krok-plot", {"--show", "cycles", "--joint", "Spine", "-o", "a.svg"}, "add angles"},
      {"krok-render", {"--format", "png", "-o", "a.jpg"}, "write -o NAME.png"},
      {"krok-view", {"--out-dir", "pages"}, "-o OUT.html"},
      {"krok-ragdoll", {"--mass", "75000g", "-o", "a.anim"}, "from 0.001 to 100000kg"},
      {"krok-edit", {"--from", "50%", "-o", "a.anim"}, "write the quantity itself"},
      {"krok-edit", {"--settle", "--floor", "5", "-o", "a.anim"}, "write 5mm, or 5m"},
      {"krok-import", {"--skeleton", "smpl24", "-o", "a.anim"}, "a BVH file has its skeleton"}};
  for (const Row& row : rows) {
    std::vector<std::string> arguments = row.arguments;
    arguments.insert(arguments.begin(), "in.bvh");
    EXPECT_THAT(refused(row.tool, arguments), HasSubstr(row.hint));
  }
  // Decimal commas where a number is expected, and in lists, which have commas of their own.
  const Row commas[] = {
      {"krok-edit", {"--playback-speed", "1,5", "-o", "a.anim"}, "write 1.5: decimals"},
      {"krok-edit", {"--from", "0,5s", "-o", "a.anim"}, "write 0.5s: decimals"},
      {"krok-edit", {"--move", "1,5m,0,5m,2,5m", "-o", "a.anim"}, "write 1.5m,0.5m,2.5m: dec"},
      {"krok-ik", {"--stiffness", "spine=0,7", "-o", "a.anim"}, "write spine=0.7: decimals"},
      {"krok-diff", {"in.bvh", "--joint-tolerance", "0,5mm"}, "write 0.5mm: decimals"},
      {"krok-diff", {"in.bvh", "--joint-tolerance", "0.5deg"}, "LENGTH[,ANGLE]"},
      {"krok-edit", {"--turn", "1.57", "-o", "a.anim"}, "write 1.57rad, or 1.57deg"}};
  for (const Row& row : commas) {
    std::vector<std::string> arguments = row.arguments;
    arguments.insert(arguments.begin(), "in.bvh");
    EXPECT_THAT(refused(row.tool, arguments), HasSubstr(row.hint));
  }
  EXPECT_THAT(
      refused("krok-walk", {"lib.steps", "--goal", "1,2", "--start", "0,0,1.57", "-o", "a"}),
      HasSubstr("write 1.57rad"));
  EXPECT_THAT(refused("krok-blend", {"in.bvh:30", "in.bvh:70", "-o", "a.anim"}),
              HasSubstr("here 0.3 and 0.7"));
  EXPECT_THAT(refused("krok-blend", {"in.bvh", "0.5", "-o", "a.anim"}),
              HasSubstr("a weight without a motion"));
  EXPECT_THAT(refused("krok-morph", {"hero.glb", "-o", "a.exr"}), HasSubstr("is not pack, unpack"));
  EXPECT_THAT(refused("krok", {"gaze", "in.bvh"}), HasSubstr("--look-at"));
  put("list.tsv", "in.bvh a.anim\n");
  EXPECT_THAT(refused("krok-edit", {"--mirror", "--manifest", "list.tsv", "--out-dir", "o"}),
              HasSubstr("by tabs"));
  put("cut.bvh", "HIERARCHY\nROOT Hips\n");
  EXPECT_THAT(refused("krok-import", {"cut.bvh", "-o", "a.anim"}), HasSubstr("is truncated"));
}

TEST_F(Mistakes, UnknownVerbsToo) {
  EXPECT_THAT(refused("krok", {"improt", "in.bvh"}),
              AllOf(HasSubstr("unknown verb 'improt'"), HasSubstr("did you mean 'import'?")));
}

// Would fail if words that are near to nothing led to something else.
TEST_F(Mistakes, WordsOfOtherProgramsLeadOn) {
  EXPECT_THAT(refused("krok", {"convert", "in.bvh"}), HasSubstr("krok import"));
  EXPECT_THAT(refused("krok-edit", {"in.bvh", "--mirror", "x", "-o", "a.anim"}),
              HasSubstr("Mirror left and right"));
  EXPECT_THAT(refused("krok-cam", {"in.bvh", "--follow", "hip", "-o", "a.cam"}),
              HasSubstr("did you mean 'Hips'?"));
  EXPECT_THAT(refused("krok-import", {"in.bvh", "-o", "hero.character"}),
              HasSubstr("krok-import --save-character"));
  EXPECT_THAT(refused("krok-edit", {"in.bvh", "--height", "180", "-o", "a.anim"}),
              HasSubstr("180cm"));
}

// Would fail if words that one tries first, or that other programs have, were answered with
// --help, or a row of the table named an option that the tool has not.
TEST_F(Mistakes, WordsOfOtherToolsLeadOn) {
  for (const auto& [verb, hint] : {std::pair{"sheet", "krok plot IN... --sheet OUT.png"},
                                   {"gait", "krok keys FOLDER --table"},
                                   {"compare", "krok diff"},
                                   {"trim", "krok edit"},
                                   {"gif", "krok render"}}) {
    EXPECT_THAT(refused("krok", {verb, "in.bvh"}), HasSubstr(hint));
  }
  EXPECT_THAT(refused("krok-import", {"in.bvh", "--output-dir", "o"}), HasSubstr("use --out-dir"));
  EXPECT_THAT(refused("krok-edit", {"takes", "--out", "o"}), HasSubstr("--out-dir for a folder"));
  EXPECT_THAT(refused("krok-edit", {"in.bvh", "--threads", "2"}), HasSubstr("use --jobs"));
  EXPECT_THAT(refused("krok-plot", {"in.bvh", "--mean"}), HasSubstr("use --show cycles"));
  EXPECT_THAT(refused("krok-retarget", {"in.bvh", "--target", "a"}), HasSubstr("use --onto"));
  EXPECT_THAT(refused("krok-diff", {"a.glb", "b.glb", "-o", "d.xml"}), HasSubstr("use --summary"));
  EXPECT_THAT(refused("krok-import", {"in.bvh", "--framerate", "30"}), HasSubstr("use --fps"));
  EXPECT_THAT(refused("krok-skin", {"a.glb", "--tolerance", "1mm"}), HasSubstr("use --reduce"));
  EXPECT_THAT(refused("krok-render", {"in.bvh", "--start", "1s"}), HasSubstr("use --from"));
  EXPECT_THAT(refused("krok-export", {"in.bvh", "--from", "1s"}), HasSubstr("krok-edit --from"));
  EXPECT_THAT(refused("krok-export", {"in.bvh", "--up", "z"}), Not(HasSubstr("krok-import")));
  EXPECT_THAT(refused("krok-import", {"in.bvh", "-o", "a.fbx"}), HasSubstr("krok-export writes"));
  EXPECT_THAT(refused("krok-export", {"in.bvh", "-o", "a.obj"}), HasSubstr("krok-skin writes"));
  // Not where the tool has no such option.
  EXPECT_THAT(refused("krok-info", {"in.bvh", "--fps", "30"}), HasSubstr("it prints joints"));
}

// Would fail if what no row of a table foresees were answered with "see --help" alone.
TEST_F(Mistakes, WhatOtherToolsOrOptionsTakeLeadsThere) {
  EXPECT_THAT(refused("krok-view", {"in.bvh", "--lens", "50", "-o", "a.html"}),
              HasSubstr("krok-cam has it"));
  EXPECT_THAT(refused("krok-edit", {"in.bvh", "--hips-heights", "1m", "-o", "a.anim"}),
              HasSubstr("krok-edit has --height LENGTH (Scale to this stature)"));
  // By what the option does.
  EXPECT_THAT(refused("krok-edit", {"in.bvh", "--stature", "2m", "-o", "a.anim"}),
              HasSubstr("hint: krok-edit has --height LENGTH (Scale to this stature); see"));
  EXPECT_THAT(refused("krok-plot", {"in.bvh", "--font-size", "3", "-o", "a.svg"}),
              HasSubstr("krok-render has --size WIDTHxHEIGHT (Size in pixels, even numbers)"));
  EXPECT_THAT(refused("krok-edit", {"in.bvh", "--filter", "6", "-o", "a.anim"}),
              HasSubstr("write --filter butterworth --cutoff 6"));
  EXPECT_THAT(refused("krok-export", {"in.bvh", "-o", "a.mp4"}), HasSubstr("krok-render"));
  EXPECT_THAT(refused("krok-export", {"in.bvh", "-o", "a.fbx"}), HasSubstr("read .glb"));
  EXPECT_THAT(refused("krok-retarget", {"in.bvh", "--onto", "0,1 2,3", "-o", "a.anim"}),
              HasSubstr("check the path; --onto IN.model"));
  EXPECT_THAT(refused("krok-edit", {"in.bvh", "--filter", "butterworth,6", "-o", "a.anim"}),
              HasSubstr("write --filter butterworth --cutoff 6"));
  EXPECT_THAT(refused("krok-info", {"in.bvh", "--csv"}), HasSubstr("use --json"));
  EXPECT_THAT(refused("krok-retarget", {"in.bvh", "--onto", "in.bvh", "-o", "a.glb"}),
              HasSubstr("krok-skin MESH MOTION --retarget"));
  EXPECT_THAT(refused("krok-walk", {"--path", "way.svg", "-o", "a.anim"}),
              HasSubstr("which krok-fit makes"));
  // It was 40 m to the side.
  EXPECT_THAT(refused("krok-ik", {"in.bvh", "--reach", "Head=-40,110cm,50cm@1f", "-o", "a.anim"}),
              HasSubstr("write -40cm"));
  // A folder of this name was made.
  EXPECT_THAT(refused("krok-lint", {"in.bvh", "--fix", "-o", "fixed"}),
              HasSubstr("--fix has no value"));
  EXPECT_THAT(refused("krok-lint", {"in.bvh", "--html", "--keep-going"}),
              HasSubstr("--html has no value"));
  EXPECT_THAT(run_here("krok-keys", {"in.bvh", "-o", "a.csv"}).err, HasSubstr("--table OUT.csv"));
}

// Would fail if what is missing, or in the wrong place, were answered with a wrong guess.
TEST_F(Mistakes, MissingAndSwappedArgumentsLeadOn) {
  std::filesystem::create_directory(path("takes"));
  put("takes/a.bvh", capture(5));
  EXPECT_THAT(refused("krok-retarget", {"takes", "hero.character", "--out-dir", "o"}),
              AllOf(HasSubstr("give --onto IN.model"), Not(HasSubstr("'--'"))));
  EXPECT_THAT(refused("krok-walk", {"takes", "--goal", "0m,5m", "-o", "a.anim"}),
              HasSubstr("krok-fit takes -o OUT.steps"));
  EXPECT_THAT(refused("krok-diff", {"in.bvh"}), HasSubstr("give B; write krok-diff A B"));
  EXPECT_THAT(refused("krok-diff", {"HEAD~1", "in.bvh"}), HasSubstr("krok git-setup"));
  EXPECT_THAT(refused("krok", {"-i", "in.bvh", "a.glb"}), HasSubstr("krok export in.bvh -o a.glb"));
  EXPECT_THAT(refused("krok-export", {"in.bvh", "a.glb"}), HasSubstr("write -o a.glb"));
  EXPECT_THAT(refused("krok-info", {"inn.bvh"}), HasSubstr("did you mean in.bvh?"));
  EXPECT_THAT(refused("krok-info", {"takes.bvh"}), HasSubstr("takes is a folder"));
  EXPECT_THAT(refused("krok-ragdoll", {"in.bvh", "--push", "2s", "-o", "a.anim"}),
              HasSubstr("--push-every 2s"));
  EXPECT_THAT(refused("krok-skin", {"in.bvh", "in.bvh", "-o", "a.glb"}),
              HasSubstr("the mesh comes first"));
  EXPECT_THAT(refused("krok-skin", {"takes", "hero.character", "-o", "a.glb"}),
              HasSubstr("a mesh comes first"));
  EXPECT_THAT(refused("krok-retarget", {"in.bvh", "--onto", "takes", "-o", "a.anim"}),
              AllOf(HasSubstr("give one of its files"), Not(HasSubstr("--out-dir"))));
  EXPECT_THAT(refused("krok-diff", {"in.bvh", "in.bvh", "--tol", "1mm"}),
              HasSubstr("did you mean '--tolerance'?"));
  EXPECT_THAT(refused("krok-view", {"in.bvh", "-o", "a.png"}), HasSubstr("krok-render"));
  EXPECT_EQ(run_here("krok-edit", {"in.bvh", "--rate", "15fps", "-o", "r.anim"}).exit_code, 0);
  EXPECT_THAT(refused("krok-blend", {"in.bvh", "-o", "a.anim"}), HasSubstr("krok-blend A B"));
  EXPECT_THAT(refused("krok-plot", {"in.bvh", "--show", "knee", "-o", "a.pdf"}),
              HasSubstr("angles draws hips, knees"));
  EXPECT_THAT(refused("krok-plot", {"in.bvh", "--show", "gait", "-o", "a.pdf"}),
              HasSubstr("krok-keys --table"));
  put("clip.mp4", std::string("\0\0\0\x18"
                              "ftypmp42",
                              12));
  EXPECT_THAT(refused("krok-import", {"clip.mp4", "-o", "a.anim"}), HasSubstr(".fbx"));
  ASSERT_EQ(run_here("krok-body", {"in.bvh", "-o", "a.model"}).exit_code, 0);
  put("cup.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THAT(
      refused("krok-skin", {"a.model", "in.bvh", "--attach", "spin=cup.obj", "-o", "a.glb"}),
      HasSubstr("did you mean 'Spine'?"));
  EXPECT_EQ(run_here("krok-export", {"in.bvh", "--format", "gltf"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(path("in.gltf"))) << "beside the input";
}

// Would fail if a run that does what was asked, but hardly what was meant, said nothing of it.
TEST_F(Mistakes, WhatWasHardlyMeantIsSaid) {
  ASSERT_EQ(run_here("krok-body", {"in.bvh", "-o", "a.model"}).exit_code, 0);
  std::string other = capture(5);
  for (std::size_t at; (at = other.find("Spine")) != std::string::npos;)
    other.replace(at, 5, "Rib");
  put("other.bvh", other);
  put("face.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  put("smile.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n");
  const struct {
    std::string tool;
    std::vector<std::string> arguments;
    const char* text;
  } runs[] = {
      {"krok-render", {"a.model", "other.bvh", "--from", "1f", "-o", "a.png"}, "krok-skin a.model"},
      {"krok-body", {"a.model", "-o", "b.model"}, "made around its joints instead"},
      {"krok-ik", {"in.bvh", "--reach", "Head=0,1m,0@20", "-o", "a.anim"}, "20f is frame 20"},
      {"krok-morph", {"pack", "face.obj", "smile.obj", "-o", "f.exr"}, "as moved from face.obj"}};
  for (const auto& run : runs) {
    const ToolRun made = run_here(run.tool, run.arguments);
    EXPECT_EQ(made.exit_code, 0) << made.err;
    EXPECT_THAT(made.err, HasSubstr(run.text)) << run.tool;
  }
  EXPECT_EQ(run_here("krok-import", {"in.bvh", "--up", "Y", "-o", "y.anim"}).exit_code, 0)
      << "as other programs write axes";
  EXPECT_THAT(refused("krok-skin", {"a.model", "in.bvh", "--touches", "free", "-o", "a.glb"}),
              HasSubstr("krok-retarget IN --onto CHARACTER"));
}

// Would fail if a file of the wrong kind, or a word of another program, led to a wrong guess.
TEST_F(Mistakes, WrongFilesAndForeignWordsLeadOn) {
  put("face.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  put("m.c3d", std::string("\x02P\x01\0", 4));
  put("s.blend", "BLENDER-v300");
  put("m.anim", "animVersion 1.1;\n");
  put("a.pkl", "\x80\x04\x95");
  ASSERT_EQ(run_here("krok-body", {"in.bvh", "-o", "a.model"}).exit_code, 0);
  ASSERT_EQ(run_here("krok-morph", {"pack", "face.obj", "face.obj", "-o", "face.exr"}).exit_code,
            0);
  put("swapped.json", R"({"joints": {"spine": "Spine"}})");
  struct Row {
    std::string tool;
    std::vector<std::string> arguments;
    std::string text;
  };
  const Row rows[] = {
      {"krok-export", {"a.model", "-o", "x"}, "it has no motion"},
      {"krok-export", {"in.bvh", "-o", "x"}, "x has no extension"},
      {"krok-cam", {"in.bvh", "--still", "-o", "c.fbx"}, "krok-cam writes .glb, too"},
      {"krok-export", {"in.bvh", "--what", "rotations", "-o", "a.csv"}, "quaternions has"},
      {"krok-render", {"in.bvh", "--codec", "h265", "-o", "a.mp4"}, "ffmpeg recodes"},
      {"krok-morph", {"info", "face.obj"}, "is an OBJ mesh (without joints), not an .exr"},
      {"krok-skin", {"face.obj", "-o", "a.glb"}, "a mesh with joints is"},
      {"krok-edit", {"in.bvh", "-ss", "1", "-o", "a.anim"}, "use --from"},
      {"krok-import", {"s.blend", "-o", "a.anim"}, "Blender (export it as glTF)"},
      {"krok-info", {"m.anim"}, "curves of Maya"},
      {"krok-import", {"a.pkl", "-o", "a.anim"}, "a pickle of Python (write its arrays as .npz"},
      {"krok-skin", {"in.bvh@Walk", "-o", "a.glb"}, "'in.bvh#Walk'"},
      {"krok-import", {"m.c3d", "-o", "a.anim"}, "solved skeleton"},
      {"krok-info", {"in.bvh", "--joints"}, "use -v"},
      {"krok-skin", {"a.model", "--correctives", "face.exr", "-o", "a.glb"}, "--morph"},
      {"krok-edit", {"in.bvh", "--plant", "--contacts", "in.bvh", "-o", "a.anim"}, "krok-keys"},
      {"krok-body", {"in.bvh", "-o", "body.obj"}, "krok-skin writes meshes as .obj"},
      {"krok-retarget",
       {"in.bvh", "--onto", "a.model", "--map", "swapped.json", "-o", "a.anim"},
       "the joint comes first"},
      {"krok-ik", {"in.bvh", "--look-at", "eye", "-o", "a.anim"}, "write head="},
      {"krok-edit", {"in.bvh", "--mirror", "x", "-o", "a.anim"}, "--mirror takes no value"},
      {"krok-walk",
       {"lib.steps", "--goal", "0,3m", "-o", "wk.html"},
       "krok-walk with --save-page"}};
  for (const Row& row : rows) EXPECT_THAT(refused(row.tool, row.arguments), HasSubstr(row.text));
}

// Would fail if an option of another program, which has one meaning here, led to a list of all
// options or to one that shares letters with it.
TEST_F(Mistakes, OptionsOfOtherProgramsHaveTheirName) {
  struct Row {
    std::string tool;
    std::vector<std::string> arguments;
    std::string hint;
  };
  const Row rows[] = {
      {"krok-import", {"-i", "in.bvh"}, "use inputs without an option"},
      {"krok-import", {"--axis_up", "z"}, "use --up"},
      {"krok-import", {"--save_model", "a.model"}, "did you mean '--save-model'?"},
      {"krok-import", {"--animation", "idle"}, "use --clip"},
      {"krok-import", {"--list-clips"}, "use krok-info"},
      {"krok-import", {"--mirror"}, "use krok-edit --mirror"},
      {"krok-import", {"--start", "10"}, "use krok-edit --from"},
      {"krok-export", {"--rotation-order", "XYZ"}, "use --order"},
      {"krok-export", {"--rotate-mode", "XYZ"}, "use --order"},
      {"krok-export", {"--precision", "4"}, "use --digits"},
      {"krok-edit", {"--offset", "0,1,0"}, "use --move"},
      {"krok-edit", {"--remove-root-motion"}, "use --in-place"},
      {"krok-edit", {"--foot-lock"}, "use --plant"},
      {"krok-edit", {"--reverse"}, "\"speed\": -1"},
      {"krok-skin", {"--clip-name", "walk"}, "walk=take_7.anim"},
      {"krok-skin", {"--clips", "Walk"}, "'IN#NAME'"},
      {"krok-edit", {"--clip", "Walk"}, "'IN#NAME'"},
      {"krok-skin", {"--dual-quaternion"}, "use --method dual-quaternion"},
      {"krok-skin", {"x.anim", "--compress", "draco", "-o", "a.glb"}, "--compress takes no value"},
      {"krok-edit", {"--retime", "2s"}, "use --playback-speed"},
      {"krok-edit", {"--start-frame", "10"}, "use --from 10f"},
      {"krok-import", {"--pattern", "*.bvh"}, "in quotes"},
      {"krok-lint", {"--only", "pop,flip"}, "give one at a time"},
      {"krok-retarget", {"--onto", "in.bvh", "--reference-pose", "t-pose"}, "leave it out"},
      {"krok-edit", {"--start", "10", "--end", "60"}, "--end: use --to TIME; 60f"},
      {"krok-edit", {"-t", "2"}, "not how long it is"},
      {"krok-ik", {"--pin", "left_foot"}, "feet without goals stay"},
      {"krok-ik", {"--pole", "1"}, "kind pole"},
      {"krok-skin", {"--take", "Walk"}, "'IN#NAME'"},
      {"krok-lint", {"--max", "foot-slide=20mm"}, "use --profile"},
      {"krok-lint", {"--fail-on", "error"}, "--baseline"},
      {"krok-cam", {"--fov", "1.2"}, "1.2rad"},
      {"krok-import", {"--root", "Hips"}, "use --map"},
      {"krok-import", {"--output-format", "fbx"}, "krok-export others"},
      {"krok-import", {"--in", "x.bvh"}, "inputs without an option"},
      {"krok-skin", {"--simplify", "0.5"}, "--quantize"},
      {"krok-skin", {"--max-influences", "4"}, "use --influences"},
      {"krok-cam", {"--focal-length", "50"}, "use --lens"},
      {"krok-cam", {"--height", "1.6m"}, "use --elevation"},
      {"krok-lint", {"--config", "p.json"}, "use --profile"},
      {"krok-lint", {"--disable", "foot-slide"}, "use --ignore"},
      {"krok-lint", {"--severity", "error"}, "use --quiet"},
      {"krok-diff", {"--ignore-root"}, "krok-edit --in-place"},
      {"krok-retarget", {"--source", "a.anim"}, "the motion without an option"},
      {"krok-retarget", {"--mapping", "m.json"}, "use --map"},
      {"krok-body", {"--resolution", "high"}, "use --detail"},
      {"krok-body", {"--gender", "male"}, "follows the skeleton"},
      {"krok-mix", {"--fps", "30"}, "\"rate\" of the timeline"},
      {"krok-walk", {"--target", "0,5"}, "use --goal"},
      {"krok-walk", {"--terrain", "hill.obj"}, "use --ground"},
      {"krok-ragdoll", {"--impulse", "Spine=1,0,0"}, "use --push"},
      {"krok-ragdoll", {"--force", "Spine=1,0,0"}, "--push Spine2=100Ns,0,0"},
      {"krok-ragdoll", {"--gravity", "9.81"}, "gravity is 9.81 m/s2"},
      {"krok-render", {"-r", "30"}, "use --rate"},
      {"krok-render", {"--background", "white"}, "another renderer"},
      {"krok-plot", {"-x", "time"}, "did you mean '--x'?"},
      {"krok-plot", {"--save", "a.svg"}, "use -o OUT.svg"},
      {"krok-fit", {"--parameters", "length"}, "\"parameters\" of a description"},
      {"krok-view", {"--open"}, "open that in a browser"},
      {"krok-info", {"--frames"}, "krok-export -o OUT.csv"},
      {"krok-blend", {"--duration", "2s"}, "krok-edit A --append B --blend TIME"},
      {"krok-blend", {"--at", "0.5"}, "krok-edit A --append B --blend TIME"},
      {"krok-edit", {"--move", "1", "0", "-2", "-o", "a.anim"}, "write --move 1,0,-2"},
      {"krok-edit", {"--from", "00:00:01.5", "-o", "a.anim"}, "write 1.5s"},
      {"krok-walk", {"--goal", "0,5", "--speed", "1.4m/s", "-o", "a.anim"}, "--pace 1.4m/s"},
      {"krok-blend", {"in.bvh=0.5", "-o", "a.anim"}, "walk.anim:0.5"},
      {"krok-edit", {"--mirror", "-o", "a_{clip}.anim"}, "--out-dir DIR"}};
  for (const Row& row : rows) {
    std::vector<std::string> arguments = row.arguments;
    arguments.insert(arguments.begin(), "in.bvh");
    EXPECT_THAT(refused(row.tool, arguments), HasSubstr(row.hint));
  }
  EXPECT_THAT(refused("krok-import", {"a.asf", "a.amc", "-o", "a.anim"}),
              HasSubstr("write a.amc --skeleton a.asf"));
  EXPECT_THAT(refused("krok-lint", {"--fix", "takes"}), HasSubstr("takes is the folder of --fix"));
}

// Would fail if a file in another form were blamed for what it is not, or silently read as less
// than it says.
TEST_F(Mistakes, FilesOfAnotherFormShowTheirForm) {
  ASSERT_EQ(run_here("krok-body", {"in.bvh", "-o", "a.model"}).exit_code, 0);
  put("list.json", R"([{"x": 0, "z": 0}])");
  put("points.json", R"({"version":1.3,"people":[]})");
  put("m.trc", "PathFileType\t4\t(X/Y/Z)\tm.trc\n");
  put("face.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  put("smile.obj", "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n");
  ASSERT_EQ(run_here("krok-morph", {"pack", "face.obj", "smile.obj", "-o", "face.exr"}).exit_code,
            0);
  put("curves.json", R"({"schema": "krok.weights/1", "curves": {"smile": [[0, 1]]}})");
  put("live.csv", "Timecode,BlendShapeCount,smile\n12:00:01:00.000,61,0.1\n");
  put("other.csv", "time,frown\n0,1\n");
  put("ms.csv", "time_ms,smile\n0,0\n500,1\n");
  put("bad.csv", "time,a,b\n0,1,2\n1,2,3\n2,oops,4\n");
  put("comma.csv", "time;a\n0,0;1,5\n0,5;2,5\n");
  put("mask.json", R"({"schema": "krok.timeline/1", "sources": {"a": "in.bvh"},
    "base": [{"source": "a"}], "layers": [{"mask": "LeftArm", "items": [{"source": "a"}]}]})");
  put("rules.json", R"({"schema": "krok.lint-profile/1", "rules": {"pop": 1}})");
  put("known.json", R"({"schema": "krok.lint-baseline/1", "faults": [
    {"file": "in", "rule": "popp", "from": 0, "to": 1}]})");
  put("map.json", R"({"joints": {"Head": "hand_left"}})");
  put("cm.json", R"({"schema": "krok.goals/1", "goals": [
    {"joint": "Head", "keys": [{"time": 0.2, "target": [-40, 100, 30]}]}]})");
  put("keys.json", R"({"schema": "krok.camera-keys/1",
    "keys": [{"time": 0, "position": {"x": 0}, "target": [0, 1, 0]}]})");
  put("lost.character", R"({"schema": "krok.character/1", "model": "none.model"})");
  struct Row {
    std::string tool;
    std::vector<std::string> arguments;
    std::string text;
  };
  const Row rows[] = {
      {"krok-import", {"points.json", "-o", "a.anim"}, "OpenPose"},
      {"krok-import", {"m.trc", "-o", "a.anim"}, "solved skeleton"},
      {"krok-cam", {"list.json", "-o", "a.cam"}, R"(write {"schema": "krok.camera-keys/1")"},
      {"krok-cam", {"keys.json", "-o", "a.cam"}, R"(write "position": [1, 1, 1])"},
      {"krok-mix", {"mask.json", "-o", "a.anim"}, R"(write "mask": [{"joints": "...", ...}])"},
      {"krok-lint", {"in.bvh", "--profile", "rules.json"}, R"(write "rules": [{"rule": "..."}])"},
      {"krok-lint", {"in.bvh", "--profile", "known.json"}, "krok-lint --baseline"},
      {"krok-lint", {"in.bvh", "--baseline", "known.json"}, "did you mean 'pop'?"},
      {"krok-morph",
       {"bake", "face.exr", "face.obj", "--weights", "curves.json", "-o", "a.glb"},
       R"(write "curves": [{"target": "...", "keys": [[1, 1]]}])"},
      {"krok-morph",
       {"bake", "face.exr", "face.obj", "--weights", "live.csv", "-o", "a.glb"},
       "in place of Timecode"},
      {"krok-morph",
       {"bake", "face.exr", "face.obj", "--weights", "other.csv", "-o", "a.glb"},
       "targets are smile"},
      {"krok-skin", {"lost.character", "in.bvh", "-o", "a.glb"}, "lost.character names it"},
      {"krok-retarget", {"in.bvh", "--onto", "face.obj", "-o", "a.anim"}, "what has joints"},
      {"krok-retarget",
       {"in.bvh", "--onto", "a.model", "--map", "map.json", "-o", "a.anim"},
       "did you mean \"left_hand\"?"},
      {"krok-plot", {"bad.csv", "-o", "a.svg"}, "bad.csv:4:3: error: 'oops'"}};
  for (const Row& row : rows) EXPECT_THAT(refused(row.tool, row.arguments), HasSubstr(row.text));
  // What has one meaning is done.
  EXPECT_EQ(run_here("krok-plot", {"comma.csv", "-o", "a.svg"}).exit_code, 0);
  EXPECT_EQ(run_here("krok-plot", {"bad.csv", "--by", "a", "-o", "b.svg"}).exit_code, 0);
  const ToolRun baked = run_here(
      "krok-morph", {"bake", "face.obj", "face.exr", "--weights", "ms.csv", "-o", "a.glb"});
  EXPECT_THAT(baked.err, HasSubstr("16 frames at 30 fps")) << "half a second, and the .exr second";
  EXPECT_EQ(run_here("krok-render", {"in.bvh", "--to", "1f", "--size", "64x64", "-o", "f_##.png"})
                .exit_code,
            0);
  EXPECT_TRUE(std::filesystem::exists(path("f_00.png"))) << "a file per frame";
  const ToolRun far = run_here("krok-ik", {"in.bvh", "--goals", "cm.json", "-o", "a.anim"});
  EXPECT_THAT(far.err, HasSubstr("\"length_unit\": \"cm\""));
}

// Would fail if a wrong word in a motion's NAME.lint.json had no effect and no message.
TEST_F(Mistakes, SuppressionsOfNothingAreNamed) {
  put("in.lint.json", R"({"schema": "krok.lint-suppressions/1", "suppressions": [
    {"rule": "popp", "reason": "x"}]})");
  EXPECT_THAT(run_here("krok-lint", {"in.bvh"}).out,
              AllOf(HasSubstr("in.lint.json: error: 'popp'"), HasSubstr("did you mean 'pop'?")));
  put("in.lint.json", R"({"schema": "krok.lint-suppressions/1", "suppressions": [
    {"rule": "pop", "joint": "Spin", "reason": "x"}]})");
  EXPECT_THAT(run_here("krok-lint", {"in.bvh"}).err, HasSubstr("did you mean 'Spine'?"));
}

TEST_F(Mistakes, ScriptsGetAReportOfUnknownVerbs) {
  const ToolRun run = run_here("krok", {"nope", "--json"});
  EXPECT_EQ(run.exit_code, 2);
  const json report = json::parse(run.out);
  EXPECT_EQ(report["schema"], "krok.report/1");
  EXPECT_EQ(report["issues"][0]["message"], "unknown verb 'nope'");
  EXPECT_EQ(run_here("krok", {"nope", "--json=report.json"}).exit_code, 2);
  EXPECT_EQ(json::parse(get(path("report.json"))), report);
  put("notes.txt", "mine");
  EXPECT_EQ(run_here("krok", {"nope", "--json=notes.txt"}).exit_code, 2);
  EXPECT_EQ(get(path("notes.txt")), "mine");
}

TEST_F(Mistakes, ABodyIsMadeForACaptureAsItIs) {
  EXPECT_EQ(run_here("krok-body", {"in.bvh", "-o", "a.model"}).exit_code, 0);
}

TEST_F(Mistakes, ArgumentsTooManyAreListedInTheirOrder) {
  const std::string text = refused("krok-import", {"in.bvh", "b.bvh", "c.bvh", "-o", "a.anim"});
  EXPECT_THAT(text, AllOf(HasSubstr("'b.bvh' 'c.bvh'"), HasSubstr("--out-dir")));
}

TEST_F(Mistakes, AFolderAsInputLeadsToOutDir) {
  std::filesystem::create_directory(path("takes"));
  EXPECT_THAT(refused("krok-import", {"takes", "-o", "a.anim"}), HasSubstr("--out-dir"));
}

TEST_F(Mistakes, EndingsThatAreNoFormatOfTheToolAreRefused) {
  EXPECT_THAT(refused("krok-import", {"in.bvh", "-o", "a.txt"}), HasSubstr(".anim"));
  EXPECT_FALSE(std::filesystem::exists(path("a.txt")));
  EXPECT_EQ(run_here("krok-import", {"in.bvh", "-o", "a.kanim"}).exit_code, 0)
      << "another extension of motions";
  EXPECT_EQ(run_here("krok-info", {"a.kanim"}).exit_code, 0);
  EXPECT_EQ(run_here("krok-import", {"in.bvh", "-o", "plain"}).exit_code, 0);
}

TEST_F(Mistakes, ATolerancesUnitIsNotGuessed) {
  const std::string text = refused("krok-diff", {"in.bvh", "in.bvh", "--tolerance", "0.1"});
  EXPECT_THAT(text, AllOf(HasSubstr("no unit"), HasSubstr("0.1mm")));
  EXPECT_EQ(run_here("krok-diff", {"in.bvh", "in.bvh", "--tolerance", "0"}).exit_code, 0);
}

TEST_F(Mistakes, PatternsThatTheShellLeftAreExpanded) {
  put("take_1.bvh", capture(5));
  put("take_2.bvh", capture(6));
  const json report = report_here("krok-plot", {"take_*.bvh", "-o", "a.svg"});
  EXPECT_EQ(report["inputs"].size(), 2U);
  EXPECT_THAT(refused("krok-plot", {"none_*.bvh", "-o", "a.svg"}), HasSubstr("none_*.bvh"));
}

TEST_F(Mistakes, BinaryDataIsNotWrittenToATerminal) {
  // `script` gives the tool a terminal; without it there is none to test with.
  if (!std::filesystem::exists("/usr/bin/script")) GTEST_SKIP() << "script is not installed";
  const std::string tool = test::tools_folder() + "/krok-import";
  const ToolRun run = test::run(
      {"/usr/bin/script", "-qec", "'" + tool + "' '" + path("in.bvh") + "' -o -", "/dev/null"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.out, HasSubstr("file-terminal"));
  EXPECT_EQ(run.out.find("KROKANIM"), std::string::npos);
}

TEST_F(Mistakes, BashCompletesVerbsOptionsAndTheirValues) {
  const std::string krok = test::tools_folder() + "/krok";
  ASSERT_EQ(run_tool("krok", {"completion", "tcsh"}).exit_code, 2);
  const ToolRun script = run_tool("krok", {"completion", "bash"});
  ASSERT_EQ(script.exit_code, 0) << script.err;
  put("completion.bash", script.out);
  const auto completed = [&](const std::string& words, int at) {
    const ToolRun run = test::run({"/bin/bash", "-c",
                                   "source '" + path("completion.bash") + "'; COMP_WORDS=(" +
                                       words + "); COMP_CWORD=" + std::to_string(at) +
                                       "; _krok; printf '%s ' \"${COMPREPLY[@]}\""});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(run.err, "");
    return run.out;
  };
  EXPECT_EQ(completed("krok imp", 1), "import ");
  EXPECT_EQ(completed("krok skin a.model --as ''", 4), "rig motion baked pose frames ");
  EXPECT_EQ(completed("krok-skin a.model --as = p", 4), "pose ");
  EXPECT_THAT(completed("krok edit --mir", 2), HasSubstr("--mirror "));
  EXPECT_THAT(completed("krok-edit --", 1), AllOf(HasSubstr("--from "), HasSubstr("--help ")));
  EXPECT_THAT(completed("krok info '" + path("in") + "'", 2), HasSubstr("in.bvh"));
}

TEST_F(Mistakes, OtherShellsAcceptTheirScripts) {
  for (const auto& [shell, check] : {std::pair<std::string, std::string>{"/usr/bin/zsh", "-n"},
                                     {"/usr/bin/fish", "--no-execute"}}) {
    const std::string name = std::filesystem::path(shell).filename();
    const ToolRun script = run_tool("krok", {"completion", name});
    ASSERT_EQ(script.exit_code, 0);
    EXPECT_THAT(script.out, HasSubstr("krok-render"));
    if (!std::filesystem::exists(shell)) continue;
    put("script", script.out);
    const ToolRun run = test::run({shell, check, path("script")});
    EXPECT_EQ(run.exit_code, 0) << run.err;
  }
}

TEST(ConsoleText, SeveritiesHintsAndCodesHaveColours) {
  EXPECT_EQ(cli::in_colours("walk.bvh:2:3: error: no value [bvh-value]\n  hint: repair it\n"),
            "walk.bvh:2:3: \033[1;31merror:\033[0m no value\033[2m [bvh-value]\033[0m\n"
            "  \033[36mhint:\033[0m repair it\n");
  EXPECT_EQ(cli::in_colours("krok-edit: warning: odd [edit-odd]\n"),
            "krok-edit: \033[1;33mwarning:\033[0m odd\033[2m [edit-odd]\033[0m\n");
  EXPECT_EQ(cli::in_colours("walk.anim: 30 frames\nno error here"),
            "walk.anim: 30 frames\nno error here");
  EXPECT_EQ(cli::in_colours(""), "");
}

TEST(ConsoleText, TimeThatIsLeftReadsAsTime) {
  EXPECT_EQ(cli::time_left(0.4), "0 s left");
  EXPECT_EQ(cli::time_left(59.4), "59 s left");
  EXPECT_EQ(cli::time_left(185), "3:05 min left");
  EXPECT_EQ(cli::time_left(4800), "1:20 h left");
  EXPECT_EQ(cli::time_left(1e300), "100:00 h left");
}

}  // namespace
}  // namespace krok::test
