// If these fail, a result destroys what a run reads, a run that failed leaves some of its results
// behind, or a limit of the system ends a tool without a word.
#include "cli/fixture.h"
#include "support/glb_builder.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

class Results : public CliTest {
 protected:
  Results() { in_folder_.folder = folder_.string(); }

  ToolRun tool(const std::string& name, const std::vector<std::string>& arguments) const {
    return run_tool(name, arguments, in_folder_);
  }
  // A command of a shell in the test's folder, with the tools on its path.
  ToolRun shell(const std::string& command) const {
    return test::run({"/bin/sh", "-c", "PATH='" + test::tools_folder() + "':$PATH; " + command},
                     in_folder_);
  }
  // in.bvh, 30 frames, and in.anim.
  void make_motion() {
    put("in.bvh", capture(30));
    ASSERT_EQ(tool("krok-import", {"in.bvh", "-o", "in.anim"}).exit_code, 0);
  }
  void make_character() {
    make_motion();
    ASSERT_EQ(tool("krok-body", {"in.anim", "--detail", "low", "-o", "in.model"}).exit_code, 0);
  }
  // Two parts, of which the second ends with `last`.
  void put_sequences(int last) const {
    put("parts.json",
        R"({"schema": "krok.sequences/1", "sequences": [)"
        R"({"name": "run", "first": 0, "last": 9}, {"name": "end", "first": 5, "last": )" +
            std::to_string(last) + "}]}");
  }
  static void expect_refused(const ToolRun& run, const std::string& part) {
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_TRUE(has_code(run.err, "usage")) << run.err;
    EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
  }

  ToolOptions in_folder_;
};

TEST_F(Results, ASequenceDoesNotReplaceTheInput) {
  make_motion();
  put_sequences(20);
  fs::rename(path("in.anim"), path("w_run.anim"));
  const std::string before = get(path("w_run.anim"));
  const Names names = listing();
  expect_refused(
      tool("krok-edit", {"w_run.anim", "--sequences", "parts.json", "-o", "w_{sequence}.anim"}),
      "w_run.anim: error: is an input and would be overwritten");
  fs::create_symlink("w_run.anim", path("x_run.anim"));
  expect_refused(
      tool("krok-edit", {"w_run.anim", "--sequences", "parts.json", "-o", "x_{sequence}.anim"}),
      "w_run.anim: error: is an input and would be overwritten");
  fs::remove(path("x_run.anim"));
  EXPECT_EQ(get(path("w_run.anim")), before);
  EXPECT_EQ(listing(), names);
}

TEST_F(Results, ASequenceDoesNotReplaceTheReport) {
  make_motion();
  put_sequences(20);
  const Names names = listing();
  expect_refused(tool("krok-edit", {"in.anim", "--sequences", "parts.json", "-o",
                                    "w_{sequence}.anim", "--json=w_end.anim"}),
                 "w_end.anim would be written twice");
  EXPECT_EQ(get(path("w_end.anim")).find("{\n  \"schema\": \"krok.report/1\""), 0u);
  fs::remove(path("w_end.anim"));
  EXPECT_EQ(listing(), names);
}

// Two names, one file.
TEST_F(Results, TwoResultsDoNotShareAFile) {
  GlbBuilder builder = rig();
  builder.json["animations"].push_back(builder.json["animations"][0]);
  builder.json["animations"][1]["name"] = "Other";
  const auto bytes = builder.glb();
  put("rig.glb", std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  put("w_Bend.anim", "old");
  fs::create_symlink("w_Bend.anim", path("w_Other.anim"));
  expect_refused(tool("krok-import", {"rig.glb", "--clip", "all", "-o", "w_{clip}.anim"}),
                 "w_Other.anim would be written twice");
  EXPECT_EQ(get(path("w_Bend.anim")), "old");
}

TEST_F(Results, OfSequencesAllAppearOrNone) {
  make_motion();
  put_sequences(9999);
  put("w_run.anim", "old");
  const Names names = listing();
  const ToolRun run =
      tool("krok-edit", {"in.anim", "--sequences", "parts.json", "-o", "w_{sequence}.anim"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_TRUE(has_code(run.err, "edit-sequence")) << run.err;
  EXPECT_EQ(run.err.find("->"), std::string::npos) << "told of what is not there: " << run.err;
  fs::create_directory(path("w_end.anim"));
  put_sequences(20);
  EXPECT_EQ(tool("krok-edit", {"in.anim", "--sequences", "parts.json", "-o", "w_{sequence}.anim"})
                .exit_code,
            2);
  fs::remove(path("w_end.anim"));
  EXPECT_EQ(listing(), names);
  EXPECT_EQ(get(path("w_run.anim")), "old");
}

TEST_F(Results, OfFramesAllAppearOrNone) {
  make_character();
  fs::create_directory(path("x_0020.glb"));
  put("x_0003.glb", "old");
  const Names names = listing();
  for (const char* jobs : {"1", "4"}) {
    const ToolRun run =
        tool("krok-skin", {"in.model", "in.anim", "--as", "frames", "-o", "x.glb", "-j", jobs});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_NE(run.err.find("x_0020.glb: error: "), std::string::npos) << run.err;
    EXPECT_EQ(listing(), names);
    EXPECT_EQ(get(path("x_0003.glb")), "old");
  }
  fs::remove(path("x_0020.glb"));
  ASSERT_EQ(tool("krok-skin", {"in.model", "in.anim", "--as", "frames", "-o", "x.glb"}).exit_code,
            0);
  EXPECT_EQ(listing().size(), 3u + 30u);
  EXPECT_NE(get(path("x_0003.glb")), "old");
}

TEST_F(Results, AReportThatCannotBeWrittenIsNoticedFirst) {
  make_motion();
  put("out.anim", "old");
  const ToolRun run =
      tool("krok-import", {"in.bvh", "-o", "out.anim", "--json=no/such/report.json"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("no/such/report.json: error: "), std::string::npos) << run.err;
  EXPECT_EQ(get(path("out.anim")), "old");
}

TEST_F(Results, NoClobberProtectsTheReportToo) {
  make_motion();
  put("report.json", "mine");
  const std::string report = "--json=report.json";
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"in.bvh", "-o", "out.anim", "--no-clobber", report},
        {"in.bvh", "--out-dir", "out", "--no-clobber", report}}) {
    const ToolRun run = tool("krok-import", arguments);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_TRUE(has_code(run.err, "file-exists")) << run.err;
  }
  // A command line that cannot be parsed.
  tool("krok-import", {"in.bvh", "--nonsense", "--no-clobber", report});
  EXPECT_EQ(get(path("report.json")), "mine");
  EXPECT_FALSE(fs::exists(path("out.anim")));
}

TEST_F(Results, AFileThatGrowsTooLargeIsAnErrorLikeOthers) {
  put("in.bvh", capture(2000));
  put("out.anim", "old");
  const Names names = listing();
  const ToolRun run = shell("ulimit -f 16; krok-import in.bvh -o out.anim");
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_TRUE(has_code(run.err, "file-unwritable")) << run.err;
  EXPECT_EQ(get(path("out.anim")), "old");
  EXPECT_EQ(listing(), names);
}

// Buffers beside a .gltf are read too.
TEST_F(Results, AReportDoesNotReplaceWhatAGltfRefersTo) {
  GlbBuilder builder = rig();
  const std::string bytes(reinterpret_cast<const char*>(builder.bin.data()), builder.bin.size());
  builder.json["buffers"] = {{{"byteLength", bytes.size()}, {"uri", "rig.bin"}}};
  put("rig.gltf", builder.json.dump());
  put("rig.bin", bytes);
  const std::string report = "--json=rig.bin";
  for (const auto& [name, arguments] :
       std::vector<std::pair<std::string, std::vector<std::string>>>{
           {"krok-diff", {"rig.gltf", "rig.gltf", report}},
           {"krok-info", {"rig.gltf", report}},
           {"krok-import", {"rig.gltf", "-o", "rig.anim", report}}}) {
    expect_refused(tool(name, arguments), "rig.bin: error: is an input and would be overwritten");
    EXPECT_TRUE(get(path("rig.bin")) == bytes) << name;
  }
  const ToolRun diff = tool("krok-diff", {"rig.gltf", "rig.gltf", "--json"});
  EXPECT_EQ(diff.exit_code, 0) << diff.err;
  EXPECT_NE(diff.out.find("rig.bin"), std::string::npos) << "no input: " << diff.out;
}

// A name of a file may be any bytes, glTF's texts are UTF-8.
TEST_F(Results, ANameThatIsNoUtf8IsNoTrouble) {
  put("caf\xe9.bvh", capture(5));
  const ToolRun run = tool("krok-export", {"caf\xe9.bvh", "-o", "out.glb"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(get(path("out.glb")).find("caf\xc3\xa9.bvh"), std::string::npos);
}

// Each thread takes a gigabyte for its stack here, and there are two and a half.
constexpr const char* kFewThreads = "ulimit -s 1000000; ulimit -v 2500000; ";

TEST_F(Results, FewerThreadsThanAskedForWillDo) {
  if (sanitized()) GTEST_SKIP() << "skipped: a sanitizer's memory has no limits";
  make_character();
  const ToolRun run =
      shell(std::string(kFewThreads) + "krok-skin in.model in.anim --as frames -o x.glb -j 1024");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(listing().size(), 3u + 30u);
}

TEST_F(Results, FewerThreadsWillDoForABatchToo) {
  if (sanitized()) GTEST_SKIP() << "skipped: a sanitizer's memory has no limits";
  make_motion();
  fs::create_directory(path("many"));
  for (int i = 0; i < 100; ++i) {
    fs::copy(path("in.anim"), path("many/" + std::to_string(i) + ".anim"));
  }
  const ToolRun run =
      shell(std::string(kFewThreads) + "krok-edit many --mirror --out-dir out -j 200");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("100 files, 100 done"), std::string::npos) << run.err;
}

TEST_F(Results, WithoutMemoryAToolSaysSoAndLeavesNothing) {
  if (sanitized()) GTEST_SKIP() << "skipped: a sanitizer's memory has no limits";
  put("in.bvh", capture(20000));
  put("out.anim", "old");
  const auto limited = [&](int kibibytes, const std::string& command) {
    return shell("ulimit -c 0; ulimit -v " + std::to_string(kibibytes) + "; " + command);
  };
  // The least with which the program can be loaded; where libraries come to lie differs from run to
  // run, and those that need memory while they are loaded (Assimp) end the program.
  int least = 0;
  for (int step = 1 << 20; step >= 64; step /= 2) {
    if (limited(least + step, "krok-import --version").exit_code != 0) least += step;
  }
  int failed = 0;
  for (int more = 1400; more < 16000; more += more < 4000 ? 200 : 1000) {
    const std::string before = get(path("out.anim"));
    const ToolRun run = limited(least + more, "krok-import in.bvh -o out.anim -j 2 -q");
    ASSERT_TRUE(run.exit_code == 0 || run.exit_code == 2) << more << ": " << run.err;
    EXPECT_EQ(listing(), (Names{"in.bvh", "out.anim"}));
    if (run.exit_code == 0) continue;
    ++failed;
    EXPECT_TRUE(has_code(run.err, "out-of-memory")) << run.err;
    EXPECT_TRUE(get(path("out.anim")) == before);
  }
  EXPECT_GT(failed, 3);
}

}  // namespace
}  // namespace krok::test
