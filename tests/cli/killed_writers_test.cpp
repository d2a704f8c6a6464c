// If this fails, a run that is killed (out of memory, a scheduler's limit) leaves files behind that
// no one writes any more, until a disk is full of them, or half of a result under its name.
#include <cstdlib>
#include <random>

#include "cli/fixture.h"
#include "core/temporary_files_internal.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

class KilledWriters : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    fs::create_directories(path("in"));
    put("in/walk.bvh", get(test::source_folder() + "/samples/captures/walk.bvh"));
    for (int i = 0; i < 8; ++i) put("in/" + std::to_string(i) + ".bvh", capture(300));
    for (const auto& command : std::vector<std::vector<std::string>>{
             {"krok-import", "in/walk.bvh", "-o", "in/walk.anim"},
             {"krok-body", "in/walk.anim", "--detail", "low", "-o", "in/walk.model"}}) {
      const ToolRun made = run_here(command[0], {command.begin() + 1, command.end()});
      ASSERT_EQ(made.exit_code, 0) << made.err;
    }
  }

  using Files = std::map<std::string, std::string>;  // content by path

  Files files() const {
    Files found;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      const std::string name = fs::relative(entry.path(), folder_).string();
      // A batch's record of what it has done grows as it goes.
      const bool is_record = name.find(".journal.jsonl") != std::string::npos;
      if (entry.is_regular_file() && !is_record) found[name] = get(entry.path().string());
    }
    return found;
  }
};

// The environment variable KROK_KILLS has the number of kills, of all writers together.
TEST_F(KilledWriters, LeaveNothingAfterTheNextRun) {
  const std::vector<std::vector<std::string>> writers = {
      {"krok-import", "in/walk.bvh", "-o", "out/walk.anim", "--json=out/walk.json"},
      {"krok-import", "in", "--out-dir", "out", "-j", "2", "--force"},
      {"krok-export", "in/walk.anim", "-o", "out/walk.bvh"},
      {"krok-export", "in/walk.anim", "-o", "out/walk.csv"},
      {"krok-keys", "in/walk.anim", "-o", "out/walk.keys.json", "--plot", "out/walk.svg"},
      {"krok-edit", "in/walk.anim", "--filter", "butterworth", "-o", "out/filtered.anim"},
      {"krok-skin", "in/walk.model", "in/walk.anim", "--as", "frames", "-o", "out/frame.glb"},
      {"krok-skin", "in/walk.model", "in/walk.anim", "-o", "out/walk.glb"},
      {"krok-view", "in/walk.anim", "--body", "none", "-o", "out/walk.html"},
      {"krok-plot", "in/walk.anim", "--joint", "Hips", "-o", "out/plot.svg"}};
  fs::create_directories(path("out"));
  std::vector<double> seconds;
  for (const auto& writer : writers) {
    const auto before = std::chrono::steady_clock::now();
    const ToolRun made = run_here(writer[0], {writer.begin() + 1, writer.end()});
    ASSERT_EQ(made.exit_code, 0) << writer[0] << ": " << made.err;
    seconds.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count());
  }
  const Files whole = files();
  const char* wanted = std::getenv("KROK_KILLS");
  const int kills = wanted != nullptr ? std::atoi(wanted) : 30;
  std::mt19937 random(44);
  int killed = 0;
  for (int i = 0; i < kills; ++i) {
    const std::size_t w = static_cast<std::size_t>(i) % writers.size();
    // Half of the runs replace the files of the one before.
    if (i / writers.size() % 2 == 0) {
      fs::remove_all(path("out"));
      fs::create_directories(path("out"));
    }
    const double moment = std::uniform_real_distribution(0.1, 0.8)(random) * seconds[w];
    const auto start = std::chrono::steady_clock::now();
    ToolOptions options;
    options.folder = folder_.string();
    options.meanwhile = [&](pid_t child) {
      if (std::chrono::steady_clock::now() - start < std::chrono::duration<double>(moment)) {
        return false;
      }
      kill(child, SIGKILL);
      return true;
    };
    const ToolRun run =
        run_tool(writers[w][0], {writers[w].begin() + 1, writers[w].end()}, options);
    killed += run.signal == SIGKILL ? 1 : 0;
    for (const auto& [name, content] : files()) {
      const std::string file = fs::path(name).filename();
      if (file.starts_with(".krok-")) continue;
      ASSERT_TRUE(whole.contains(name) && whole.at(name) == content)
          << name << " after " << writers[w][0] << " was killed";
    }
  }
  EXPECT_GT(killed, kills / 8) << "most ended before";
  // One that a process of long ago left, for a file system without unnamed files.
  const pid_t child = fork();
  if (child == 0) {
    (void)create_temporary(path("out"));
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  const ToolRun last = run_here("krok-export", {"in/walk.anim", "-o", "out/walk.csv"});
  ASSERT_EQ(last.exit_code, 0) << last.err;
  for (const auto& [name, content] : files()) {
    EXPECT_EQ(name.find(".krok-"), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace krok::test
