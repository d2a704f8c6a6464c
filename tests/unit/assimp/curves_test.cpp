// Curves between keys, which Assimp does not read, against an evaluation of the same numbers. If
// these fail, keyframed characters move otherwise than in the program that made them.

#include "unit/assimp/expectations.h"
#include "unit/assimp/sample_curves.h"

namespace krok {
namespace {

using namespace test;

// Rotations hold 0.02 degrees at new keys and between them; twice that for rounding to floats.
constexpr double kTolerance = 2 * 0.02 * kRadiansPerDegree;

const std::vector<TurnCurve>& turn_curves() {
  static const std::vector<TurnCurve> curves = {
      {{0, 1, 1.5}, {0, 200, 150}, {{'l'}, {'b', 300, -100, 0.6, 0.25}}},
      {{0, 0.5, 1.5}, {0, 0, -70}, {{'l'}, {'b', -30, 0}}},
      {{0, 1, 1.5}, {0, 100, 90}, {{'b', 10, 150, 0.4, 0.2}, {'l'}}}};
  return curves;
}

void expect_curves(const std::string& path, const std::vector<TurnCurve>& curves) {
  const auto scene = read_or_fail(path);
  ASSERT_EQ(scene.animations.size(), 1u);
  for (int i = 0; i <= 300; ++i) {
    const double time = i / 200.0 + 1e-4;  // not at a jump
    Mat3 turned = Mat3::Identity();
    for (std::size_t axis = 0; axis < curves.size(); ++axis) {
      const double angle = curves[axis].at(time) * kRadiansPerDegree;
      turned = Eigen::AngleAxisd(angle, Vec3::Unit(static_cast<int>(axis))) * turned;
    }
    const Vec3 tip = node_to_world(scene, "Tip", 0, time).topRightCorner<3, 1>();
    EXPECT_LT((tip / 100 - turned.col(1)).norm(), kTolerance) << path << " at " << time;
  }
}

TEST(FbxCurves, OfSeveralAxes) {
  const Folder folder;
  const FbxTree file = turning_bone(turn_curves());
  for (const std::uint32_t version : {0u, 7400u, 7500u}) {
    const auto path = folder.add(fmt::format("{}.fbx", version), fbx_file(file, version));
    expect_curves(path, turn_curves());
    const auto scene = read_or_fail(path);
    EXPECT_TRUE(has_code(scene.diagnostics, "assimp-curves"));
    for (const char* name : {"Hips", "Tip"}) {
      EXPECT_TRUE(scene.nodes[static_cast<std::size_t>(node_named(scene, name))].bone) << name;
    }
  }
}

TEST(FbxCurves, StepsStaySteps) {
  const Folder folder;
  const std::vector<TurnCurve> curves = {{{0, 0.5, 1.5}, {0, 90, 30}, {{'s'}, {'s'}}}};
  expect_curves(folder.add("step.fbx", fbx_file(turning_bone(curves), 7400)), curves);
}

// A damaged file is read as Assimp reads it, or refused; no count or end leads out of it.
TEST(FbxCurves, DamagedFiles) {
  const Folder folder;
  const std::string file = fbx_file(turning_bone(turn_curves()), 7400);
  for (std::size_t size = 0; size < file.size(); size += 97) {
    (void)assimp::read_file(folder.add("short.fbx", file.substr(0, size)));
  }
  for (std::size_t place = 27; place < file.size(); place += 41) {
    std::string damaged = file;
    damaged[place] = static_cast<char>(damaged[place] ^ 0xff);
    (void)assimp::read_file(folder.add("damaged.fbx", damaged));
  }
}

TEST(FbxCurves, BakedKeysStayAsTheyAre) {
  const Folder folder;
  TurnCurve x, z;
  for (int k = 0; k < 10; ++k) {
    for (TurnCurve* curve : {&x, &z}) {
      curve->times.push_back(k / 30.0);
      curve->values.push_back(k % 3 * 60.0);
      if (k < 9) curve->gaps.push_back({'b', 900, -900});
    }
  }
  const auto file = turning_bone({x, TurnCurve{{0}, {0}, {}}, z});
  const auto scene = read_or_fail(folder.add("baked.fbx", fbx_file(file, 0)));
  EXPECT_EQ(scene.animations.at(0).channels.at(0).times->size(), 10u);
  EXPECT_FALSE(has_code(scene.diagnostics, "assimp-curves"));
}

TEST(ColladaCurves, OfSeveralAxes) {
  const Folder folder;
  const MovingRig rig;
  std::string text = collada(rig);
  const auto path = folder.add("linear.dae", text);
  // The same with the curve about x as a spline that overshoots, and that about z in steps.
  const auto replace = [&](const std::string& id, const std::string& from, const std::string& to) {
    const std::size_t begin = text.find("<animation id=\"" + id + "\">");
    for (std::size_t at = text.find(from, begin); at < text.find("</animation>", begin);
         at = text.find(from, at + to.size())) {
      text.replace(at, from.size(), to);
    }
  };
  replace("spine-X", "LINEAR", "BEZIER");
  replace("spine-Z", "LINEAR", "STEP");
  std::string points;
  TurnCurve x, y, z;
  const std::vector<double> times = {0, 0.1, 0.4, 0.6};
  for (std::size_t k = 0; k < times.size(); ++k) {
    for (const auto& [curve, axis, kind] :
         {std::tuple(&x, 0, 'b'), std::tuple(&y, 1, 'l'), std::tuple(&z, 2, 's')}) {
      curve->times.push_back(times[k]);
      curve->values.push_back(rig.frames[k][1].angles[axis] / kRadiansPerDegree);
      if (k < 3) curve->gaps.push_back({kind, 200, 200, 0.3, 0.3});
    }
  }
  y.times.pop_back();  // as the sample
  y.values.pop_back();
  y.gaps.pop_back();
  std::string into = "0 0 ", out;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto polygon = x.polygon(k);
    out += fmt::format("{} {} ", polygon[1][0], polygon[1][1]);
    into += fmt::format("{} {} ", polygon[2][0], polygon[2][1]);
  }
  std::string sources, inputs;
  for (const auto& [name, list] : {std::pair("IN", into), std::pair("OUT", out + "0 0")}) {
    sources += collada_source(fmt::format("{}-t", name), "X Y", list, 4, 2, "float", "float_array");
    inputs += fmt::format("<input semantic=\"{0}_TANGENT\" source=\"#{0}-t\"/>", name);
  }
  replace("spine-X", "<sampler id=\"spine-X-sampler\">",
          sources + "<sampler id=\"spine-X-sampler\">" + inputs);
  const auto splines = folder.add("splines.dae", text);
  for (const auto& [file, straight] : {std::pair(path, true), std::pair(splines, false)}) {
    const auto scene = read_or_fail(file);
    for (int i = 0; i < 120; ++i) {
      const double time = i / 200.0 + 1e-4;
      Pose pose = rig.rest[1];
      for (const auto& [curve, axis] : {std::pair(x, 0), std::pair(y, 1), std::pair(z, 2)}) {
        TurnCurve own = curve;
        if (straight) own.gaps.assign(3, {});
        pose.angles[axis] = own.at(time) * kRadiansPerDegree;
      }
      const Mat4 hips = node_to_world(scene, "Hips", 0, time);
      const Mat4 spine = hips.inverse() * node_to_world(scene, "Spine", 0, time);
      expect_near(spine, pose.transform().matrix(), kTolerance, fmt::format("{} {}", file, time));
    }
  }
}

// The importer keeps a sampler's last channel: the other axes of an even scale or of a diagonal
// would rest.
TEST(ColladaCurves, OneSamplerForTwoChannels) {
  const Folder folder;
  const MovingRig rig;
  for (const bool spline : {false, true}) {
    std::string text = collada(rig);
    const std::string channel = "<channel source=\"#spine-X-sampler\" target=\"rig_Spine/rotate";
    const std::size_t old = text.find("<channel source=\"#spine-Z-sampler\"");
    text.erase(old, text.find("/>", old) + 2 - old);
    text.insert(text.find(channel), channel + "Z.ANGLE\"/>");
    if (spline) text.replace(text.find("LINEAR", text.find("id=\"spine-X-interp")), 6, "STEP");
    const auto scene = read_or_fail(folder.add("shared.dae", text));
    for (const double time : {0.05, 0.3}) {
      Pose pose = rig.rest[1];
      for (const int axis : {0, 1, 2}) {
        const std::size_t key = time < 0.1 ? 0 : 1;
        const int from = axis == 1 ? 1 : 0;
        const double part = time < 0.1 ? (spline && axis != 1 ? 0 : 0.5) : 2.0 / 3;
        pose.angles[axis] = (1 - part) * rig.frames[key][1].angles[from] +
                            part * rig.frames[key + 1][1].angles[from];
      }
      const Mat4 hips = node_to_world(scene, "Hips", 0, time);
      const Mat4 spine = hips.inverse() * node_to_world(scene, "Spine", 0, time);
      expect_near(spine, pose.transform().matrix(), kTolerance, fmt::format("{}", time));
    }
  }
}

}  // namespace
}  // namespace krok
