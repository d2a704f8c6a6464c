// If these fail, a full disk, a drive that goes away or a machine out of descriptors ends in a
// crash, a success that is none, half a file, an old file gone, or temporary files left behind.

#include "cli/fixture.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

class FailingCalls : public CliTest {
 protected:
  void SetUp() override {
    if (sanitized()) GTEST_SKIP() << "a sanitizer's runtime must be the first library";
    CliTest::SetUp();
    fs::create_directories(path("in"));
    put("in/walk.bvh", get(test::source_folder() + "/samples/captures/walk.bvh"));
    made({"krok-import", "in/walk.bvh", "-o", "in/walk.anim"});
    made({"krok-body", "in/walk.anim", "--detail", "low", "-o", "in/walk.model"});
  }

  using Files = std::map<std::string, std::string>;  // content by path

  // What differs, without the contents.
  static std::string changes(const Files& before, const Files& after) {
    std::string text;
    for (const auto& [name, content] : after) {
      const auto was = before.find(name);
      if (was == before.end()) text += name + " is new; ";
      if (was != before.end() && was->second != content) text += name + " has changed; ";
    }
    for (const auto& [name, content] : before) {
      if (!after.contains(name)) text += name + " is gone; ";
    }
    return text;
  }

  Files files() const {
    Files found;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      // What a batch writes of its progress depends on what failed.
      if (entry.is_regular_file() && !entry.path().string().ends_with(".journal.jsonl")) {
        found[fs::relative(entry.path(), folder_).string()] = get(entry.path().string());
      }
    }
    return found;
  }

  void made(const std::vector<std::string>& command) {
    const ToolRun done = run_here(command[0], {command.begin() + 1, command.end()});
    ASSERT_EQ(done.exit_code, 0) << done.err;
  }

  // Puts the folder back to these files.
  void restore(const Files& before) {
    std::vector<fs::path> found;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      if (entry.is_regular_file()) found.push_back(entry.path());
    }
    for (const fs::path& file : found) {
      if (!before.contains(fs::relative(file, folder_).string())) fs::remove(file);
    }
    for (const auto& [name, content] : before) put(name, content);
  }

  // Whether each file is as it was or as it is to be, and there is no other.
  static std::string neither(const Files& before, const Files& wanted, const Files& after) {
    std::string text;
    for (const auto& [name, content] : after) {
      const auto was = before.find(name), is = wanted.find(name);
      const bool known = (was != before.end() && was->second == content) ||
                         (is != wanted.end() && is->second == content);
      if (!known) text += name + " is neither; ";
    }
    for (const auto& [name, content] : before) {
      if (!after.contains(name)) text += name + " is gone; ";
    }
    return text;
  }

  // How a command ends whose call fails.
  enum class Ends : unsigned char {
    plainly,
    with_report,  // which may say what went wrong
    in_part,      // one of many files, the others are written
  };

  // Runs the command again and again, with each of its calls failing in turn. `outputs` are files
  // that it replaces.
  void each_call_fails(const std::vector<std::string>& command,
                       const std::vector<std::string>& outputs, Ends ends = Ends::plainly) {
    for (const std::string& output : outputs) put(output, "old\n");
    const Files before = files();
    made(command);
    const Files wanted = files();
    int refused = 0;
    const bool reports = ends == Ends::with_report;
    for (const char* call : {"open", "read", "write", "rename", "sync", "mmap", "close"}) {
      for (int at = 1; at < 500; ++at) {
        restore(before);
        SCOPED_TRACE(command[0] + ": call " + call + " number " + std::to_string(at));
        std::vector<std::string> arguments = {"/usr/bin/env",
                                              std::string("LD_PRELOAD=") + test::failing_calls(),
                                              std::string("KROK_FAIL_CALL=") + call,
                                              "KROK_FAIL_AT=" + std::to_string(at),
                                              "KROK_FAIL_MARK=" + path("mark"),
                                              test::tools_folder() + "/" + command[0]};
        arguments.insert(arguments.end(), command.begin() + 1, command.end());
        ToolOptions options;
        options.folder = folder_.string();
        const ToolRun done = run(arguments, options);
        const bool failed = fs::remove(path("mark"));
        if (!failed) {
          ASSERT_EQ(done.exit_code, 0) << done.err;
          break;
        }
        ASSERT_EQ(done.signal, 0) << done.err;
        if (done.exit_code == 0) {
          // There was another way, such as reading what cannot be mapped.
          EXPECT_EQ(changes(wanted, files()), "") << done.err;
          continue;
        }
        ++refused;
        EXPECT_THAT(done.err, HasSubstr("error: "));
        if (ends == Ends::in_part) {
          EXPECT_THAT(done.exit_code, testing::AnyOf(2, 3)) << done.err;
          EXPECT_EQ(neither(before, wanted, files()), "") << done.err;
          // The next run writes what is missing.
          made(command);
          EXPECT_EQ(changes(wanted, files()), "");
          continue;
        }
        EXPECT_EQ(done.exit_code, 2) << done.err;
        std::string changed = changes(before, files());
        if (reports && changed == "report.json is new; ") changed.clear();
        EXPECT_EQ(changed, "") << done.err;
      }
    }
    RecordProperty("refused_calls", refused);
    EXPECT_GE(refused, 4) << "the library that lets calls fail is not loaded";
  }
};

TEST_F(FailingCalls, Import) {
  each_call_fails({"krok-import", "in/walk.bvh", "-o", "out.anim", "-j", "1"}, {"out.anim"});
}

TEST_F(FailingCalls, Edit) {
  each_call_fails({"krok-edit", "in/walk.anim", "--mirror", "-o", "out.anim", "-j", "1"},
                  {"out.anim"});
}

TEST_F(FailingCalls, ExportWithAReport) {
  each_call_fails({"krok-export", "in/walk.anim", "-o", "out.glb", "--json=report.json", "-j", "1"},
                  {"out.glb"}, Ends::with_report);
}

TEST_F(FailingCalls, Skin) {
  each_call_fails({"krok-skin", "in/walk.model", "in/walk.anim", "-o", "out.glb", "-j", "1"},
                  {"out.glb"});
}

TEST_F(FailingCalls, Keys) {
  made({"krok-keys", "in/walk.anim", "-o", "in/walk.keys.json"});
  each_call_fails({"krok-keys", "in/walk.anim", "--find", "none", "--add-contact",
                   "LeftFoot=0.1s..0.5s", "--plot", "out.svg", "-o", "in/walk.keys.json"},
                  {"out.svg"});
}

TEST_F(FailingCalls, View) {
  each_call_fails({"krok-view", "in/walk.anim", "--body", "none", "-o", "out.html", "-j", "1"},
                  {"out.html"});
}

TEST_F(FailingCalls, Fit) {
  for (const char* length : {"50", "60", "70"}) {
    const ToolRun walk =
        run({test::make_walk(), "--steps", "3", "--step-length", std::string(length) + "cm", "-q",
             "-o", path("in/" + std::string(length) + ".bvh")});
    ASSERT_EQ(walk.exit_code, 0) << walk.err;
  }
  put("in/library.json",
      R"({"schema": "krok.library/1", "steps": "auto", "parameters": [{"measures": "step.length"}],
          "examples": [{"clip": "50.bvh"}, {"clip": "60.bvh"}, {"clip": "70.bvh"}]})");
  each_call_fails({"krok-fit", "in/library.json", "--refine", "0", "-o", "out.steps", "-j", "1"},
                  {"out.steps"});
}

// Many files in one run: those that did not fail are whole, the others as they were.
TEST_F(FailingCalls, Batch) {
  fs::create_directories(path("many"));
  for (const char* name : {"many/a.bvh", "many/b.bvh"}) put(name, capture(3));
  each_call_fails({"krok-import", "many", "--out-dir", "out", "--keep-going", "-j", "1"}, {},
                  Ends::in_part);
}

TEST_F(FailingCalls, Plot) {
  each_call_fails({"krok-plot", "in/walk.anim", "--joint", "LeftFoot", "-o", "out.svg", "--sheet",
                   "out.png", "--body", "none", "-j", "1"},
                  {"out.svg", "out.png"});
}

}  // namespace
}  // namespace krok::test
