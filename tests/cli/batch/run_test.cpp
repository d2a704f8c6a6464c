// If these fail, a batch of thousands of captures must be watched: it does work again that is done,
// leaves out work that is not, ends at the first broken file, or says something else each time.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include "cli/batch/batch_fixture.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

class BatchRun : public BatchTest {
 protected:
  void put_captures(int count) const {
    for (int i = 0; i < count; ++i) put_capture("takes/" + number(i) + ".bvh", 3 + i % 7);
  }
  static std::string number(int i) {
    const std::string digits = std::to_string(i);
    return std::string(4 - digits.size(), '0') + digits;
  }
  // How many files stand in a folder now, while it changes.
  std::size_t entries(const std::string& name) const {
    std::error_code missing;
    std::size_t count = 0;
    for (std::filesystem::directory_iterator at(path(name), missing), end; at != end && !missing;
         at.increment(missing)) {
      ++count;
    }
    return count;
  }
  Counts imported_counts(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"takes", "--out-dir", "out", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return counts(import(arguments).out);
  }
};

TEST_F(BatchRun, AResultIsThatOfARunOfItsOwn) {
  put_captures(2);
  ASSERT_EQ(
      import({"takes", "--out-dir", "out", "--fps", "48", "--orientation", "xyzw", "--strict"})
          .exit_code,
      0);
  ASSERT_EQ(import({"takes/0001.bvh", "--fps", "48", "--orientation", "xyzw", "--strict", "-o",
                    "single.anim"})
                .exit_code,
            0);
  EXPECT_TRUE(get(path("single.anim")) == get(path("out/0001.anim")));
}

// Files of a batch are parsed for one after the other; an option must not stay for the next.
TEST_F(BatchRun, OptionsOfALineAreThoseOfItsFileAlone) {
  put_captures(1);
  const std::vector<Names> options = {{"--fps", "48"},
                                      {},
                                      {"--orientation", "xyzw", "--strict"},
                                      {"--unit", "cm", "--save-model", "NAME.model"}};
  std::string list;
  for (int i = 0; i < 12; ++i) {
    list += "takes/0000.bvh\t" + number(i) + ".anim\t";
    for (const std::string& word : options[static_cast<std::size_t>(i) % options.size()]) {
      list += (word == "NAME.model" ? "{name}.model" : word) + " ";
    }
    list += "\n";
  }
  put("list.tsv", list);
  for (const char* jobs : {"1", "3"}) {
    std::filesystem::remove_all(path("out"));
    ASSERT_EQ(import({"--manifest", "list.tsv", "--out-dir", "out", "-j", jobs}).exit_code, 0);
    EXPECT_EQ(files_below("out").size(), 15u);
    for (int i = 0; i < 12; ++i) {
      Names alone = {"takes/0000.bvh", "-o", "alone.anim"};
      for (std::string word : options[static_cast<std::size_t>(i) % options.size()]) {
        alone.push_back(word == "NAME.model" ? "alone.model" : word);
      }
      ASSERT_EQ(import(alone).exit_code, 0);
      EXPECT_TRUE(get(path("alone.anim")) == get(path("out/" + number(i) + ".anim"))) << i;
    }
  }
}

TEST_F(BatchRun, TheSameForAnyJobs) {
  put_captures(30);
  put_broken("takes/0011.bvh");
  put_broken("takes/0017.bvh");
  ToolRun runs[2];
  for (const int jobs : {1, 2}) {
    // The folder has the same name, for it stands in the report.
    std::filesystem::remove_all(path("out"));
    runs[jobs - 1] = import(
        {"takes", "--out-dir", "out", "--keep-going", "-v", "-j", std::to_string(jobs), "--json"});
    EXPECT_EQ(runs[jobs - 1].exit_code, 3);
    if (jobs == 1) std::filesystem::copy(path("out"), path("first"));
  }
  EXPECT_EQ(runs[0].out, runs[1].out);
  EXPECT_EQ(runs[0].err, runs[1].err);
  EXPECT_TRUE(contents("first") == contents("out"));
  // Stopped at the first failure, both say the same too.
  for (const int jobs : {1, 2}) {
    std::filesystem::remove_all(path("out"));
    runs[jobs - 1] = import({"takes", "--out-dir", "out", "-j", std::to_string(jobs), "--json"});
    EXPECT_EQ(runs[jobs - 1].exit_code, 2);
  }
  EXPECT_EQ(runs[0].out, runs[1].out);
  EXPECT_EQ(runs[0].err, runs[1].err);
  EXPECT_EQ(counts(runs[0].out), (Counts{{"done", 11}, {"failed", 1}}));
  EXPECT_THAT(runs[0].err,
              HasSubstr("stopped at takes/0011.bvh, the first file that failed; 18 left"));
  EXPECT_TRUE(has_code(runs[0].err, "batch-stopped"));
  EXPECT_THAT(runs[0].err, Not(HasSubstr("0017")));
}

TEST_F(BatchRun, ABrokenFileAmongFiveHundredIsNamedAndTheOthersAreDone) {
  put_captures(500);
  put_broken("takes/0250.bvh");
  const ToolRun run = import({"takes", "--out-dir", "out", "--keep-going", "--json=report.json"});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_THAT(run.err, HasSubstr("takes/0250.bvh:25:5: error: "));
  EXPECT_THAT(run.err, HasSubstr("1 file failed: takes/0250.bvh [batch-failed]"));
  EXPECT_THAT(run.err, HasSubstr("500 files, 499 done, 1 failed"));
  EXPECT_EQ(files_below("out").size(), 499u);
  const Json report = Json::parse(get(path("report.json")));
  EXPECT_EQ(report["schema"], "krok.batch/1");
  ASSERT_EQ(report["files"].size(), 500u);
  EXPECT_EQ(report["files"][250]["status"], "failed");
  EXPECT_EQ(report["files"][250]["issues"][0]["line"], 25);
  EXPECT_EQ(report["files"][251]["input"], "takes/0251.bvh");
  EXPECT_EQ(report["result"]["failed"], 1);
  // Mended, it alone is done.
  put_capture("takes/0250.bvh");
  EXPECT_EQ(imported_counts(), (Counts{{"done", 1}, {"unchanged", 499}}));
}

TEST_F(BatchRun, WhatStandsIsLeftUnlessAnythingChanged) {
  put_captures(4);
  const std::string kept = path("out/0000.anim");
  ASSERT_EQ(imported_counts(), (Counts{{"done", 4}}));
  const auto bytes = contents("out");
  const auto time = std::filesystem::last_write_time(kept);
  EXPECT_EQ(imported_counts(), (Counts{{"unchanged", 4}}));
  EXPECT_EQ(std::filesystem::last_write_time(kept), time);
  EXPECT_TRUE(contents("out") == bytes);

  put_capture("takes/0001.bvh", 50);
  EXPECT_EQ(imported_counts(), (Counts{{"done", 1}, {"unchanged", 3}})) << "another input";
  std::filesystem::remove(path("out/0002.anim"));
  EXPECT_EQ(imported_counts(), (Counts{{"done", 1}, {"unchanged", 3}})) << "an output deleted";
  // One byte changed, the size and the time of change are as before.
  const std::string damaged = path("out/0003.anim");
  const auto when = std::filesystem::last_write_time(damaged);
  std::string text = get(damaged);
  text[text.size() / 2] = static_cast<char>(text[text.size() / 2] ^ 1);
  put("out/0003.anim", text);
  std::filesystem::last_write_time(damaged, when);
  EXPECT_EQ(imported_counts(), (Counts{{"done", 1}, {"unchanged", 3}})) << "an output damaged";
  EXPECT_TRUE(get(damaged) == bytes.at("0003.anim"));
  EXPECT_EQ(imported_counts({"--fps", "30"}), (Counts{{"done", 4}})) << "another option";
  EXPECT_EQ(imported_counts({"--fps", "30"}), (Counts{{"unchanged", 4}}));
  EXPECT_EQ(imported_counts({"--fps", "30", "--force"}), (Counts{{"done", 4}}));
  EXPECT_EQ(imported_counts({"--fps", "30", "--save-model", "{name}.model"}),
            (Counts{{"done", 4}}));
}

// The keytimes beside a motion are drawn into its charts; a map says what its joints are.
TEST_F(BatchRun, OtherFilesThatComeChangeOrGoAreNoticed) {
  put_captures(2);
  put("map.json", R"({"schema": "krok.role-map/1", "joints": {}})");
  const auto plots = [&](const Names& options = {}) {
    Names arguments = {"takes", "--show", "path", "--out-dir", "plots", "--json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ToolRun run = tool("krok-plot", arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return counts(run.out);
  };
  EXPECT_EQ(plots(), (Counts{{"done", 2}}));
  EXPECT_EQ(plots(), (Counts{{"unchanged", 2}}));
  const std::string keys =
      R"({"schema": "krok.keys/1", "keytimes": [{"name": "left_strike", "time": 0.01}]})";
  put("takes/0001.keys.json", keys);
  EXPECT_EQ(plots(), (Counts{{"done", 1}, {"unchanged", 1}})) << "come";
  EXPECT_EQ(plots(), (Counts{{"unchanged", 2}}));
  put("takes/0001.keys.json", keys + "\n");
  EXPECT_EQ(plots(), (Counts{{"done", 1}, {"unchanged", 1}})) << "changed";
  std::filesystem::remove(path("takes/0001.keys.json"));
  EXPECT_EQ(plots(), (Counts{{"done", 1}, {"unchanged", 1}})) << "gone";
  EXPECT_EQ(plots({"--map", "map.json"}), (Counts{{"done", 2}}));
  EXPECT_EQ(plots({"--map", "map.json"}), (Counts{{"unchanged", 2}}));
  put("map.json", R"({"schema": "krok.role-map/1", "joints": { }})");
  EXPECT_EQ(plots({"--map", "map.json"}), (Counts{{"done", 2}})) << "another map";
}

// The name of the source stands in a result, so one of another name is another input.
TEST_F(BatchRun, AnotherInputOfTheSameContentIsDone) {
  put_capture("a.bvh");
  put_capture("b.bvh");
  put("list.tsv", "a.bvh\tx.anim\n");
  EXPECT_EQ(counts(import({"--manifest", "list.tsv", "--json"}).out), (Counts{{"done", 1}}));
  EXPECT_EQ(counts(import({"--manifest", "list.tsv", "--json"}).out), (Counts{{"unchanged", 1}}));
  put("list.tsv", "b.bvh\tx.anim\n");
  EXPECT_EQ(counts(import({"--manifest", "list.tsv", "--json"}).out), (Counts{{"done", 1}}));
}

TEST_F(BatchRun, AReportOfARunThatWentOnTellsAll) {
  put_captures(4);
  const Json whole = Json::parse(import({"takes", "--out-dir", "out", "--json"}).out);
  std::filesystem::remove(path("out/0002.anim"));
  const Json rest = Json::parse(import({"takes", "--out-dir", "out", "--json"}).out);
  EXPECT_EQ(rest["files"][0]["status"], "unchanged");
  for (const char* key : {"input", "output", "options", "inputs", "outputs", "issues", "result"}) {
    EXPECT_EQ(rest["files"][0][key], whole["files"][0][key]) << key;
  }
  EXPECT_EQ(rest["files"][2], whole["files"][2]);
}

TEST_F(BatchRun, AJournalThatIsDamagedOrLostCostsOnlyTime) {
  put_captures(6);
  ASSERT_EQ(imported_counts(), (Counts{{"done", 6}}));
  const std::string journal = "out/krok-import.journal.jsonl";
  const std::string whole = get(path(journal));
  const auto bytes = contents("out");
  put(journal, whole.substr(0, whole.size() - 10));  // as a killed run leaves it
  EXPECT_EQ(imported_counts(), (Counts{{"done", 1}, {"unchanged", 5}}));
  EXPECT_TRUE(contents("out") == bytes) << "the journal too";
  put(journal, "{\"output\": 3}\nnonsense\n[]\n{\"output\": \"0001.anim\"}\n" + whole);
  EXPECT_EQ(imported_counts(), (Counts{{"unchanged", 6}}));
  std::string lying = whole;
  for (std::size_t at = 0; (at = lying.find("\"path\":\"0", at)) != std::string::npos;) {
    lying[at + 8] = '9';
  }
  put(journal, lying);
  EXPECT_EQ(imported_counts(), (Counts{{"done", 6}}));
  std::filesystem::remove(path(journal));
  EXPECT_EQ(imported_counts(), (Counts{{"done", 6}}));
  EXPECT_TRUE(contents("out") == bytes);
}

// Killed at several moments; what it left is found, nothing is half-written, and the next run
// finishes the rest.
TEST_F(BatchRun, KilledInTheMiddleAndRunAgainItFinishesTheRest) {
  for (int i = 0; i < 60; ++i) put_capture("takes/" + number(i) + ".bvh", 2000);
  ASSERT_EQ(import({"takes", "--out-dir", "whole"}).exit_code, 0);
  std::size_t before = 0;
  for (const std::size_t moment : {5u, 20u, 40u}) {
    ToolOptions options;
    options.meanwhile = [&](pid_t child) {
      // Temporary files are seen too: with luck one is being written.
      if (entries("out") < moment) return false;
      kill(child, SIGKILL);
      return true;
    };
    const ToolRun run = import({"takes", "--out-dir", "out", "-j", "2"}, options);
    ASSERT_TRUE(run.signal == SIGKILL || run.exit_code == 0);
    std::size_t results = 0;
    for (const std::string& name : files_below("out")) {
      if (name.find(".krok-") == 0) continue;
      ++results;
      EXPECT_TRUE(get(path("out/" + name)) == get(path("whole/" + name))) << name;
    }
    EXPECT_GE(results, before);
    before = results;
  }
  put("out/.krok-another-machine-1-0", "not ours");
  const ToolRun last = import({"takes", "--out-dir", "out", "--json"});
  EXPECT_EQ(last.exit_code, 0) << last.err;
  const Counts result = counts(last.out);
  EXPECT_EQ(result.at("unchanged") + (result.count("done") != 0 ? result.at("done") : 0), 60);
  EXPECT_GE(static_cast<std::size_t>(result.at("unchanged")), before - 2) << "one a thread is lost";
  std::filesystem::remove(path("out/.krok-another-machine-1-0"));
  EXPECT_TRUE(contents("out") == contents("whole")) << "no temporary file is left";
}

TEST_F(BatchRun, ASignalLeavesNothingHalfWritten) {
  for (int i = 0; i < 60; ++i) put_capture("takes/" + number(i) + ".bvh", 2000);
  ToolOptions options;
  options.meanwhile = [&](pid_t child) {
    if (entries("out") < 10) return false;
    kill(child, SIGTERM);
    return true;
  };
  const ToolRun run = import({"takes", "--out-dir", "out", "-j", "2"}, options);
  EXPECT_TRUE(run.signal == SIGTERM || run.exit_code == 0) << run.exit_code;
  for (const std::string& name : files_below("out"))
    EXPECT_EQ(name.find(".krok-"), std::string::npos);
}

// As an archive from another system has them. JSON, in which a batch keeps what it has done, is
// UTF-8.
TEST_F(BatchRun, NamesThatAreNotUtf8AreUpToDateToo) {
  put_capture("takes/walk\xE9.bvh");
  put_capture("takes/\xFF\xFE/walk.bvh", 7);
  put_capture("takes/walk\xC3\xA9.bvh", 9);
  EXPECT_EQ(imported_counts(), (Counts{{"done", 3}}));
  const auto bytes = contents("out");
  EXPECT_EQ(imported_counts(), (Counts{{"unchanged", 3}}));
  put_capture("takes/walk\xE9.bvh", 6);
  EXPECT_EQ(imported_counts(), (Counts{{"done", 1}, {"unchanged", 2}}));
  std::filesystem::remove(path("out/\xFF\xFE/walk.anim"));
  EXPECT_EQ(imported_counts(), (Counts{{"done", 1}, {"unchanged", 2}}));
  EXPECT_EQ(contents("out").size(), bytes.size());
}

// A terminal shows what is wrong with the first few, and how many more there are.
TEST_F(BatchRun, ManyFilesThatFailTakeFewLines) {
  for (int i = 0; i < 60; ++i) put_broken("takes/" + number(i) + ".bvh");
  const ToolRun run = import({"takes", "--out-dir", "out", "--keep-going"});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_LT(std::ranges::count(run.err, '\n'), 15) << run.err;
  EXPECT_THAT(run.err, HasSubstr("57 more files have such messages"));
  EXPECT_THAT(run.err, HasSubstr("60 files failed"));
  const ToolRun all = import({"takes", "--out-dir", "out", "--keep-going", "-v"});
  EXPECT_GE(std::ranges::count(all.err, '\n'), 60);
}

TEST_F(BatchRun, NoClobberIsForWhatIsNotOfThisBatch) {
  put_captures(2);
  std::filesystem::create_directory(path("out"));
  put("out/0001.anim", "mine");
  EXPECT_EQ(imported_counts({"--no-clobber", "--keep-going"}),
            (Counts{{"done", 1}, {"failed", 1}}));
  EXPECT_EQ(get(path("out/0001.anim")), "mine");
  EXPECT_EQ(imported_counts({"--no-clobber", "--keep-going"}),
            (Counts{{"failed", 1}, {"unchanged", 1}}));
}

TEST_F(BatchRun, AFailureLeavesTheOldResult) {
  put_captures(1);
  ASSERT_EQ(imported_counts(), (Counts{{"done", 1}}));
  const std::string old = get(path("out/0000.anim"));
  put_broken("takes/0000.bvh");
  EXPECT_EQ(imported_counts(), (Counts{{"failed", 1}}));
  EXPECT_TRUE(get(path("out/0000.anim")) == old);
}

TEST_F(BatchRun, OneProgressForTheBatchAndNoTalk) {
  put_captures(20);
  const ToolRun plain = import({"takes", "--out-dir", "out", "--progress=plain"});
  EXPECT_THAT(plain.err, HasSubstr("krok-import: 0/20 (0 %)\n"));
  EXPECT_THAT(plain.err, HasSubstr("krok-import: 20/20 (100 %)\n"));
  EXPECT_THAT(plain.err, Not(HasSubstr("reading")));
  const ToolRun quiet = import({"takes", "--out-dir", "out", "-q", "--force"});
  EXPECT_EQ(quiet.out + quiet.err, "");
}

// The peak of memory, in KiB, of the tool that is run by `run`.
class Memory : public BatchRun {
 protected:
  long peak(const std::string& folder) {
    const pid_t child = fork();
    if (child == 0) {
      const ToolRun run = import(
          {folder, "--out-dir", "out_" + folder, "-j", "2", "-q", "--json=" + folder + ".json"});
      struct rusage usage {};
      getrusage(RUSAGE_CHILDREN, &usage);
      put(folder + ".peak", std::to_string(usage.ru_maxrss));
      _exit(run.exit_code);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
    return std::stol(get(path(folder + ".peak")));
  }
};

TEST_F(Memory, DoesNotGrowWithTheNumberOfFiles) {
  if (sanitized()) GTEST_SKIP() << "skipped: sanitizers keep memory for themselves";
  for (int i = 0; i < 400; ++i) {
    put_capture("many/" + number(i) + ".bvh", 500);
    if (i < 40) put_capture("few/" + number(i) + ".bvh", 500);
  }
  const long few = peak("few"), many = peak("many");
  EXPECT_LT(static_cast<double>(many), 1.15 * static_cast<double>(few) + 1024);
}

}  // namespace
}  // namespace krok::test
