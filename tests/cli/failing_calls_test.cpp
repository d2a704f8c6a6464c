// If these fail, a full disk, a drive that goes away or a machine out of descriptors ends in a
// crash, a success that is none, half a file, an old file gone, or temporary files left behind.

#include "cli/fixture.h"
#include "support/sanitized.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

class FailingCalls : public CliTest {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "a sanitizer's runtime must be the first library";
    CliTest::SetUp();
    fs::create_directories(path("in"));
    put("in/walk.bvh", get(std::string(KROK_SOURCE_DIR) + "/samples/captures/walk.bvh"));
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
      if (entry.is_regular_file()) {
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
    for (const auto& [name, content] : files()) {
      if (!before.contains(name)) fs::remove(path(name));
    }
    for (const auto& [name, content] : before) put(name, content);
  }

  // Runs the command again and again, with each of its calls failing in turn. `outputs` are files
  // that it replaces; a report may say what went wrong, or be what could not be written.
  void each_call_fails(const std::vector<std::string>& command,
                       const std::vector<std::string>& outputs, bool reports = false) {
    for (const std::string& output : outputs) put(output, "old\n");
    const Files before = files();
    made(command);
    const Files wanted = files();
    int refused = 0;
    for (const char* call : {"open", "write", "rename", "sync", "mmap"}) {
      for (int at = 1; at < 500; ++at) {
        restore(before);
        SCOPED_TRACE(command[0] + ": call " + call + " number " + std::to_string(at));
        std::vector<std::string> arguments = {"/usr/bin/env",
                                              std::string("LD_PRELOAD=") + KROK_FAILING_CALLS,
                                              std::string("KROK_FAIL_CALL=") + call,
                                              "KROK_FAIL_AT=" + std::to_string(at),
                                              "KROK_FAIL_MARK=" + path("mark"),
                                              std::string(KROK_BIN_DIR) + "/" + command[0]};
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
        EXPECT_EQ(done.exit_code, 2) << done.err;
        EXPECT_THAT(done.err, HasSubstr("error: "));
        std::string changed = changes(before, files());
        if (reports && changed == "report.json is new; ") changed.clear();
        if (reports && done.err.find("report.json: error: ") != std::string::npos) {
          changed = changes(wanted, files());
          if (changed == "report.json is gone; ") changed.clear();
        }
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
                  {"out.glb"}, true);
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

TEST_F(FailingCalls, Plot) {
  each_call_fails({"krok-plot", "in/walk.anim", "--joint", "LeftFoot", "-o", "out.svg", "--sheet",
                   "out.png", "--body", "none", "-j", "1"},
                  {"out.svg", "out.png"});
}

}  // namespace
}  // namespace krok::test
