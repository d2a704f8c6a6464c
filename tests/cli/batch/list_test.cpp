// If these fail, a batch takes other files than the user meant, puts results where nobody looks for
// them, or lets one result replace another or a capture.
#include <gmock/gmock.h>

#include "cli/batch/batch_fixture.h"

namespace krok::test {
namespace {

class BatchList : public BatchTest {
 protected:
  void expect_usage_error(const ToolRun& run, const std::string& part) {
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_TRUE(has_code(run.err, "usage")) << run.err;
    EXPECT_THAT(run.err, HasSubstr(part));
  }
};

TEST_F(BatchList, APatternKeepsTheFoldersBelowItsFixedPart) {
  put_capture("takes/a/x.bvh");
  put_capture("takes/b/c/x.bvh");
  put_capture("takes/y.bvh");
  put_capture("takes/.hidden.bvh");
  put("takes/notes.txt", "no capture");
  const ToolRun run = import({"takes/**/*.bvh", "--out-dir", "new/out"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, EndsWith("\nkrok-import: 3 files, 3 done; 3 with warnings\n"));
  EXPECT_EQ(files_below("new/out"), (Names{"a/x.anim", "b/c/x.anim", "y.anim"}));
}

// Would fail if hundreds of lines said the same, or if the report left any of it out.
TEST_F(BatchList, OfManyFilesWithOneWarningTheFirstAreTold) {
  for (const char* name : {"a", "b", "c", "d", "e"}) {
    put_capture(std::string("takes/") + name + ".bvh");
  }
  const auto count = [](const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++found;
    return found;
  };
  const ToolRun run = import({"takes", "--out-dir", "out", "--json=report.json"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(count(run.err, "the unit is"), 3U) << run.err;
  EXPECT_THAT(run.err,
              HasSubstr("  2 more files have such messages; -v and --json have all [bvh-unit]"));
  EXPECT_EQ(count(get(path("report.json")), "the unit is"), 5U);
  const ToolRun all = import({"takes", "--out-dir", "again", "-v"});
  EXPECT_EQ(count(all.err, "the unit is"), 5U) << all.err;
}

TEST_F(BatchList, PatternsAreExpandedAsShellsDo) {
  for (const char* name : {"a1.bvh", "a2.bvh", "b1.bvh", "[x].bvh"}) put_capture(name);
  const auto made = [&](const std::string& pattern) {
    std::filesystem::remove_all(path("out"));
    const ToolRun run = import({pattern, "--out-dir", "out"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return files_below("out");
  };
  EXPECT_EQ(made("a?.bvh"), (Names{"a1.anim", "a2.anim"}));
  EXPECT_EQ(made("[!a]1.bvh"), Names{"b1.anim"});
  EXPECT_EQ(made("[x].bvh"), Names{"[x].anim"}) << "a file of this very name";
  EXPECT_EQ(made(path("*1.bvh")), (Names{"a1.anim", "b1.anim"}));
}

TEST_F(BatchList, FilesNamedOneByOneKeepTheFoldersThatTheyDoNotShare) {
  put_capture("takes/a/x.bvh");
  put_capture("takes/b/x.bvh");
  ASSERT_EQ(import({"takes/a/x.bvh", "takes/b/x.bvh", "--out-dir", "out"}).exit_code, 0);
  EXPECT_EQ(files_below("out"), (Names{"a/x.anim", "b/x.anim"}));
  ASSERT_EQ(import({"takes/a/x.bvh", "--out-dir", "one"}).exit_code, 0);
  EXPECT_EQ(files_below("one"), Names{"x.anim"});
  ASSERT_EQ(import({"takes/a/x.bvh", "--out-dir", "based", "--base", "takes/"}).exit_code, 0);
  EXPECT_EQ(files_below("based"), Names{"a/x.anim"});
  expect_usage_error(import({"takes/a/x.bvh", "--out-dir", "q", "--base", "takes/b"}),
                     "takes/a/x.bvh: error: is not inside takes/b");
}

TEST_F(BatchList, AFolderStandsForTheFilesThatTheToolReads) {
  put_capture("takes/a/x.bvh");
  put_capture("takes/Y.BVH");
  put("takes/notes.txt", "no capture");
  ASSERT_EQ(import({"takes", "--out-dir", "out"}).exit_code, 0);
  EXPECT_EQ(files_below("out"), (Names{"Y.anim", "a/x.anim"}));
  std::filesystem::create_directory(path("empty"));
  expect_usage_error(import({"empty", "--out-dir", "out"}), "empty: error: the folder has no .bvh");
}

// Takes that a tool does not read would go missing without a word.
TEST_F(BatchList, WhatAFolderLeavesOutIsNamedAndCounted) {
  put_capture("takes/x.bvh");
  put_capture("takes/y.bvh");
  put("takes/a.anim", "");
  put("takes/b.KANIM", "");
  put("takes/c.model", "");
  put("takes/skeleton.asf", "");
  put("takes/notes.txt", "no capture");
  const ToolRun run = import({"takes", "--out-dir", "out"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("takes: warning: 3 of 7 files are left out: 1 .anim, 1 .kanim, 1 "
                                 ".model [folder-left-out]\n"));
  for (const char* name : {"a.anim", "b.KANIM"}) std::filesystem::remove(path("takes/") + name);
  // A model is not missed.
  EXPECT_THAT(import({"takes", "--out-dir", "out"}).err, Not(HasSubstr("left out")));
}

// A take and the motion made of it would be two clips, or two examples of one walk.
TEST_F(BatchList, ACaptureBesideItsMotionCountsOnce) {
  for (const char* name : {"takes/x.bvh", "takes/y.bvh", "takes/sub/z.bvh"}) put_capture(name);
  for (const char* name : {"takes/x", "takes/sub/z"}) {
    ASSERT_EQ(import({std::string(name) + ".bvh", "-o", std::string(name) + ".anim"}).exit_code, 0);
  }
  const ToolRun table = run_here("krok-keys", {"takes", "--table", "gait.csv"});
  EXPECT_THAT(table.err, HasSubstr("takes: warning: 2 captures left out"));
  EXPECT_THAT(get(path("gait.csv")), AllOf(HasSubstr("x.anim"), HasSubstr("y.bvh")));
  EXPECT_THAT(get(path("gait.csv")), Not(HasSubstr("x.bvh")));
  const ToolRun edit = run_here("krok-edit", {"takes", "--mirror", "--out-dir", "out"});
  EXPECT_EQ(edit.exit_code, 0) << edit.err;
  EXPECT_EQ(files_below("out"), (Names{"sub/z.anim", "x.anim", "y.anim"}));
  // Both, where they are named; then no base keeps their outputs apart.
  EXPECT_THAT(
      run_here("krok-edit", {"takes/x.bvh", "takes/x.anim", "--mirror", "--out-dir", "o"}).err,
      AllOf(HasSubstr("would both be written to"), HasSubstr("files of one kind")));
}

TEST_F(BatchList, AFileGivenTwiceIsDoneOnce) {
  put_capture("takes/x.bvh");
  const ToolRun run =
      import({"takes/x.bvh", "takes/*.bvh", "./takes/../takes/x.bvh", "--out-dir", "out"});
  EXPECT_THAT(run.err, EndsWith("\nkrok-import: 1 file, 1 done; 1 with warnings\n"));
}

TEST_F(BatchList, WhatIsMissingOrDoesNotFitIsSaid) {
  put_capture("x.bvh");
  expect_usage_error(import({"none/*.bvh", "--out-dir", "out"}),
                     "none/*.bvh: error: no file matches");
  expect_usage_error(import({"--out-dir", "out"}), "no input");
  expect_usage_error(import({"-", "--out-dir", "out"}), "standard input");
  expect_usage_error(import({"x.bvh", "--out-dir", "out", "-o", "y.anim"}), "-o is for one output");
  expect_usage_error(import({"x.bvh", "--out-dir", "out", "--skeleton", "-"}), "only once");
  expect_usage_error(import({"x.bvh", "--keep-going", "-o", "y.anim"}), "--keep-going");
  expect_usage_error(import({"x.bvh", "x.bvh", "-o", "y.anim"}), "--out-dir DIR");
  expect_usage_error(import({"x.bvh", "--out-dir", "out", "--shard", "3/2"}), "--shard: '3/2'");
  expect_usage_error(import({"x.bvh", "--out-dir", "out", "--strict", "--repair"}), "--repair");
  EXPECT_EQ(listing(), Names{"x.bvh"});
}

// Before the first file is converted, not an hour later; with --keep-going the others are.
TEST_F(BatchList, MissingInputsOfAManifestAreListedFirst) {
  put_capture("a.bvh");
  put("list.tsv", "a.bvh\tx.anim\nnone.bvh\ty.anim\nalso/none.bvh\tz.anim\n");
  const ToolRun run = import({"--manifest", "list.tsv"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("list.tsv:2:1: error: no such file: none.bvh"));
  EXPECT_THAT(run.err, HasSubstr("list.tsv:3:1: error: no such file: also/none.bvh"));
  EXPECT_EQ(listing(), (Names{"a.bvh", "list.tsv"}));
  // Beside other errors of the list, too.
  put("faulty.tsv", "none.bvh\ty.anim\t--unit furlong\na.bvh\tx.anim\t--unit ell\n");
  const ToolRun faulty = import({"--manifest", "faulty.tsv"});
  EXPECT_EQ(faulty.exit_code, 2);
  EXPECT_THAT(faulty.err, HasSubstr("faulty.tsv:1:1: error: no such file: none.bvh"));
  EXPECT_THAT(faulty.err, HasSubstr("'furlong' is not a unit of length"));
  EXPECT_THAT(faulty.err, HasSubstr("'ell' is not a unit of length"));
  std::filesystem::remove(path("faulty.tsv"));
  EXPECT_EQ(import({"--manifest", "list.tsv", "--keep-going"}).exit_code, 3);
  EXPECT_EQ(files_below("."), (Names{"a.bvh", "list.tsv", "x.anim"}));
}

TEST_F(BatchList, TwoResultsOfOneNameAreRefused) {
  put_capture("a/x.bvh");
  put_capture("b/x.bvh");
  expect_usage_error(import({"a/*.bvh", "b/*.bvh", "--out-dir", "out"}),
                     "a/x.bvh and b/x.bvh would both be written to out/x.anim");
  expect_usage_error(
      import({"a", "b", "--base", ".", "--out-dir", "out", "--save-model", "m.model"}),
      "use {name}, which is replaced");
  EXPECT_EQ(listing(), (Names{"a", "b"}));
}

TEST_F(BatchList, ResultsNeverReplaceInputs) {
  put_capture("a.bvh", 4);
  put_capture("b.bvh", 5);
  put("list.tsv", "a.bvh\tc.anim\nb.bvh\ta.bvh\n");
  expect_usage_error(import({"--manifest", "list.tsv"}), "list.tsv:2:1: error: a.bvh is an input");
  std::filesystem::create_hard_link(path("a.bvh"), path("linked.anim"));
  put("list.tsv", "a.bvh\tlinked.anim\n");
  expect_usage_error(import({"--manifest", "list.tsv"}), "a.bvh is an input");
  put("list.tsv", "a.bvh\tlist.tsv\n");
  expect_usage_error(import({"--manifest", "list.tsv"}), "list.tsv is an input");
  expect_usage_error(import({"*.bvh", "--out-dir", "out", "--json=a.bvh"}), "a.bvh is an input");
  EXPECT_EQ(import({"*.bvh", "--nonsense", "--out-dir", "out", "--json=a.bvh"}).exit_code, 2);
  EXPECT_EQ(import({"*.none", "--out-dir", "out", "--json=a.bvh"}).exit_code, 2);
  EXPECT_EQ(get(path("a.bvh")), capture(4));
  EXPECT_EQ(get(path("b.bvh")), capture(5));
}

TEST_F(BatchList, OtherOutputsAreNamedByThePlaceholder) {
  put_capture("takes/a/x.bvh");
  put_capture("takes/y.bvh");
  const ToolRun run = import({"takes", "--out-dir", "out", "--save-model", "models/{name}.model"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(files_below("out"),
            (Names{"a/x.anim", "models/a/x.model", "models/y.model", "y.anim"}));
  // One that is gone is made again, with the motion that belongs to it.
  std::filesystem::remove(path("out/models/y.model"));
  EXPECT_EQ(
      counts(import({"takes", "--out-dir", "out", "--save-model", "models/{name}.model", "--json"})
                 .out),
      (Counts{{"done", 1}, {"unchanged", 1}}));
  EXPECT_TRUE(std::filesystem::exists(path("out/models/y.model")));
}

TEST_F(BatchList, AManifestNamesInputsOutputsAndOptions) {
  put_capture("x.bvh", 40);
  put_capture("takes/y.bvh", 40);
  put("list.tsv",
      "input\toutput\toptions\r\n# a comment\r\n\r\n"
      "x.bvh\tone.anim\t--fps 60 --unit 'm'\r\nx.bvh\tsub/two.anim\r\ntakes/y.bvh\t\t--fps 24");
  const ToolRun run = import({"--manifest", "list.tsv", "--out-dir", "out", "--fps", "50", "--up=y",
                              "--json=report.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(files_below("out"), (Names{"one.anim", "sub/two.anim", "y.anim"}));
  const Json files = Json::parse(get(path("report.json")))["files"];
  EXPECT_EQ(files[0]["result"]["rate"], 60.0) << "a line's option goes before";
  EXPECT_EQ(files[0]["options"], Json({{"unit", "m"}, {"up", "y"}, {"fps", "60"}}));
  EXPECT_EQ(files[1]["result"]["rate"], 50.0);
  EXPECT_EQ(files[2]["result"]["rate"], 24.0);

  // From standard input, with outputs where the line says.
  ToolOptions piped;
  piped.input = "x.bvh\tpiped.anim\n";
  EXPECT_EQ(import({"--manifest", "-"}, piped).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(path("piped.anim")));
}

TEST_F(BatchList, FaultsOfAManifestAreToldByLineAndColumn) {
  put_capture("x.bvh");
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"x.bvh\ta.anim\t--fps 60\tmore", "list.tsv:1:23: error: more than three fields"},
      {"\n\tb.anim", "list.tsv:2:1: error: no input given"},
      {"x.bvh", "list.tsv:1:1: error: no output given"},
      {"-\tb.anim", "list.tsv:1:1: error: standard streams cannot be used"},
      {"x.bvh\t-", "list.tsv:1:7: error: standard streams cannot be used"},
      {"x.bvh\tb.anim\t--strict  --repair",
       "list.tsv:1:24: error: --repair and --strict exclude each other"},
      {"x.bvh\tb.anim\t--strict --fps fast", "list.tsv:1:23: error: --fps: 'fast'"},
      {"x.bvh\tb.anim\t--fps", "list.tsv:1:14: error: --fps"},
      {"x.bvh\tb.anim\t--jobs 3", "list.tsv:1:14: error: "},
      {"x.bvh\tb.anim\tword", "list.tsv:1:14: error: "},
      {"x.bvh\tb.anim\t--up \"y", "list.tsv:1:19: error: unclosed quote \""},
      {"x.bvh\tb.anim\t--unit furlong", "list.tsv:1:14: error: --unit: 'furlong'"},
      {"x.bvh\tb.anim\nx.bvh\t./b.anim", "list.tsv:2:1: error: x.bvh and x.bvh would both"},
      {"# nothing\n", "list.tsv: error: the list has no files"}};
  for (const auto& [text, message] : cases) {
    put("list.tsv", text);
    const ToolRun run = import({"--manifest", "list.tsv"});
    EXPECT_EQ(run.exit_code, 2) << text;
    EXPECT_THAT(run.err, HasSubstr(message)) << text;
    EXPECT_FALSE(std::filesystem::exists(path("b.anim"))) << text;
  }
  // All at once, in the order of the lines.
  put("list.tsv", "x.bvh\ta.anim\t--jobs 3\n\tb.anim\n");
  const ToolRun run = import({"--manifest", "list.tsv", "--json"});
  const Json issues = Json::parse(run.out)["issues"];
  ASSERT_EQ(issues.size(), 2u);
  EXPECT_EQ(issues[0]["line"], 1);
  EXPECT_EQ(issues[1]["line"], 2);
}

TEST_F(BatchList, EveryFileIsInOneShardAndStaysThere) {
  for (int i = 0; i < 20; ++i) put_capture("takes/x" + std::to_string(i) + ".bvh", 2);
  std::map<std::string, int> shard_of;
  const auto import_shards = [&](const std::string& out) {
    std::map<std::string, int> result;
    for (int i = 1; i <= 3; ++i) {
      const ToolRun run =
          import({"takes", "--out-dir", out, "--shard", std::to_string(i) + "/3", "--json"});
      EXPECT_EQ(run.exit_code, 0) << run.err;
      const Json report = Json::parse(run.out);
      for (const auto& file : report["files"]) {
        EXPECT_TRUE(result.emplace(file["input"], i).second) << "in two shards";
      }
    }
    return result;
  };
  shard_of = import_shards("out");
  EXPECT_EQ(shard_of.size(), 20u);
  // With fewer files the others stay in their shards.
  std::filesystem::remove(path("takes/x7.bvh"));
  for (const auto& [file, shard] : import_shards("again")) EXPECT_EQ(shard, shard_of[file]) << file;
  // What shards did is done.
  EXPECT_EQ(counts(import({"takes", "--out-dir", "out", "--json"}).out),
            (Counts{{"unchanged", 19}}));
}

TEST_F(BatchList, ExportAsksForAFormat) {
  put_capture("takes/x.bvh");
  ASSERT_EQ(import({"takes", "--out-dir", "motions"}).exit_code, 0);
  expect_usage_error(tool("krok-export", {"motions", "--out-dir", "glb"}), "--format");
  ASSERT_EQ(tool("krok-export", {"motions", "--out-dir", "glb", "--format", "glb", "--no-bones"})
                .exit_code,
            0);
  EXPECT_EQ(files_below("glb"), Names{"x.glb"});
  ASSERT_EQ(
      tool("krok-export", {"motions/x.anim", "--format", "glb", "--no-bones", "-o", "single.glb"})
          .exit_code,
      0);
  EXPECT_TRUE(get(path("single.glb")) == get(path("glb/x.glb"))) << "as a run of its own does";
}

TEST_F(BatchList, OneModelForManyMotions) {
  put_capture("takes/x.bvh");
  put_capture("takes/y.bvh", 9);
  ASSERT_EQ(import({"takes", "--out-dir", "motions"}).exit_code, 0);
  ASSERT_EQ(tool("krok-body", {"motions/*.anim", "--detail", "low", "--out-dir", "b"}).exit_code,
            0);
  EXPECT_EQ(files_below("b"), (Names{"x.model", "y.model"}));
  const ToolRun skin = tool("krok-skin", {"b/x.model", "motions", "--as", "rig", "--out-dir", "r"});
  EXPECT_EQ(skin.exit_code, 0) << skin.err;
  EXPECT_EQ(files_below("r"), (Names{"x.glb", "y.glb"}));
  // Another model: both are made anew.
  const std::vector<std::string> again = {"b/y.model", "motions", "--as",  "rig",
                                          "--out-dir", "r",       "--json"};
  EXPECT_EQ(counts(tool("krok-skin", again).out), (Counts{{"done", 2}}));
  EXPECT_EQ(counts(tool("krok-skin", again).out), (Counts{{"unchanged", 2}}));
}

// Results that lie inside the folder that is read are not read when the batch runs again.
TEST_F(BatchList, ResultsAreNoInputs) {
  put_capture("takes/a.bvh");
  put_capture("takes/deep/b.bvh");
  ASSERT_EQ(import({"takes", "--out-dir", "m"}).exit_code, 0);
  for (int round = 0; round < 2; ++round) {
    const ToolRun run =
        tool("krok-edit", {"m/**/*.anim", "--mirror", "--out-dir", "m/out", "--json"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(counts(run.out),
              (std::map<std::string, int>{{round == 0 ? "done" : "unchanged", 2}}));
  }
  const ToolRun folder =
      tool("krok-edit", {"m", "--at-origin", "--out-dir", "m/../m/out", "--force"});
  EXPECT_NE(folder.err.find("2 files, 2 done"), std::string::npos) << folder.err;
  EXPECT_EQ(files_below("m/out"), (Names{"a.anim", "deep/b.anim"}));
  // A file that is named is taken, wherever it stands.
  EXPECT_EQ(tool("krok-edit", {"m/out/a.anim", "--mirror", "--out-dir", "m/out/again"}).exit_code,
            0);
}

TEST_F(BatchList, FilesThatAreNamedMustBeThereAndAllThatAreNotAreTold) {
  put_capture("a.bvh");
  const ToolRun run = import({"a.bvh", "captures/", "b.bvh", "--out-dir", "out", "--keep-going"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("captures/: error: no such file"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("b.bvh: error: no such file"), std::string::npos) << run.err;
  EXPECT_EQ(files_below("out"), Names{});
}

TEST_F(BatchList, AListOfSequencesIsNoBatch) {
  put_capture("a.bvh");
  put("parts.json", R"({"schema": "krok.sequences/1", "sequences": []})");
  const ToolRun run = tool(
      "krok-edit", {"a.bvh", "--list-sequences", "--sequences", "parts.json", "--out-dir", "out"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_TRUE(has_code(run.err, "usage")) << run.err;
  EXPECT_FALSE(std::filesystem::exists(path("out")));
}

}  // namespace
}  // namespace krok::test
