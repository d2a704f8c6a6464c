// krok-render. Would fail if a film lacked frames, if its bytes depended on threads, if the camera
// of a .cam file were not used, or if a missing ffmpeg were found out only after rendering.
#include "cli/motion_fixture.h"
#include "core/fed_program.h"
#include "render/image.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

class KrokRender : public MotionTest {
 protected:
  KrokRender() { write_walk(2); }

  ToolRun film(std::vector<std::string> arguments) const {
    return run_here("krok-render", std::move(arguments));
  }

  // Small bones from the walk's beginning.
  static std::vector<std::string> small(std::vector<std::string> more) {
    more.insert(more.begin(),
                {"walk.anim", "--body", "none", "--size", "96x64", "--to", "0.3s", "--rate", "20"});
    return more;
  }

  render::Image image(const std::string& name) const {
    const auto file = InputFile::open(path(name));
    EXPECT_TRUE(file.ok()) << name;
    auto read = render::read_png(file->bytes());
    EXPECT_TRUE(read.ok()) << name;
    return *std::move(read);
  }

  // Pixels of which red, green and blue differ: actors are coloured by side, the rest is grey.
  static int coloured(const render::Image& image) {
    int count = 0;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
      const auto [low, high] = std::minmax({image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]});
      count += high - low > 40 ? 1 : 0;
    }
    return count;
  }
};

TEST_F(KrokRender, WritesAFilePerFrame) {
  const ToolRun run = film(small({"-o", "f_%03d.png", "--json"}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json report = json::parse(run.out);
  EXPECT_EQ(report["result"]["frames"], 7);
  EXPECT_EQ(report["outputs"].size(), 7U);
  const render::Image first = image("f_000.png"), last = image("f_006.png");
  EXPECT_EQ(first.width, 96);
  EXPECT_EQ(first.height, 64);
  EXPECT_GT(coloured(first), 60) << "an actor is to be seen";
  EXPECT_NE(first.rgb, last.rgb);
  EXPECT_FALSE(std::filesystem::exists(path("f_007.png")));
}

TEST_F(KrokRender, ThreadsDoNotChangeTheBytes) {
  ASSERT_EQ(film(small({"-o", "a_%d.png", "-j", "1"})).exit_code, 0);
  ASSERT_EQ(film(small({"-o", "b_%d.png", "-j", "3"})).exit_code, 0);
  for (const char* frame : {"0", "3", "6"}) {
    EXPECT_TRUE(get(path(std::string("a_") + frame + ".png")) ==
                get(path(std::string("b_") + frame + ".png")));
  }
}

TEST_F(KrokRender, ViewsStandSideBySide) {
  write("again.anim", read("walk.anim"));
  const ToolRun run = film({"walk.anim", "again.anim", "--body", "none", "--size", "192x64", "--to",
                            "0s", "--no-labels", "-o", "two_%d.png"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const render::Image both = image("two_0.png");
  // The same actor twice: both halves have the same pixels, but for the line between them.
  for (int y = 0; y < 64; ++y) {
    for (int x = 2; x < 94; ++x) {
      ASSERT_EQ(both.at(x, y), both.at(x + 96, y)) << x << ' ' << y;
    }
  }
}

TEST_F(KrokRender, ADifferenceIsColouredAndMeasured) {
  ASSERT_EQ(run_here("krok-edit", {"walk.anim", "--move", "0,3cm,0", "-o", "up.anim"}).exit_code,
            0);
  const ToolRun run = film({"walk.anim", "up.anim", "--difference", "--body", "low", "--size",
                            "288x96", "--to", "0s", "-o", "d_%d.png", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json result = json::parse(run.out)["result"];
  EXPECT_NEAR(result["largest_distance"].get<double>(), 0.03, 1e-5);
  EXPECT_EQ(result["views"].size(), 3U);
  EXPECT_EQ(result["views"][2]["title"], "difference");
  const render::Image made = image("d_0.png");
  int red = 0;  // all is as far as the scale goes
  for (int y = 0; y < 96; ++y) {
    for (int x = 192; x < 288; ++x) {
      const render::Colour at = made.at(x, y);
      red += at.red > at.green + 60 && at.red > at.blue + 60 ? 1 : 0;
    }
  }
  EXPECT_GT(red, 100);
  EXPECT_EQ(film({"walk.anim", "--difference", "-o", "d_%d.png"}).exit_code, 2);
}

TEST_F(KrokRender, ACameraFileFilmsInPerspective) {
  ASSERT_EQ(run_here("krok-cam", {"walk.anim", "--follow", "hips", "--view", "left", "-o", "l.cam"})
                .exit_code,
            0);
  ASSERT_EQ(run_here("krok-cam", {"walk.anim", "--follow", "hips", "--view", "left", "--distance",
                                  "12m", "-o", "far.cam"})
                .exit_code,
            0);
  ASSERT_EQ(film(small({"--cam", "l.cam", "-o", "near_%d.png"})).exit_code, 0);
  ASSERT_EQ(film(small({"--cam", "far.cam", "-o", "far_%d.png"})).exit_code, 0);
  const int near = coloured(image("near_0.png")), far = coloured(image("far_0.png"));
  EXPECT_GT(near, 50);
  EXPECT_GT(far, 0);
  EXPECT_LT(3 * far, near) << "a camera further away shows it smaller";
  EXPECT_EQ(film(small({"--cam", "walk.anim", "-o", "x_%d.png"})).exit_code, 2);
}

TEST_F(KrokRender, FilmsAreWhatTheirNamesSay) {
  if (!find_program("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  for (const auto& [name, magic] : {std::pair<std::string, std::string>{"w.mp4", "ftyp"},
                                    {"w.gif", "GIF89a"},
                                    {"w.webp", "WEBP"}}) {
    for (const std::string jobs : {"1", "3"}) {
      const ToolRun run = film(small({"-o", jobs + name, "-j", jobs}));
      ASSERT_EQ(run.exit_code, 0) << run.err;
      EXPECT_NE(get(path(jobs + name)).substr(0, 16).find(magic), std::string::npos) << name;
    }
    EXPECT_TRUE(get(path("1" + name)) == get(path("3" + name))) << name;
  }
  // An mp4's index is in front, and no time of day is in it.
  const std::string mp4 = get(path("1w.mp4"));
  EXPECT_LT(mp4.find("moov"), mp4.find("mdat"));
}

TEST_F(KrokRender, WithoutFfmpegItSaysSoBeforeRendering) {
  const ToolRun run =
      test::run({"/usr/bin/env", "PATH=/nowhere", test::tools_folder() + "/krok-render",
                 path("walk.anim"), "-o", path("w.mp4")});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_TRUE(has_code(run.err, "film-ffmpeg")) << run.err;
  EXPECT_THAT(run.err, HasSubstr("frame_%04d.png"));
  // A program of that name that fails.
  put("ffmpeg", "#!/bin/sh\necho no such codec >&2\nexit 3\n");
  std::filesystem::permissions(path("ffmpeg"), std::filesystem::perms::owner_all);
  const ToolRun broken = test::run({"/usr/bin/env", "PATH=" + folder_.string() + ":/usr/bin:/bin",
                                    test::tools_folder() + "/krok-render", path("walk.anim"),
                                    "--body", "none", "--size", "96x64", "-o", path("w.mp4")});
  EXPECT_EQ(broken.exit_code, 2);
  EXPECT_TRUE(has_code(broken.err, "program-failed")) << broken.err;
  EXPECT_THAT(broken.err, HasSubstr("no such codec"));
  EXPECT_FALSE(std::filesystem::exists(path("w.mp4")));
}

// Would fail if a glTF character could not be the model, and each hint led to the next.
TEST_F(KrokRender, AGlbIsAModelToo) {
  ASSERT_EQ(run_here("krok-body", {"walk.anim", "--detail", "low", "-o", "b.model"}).exit_code, 0);
  ASSERT_EQ(run_here("krok-skin", {"b.model", "walk.anim", "-o", "hero.glb"}).exit_code, 0);
  const auto film_with = [&](const std::string& model, const std::string& name) {
    const ToolRun run = film({"walk.anim", "--model", model, "--size", "96x64", "-o", name});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return image(name);
  };
  const auto by_model = film_with("b.model", "a.png"), by_glb = film_with("hero.glb", "b.png");
  EXPECT_GT(coloured(by_glb), 60);
  EXPECT_NEAR(coloured(by_glb), coloured(by_model), 20) << "one body, in the same pose";
}

TEST_F(KrokRender, OutputsThatAreNoFilmAreRefused) {
  for (const char* output :
       {"walk.txt", "walk.svg", "walk", "a_%d_%d.png", "a_%s.png", "a_%.png"}) {
    const ToolRun run = film({"walk.anim", "-o", output});
    EXPECT_EQ(run.exit_code, 2) << output;
    EXPECT_TRUE(has_code(run.err, "usage")) << output << run.err;
  }
  for (const char* size : {"10x10", "97x64", "96", "9999x64", "axb"}) {
    EXPECT_EQ(film({"walk.anim", "--size", size, "-o", "a_%d.png"}).exit_code, 2) << size;
  }
}

TEST_F(KrokRender, AFolderBecomesAFilmEach) {
  std::filesystem::create_directory(path("takes"));
  write("takes/a.anim", read("walk.anim"));
  write("takes/b.anim", read("walk.anim"));
  const ToolRun run = film({"takes", "--body", "none", "--size", "64x64", "--to", "1f", "--format",
                            "png", "--out-dir", "films"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(std::filesystem::exists(path("films/a_0000.png")));
  EXPECT_TRUE(std::filesystem::exists(path("films/b_0000.png")));
}

// Sheets in batches, too.
TEST_F(KrokRender, SheetsOfAFolder) {
  std::filesystem::create_directory(path("takes"));
  write("takes/a.anim", read("walk.anim"));
  write("takes/b.anim", read("walk.anim"));
  const ToolRun run = run_here("krok-plot", {"takes", "--sheet", "{name}.png", "--moments", "1",
                                             "--body", "none", "--out-dir", "sheets"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(get(path("sheets/a.png")) != "");
  EXPECT_TRUE(get(path("sheets/b.png")) != "");
  EXPECT_FALSE(std::filesystem::exists(path("sheets/a.svg")));
}

}  // namespace
}  // namespace krok::test
