// If these fail, krok-walk walks elsewhere than asked, on other ground, hides what it could not do,
// or ends wrongly on wrong input.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

#include "cli/step_library/library_fixture.h"
#include "formats/anim/anim.h"
#include "formats/prints/prints.h"
#include "support/glb_builder.h"
#include "support/height_images.h"

namespace krok::test {
namespace {

// The library of generated walks, and walks with it.
class KrokWalk : public StepLibrary {
 protected:
  void SetUp() override {
    StepLibrary::SetUp();
    fit_well();
  }
  ToolRun walk(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), path("out.steps"));
    if (!testing::Value(arguments, Contains("-o"))) {
      arguments.insert(arguments.end(), {"-o", path("walk.anim")});
    }
    return run_tool("krok-walk", arguments);
  }
  nlohmann::json walked(std::vector<std::string> arguments) const {
    arguments.emplace_back("--json");
    const ToolRun run = walk(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.exit_code == 0 ? nlohmann::json::parse(run.out)["result"] : nlohmann::json();
  }
  void refused(const std::vector<std::string>& arguments, const std::string& code,
               const std::string& says) const {
    const ToolRun run = walk(arguments);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_THAT(run.err, HasSubstr("[" + code + "]"));
    EXPECT_THAT(run.err, HasSubstr(says));
    EXPECT_THAT(listing(), Not(Contains("walk.anim")));
  }
  std::vector<gait::Print> prints(const std::string& name) const {
    const auto read = krok::prints::read(get(path(name)), name);
    EXPECT_TRUE(read) << (read ? "" : read.error().message);
    return read ? *read : std::vector<gait::Print>();
  }
  Clip clip(const std::string& name) const {
    const std::string bytes = get(path(name));
    return *anim::read(std::as_bytes(std::span(bytes)));
  }
};

// Would fail if the goal were missed, if the files beside the motion were missing, or if prints
// that were saved and handed back made another walk.
TEST_F(KrokWalk, WalksToAGoalAndFromItsOwnPrints) {
  const auto report = walked({"--goal", "1m,4m", "--save-prints", path("prints.csv")});
  EXPECT_THAT(listing(), testing::IsSupersetOf({"walk.anim", "walk.keys.json", "prints.csv"}));
  const auto set = prints("prints.csv");
  ASSERT_EQ(report["prints"], set.size());
  EXPECT_EQ(report["steps"].size(), set.size() - 2);
  EXPECT_LT(report["largest_miss"], 1e-4);
  EXPECT_NEAR(0.5 * (set.back().x + set[set.size() - 2].x), 1, 0.02);
  EXPECT_NEAR(0.5 * (set.back().z + set[set.size() - 2].z), 4, 0.02);
  const Clip made = clip("walk.anim");
  const Vec3f hips = made.frame_positions(made.frame_count() - 1)[0];
  EXPECT_NEAR(hips.x(), 1, 0.15);
  EXPECT_NEAR(hips.z(), 4, 0.15);
  const auto again = walked({"--prints", path("prints.csv"), "-o", path("again.anim"),
                             "--save-prints", path("prints.json")});
  EXPECT_EQ(again["duration"], report["duration"]);
  const Clip second = clip("again.anim");
  ASSERT_EQ(second.frame_count(), made.frame_count());
  for (std::size_t i = 0; i < made.positions.size(); ++i) {
    ASSERT_LT((made.positions[i] - second.positions[i]).norm(), 1e-5f);
  }
  EXPECT_EQ(prints("prints.json").size(), set.size());
}

// Would fail if a drawing were walked mirrored, in another unit, or only its first part.
TEST_F(KrokWalk, FollowsADrawing) {
  put("way.svg",
      "<svg><path id='a' d='M0 0L9 9'/><path id='b' d='M100 100L100 300Q100 500 300 500'/></svg>");
  walked({"--path", path("way.svg"), "--path-id", "b", "--save-prints", path("p.csv")});
  const auto set = prints("p.csv");
  EXPECT_NEAR(0.5 * (set[0].x + set[1].x), 1, 0.01);
  EXPECT_NEAR(0.5 * (set[0].z + set[1].z), 1, 0.01);
  EXPECT_NEAR(set.back().x, 3, 0.1);
  EXPECT_NEAR(set.back().z, 5, 0.15);
  EXPECT_NEAR(set.back().heading, kPi / 2, 0.3);
  walked({"--path", path("way.svg"), "--path-id", "b", "--path-scale", "2cm", "--save-prints",
          path("q.csv")});
  EXPECT_NEAR(prints("q.csv").back().x, 6, 0.2);
  // Path a is 13 cm long: no unit of a drawing that one walks in.
  EXPECT_THAT(walk({"--path", path("way.svg"), "-o", path("short.anim")}).err,
              AllOf(HasSubstr("[path-short]"), HasSubstr("--path-scale")));
  // 300 m and more are centimetres without their unit.
  put("cm.csv", "x,z\n0,0\n0,310\n");
  EXPECT_THAT(walk({"--path", path("cm.csv"), "-o", path("long.anim")}).err,
              AllOf(HasSubstr("[path-long]"), HasSubstr("z [cm]")));
  // The way of a motion is another walk's.
  walked({"--path", path("walk.anim"), "-o", path("copy.anim"), "--save-prints", path("r.csv")});
  EXPECT_NEAR(prints("r.csv").back().z, prints("q.csv").back().z, 0.3);
}

// Would fail if the way of another joint or node were taken than named, its parents left out, or a
// node that stands still walked along.
TEST_F(KrokWalk, FollowsAJointAndANode) {
  GlbBuilder scene;
  scene.json["scenes"] = {{{"nodes", {0}}}};
  scene.json["nodes"] = {{{"name", "yard"}, {"translation", {5, 0, 1}}, {"children", {1, 2}}},
                         {{"name", "lamp"}},
                         {{"name", "cart"}}};
  const int times = scene.add(std::vector<float>{0, 4, 8}, "SCALAR");
  scene.json["accessors"][static_cast<std::size_t>(times)]["min"] = nlohmann::json::array({0});
  scene.json["accessors"][static_cast<std::size_t>(times)]["max"] = nlohmann::json::array({8});
  const int places = scene.add(std::vector<float>{0, 1, 0, 0, 1, 3, 2, 1, 5}, "VEC3");
  scene.json["animations"] = {
      {{"samplers", {{{"input", times}, {"output", places}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "translation"}}}}}}}};
  const auto bytes = scene.glb();
  put("way.glb", std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  for (const bool named : {false, true}) {
    std::vector<std::string> arguments = {"--path", path("way.glb"), "--save-prints",
                                          path("p.csv")};
    if (named) arguments.insert(arguments.end(), {"--path-id", "cart"});
    walked(arguments);
    const auto set = prints("p.csv");
    EXPECT_NEAR(0.5 * (set[0].x + set[1].x), 5, 0.02);
    EXPECT_NEAR(0.5 * (set[0].z + set[1].z), 1, 0.02);
    EXPECT_NEAR(0.5 * (set.back().x + set[set.size() - 2].x), 7, 0.05);
    EXPECT_NEAR(0.5 * (set.back().z + set[set.size() - 2].z), 6, 0.05);
  }
  walked({"--path", path("walk.anim"), "--path-id", "Head", "-o", path("copy.anim"),
          "--save-prints", path("q.csv")});
  EXPECT_NEAR(prints("q.csv").back().z, 6, 0.3);
  std::filesystem::remove(path("walk.anim"));
  refused({"--path", path("way.glb"), "--path-id", "lamp"}, "path-node", "'lamp' stays");
  refused({"--path", path("way.glb"), "--path-id", "tree"}, "path-node", "'tree'");
  refused({"--path", path("copy.anim"), "--path-id", "tree"}, "path-node", "'tree'");
}

// Would fail if a ground were not the one that was named: each raises the end of the walk by a
// height that is known.
TEST_F(KrokWalk, StandsOnEveryKindOfGround) {
  const auto hips_rise = [&](const std::vector<std::string>& ground) {
    std::vector<std::string> arguments = {"--goal", "0,4m"};
    arguments.insert(arguments.end(), ground.begin(), ground.end());
    walked(arguments);
    const Clip made = clip("walk.anim");
    return made.frame_positions(made.frame_count() - 1)[0].y() - made.frame_positions(0)[0].y();
  };
  EXPECT_NEAR(hips_rise({}), 0, 0.005);
  EXPECT_NEAR(hips_rise({"--ground", "slope:6deg"}), 3 * std::tan(6 * kRadiansPerDegree), 0.03);
  EXPECT_NEAR(hips_rise({"--ground", "stairs:rise=-10cm,run=40cm,count=4"}), -0.4, 0.01);
  put("hill.exr", exr_image(2, 2, {{"Y", {0, 0, 1, 1}}}));
  EXPECT_NEAR(
      hips_rise({"--ground", path("hill.exr"), "--ground-size", "20x20", "--ground-range", "0,2m"}),
      0.4, 0.02);
  put("ramp.obj", "v -9 0 -9\nv -9 0.9 9\nv 9 0.9 9\nv 9 0 -9\nf 1 2 3 4\n");
  EXPECT_NEAR(hips_rise({"--ground", path("ramp.obj")}), 0.2, 0.02);
}

// Would fail if what no one can do were done in silence, or the message did not say which print.
TEST_F(KrokWalk, RefusesOrAdaptsWhatIsTooFar) {
  const std::string good = "side,x,z,heading\nleft,0.05,0,0\nright,-0.05,0,0\nleft,0.05,0.6,0\n";
  put("far.csv", good + "right,-0.05,3,0\nleft,0.05,3,0\n");
  refused({"--prints", path("far.csv")}, "walk-too-long", "print 4");
  const auto adapted =
      walked({"--prints", path("far.csv"), "--adapt", "--save-prints", path("near.csv")});
  EXPECT_EQ(adapted["moved_prints"], 2);
  EXPECT_GT(adapted["steps"][1]["moved"], 1);
  EXPECT_THAT(adapted["steps"][1]["why_moved"].get<std::string>(), HasSubstr("print 4"));
  EXPECT_LT(prints("near.csv")[3].z, 2);
}

// Would fail if it were not said that the ground is too small.
TEST_F(KrokWalk, SaysWhereTheGroundEnds) {
  write("floor.obj", "v -1 0 -1\nv -1 0 3\nv 1 0 3\nv 1 0 -1\nf 1 2 3 4\n");
  refused({"--goal", "0,8m", "--ground", path("floor.obj")}, "plan-ground", "the ground ends");
}

// Would fail if legs were stretched to prints that no example comes near to, without a word.
TEST_F(KrokWalk, StepsLongerThanTheLibrarysAreWarnedOf) {
  const auto prints_apart = [&](double length) {
    std::string text = "side,x,z,heading\n";
    for (int i = 0; i < 8; ++i) {
      text += fmt::format("{},{},{},0\n", i % 2 == 0 ? "left" : "right", i % 2 == 0 ? 0.05 : -0.05,
                          i == 0 ? 0 : length * (i - 1));
    }
    write("apart.csv", text);
    return walk({"--prints", path("apart.csv")}).err;
  };
  EXPECT_THAT(prints_apart(0.65), Not(HasSubstr("walk-beyond")));
  EXPECT_THAT(prints_apart(0.85),
              AllOf(HasSubstr("4 of 6 steps are longer or wider"),
                    HasSubstr("0.85 m long and 0.1 m"), HasSubstr("[walk-beyond]")));
}

// Would fail if ground that ankles cannot stand on were walked without a word.
TEST_F(KrokWalk, SaysWhereTheGroundIsTooSteep) {
  refused({"--goal", "0,4m", "--ground", "slope:40deg"}, "walk-too-steep", "print ");
  const std::vector<std::string> steep = {"--goal", "0,4m", "--ground", "slope:30deg"};
  const ToolRun warned = walk(steep);
  EXPECT_EQ(warned.exit_code, 0) << warned.err;
  EXPECT_THAT(warned.err, HasSubstr("[walk-ankle]"));
  std::vector<std::string> strict = steep;
  strict.emplace_back("--strict");
  EXPECT_EQ(walk(strict).exit_code, 1);
  EXPECT_EQ(walk({"--goal", "0,4m", "--strict"}).exit_code, 0);
}

TEST_F(KrokWalk, RefusesWrongInput) {
  refused({}, "usage", "no path is given");
  refused({"--goal", "1,2", "--path", "x.svg"}, "usage", "exclude each other");
  refused({"--goal", "1"}, "usage", "too few");
  refused({"--goal", "1,2,3"}, "usage", "too many");
  refused({"--goal", "1kg,2"}, "quantity-unit", "kg");
  refused({"--goal", "0,0"}, "path-short", "5 cm");
  refused({"--goal", "0,3", "--ground", "stars"}, "ground-kind", "stairs");
  refused({"--goal", "0,3", "--ground", path("none.exr")}, "file-missing", "none.exr");
  refused({"--goal", "0,3", "--ground-size", "3"}, "usage", "too few");
  refused({"--goal", "0,3", "--ground-size", "3x3"}, "usage", "height fields");
  refused({"--goal", "0,3", "--speed", "0"}, "usage", "--speed");
  refused({"--goal", "0,3", "--save-prints", "p.txt"}, "usage", ".csv");
  refused({"--prints", path("walk_50_0.bvh")}, "prints-column", "side");
  refused({"--prints", put("p.csv", "side,x,z,heading\nleft,nan,0,0\n")}, "prints-value",
          "p.csv:2:6");
  refused({"--prints", put("p.csv", "side,x,z,heading\nleft,0,0,0\n")}, "walk-prints", "three");
  refused({"--path", put("p.svg", "<svg><path d='M0 0X'/></svg>")}, "path-data", "p.svg:1:19");
  const ToolRun other =
      run_tool("krok-walk", {path("walk_50_0.bvh"), "--goal", "0,3", "-o", path("w.anim")});
  EXPECT_EQ(other.exit_code, 2) << other.err;
}

// Would fail if the number of threads changed a walk.
TEST_F(KrokWalk, IsTheSameOnAnyNumberOfThreads) {
  walked({"--goal", "3m,20m", "-j", "1"});
  walked({"--goal", "3m,20m", "-j", "2", "-o", path("two.anim")});
  const Clip one = clip("walk.anim"), two = clip("two.anim");
  ASSERT_EQ(one.positions.size(), two.positions.size());
  for (std::size_t i = 0; i < one.positions.size(); ++i) {
    ASSERT_EQ(one.positions[i], two.positions[i]);
    ASSERT_EQ(one.orientations[i].coeffs(), two.orientations[i].coeffs());
  }
}

// Would fail if a speed were said to be reached that the motion does not have.
TEST_F(KrokWalk, ThePaceIsReachedOrItIsSaid) {
  const auto report = walked({"--goal", "0,12m", "--pace", "1.2m/s"});
  const Clip clip = this->clip("walk.anim");
  const auto hips = static_cast<std::size_t>(clip.skeleton.find("Hips"));
  const auto& steps = report["steps"];
  const auto at = [&](const nlohmann::json& time) {
    const int frame = static_cast<int>(std::lround(time.get<double>() * clip.rate));
    return clip.frame_positions(std::min(frame, clip.frame_count() - 1))[hips];
  };
  const auto& first = steps[3];
  const auto& last = steps[steps.size() - 4];
  const double way = static_cast<double>((at(last["end"]) - at(first["start"])).norm());
  EXPECT_NEAR(way / (last["end"].get<double>() - first["start"].get<double>()), 1.2, 0.1);
  EXPECT_NEAR(first["speed"].get<double>(), 1.2, 0.1);
  EXPECT_THAT(walk({"--goal", "0,12m", "--pace", "1.2m/s"}).err, Not(HasSubstr("walk-pace")));
  const ToolRun near = walk({"--goal", "0,1m", "--pace", "4.3km/h", "--strict"});
  EXPECT_EQ(near.exit_code, 1) << near.err;
  EXPECT_THAT(near.err, HasSubstr("[walk-pace]"));
}

}  // namespace
}  // namespace krok::test
