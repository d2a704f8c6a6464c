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
      {"krok-edit", {"--append", "short.bvh", "--blend", "0s", "-o", "out.anim"}, 719999},
      {"krok-export", {"--what", "velocities", "-o", "out.csv"}},
      {"krok-export", {"--what", "local", "--layout", "wide", "-o", "out.csv"}},
      {"krok-export", {"--what", "quaternions", "-o", "out.sto"}},
      {"krok-body", {"--detail", "low", "-o", "out.model"}, 0},
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

// Would fail if a motion were held whole as it is appended, or arrays as they are unpacked.
TEST_F(LongTake, WhatIsAddedAndUnpackedIsReadInParts) {
  if (sanitized()) GTEST_SKIP() << "skipped: sanitizers keep memory for themselves";
  put("short.bvh", capture(20000));
  put("long.bvh", capture(700000));
  ASSERT_EQ(run_here("krok-export", {"long.bvh", "-o", "long.npz"}).exit_code, 0);
  data_ = 64 << 20;
  peak("krok-edit", "short.bvh", {"--append", "long.bvh", "--blend", "0s", "-o", "out.anim"});
  EXPECT_EQ(read("out.anim").provenance.sources.back().xxh3.size(), 16U);
  EXPECT_EQ(json::parse(get(path("report.json")))["result"]["frames"], 719999);
  peak("krok-import", "long.npz", {"-o", "out.anim"});
  EXPECT_EQ(json::parse(get(path("report.json")))["result"]["frames"], 700000);
}

// Would fail if poses of all frames were kept to blend them.
TEST_F(LongTake, MotionsAreBlendedInParts) {
  if (sanitized()) GTEST_SKIP() << "skipped: sanitizers keep memory for themselves";
  put("long.bvh", capture(700000));
  for (const std::string name : {"a", "b"}) {
    ASSERT_EQ(run_here("krok-import", {"long.bvh", "-o", name + ".anim"}).exit_code, 0);
  }
  data_ = 160 << 20;
  peak("krok-blend", "a.anim:0.5", {"b.anim:0.5", "--contacts", "none", "-o", "out.anim"});
  EXPECT_EQ(json::parse(get(path("report.json")))["result"]["frames"], 700000);
  const Clip one = read("a.anim"), both = read("out.anim");
  for (const int f : {0, 4095, 4096, 699999}) {
    EXPECT_LT((one.frame_positions(f)[2] - both.frame_positions(f)[2]).norm(), 1e-4F) << f;
  }
}

// Would fail if memory were taken for a page that no browser shows.
TEST_F(LongTake, APageOfItIsRefused) {
  put("long.bvh", capture(3'100'000));
  const ToolRun run = run_here("krok-view", {"long.bvh", "-o", "out.html"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_TRUE(has_code(run.err, "view-long")) << run.err;
  EXPECT_NE(run.err.find("--rate"), std::string::npos) << run.err;
}

// Would fail if a take were held whole to cut a part out of it, or were cut elsewhere than a short
// one.
TEST_F(LongTake, PartsAreCutOutOfIt) {
  if (sanitized()) GTEST_SKIP() << "skipped: sanitizers keep memory for themselves";
  const std::vector<std::string> steps = {"--from", "left_strike[2]", "--to", "left_strike[4]",
                                          "-o",     "out.anim"};
  const auto walk = [&](int count) {
    samples::WalkOptions options;
    options.steps = count;
    options.rate = 240;
    write("walk.anim", samples::make_walk(options)->clip);
  };
  walk(20);
  peak("krok-edit", "walk.anim", steps);
  const json cut = json::parse(get(path("report.json")))["result"]["steps"][0];
  walk(900);
  ASSERT_GT(get(path("walk.anim")).size(), std::size_t{64} << 20);
  put("parts.json", R"({"schema": "krok.sequences/1", "rate": 240, "sequences": [
      {"name": "a", "first": 400, "last": 640, "loop": true},
      {"name": "b", "first": 70000, "last": 70050}]})");
  data_ = 128 << 20;
  peak("krok-edit", "walk.anim", steps);
  const json here = json::parse(get(path("report.json")))["result"]["steps"][0];
  EXPECT_EQ(here["first_frame"], cut["first_frame"]);
  EXPECT_EQ(here["last_frame"], cut["last_frame"]);
  data_ = 64 << 20;
  peak("krok-edit", "walk.anim", {"--sequences", "parts.json", "-o", "{sequence}.anim"});
  const json parts = json::parse(get(path("report.json")))["result"]["sequences"];
  EXPECT_EQ(parts[1]["frames"], 51);
  EXPECT_EQ(read("b.anim").frame_positions(50)[0], read("walk.anim").frame_positions(70050)[0]);
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

// Would fail if the keys of a rig, what a camera looks at, or frames that are not shown were held
// in memory.
TEST_F(LongTake, RigsAndCamerasAreMadeInParts) {
  if (sanitized()) GTEST_SKIP() << "skipped: sanitizers keep memory for themselves";
  samples::WalkOptions how;
  how.steps = 900;
  how.rate = 240;
  const Clip walk = samples::make_walk(how)->clip;
  write("walk.anim", walk);
  ASSERT_EQ(run_here("krok-body", {"walk.anim", "--detail", "low", "-o", "b.model"}).exit_code, 0);
  data_ = 96 << 20;
  peak("krok-skin", "b.model", {"walk.anim", "-o", "out.glb"});
  EXPECT_EQ(json::parse(get(path("report.json")))["result"]["frames"], walk.frame_count());
  peak("krok-skin", "b.model", {"walk.anim", "--from", "100f", "--to", "400f", "-o", "part.glb"});
  ASSERT_EQ(run_here("krok-edit", {"walk.anim", "--from", "100f", "--to", "400f", "-o", "p.anim"})
                .exit_code,
            0);
  EXPECT_EQ(run_here("krok-diff", {"part.glb", "p.anim"}).exit_code, 0);
  peak("krok-cam", "walk.anim", {"--follow", "hips", "-o", "out.cam"});
  EXPECT_EQ(json::parse(get(path("report.json")))["result"]["frames"], walk.frame_count());
  peak("krok-export", "walk.anim", {"-o", "skeleton.glb"});
  // Threads of the renderer have memory that is not used, and that of this process as it forks
  // counts, too.
  data_ = 0;
  EXPECT_LT(peak("krok-plot", "walk.anim", {"--strip", "s.png", "--from", "1s", "--to", "2s"}),
            150);
  const auto film = [](const char* frame, const char* output) {
    return std::vector<std::string>{"--from",      frame, "--size", "96x54",
                                    "--no-labels", "-o",  output};
  };
  EXPECT_LT(peak("krok-render", "walk.anim", film("250f", "long.png")), 150);
  peak("krok-render", "p.anim", film("150f", "part.png"));
  EXPECT_EQ(get(path("long.png")), get(path("part.png")));
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
