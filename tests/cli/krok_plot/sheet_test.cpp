// If these fail, who looks at a contact sheet sees the figure elsewhere, at another moment or at
// another size than it was.

#include <gmock/gmock.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <tuple>

#include "cli/fixture.h"
#include "cli/kept_files.h"
#include "support/image.h"

namespace krok::test {
namespace {

class KrokPlotSheet : public CliTest {
 protected:
  ToolRun plot(std::vector<std::string> arguments) const {
    arguments.push_back("--json=" + path("report.json"));
    return run_tool("krok-plot", arguments);
  }
  json report() const { return json::parse(get(path("report.json")))["result"]; }
  // Of all cells in their order.
  std::vector<int> frames_shown() const {
    const json cells = report()["sheet"]["cells"];
    std::vector<int> frames;
    for (const json& cell : cells) frames.push_back(cell["moments"][0]["frame"]);
    return frames;
  }
  render::Image image(const std::string& name) const {
    auto image = image_of(get(path(name)));
    EXPECT_TRUE(image.ok()) << (image ? "" : image.error().message);
    return image ? std::move(*image) : render::Image();
  }

  // World positions by frame, as krok-export tells them.
  std::map<int, std::vector<Vec3>> exported(const std::string& capture) const {
    EXPECT_EQ(run_tool("krok-export", {capture, "-o", path("positions.csv")}).exit_code, 0);
    std::istringstream lines(get(path("positions.csv")));
    std::map<int, std::vector<Vec3>> frames;
    std::string line;
    std::map<std::string, std::size_t> columns;
    while (std::getline(lines, line)) {
      if (line.empty() || line[0] == '#') continue;
      std::vector<std::string> fields;
      std::istringstream parts(line);
      for (std::string field; std::getline(parts, field, ',');) fields.push_back(field);
      if (columns.empty()) {
        for (std::size_t i = 0; i < fields.size(); ++i) columns[fields[i]] = i;
        continue;
      }
      const auto number = [&](const char* name) { return std::stod(fields.at(columns.at(name))); };
      frames[static_cast<int>(number("frame"))].emplace_back(number("x"), number("y"), number("z"));
    }
    return frames;
  }
};

TEST_F(KrokPlotSheet, EveryJointsPixelIsWhereTheJointIs) {
  ASSERT_EQ(plot({kWalk, "--body", "none", "--sheet", path("s.png"), "--view",
                  "front,left,back-right,top", "--moments", "4"})
                .exit_code,
            0);
  const auto frames = exported(kWalk);
  const auto drawn = image("s.png");
  const json sheet = report()["sheet"];
  ASSERT_EQ(sheet["width"], drawn.width);
  ASSERT_EQ(sheet["cells"].size(), 16U);
  int joints = 0;
  for (const json& cell : sheet["cells"]) {
    for (const Vec3& joint : frames.at(cell["moments"][0]["frame"])) {
      const Vec2 at = place_in(cell, sheet["pixels_per_metre"], joint);
      const render::Colour colour =
          drawn.at(static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y())));
      // Darker than the lightest of the background, whatever colour the limb has.
      EXPECT_LT(std::min({colour.red, colour.green, colour.blue}), 200)
          << cell << " " << joint.transpose();
      ++joints;
    }
  }
  EXPECT_EQ(joints, 16 * 29);
}

TEST_F(KrokPlotSheet, TheBodyStandsOnTheGroundAndIsAsTallAsTheActor) {
  ASSERT_EQ(plot({kWalk, "--sheet", path("s.png"), "--moments", "3"}).exit_code, 0);
  const auto frames = exported(kWalk);
  const auto drawn = image("s.png");
  const json sheet = report()["sheet"];
  ASSERT_EQ(sheet["cells"].size(), 6U);
  const double per_metre = sheet["pixels_per_metre"];
  for (const json& cell : sheet["cells"]) {
    const Silhouette actor = silhouette(drawn, cell, 16);
    const double ground = cell["target_pixel"][1];
    EXPECT_NEAR((ground - actor.bottom) / per_metre, 0.0, 0.03);
    double top = 0;
    for (const Vec3& joint : frames.at(cell["moments"][0]["frame"])) top = std::max(top, joint.y());
    EXPECT_NEAR((ground - actor.top) / per_metre, top, 0.06);
    EXPECT_GT(actor.bottom - actor.top, 200) << "not tiny";
  }
}

TEST_F(KrokPlotSheet, JointsOfGltfWithoutAMeshGetABody) {
  ASSERT_EQ(run_tool("krok-export", {kWalk, "-o", path("walk.gltf")}).exit_code, 0);
  json file = json::parse(get(path("walk.gltf")));
  file.erase("meshes");
  file.erase("skins");
  for (json& node : file["nodes"]) {
    node.erase("mesh");
    node.erase("skin");
  }
  put("bare.gltf", file.dump());
  std::vector<int> pixels;
  for (const std::string& input : {std::string(kWalk), path("bare.gltf")}) {
    ASSERT_EQ(plot({input, "--sheet", path("s.png"), "--moments", "1"}).exit_code, 0);
    const json sheet = report()["sheet"];
    pixels.push_back(silhouette(image("s.png"), sheet["cells"][0], 16).pixels);
  }
  EXPECT_NEAR(pixels[1], pixels[0], 0.05 * pixels[0]) << "bones have other pixels";
}

TEST_F(KrokPlotSheet, TheLeftIsBlueAndToTheRightOfWhoeverLooksAtTheFront) {
  ASSERT_EQ(
      plot({kWalk, "--body", "none", "--sheet", path("s.png"), "--view", "front,back"}).exit_code,
      0);
  const auto drawn = image("s.png");
  const json cells = report()["sheet"]["cells"];
  ASSERT_EQ(cells.size(), 16U);
  for (const json& cell : cells) {
    const Silhouette actor = silhouette(drawn, cell);
    if (cell["row"] == 0) {
      EXPECT_GT(actor.blue_x, actor.orange_x + 10);
    } else {
      EXPECT_LT(actor.blue_x, actor.orange_x - 10);
    }
  }
}

TEST_F(KrokPlotSheet, ShowsTheMomentsThatAreNamed) {
  ASSERT_EQ(plot({kWalk, "--body", "none", "--sheet", path("s.png"), "--view", "front", "--moments",
                  "2s,30f,0.5s"})
                .exit_code,
            0);
  EXPECT_THAT(frames_shown(), ElementsAre(30, 120)) << "30f and 0.5s are one frame of 60 a second";
  ASSERT_EQ(plot({kWalk, "--body", "none", "--sheet", path("s.png"), "--view", "front", "--moments",
                  "3", "--from", "1s", "--to", "120f"})
                .exit_code,
            0);
  EXPECT_THAT(frames_shown(), ElementsAre(60, 90, 120));
  // Frames are meant: the message has both units, or 30 seems to be among 0 to 200.
  EXPECT_THAT(plot({kWalk, "--sheet", path("s.png"), "--moments", "0,30"}).err,
              AllOf(HasSubstr("--moments 30s: not in the shown frames 0 to "), HasSubstr(" s ["),
                    HasSubstr("30f is frame 30")));
}

TEST_F(KrokPlotSheet, PutsFilesOnOneSheetAtOneScale) {
  put("short.bvh", capture(5));
  ASSERT_EQ(plot({kWalk, path("short.bvh"), "--body", "none", "--sheet", path("s.png"), "--view",
                  "front", "--moments", "4"})
                .exit_code,
            0);
  const json cells = report()["sheet"]["cells"];
  ASSERT_EQ(cells.size(), 8U);
  EXPECT_EQ(cells[0]["name"], "walk.bvh");
  EXPECT_EQ(cells[7]["name"], "short.bvh");
  EXPECT_EQ(cells[7]["moments"][0]["frame"], 4);
}

TEST_F(KrokPlotSheet, AStripGoesFromLeftToRight) {
  ASSERT_EQ(plot({kWalk, "--strip", path("s.png"), "--body", "none", "--moments", "5"}).exit_code,
            0);
  const json strip = report()["strip"];
  ASSERT_EQ(strip["cells"].size(), 1U);
  const json cell = strip["cells"][0];
  ASSERT_EQ(cell["moments"].size(), 5U);
  const auto frames = exported(kWalk);
  const auto drawn = image("s.png");
  double before = -1;
  for (const json& moment : cell["moments"]) {
    const Vec3 hips = frames.at(moment["frame"])[0];
    const Vec2 at = place_in(cell, strip["pixels_per_metre"], hips);
    EXPECT_GT(at.x(), before);
    before = at.x();
  }
  // The last figure's hips are drawn in full where they project.
  const auto last =
      place_in(cell, strip["pixels_per_metre"], frames.at(cell["moments"][4]["frame"])[0]);
  const render::Colour colour = drawn.at(static_cast<int>(last.x()), static_cast<int>(last.y()));
  EXPECT_LT(std::min({colour.red, colour.green, colour.blue}), 150);
}

TEST_F(KrokPlotSheet, DrawsModelsAndGlbFiles) {
  const std::string model = path("own.model"), glb = path("own.glb"), anim = path("own.anim");
  ASSERT_EQ(run_tool("krok-import", {kWalk, "-o", anim}).exit_code, 0);
  ASSERT_EQ(run_tool("krok-body", {anim, "--detail", "low", "-o", model}).exit_code, 0);
  ASSERT_EQ(run_tool("krok-skin", {model, anim, "-o", glb, "--as", "rig"}).exit_code, 0);
  ASSERT_EQ(
      plot({model, anim, "--sheet", path("a.png"), "--view", "left", "--moments", "2"}).exit_code,
      0);
  const json by_model = report()["sheet"];
  EXPECT_EQ(by_model["cells"].size(), 2U) << "the model is moved, not shown beside the motion";
  ASSERT_EQ(plot({glb, "--sheet", path("b.png"), "--view", "left", "--moments", "2"}).exit_code, 0);
  const json by_glb = report()["sheet"];
  const auto a = image("a.png");
  const auto b = image("b.png");
  for (std::size_t i = 0; i < 2; ++i) {
    const double first = silhouette(a, by_model["cells"][i], 16).pixels;
    const double second = silhouette(b, by_glb["cells"][i], 16).pixels;
    EXPECT_GT(first, 1000);
    EXPECT_NEAR(second / first, 1, 0.03) << "the same body in the same pose";
  }
  ASSERT_EQ(plot({model, "--sheet", path("c.png")}).exit_code, 0);
  EXPECT_EQ(report()["sheet"]["cells"].size(), 2U) << "alone it stands still, seen from two sides";
}

// Would fail if a glTF file were seen from +Z, or from one place for its whole way.
TEST_F(KrokPlotSheet, AGlbIsSeenAsItsMotionIs) {
  const std::string anim = path("turned.anim"), glb = path("turned.glb");
  ASSERT_EQ(run_tool("krok-edit", {kWalk, "--heading", "110deg", "-o", anim}).exit_code, 0);
  ASSERT_EQ(run_tool("krok-export", {anim, "-o", glb}).exit_code, 0);
  const auto cells = [&](const std::string& input) {
    EXPECT_EQ(plot({input, "--body", "none", "--sheet", path("s.png"), "--view", "front",
                    "--moments", "0s,1s"})
                  .exit_code,
              0);
    return report()["sheet"]["cells"];
  };
  const json as_motion = cells(anim), as_glb = cells(glb);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(as_glb[i]["yaw"].get<double>(), as_motion[i]["yaw"].get<double>(), 15);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(as_glb[i]["target"][axis].get<double>(),
                  as_motion[i]["target"][axis].get<double>(), 1e-3);
    }
  }
}

// Would fail if the header of a sheet of few cells were cut off at their width.
TEST_F(KrokPlotSheet, ASheetIsAsWideAsItsHeader) {
  const auto width = [&](const std::string& name) {
    const std::string input = put(name, get(kWalk));
    EXPECT_EQ(plot({input, "--body", "none", "--sheet", path("s.png"), "--moments", "1"}).exit_code,
              0);
    return report()["sheet"]["width"].get<int>();
  };
  EXPECT_GT(width("a_walk_with_a_name_that_is_longer_than_a_cell_is_wide.bvh"), width("w.bvh"));
}

// If it fails, --method does not reach the mesh, or changes what is drawn without it.
TEST_F(KrokPlotSheet, MovesModelsByTheMethodAskedFor) {
  const std::string model = path("own.model"), anim = path("own.anim");
  ASSERT_EQ(run_tool("krok-import", {kWalk, "-o", anim}).exit_code, 0);
  ASSERT_EQ(run_tool("krok-body", {anim, "--detail", "low", "-o", model}).exit_code, 0);
  const auto drawn = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {model,    anim,   "--sheet",   path("s.png"),
                                          "--view", "left", "--moments", "20f"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    EXPECT_EQ(run_tool("krok-plot", arguments).exit_code, 0);
    return get(path("s.png"));
  };
  const std::string plain = drawn({}), linear = drawn({"--method", "linear"}),
                    dual = drawn({"--method", "dual-quaternion"}),
                    rigid = drawn({"--method", "rigid"});
  EXPECT_EQ(plain, linear);
  EXPECT_NE(dual, linear);
  EXPECT_NE(rigid, linear);
  EXPECT_NE(rigid, dual);
}

TEST_F(KrokPlotSheet, GivesTheSameBytesForAnyNumberOfThreads) {
  for (const char* jobs : {"1", "2"}) {
    ASSERT_EQ(run_tool("krok-plot", {kWalk, "--sheet", path(std::string(jobs) + ".png"),
                                     "--moments", "2", "--elevation", "20deg", "-j", jobs})
                  .exit_code,
              0);
  }
  EXPECT_EQ(get(path("1.png")), get(path("2.png")));
}

// Would fail if files that are read at the same time came in another order, in the sheet or in what
// is said of them, or if standard input were read as two files.
TEST_F(KrokPlotSheet, FilesReadBesideEachOtherComeInTheirOrder) {
  put("broken.bvh", "HIERARCHY nothing");
  put("chain.bvh", capture(3));
  const std::string turn = test::source_folder() + "/samples/captures/turn.bvh";
  const auto run = [&](const char* jobs) {
    const ToolRun done =
        run_tool("krok-plot", {path("chain.bvh"), turn, path("broken.bvh"), path("none.bvh"), kWalk,
                               "--keep-going", "--moments", "1", "-j", jobs, "--sheet",
                               path("s.png"), "--json=" + path("report.json")});
    return std::tuple(done.exit_code, done.err, get(path("report.json")), get(path("s.png")));
  };
  const auto one = run("1");
  EXPECT_EQ(std::get<0>(one), 3) << std::get<1>(one);
  EXPECT_EQ(one, run("4"));
  ToolOptions options;
  options.input = get(kWalk);
  const ToolRun twice = run_tool("krok-plot", {"-", "-", "--sheet", path("t.png")}, options);
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_THAT(twice.err, HasSubstr("standard input can be read only once"));
}

TEST_F(KrokPlotSheet, RefusesWhatMakesNoSense) {
  const std::vector<std::vector<std::string>> wrong = {
      {"--actor-size", "5"},
      {"--actor-size", "100000"},
      {"--actor-size", "4000", "--moments", "100", "--view", "front,left,back"},
      {"--moments", "0"},
      {"--moments", "100000"},
      {"--moments", "soon"},
      {"--moments", "99s"},
      {"--moments", "-1f"},
      {"--moments", "0s,,1s"},
      {"--view", "under"},
      {"--view", ""},
      {"--elevation", "100deg"},
      {"--elevation", "high"},
      {"--from", "99s"},
      {"--from", "2s", "--to", "1s"},
      {"--body", "fat"},
      {"--method", "stiff"},
      {"--front", "back"},
  };
  for (std::vector<std::string> arguments : wrong) {
    const std::string what = arguments[0] + " " + arguments[1];
    arguments.insert(arguments.begin(), {kWalk, "--body", "none", "--sheet", path("s.png")});
    const ToolRun run = run_tool("krok-plot", arguments);
    EXPECT_EQ(run.exit_code, 2) << what;
    EXPECT_THAT(run.err, HasSubstr("error: ")) << what;
    EXPECT_THAT(listing(), IsEmpty()) << what;
  }
  const ToolRun named = run_tool("krok-plot", {kWalk, "--sheet", path("s.jpg")});
  EXPECT_EQ(named.exit_code, 2);
  EXPECT_THAT(named.err, HasSubstr(".png"));
  EXPECT_THAT(listing(), IsEmpty());
}

TEST_F(KrokPlotSheet, TakesOneFrameAndNoFrames) {
  put("one.bvh", capture(1));
  put("none.bvh", capture(0));
  for (const char* name : {"one.bvh", "none.bvh"}) {
    const ToolRun run = plot({path(name), "--sheet", path("s.png"), "--strip", path("t.png")});
    EXPECT_EQ(run.exit_code, 0) << name << run.err;
    EXPECT_EQ(report()["sheet"]["cells"].size(), 2U) << name;
  }
}

// A sheet of a folder was a ribbon of 30,000 pixels, refused after all had been drawn.
// From one side at four times, unless options say otherwise.
TEST_F(KrokPlotSheet, ManyMotionsAreAGridOfASizeThatFits) {
  std::vector<std::string> inputs(30, kWalk);
  inputs.insert(inputs.end(), {"--sheet", path("all.png"), "--body", "none"});
  ASSERT_EQ(plot(inputs).exit_code, 0);
  EXPECT_EQ(report()["sheet"]["cells"].size(), 30U * 4);
  const render::Image grid = image("all.png");
  EXPECT_LT(grid.height, 3 * grid.width);
  EXPECT_LT(grid.height, 6000);
  inputs.insert(inputs.end(), {"--columns", "6", "--moments", "2", "--view", "front,top"});
  ASSERT_EQ(plot(inputs).exit_code, 0);
  const json cells = report()["sheet"]["cells"];
  ASSERT_EQ(cells.size(), 120U);
  EXPECT_EQ(cells[0]["box"][1], cells[11]["box"][1]);
  EXPECT_LT(cells[0]["box"][1], cells[12]["box"][1]);
}

}  // namespace
}  // namespace krok::test
