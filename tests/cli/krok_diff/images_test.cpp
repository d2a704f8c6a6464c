// If these fail, the picture of a difference points at the wrong place, or at none.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cli/fixture.h"
#include "cli/kept_files.h"
#include "formats/anim/anim.h"
#include "math/quaternion.h"
#include "support/glb_builder.h"
#include "support/image.h"

namespace krok::test {
namespace {

class KrokDiffImages : public CliTest {
 protected:
  // A mast with two arms along x; the figure faces +Z.
  static Clip clip() {
    Clip clip;
    clip.rate = 10;
    const auto at = [](double x, double y) { return Transform{Vec3(x, y, 0), Quat::Identity()}; };
    clip.skeleton.add("base", -1, at(0, 0.05));
    clip.skeleton.add("mast", 0, at(0, 1));
    clip.skeleton.add("one", 1, at(0.8, 1));
    clip.skeleton.add("other", 1, at(-0.8, 1));
    clip.resize(5);
    for (int frame = 0; frame < 5; ++frame) clip.set_pose(frame, clip.skeleton.reference);
    return clip;
  }
  std::string write(const std::string& name, const Clip& clip) const {
    auto file = OutputFile::create(path(name));
    EXPECT_TRUE(file.ok() && anim::write(clip, {}, *file).ok() && file->commit().ok());
    return path(name);
  }
  // Frame 3 of the second has one arm 6 cm higher.
  std::string changed() const {
    Clip other = clip();
    other.frame_positions(3)[2].y() += 0.06F;
    return write("b.anim", other);
  }
  ToolRun diff(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--sheet", path("d.png")});
    return run_tool("krok-diff", arguments);
  }
  render::Image image() const {
    auto image = image_of(get(path("d.png")));
    EXPECT_TRUE(image.ok());
    return image ? std::move(*image) : render::Image();
  }
  // Pixels that are red, as the largest differences are, within a part of the picture.
  static int red_pixels(const render::Image& image, int left, int right, int top, int bottom) {
    int count = 0;
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x) {
        const render::Colour colour = image.at(x, y);
        count += colour.red > colour.green + 70 && colour.red > colour.blue + 70 ? 1 : 0;
      }
    }
    return count;
  }
};

TEST_F(KrokDiffImages, TheMomentThatDiffersIsShownAndTheJointIsRed) {
  const ToolRun run = diff({write("a.anim", clip()), changed(), "--view", "front", "--moments",
                            "0f", "--actor-size", "200"});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  const auto drawn = image();
  // Two columns: frame 0, which was asked for, and frame 3; three rows and the key. The joint that
  // moved is to the right in the second column of the last row.
  const int key = drawn.height - 70;
  const int row = key * 2 / 3;
  const int middle = 62 + (drawn.width - 62 - 16) / 2;
  const int moved = red_pixels(drawn, middle, drawn.width, row, key);
  EXPECT_GT(moved, 15);
  EXPECT_EQ(red_pixels(drawn, 62, middle, row + 40, key - 40), 0) << "frame 0 is the same";
  const int arm = middle + (drawn.width - 16 - middle) * 6 / 10;
  EXPECT_EQ(red_pixels(drawn, middle, arm, row + 30, key - 45), 0) << "the rest did not move";
}

TEST_F(KrokDiffImages, TheSameIsGreyAndExitCodeZero) {
  const std::string a = write("a.anim", clip());
  const ToolRun run = diff({a, a, "--view", "front", "--actor-size", "200"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto drawn = image();
  EXPECT_EQ(red_pixels(drawn, 62, drawn.width, drawn.height / 3 + 40, drawn.height - 80), 0);
}

TEST_F(KrokDiffImages, DrawsModelsToo) {
  const ToolRun run = diff({kFrozen + "full.model", kFrozen + "full.model", "--actor-size", "100"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_GT(image().height, 300);
}

TEST_F(KrokDiffImages, DrawsGlbFiles) {
  const std::string motion = kFrozen + "motion.anim";
  ASSERT_EQ(run_tool("krok-export", {motion, "-o", path("a.glb")}).exit_code, 0);
  const ToolRun run = diff({path("a.glb"), path("a.glb"), "--actor-size", "100", "--moments", "2"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_GT(image().height, 300);
}

// Would fail if a page about other materials showed two characters that look alike.
TEST_F(KrokDiffImages, WithMaterialsBothAreInTheirColours) {
  const auto coloured = [&](const char* name, const std::vector<double>& colour) {
    GlbBuilder builder = square();
    builder.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", colour}}}}};
    builder.json["meshes"][0]["primitives"][0]["material"] = 0;
    const auto bytes = builder.glb();
    put(name, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    return path(name);
  };
  const std::string grey = coloured("grey.glb", {0.5, 0.5, 0.5, 1});
  const std::string red = coloured("red.glb", {0.8, 0.02, 0.02, 1});
  EXPECT_EQ(diff({grey, red, "--view", "front", "--actor-size", "200"}).exit_code, 0);
  const auto plain = image();
  EXPECT_EQ(red_pixels(plain, 0, plain.width, 0, plain.height - 70), 0);
  EXPECT_EQ(diff({grey, red, "--materials", "--view", "front", "--actor-size", "200"}).exit_code,
            1);
  const auto dressed = image();
  EXPECT_GT(red_pixels(dressed, 0, dressed.width, 0, dressed.height - 70), 1000);
}

TEST_F(KrokDiffImages, SkeletonsThatDifferAreDrawnWithoutDistances) {
  Clip other = clip();
  other.skeleton.names[3] = "third";
  const ToolRun run = diff(
      {write("a.anim", clip()), write("c.anim", other), "--actor-size", "100", "--moments", "1"});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_GT(image().height, 300);
}

TEST_F(KrokDiffImages, PlotsTheDifferenceOverTime) {
  const ToolRun run =
      run_tool("krok-diff", {write("a.anim", clip()), changed(), "--plot", path("d.svg")});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  const std::string svg = get(path("d.svg"));
  EXPECT_THAT(svg, HasSubstr("<svg"));
  EXPECT_THAT(svg, HasSubstr("a.anim"));
  EXPECT_THAT(svg, HasSubstr("mm"));
}

TEST_F(KrokDiffImages, RefusesWhatItCannotDraw) {
  const std::string a = write("a.anim", clip());
  const std::string camera = kFrozen + "camera.cam";
  const std::string model = kFrozen + "full.model";
  const std::vector<std::vector<std::string>> wrong = {
      {camera, camera, "--sheet", path("d.png")},
      {model, model, "--plot", path("d.svg")},
      {a, a, "--sheet", path("d.svg")},
      {a, a, "--plot", path("d.txt")},
      {a, a, "--actor-size", "100"},
      {a, a, "--sheet", path("d.png"), "--actor-size", "1"},
      {a, a, "--sheet", path("d.png"), "--moments", "77f"}};
  for (const auto& arguments : wrong) {
    const ToolRun run = run_tool("krok-diff", arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments[2] << arguments[3];
    EXPECT_THAT(run.err, HasSubstr("error: "));
    EXPECT_THAT(listing(), ElementsAre("a.anim"));
  }
}

}  // namespace
}  // namespace krok::test
