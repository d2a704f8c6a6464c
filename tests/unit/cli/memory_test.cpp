// If these fail, a tool that runs out of memory where that cannot be caught ends by a signal,
// without a word of why, or leaves half a file behind.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <new>

#include "core/file.h"
#include "support/folder_test.h"
#include "tools/cli/tool.h"

namespace krok::cli {
namespace {

class MemoryTest : public test::FolderTest {
 protected:
  // Runs a tool in a child whose messages go to "messages"; gives what waitpid() tells.
  int run(const std::function<void()>& work) const {
    const pid_t child = fork();
    if (child == 0) {
      const int messages = open(path("messages").c_str(), O_WRONLY | O_CREAT, 0600);
      dup2(messages, STDERR_FILENO);
      ToolSpec spec;
      spec.name = "krok-test";
      spec.has_output = false;
      spec.declare = [](CommandOptions&) {};
      spec.run = [&](ToolContext&) -> Result<int> {
        auto file = OutputFile::create(path("out"));
        if (!file || !file->write("half")) return kExitNo;
        work();
        return kExitDone;
      };
      std::string name = "/a/folder/krok-test";
      char* arguments[] = {name.data(), nullptr};
      _exit(run_tool([&spec] { return spec; }, 1, arguments));
    }
    int status = 0;
    waitpid(child, &status, 0);
    return status;
  }
};

using Names = std::vector<std::string>;
const std::string kMessage = "krok-test: error: out of memory [out-of-memory]\n";

[[noreturn]] void run_out() {
  throw std::bad_alloc();
}

TEST_F(MemoryTest, WhereItCanBeCaughtItIsAnError) {
  put("out", "old");
  const int status = run([] { run_out(); });
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == kExitTrouble) << status;
  EXPECT_EQ(get(path("messages")), kMessage);
  EXPECT_EQ(listing(), (Names{"messages", "out"}));
}

TEST_F(MemoryTest, WhereItCannotBeCaughtTooAndNothingIsLeft) {
  put("out", "old");
  const int status =
      run([] { [](const std::function<void()>& work) noexcept { work(); }(run_out); });
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == kExitTrouble) << status;
  EXPECT_EQ(get(path("messages")), kMessage);
  EXPECT_EQ(listing(), (Names{"messages", "out"}));
  EXPECT_EQ(get(path("out")), "old");
}

TEST_F(MemoryTest, ABugStillEndsBySignal) {
  put("out", "old");
  const int status =
      run([] { [](const std::function<void()>& work) noexcept { work(); }([] { throw 7; }); });
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT) << status;
  EXPECT_EQ(listing(), (Names{"messages", "out"}));
}

}  // namespace
}  // namespace krok::cli
