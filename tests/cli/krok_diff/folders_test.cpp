// If these fail, a regression test in CI passes though a file changed, is missing or cannot be
// read, or golden files are changed that nobody meant to change.

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <nlohmann/json.hpp>

#include "cli/fixture.h"
#include "formats/anim/anim.h"
#include "support/glb_builder.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

class KrokDiffFolders : public CliTest {
 protected:
  void put_below(const std::string& name, const std::string& text) const {
    fs::create_directories(fs::path(path(name)).parent_path());
    put(name, text);
  }
  // A motion of two joints; one of them `off` metres aside in frame 3, the reference pose all over.
  void put_motion(const std::string& name, float off = 0, double reference_off = 0) const {
    Clip clip;
    clip.rate = 10;
    clip.skeleton.add("Hips", -1, {Vec3(0, 1, 0), Quat::Identity()});
    clip.skeleton.add("LeftHand", 0, {Vec3(0.5, 1.2, 0), Quat::Identity()});
    clip.resize(5);
    for (int frame = 0; frame < 5; ++frame) clip.set_pose(frame, clip.skeleton.reference);
    clip.frame_positions(3)[1].x() += off;
    for (Transform& joint : clip.skeleton.reference) joint.position.x() += reference_off;
    fs::create_directories(fs::path(path(name)).parent_path());
    auto file = OutputFile::create(path(name));
    ASSERT_TRUE(file.ok() && anim::write(clip, {}, *file).ok() && file->commit().ok());
  }
  // A .gltf with its numbers in a .bin beside it; the first corner `off` metres aside.
  void put_gltf(const std::string& name, float off) const {
    GlbBuilder square = test::square();
    float x = 0;
    std::memcpy(&x, square.bin.data(), 4);
    x += off;
    std::memcpy(square.bin.data(), &x, 4);
    square.json["buffers"] = {{{"uri", "data.bin"}, {"byteLength", square.bin.size()}}};
    put_below(name + "/square.gltf", square.json.dump());
    put_below(name + "/data.bin",
              std::string(reinterpret_cast<const char*>(square.bin.data()), square.bin.size()));
  }
  ToolRun diff(std::vector<std::string> arguments) const {
    return run_here("krok-diff", std::move(arguments));
  }
  std::vector<std::string> files_below(const std::string& folder) const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(path(folder))) {
      names.push_back(fs::relative(entry.path(), path(folder)).string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }
};

TEST_F(KrokDiffFolders, EqualFoldersAreTheSame) {
  for (const char* folder : {"a/", "b/"}) {
    put_motion(std::string(folder) + "walks/walk.anim");
    put_below(std::string(folder) + "notes.txt", "one");
  }
  const ToolRun run = diff({"a", "b"});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_EQ(run.out, "a against b: 2 files\n  the same      2\n");
  EXPECT_EQ(run.err, "");
  EXPECT_EQ(diff({"a/", "./b/"}).exit_code, 0) << "slashes do not matter";
  EXPECT_EQ(diff({"-q", "a", "b"}).out, "");
}

TEST_F(KrokDiffFolders, NamesWhatDiffersHowFarAndWhere) {
  put_motion("a/walks/walk.anim");
  put_motion("b/walks/walk.anim", 3.2e-4F);
  const ToolRun run = diff({"a", "b", "--json=report.json"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.out, HasSubstr("differs: walks/walk.anim: positions 0.32 mm (32 x the tolerance) "
                                 "at joint LeftHand, frame 3 (0.3 s)\n"));
  EXPECT_EQ(diff({"a", "b", "--tolerance", "0.4mm"}).exit_code, 0);
  const json result = json::parse(get(path("report.json")))["result"];
  EXPECT_EQ(result["same"], false);
  EXPECT_EQ(result["counts"]["differs"], 1);
  const json& file = result["files"].at(0);
  EXPECT_EQ(file["path"], "walks/walk.anim");
  EXPECT_EQ(file["status"], "differs");
  EXPECT_EQ(file["difference"]["kind"], "anim");
  bool found = false;
  for (const json& measure : file["difference"]["measures"]) {
    if (measure["what"] != "positions") continue;
    found = true;
    EXPECT_NEAR(measure["largest"].get<double>(), 3.2e-4, 1e-7);
  }
  EXPECT_TRUE(found);
}

TEST_F(KrokDiffFolders, MissingAndNewFilesAreDifferences) {
  put_motion("a/both.anim");
  put_motion("b/both.anim");
  put_motion("a/gone.anim");
  const ToolRun gone = diff({"a", "b"});
  EXPECT_EQ(gone.exit_code, 1);
  EXPECT_THAT(gone.out, HasSubstr("only in a: gone.anim\n"));
  fs::rename(path("a/gone.anim"), path("b/new.anim"));
  const ToolRun added = diff({"a", "b"});
  EXPECT_EQ(added.exit_code, 1);
  EXPECT_THAT(added.out, HasSubstr("only in b: new.anim\n"));
}

TEST_F(KrokDiffFolders, OtherKindsAreComparedByteByByte) {
  put_below("a/table.csv", "1,2,3");
  put_below("b/table.csv", "1,2,4");
  put_below("a/.gitattributes", "x");
  put_below("b/krok-import.journal.jsonl", "{}");
  const ToolRun run = diff({"a", "b"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.out, HasSubstr("differs: table.csv: first difference at byte 4\n"));
  EXPECT_THAT(run.out, HasSubstr("1 file\n")) << "hidden files and journals are no results";
  put_below("b/table.csv", "1,2,3,4");
  EXPECT_THAT(diff({"a", "b"}).out, HasSubstr("5 bytes in the first, 7 bytes in the second"));
}

// One that cannot be read is named, and the others are compared all the same.
TEST_F(KrokDiffFolders, OneOfFiveHundredCannotBeRead) {
  for (int i = 0; i < 500; ++i) {
    const std::string name = "/" + std::to_string(1000 + i) + ".anim";
    put_motion("a" + name);
    put_motion("b" + name, i == 499 ? 1e-3F : 0.0F);
  }
  fs::resize_file(path("b/1250.anim"), 300);
  const ToolRun all = diff({"a", "b", "--keep-going"});
  EXPECT_EQ(all.exit_code, 3);
  EXPECT_THAT(all.err, HasSubstr("b/1250.anim: error: "));
  EXPECT_THAT(all.err, HasSubstr("1 file cannot be read: 1250.anim [batch-failed]"));
  EXPECT_THAT(all.out, HasSubstr("differs: 1499.anim: positions 1 mm"));
  EXPECT_THAT(all.out, HasSubstr("  the same          498\n"));
  // The report of an earlier run would say that all is well.
  put("out.xml", "<testsuites/>\n");
  const ToolRun stopped = diff({"a", "b", "--summary", "out.xml"});
  EXPECT_EQ(stopped.exit_code, 2);
  EXPECT_THAT(get(path("out.xml")), AllOf(HasSubstr("errors=\"1\""), HasSubstr("<skipped")));
  const ToolRun two = diff({"a/1250.anim", "b/1250.anim", "--summary", "two.xml"});
  EXPECT_EQ(two.exit_code, 2);
  EXPECT_THAT(get(path("two.xml")), HasSubstr("errors=\"1\""));
  EXPECT_THAT(stopped.err, HasSubstr("stopped at 1250.anim: the file cannot be read"));
  EXPECT_THAT(stopped.err, HasSubstr("--keep-going"));
  EXPECT_THAT(stopped.out, Not(HasSubstr("1499.anim")));
}

TEST_F(KrokDiffFolders, TheSameIsToldWhateverTheThreads) {
  for (int i = 0; i < 40; ++i) {
    const std::string name = "/" + std::to_string(i) + (i % 3 == 0 ? ".txt" : ".anim");
    put_motion("a" + name);
    put_motion("b" + name, i % 4 == 0 ? 1e-3F * static_cast<float>(i) : 0.0F);
  }
  fs::resize_file(path("b/7.anim"), 300);
  fs::resize_file(path("b/22.anim"), 300);
  for (const char* going : {"--keep-going", "-q"}) {
    const ToolRun one = diff({"a", "b", going, "-j", "1", "--json=r.json"});
    const std::string first = get(path("r.json"));
    const ToolRun eight = diff({"a", "b", going, "-j", "8", "--json=r.json"});
    EXPECT_EQ(one.exit_code, eight.exit_code);
    EXPECT_EQ(one.out, eight.out);
    EXPECT_EQ(one.err, eight.err);
    EXPECT_EQ(get(path("r.json")), first);
  }
}

TEST_F(KrokDiffFolders, WhatAGltfRefersToIsComparedWithIt) {
  put_gltf("a", 0);
  put_gltf("b", 1e-6F);  // within the tolerance, but other bytes
  const ToolRun within = diff({"a", "b"});
  EXPECT_EQ(within.exit_code, 0) << within.out << within.err;
  put_gltf("b", 1e-2F);
  const ToolRun beyond = diff({"a", "b"});
  EXPECT_EQ(beyond.exit_code, 1);
  EXPECT_THAT(
      beyond.out,
      HasSubstr("differs: square.gltf: positions 10 mm (1000 x the tolerance) at vertex 0"));
  EXPECT_THAT(beyond.out, Not(HasSubstr("data.bin")));
}

TEST_F(KrokDiffFolders, LinksAndPipesEndNothing) {
  put_motion("a/walk.anim");
  put_motion("b/walk.anim");
  fs::create_directory_symlink(path("b"), path("b/loop"));
  ASSERT_EQ(mkfifo(path("b/pipe").c_str(), 0600), 0);
  const ToolRun run = diff({"a", "b"});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("note: b/loop was skipped: a link to a folder\n"));
  EXPECT_THAT(run.out, HasSubstr("note: b/pipe was skipped: not a regular file\n"));
  put_below("a/lost.anim", "x");
  fs::create_symlink(path("nowhere"), path("b/lost.anim"));
  const ToolRun lost = diff({"a", "b", "--keep-going"});
  EXPECT_EQ(lost.exit_code, 3);
  EXPECT_THAT(lost.out, HasSubstr("cannot be read: lost.anim"));
}

TEST_F(KrokDiffFolders, OneFolderMayLieInTheOther) {
  put_motion("a/walk.anim");
  put_motion("a/out/walk.anim");
  EXPECT_EQ(diff({"a", "a/out"}).exit_code, 0);
  EXPECT_EQ(diff({"a/out", "a"}).exit_code, 0);
}

TEST_F(KrokDiffFolders, UpdateMakesTheFirstWhatTheSecondIs) {
  put_motion("a/changed.anim");
  put_motion("b/changed.anim", 1e-2F);
  put_motion("a/close.anim");
  put_motion("b/close.anim", 1e-6F);  // within the tolerance
  put_motion("b/deep/in/new.anim");
  put_motion("a/gone.anim");
  const std::string close = get(path("a/close.anim"));
  const ToolRun run = diff({"a", "b", "--update"});
  EXPECT_EQ(run.exit_code, 1) << "one file is still only in the first";
  EXPECT_EQ(run.err, "replaced a/changed.anim\nadded a/deep/in/new.anim\n");
  EXPECT_EQ(get(path("a/changed.anim")), get(path("b/changed.anim")));
  EXPECT_EQ(get(path("a/close.anim")), close) << "what is the same is left alone";
  EXPECT_TRUE(fs::exists(path("a/gone.anim")));
  const ToolRun pruned = diff({"a", "b", "--update", "--prune", "--json=r.json"});
  EXPECT_EQ(pruned.exit_code, 0) << pruned.err;
  EXPECT_EQ(json::parse(get(path("r.json")))["result"]["update"]["removed"],
            json::array({"gone.anim"}));
  EXPECT_FALSE(fs::exists(path("a/gone.anim")));
  EXPECT_EQ(diff({"a", "b"}).exit_code, 0);
}

TEST_F(KrokDiffFolders, UpdateChangesNothingWhereSomethingIsAmiss) {
  put_motion("a/changed.anim");
  put_motion("b/changed.anim", 1e-2F);
  put_motion("a/cut.anim");
  put_below("b/cut.anim", "KROKANIM");
  const std::string before = get(path("a/changed.anim"));
  const ToolRun going = diff({"a", "b", "--update", "--keep-going"});
  EXPECT_EQ(going.exit_code, 3);
  EXPECT_THAT(going.err, HasSubstr("nothing was updated"));
  EXPECT_EQ(diff({"a", "b", "--update"}).exit_code, 2);
  EXPECT_EQ(get(path("a/changed.anim")), before);

  // A file stands where a folder is needed.
  fs::remove(path("a/cut.anim"));
  fs::remove(path("b/cut.anim"));
  put_below("a/deep", "a file");
  put_motion("b/deep/new.anim");
  put_motion("b/aside/new.anim");
  const auto listed = files_below("a");
  const ToolRun blocked = diff({"a", "b", "--update"});
  EXPECT_EQ(blocked.exit_code, 2);
  EXPECT_THAT(blocked.err, HasSubstr("a/deep: error: "));
  EXPECT_EQ(get(path("a/changed.anim")), before);
  EXPECT_EQ(files_below("a"), listed) << "no new folder is left either";
}

TEST_F(KrokDiffFolders, UpdateWritesNotThroughLinksToFolders) {
  put_motion("a/walk.anim");
  put_motion("b/walk.anim");
  put_motion("b/sub/new.anim");
  fs::create_directory(path("elsewhere"));
  fs::create_directory_symlink(path("elsewhere"), path("a/sub"));
  const ToolRun run = diff({"a", "b", "--update"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("a/sub: error: is a link"));
  EXPECT_TRUE(fs::is_empty(path("elsewhere")));
}

TEST_F(KrokDiffFolders, UpdateMakesTheFirstGoldenFiles) {
  put_motion("b/deep/walk.anim");
  const ToolRun none = diff({"a", "b"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, AllOf(HasSubstr("[file-missing]"), HasSubstr("--update")));
  const ToolRun run = diff({"golden/a", "b", "--update"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(files_below("golden"), ElementsAre("a", "a/deep", "a/deep/walk.anim"));
  EXPECT_EQ(diff({"golden/a", "b"}).exit_code, 0);
}

TEST_F(KrokDiffFolders, PruneDoesNotRemoveAll) {
  put_motion("a/walk.anim");
  fs::create_directory(path("b"));
  const ToolRun run = diff({"a", "b", "--update", "--prune"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("[diff-empty]"));
  EXPECT_TRUE(fs::exists(path("a/walk.anim")));
}

TEST_F(KrokDiffFolders, NothingToCompareIsTrouble) {
  fs::create_directory(path("a"));
  fs::create_directory(path("b"));
  const ToolRun run = diff({"a", "b"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("[diff-empty]"));
}

TEST_F(KrokDiffFolders, PatternsChooseFiles) {
  put_motion("a/walks/slow/one.anim");
  put_motion("b/walks/slow/one.anim", 1e-2F);
  put_below("a/log.txt", "1");
  put_below("b/log.txt", "2");
  const auto code = [&](std::vector<std::string> patterns) {
    patterns.insert(patterns.begin(), {"a", "b"});
    return diff(patterns).exit_code;
  };
  EXPECT_EQ(code({"--exclude", "*.anim"}), 1);
  EXPECT_EQ(code({"--include", "log.*"}), 1);
  EXPECT_EQ(code({"--exclude", "*.anim", "--exclude", "*.txt"}), 2) << "none is left";
  EXPECT_THAT(diff({"a", "b", "--include", "walks/**/*.anim"}).out, HasSubstr("1 file\n"));
  EXPECT_THAT(diff({"a", "b", "--include", "walks/*.anim", "--include", "log.txt"}).out,
              HasSubstr("1 file\n"));
  EXPECT_THAT(diff({"a", "b", "--exclude", "walks/**"}).out, HasSubstr("1 file\n"));
  EXPECT_EQ(code({"--include", "**", "--exclude", "walks/**", "--exclude", "log.txt"}), 2);
  // A gate that leaves nothing out although it is said to.
  EXPECT_THAT(diff({"a", "b", "--exclude", "walk/**"}).err, HasSubstr("matches no file"));
  EXPECT_THAT(diff({"a", "b", "--exclude", "walks/**"}).err, Not(HasSubstr("matches no file")));
}

TEST_F(KrokDiffFolders, ThePageHasARowForEachFileThatIsNotTheSame) {
  put_motion("a/same.anim");
  put_motion("b/same.anim");
  put_motion("a/walk.anim");
  put_motion("b/walk.anim", 1e-2F);
  put_below("b/<b>&|.txt", "x");
  ASSERT_EQ(diff({"a", "b", "--summary", "page.html"}).exit_code, 1);
  const std::string html = get(path("page.html"));
  EXPECT_THAT(html, HasSubstr("<title>a against b</title>"));
  EXPECT_THAT(html, HasSubstr("<tr><td><a href=\"#file-1\"><code>walk.anim</code></a></td>"
                              "<td>differs</td><td>positions 10 mm (1000 x the tolerance) at joint "
                              "LeftHand, frame 3 (0.3 s)</td></tr>"));
  EXPECT_THAT(html, HasSubstr("<a href=\"a/walk.anim\">")) << "relative to the page";
  EXPECT_THAT(html, HasSubstr("<code>&lt;b&gt;&amp;&#124;.txt</code>"));
  EXPECT_THAT(html, Not(HasSubstr("same.anim")));
  const std::string named = get(path("page.html"));
  ASSERT_EQ(diff({"a", "b", "--summary", "page.md", "--summary", "again.html", "--summary", "step"})
                .exit_code,
            1);
  EXPECT_THAT(get(path("page.md")), HasSubstr("| <code>walk.anim</code> | differs | positions"));
  EXPECT_EQ(get(path("again.html")), named) << "as alone";
  EXPECT_EQ(get(path("step")), get(path("page.md"))) << "a name without ending is Markdown";
}

// Would fail if a CI server counted a file that differs as passed.
TEST_F(KrokDiffFolders, JUnitHasATestCaseForEachFile) {
  put_motion("a/same.anim");
  put_motion("b/same.anim");
  put_motion("a/walk.anim");
  put_motion("b/walk.anim", 1e-2F);
  put_below("b/<b>&.txt", "x");
  put_below("a/broken.anim", "x");
  put_below("b/broken.anim", "y");
  ASSERT_EQ(diff({"a", "b", "--keep-going", "--summary", "out.xml"}).exit_code, 3);
  const std::string xml = get(path("out.xml"));
  EXPECT_THAT(xml, HasSubstr("<testsuite name=\"a against b\" tests=\"4\" failures=\"2\" "
                             "errors=\"1\" skipped=\"0\">"));
  EXPECT_THAT(xml, testing::ContainsRegex("name=\"same.anim\" time=\"[0-9]+[.][0-9]+\"/>"));
  EXPECT_THAT(
      xml, testing::ContainsRegex("name=\"walk.anim\" time=\"[0-9.]+\"><failure message=\"differs: "
                                  "positions 10 mm .1000 x the tolerance."));
  EXPECT_THAT(xml, testing::ContainsRegex(
                       "name=\"broken.anim\" time=\"[0-9.]+\"><error message=\"cannot be read: "));
  EXPECT_THAT(
      xml,
      HasSubstr("name=\"&lt;b&gt;&amp;.txt\" time=\"0.000\"><failure message=\"only in b\"/>"));
  EXPECT_EQ(diff({"a", "b", "--summary", "out.pdf"}).exit_code, 2);
}

// A reference pose 1.2 m away, which no picture shows, was the only reason that a gate gave for a
// motion that was turned.
TEST_F(KrokDiffFolders, WhatShowsIsTheReasonBeforeTheReferencePose) {
  put_motion("a/walk.anim");
  put_motion("b/walk.anim", 0.1F, 1.2);
  ASSERT_EQ(diff({"a", "b", "--summary", "d.xml"}).exit_code, 1);
  EXPECT_THAT(get(path("d.xml")), HasSubstr("message=\"differs: positions 100 mm"));
  put_motion("b/walk.anim", 0, 1.2);
  ASSERT_EQ(diff({"a", "b", "--summary", "d.xml"}).exit_code, 1);
  EXPECT_THAT(get(path("d.xml")), HasSubstr("message=\"differs: reference positions 1200 mm"));
}

TEST_F(KrokDiffFolders, ThePageBeginsWithTheWorst) {
  const std::vector<std::pair<const char*, float>> files = {
      {"a_little.anim", 1e-3F}, {"b_most.anim", 1e-1F}, {"c_some.anim", 1e-2F}};
  for (const auto& [name, offset] : files) {
    put_motion("a/" + std::string(name));
    put_motion("b/" + std::string(name), offset);
  }
  put_below("a/z.txt", "x");
  put_below("b/z.anim", "no motion");
  put_below("a/z.anim", "no motion either");
  EXPECT_EQ(diff({"a", "b", "--keep-going", "--summary", "page.html"}).exit_code, 3);
  const std::string html = get(path("page.html"));
  std::size_t before = 0;
  for (const char* name : {"z.anim", "b_most.anim", "c_some.anim", "a_little.anim", "z.txt"}) {
    const std::size_t at = html.find("<code>" + std::string(name) + "</code>");
    ASSERT_NE(at, std::string::npos) << name;
    EXPECT_GT(at, before) << name;
    before = at;
  }
}

TEST_F(KrokDiffFolders, ReportsInTheFoldersAreNotCompared) {
  put_motion("a/walk.anim");
  put_motion("b/walk.anim");
  for (int run = 0; run < 2; ++run) {
    EXPECT_EQ(diff({"a", "b", "--json=b/report.json", "--summary", "b/page.html"}).exit_code, 0);
  }
}

TEST_F(KrokDiffFolders, WrongUseIsTrouble) {
  put_motion("a/walk.anim");
  put_motion("b/walk.anim");
  const std::vector<std::vector<std::string>> wrong = {
      {"a", "b/walk.anim"},
      {"a", "nowhere"},
      {"a/walk.anim", "b/walk.anim", "--update"},
      {"a/walk.anim", "b/walk.anim", "--include", "*"},
      {"a/walk.anim", "b/walk.anim", "--summary", "page.png"},
      {"a", "b", "--prune"},
      {"a", "b", "--summary", "page.png"},
      {"a", "b", "--sheet", "sheet.png"},
      {"a", "b", "--plot", "plot.svg"},
      {"a", "b", "--heatmap", "heat.glb"},
      {"nowhere", "neither", "--update"}};
  for (const auto& arguments : wrong) {
    const ToolRun run = diff(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments[0] << " " << arguments[1] << " " << arguments.back();
    EXPECT_THAT(run.err, HasSubstr("error: "));
  }
  EXPECT_THAT(listing(), ElementsAre("a", "b"));
}

}  // namespace
}  // namespace krok::test
