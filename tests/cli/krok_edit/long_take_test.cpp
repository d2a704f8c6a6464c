// If these fail, the memory of a tool grows with the length of the motion.

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/motion_fixture.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

class LongTake : public MotionTest {
 protected:
  // The peak of memory, in MiB, of a tool with the input `name`.
  double peak(const std::string& tool, const std::string& name, std::vector<std::string> options) {
    const pid_t child = fork();
    if (child == 0) {
      const struct rlimit limit = {data_, data_};
      if (data_ > 0) setrlimit(RLIMIT_DATA, &limit);
      options.insert(options.begin(), name);
      options.insert(options.end(), {"-j", "2", "-q", "--json=report.json"});
      const ToolRun run = run_here(tool, options);
      struct rusage usage {};
      getrusage(RUSAGE_CHILDREN, &usage);
      put("peak", std::to_string(usage.ru_maxrss));
      _exit(run.exit_code);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0) << tool;
    return std::stod(get(path("peak"))) / 1024;
  }

  rlim_t data_ = 0;  // bytes of memory beyond mapped files that a tool may have; 0: any
};

// 700,000 frames are 75 MiB in memory. A capture's pages are released as it is read.
TEST_F(LongTake, MemoryDoesNotGrowWithTheFrames) {
  if (sanitized()) GTEST_SKIP() << "skipped: sanitizers keep memory for themselves";
  put("long.bvh", capture(700000));
  put("short.bvh", capture(20000));
  struct Row {
    std::string tool;
    std::vector<std::string> options;
    int frames = 700000;  // of the result
  };
  const std::vector<Row> rows = {
      {"krok-export", {"-o", "out.bvh"}},
      {"krok-export", {"-o", "out.csv"}},
      {"krok-edit", {"--from", "10f", "--to", "19000f", "-o", "out.anim"}, 18991},
      {"krok-edit", {"--playback-speed", "0.8", "-o", "out.anim"}, 874999},
      {"krok-edit", {"--in-place", "-o", "out.anim"}},
      {"krok-edit",
       {"--mirror", "--scale", "2", "--turn", "90deg", "--on-ground", "-o", "out.anim"}},
      {"krok-edit", {"--filter", "butterworth", "-o", "out.anim"}},
      {"krok-edit", {"--spikes", "-o", "out.anim"}},
      {"krok-edit", {"--filter", "auto", "-o", "out.anim"}},
      {"krok-ik", {"--reach", "Head=0.5m,1.5m,0m@10s..20s", "-o", "out.anim"}},
      {"krok-retarget", {"--onto", "short.bvh", "--scale", "2", "-o", "out.anim"}, 0}};
  for (const auto& [tool, options, frames] : rows) {
    const double few = peak(tool, "short.bvh", options), many = peak(tool, "long.bvh", options);
    EXPECT_LT(many, few + 32) << tool << " " << options[0];
    if (frames > 0) {
      EXPECT_EQ(json::parse(get(path("report.json")))["result"]["frames"], frames) << options[0];
    }
  }
}

// Would fail if a take of 64 MiB were held whole.
TEST_F(LongTake, LargeFilesAreReadInParts) {
  if (sanitized()) GTEST_SKIP() << "skipped: sanitizers keep memory for themselves";
  put("long.bvh", capture(700000));
  ASSERT_EQ(run_here("krok-import", {"long.bvh", "-o", "long.anim"}).exit_code, 0);
  data_ = 72 << 20;
  peak("krok-export", "long.anim", {"-o", "out.npz"});
  peak("krok-lint", "long.anim", {"--only", "frozen"});
}

// Would fail if feet were planted in all frames at once, or nothing of it were reported.
TEST_F(LongTake, FeetArePlantedInParts) {
  if (sanitized()) GTEST_SKIP() << "skipped: sanitizers keep memory for themselves";
  const Clip walk = write_walk(900);
  data_ = 128 << 20;
  peak("krok-edit", "walk.anim", {"--plant", "-o", "out.anim"});
  const json result = json::parse(get(path("report.json")))["result"];
  EXPECT_EQ(result["frames"], walk.frame_count());
  EXPECT_GT(result["steps"][0]["stays"].size(), 1000U);
  EXPECT_LT(result["steps"][0]["drift"], 0.002);
  EXPECT_GT(result["steps"][0]["stance_share"], 0.5);
  const std::vector<std::string> reach = {"--reach", "Head=0.5m,1.5m,0m@10s..20s"};
  for (const auto& goals : {std::vector<std::string>(), reach}) {
    std::vector<std::string> options = {"--plant", "-o", "out.anim"};
    options.insert(options.end(), goals.begin(), goals.end());
    peak("krok-ik", "walk.anim", options);
    const json plant = json::parse(get(path("report.json")))["result"]["plant"];
    EXPECT_EQ(plant["stays"], result["steps"][0]["stays"]);
  }
}

// Would fail if the ground's targets of all points were kept for all frames: 35 kB each.
TEST_F(LongTake, SettlingKeepsAStretchAtATime) {
  if (sanitized()) GTEST_SKIP() << "skipped: sanitizers keep memory for themselves";
  const std::vector<std::string> options = {"--settle", "--ground", "slope:5deg", "-o", "out.anim"};
  write_walk(16);  // more than a stretch
  const double few = peak("krok-edit", "walk.anim", options);
  write_walk(60);
  EXPECT_LT(peak("krok-edit", "walk.anim", options), few + 32);
}

}  // namespace
}  // namespace krok::test
