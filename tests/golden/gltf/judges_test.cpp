// Would fail if a glTF file that the tools write broke the standard, or showed something else in
// three.js than Krok computed: another pose of the joints, another shape of the mesh.

#include <gmock/gmock.h>

#include <array>
#include <nlohmann/json.hpp>

#include "golden/gltf/judges.h"
#include "support/test_scenes.h"

namespace krok {
namespace {

Skeleton human() {
  return test::turned_human();
}

TEST_F(GltfJudges, SkeletonsShowTheJointsOfTheTable) {
  write_clip(test::swinging_clip(human(), 41, 30));
  for (const char* name : {"a.glb", "a.gltf", "--no-bones -o b.glb", "a.csv"}) {
    tool(fmt::format("krok-export in.anim {}{}", *name == '-' ? "" : "-o ", name));
  }
  valid("a.glb a.gltf b.glb");
  for (const char* file : {"a.glb", "a.gltf", "b.glb"}) {
    judge("three_bounds.mjs", fmt::format("{} --joints a.csv --tolerance 2e-6", file));
  }
}

TEST_F(GltfJudges, FewerKeysShowTheJointsOfTheTableWithinTheTolerance) {
  write_clip(test::swinging_clip(human(), 241, 60));
  tool("krok-export in.anim -o a.csv");
  // Still some key in each frame, as the table's rows need it.
  tool("krok-export in.anim -o reduced.glb --reduce 0.2mm");
  tool("krok-export in.anim -o still.glb --reduce 100m");
  valid("reduced.glb still.glb");
  judge("three_bounds.mjs", "reduced.glb --joints a.csv --tolerance 2e-4");
  judge("three_bounds.mjs", "reduced.glb --joints a.csv --tolerance 2e-5", 1);
}

TEST_F(GltfJudges, RigShowsWhatTheBakeShows) {
  write_clip(test::swinging_clip(human(), 41, 30));
  write_model(test::tube_model(human()));
  tool("krok-skin in.model in.anim --as baked -o clip.glb");
  tool("krok-skin in.model in.anim --as rig -o rig.glb");
  tool("krok-skin in.model in.anim --as rig -o rig.gltf");
  tool("krok-export in.anim -o joints.csv");
  valid("clip.glb rig.glb rig.gltf");
  judge("three_bounds.mjs", "rig.glb --against clip.glb --tolerance 1e-5");
  judge("three_bounds.mjs", "rig.gltf --against clip.glb --tolerance 1e-5");
  judge("three_bounds.mjs", "rig.glb --joints joints.csv --tolerance 2e-6");
}

// What --reduce and --quantize lose is measured by Krok alone; three.js has to see no more.
TEST_F(GltfJudges, SmallRigsShowTheBakeWithinTheirTolerance) {
  write_clip(test::swinging_clip(human(), 61, 30));
  write_model(test::tube_model(human()));
  tool("krok-skin in.model in.anim --as baked -o clip.glb");
  tool("krok-skin in.model in.anim --as rig -o rig.glb");
  tool("krok-skin in.model in.anim --as rig --reduce 0.5mm -o reduced.glb");
  tool("krok-skin in.model in.anim --as rig --reduce 0.5mm --quantize -o quantized.glb");
  tool("krok-skin in.model in.anim --as rig --reduce 0.5mm --quantize --compress -o small.glb");
  valid("reduced.glb quantized.glb");
  judge("three_bounds.mjs", "clip.glb --every 1 --against reduced.glb --tolerance 5.1e-4");
  judge("three_bounds.mjs", "clip.glb --every 1 --against reduced.glb --tolerance 1e-4", 1);
  judge("three_bounds.mjs", "clip.glb --every 1 --against quantized.glb --tolerance 5.5e-4");
  // Compression reorders vertices, of the same mesh in the same way.
  tool("krok-skin in.model in.anim --as rig --compress -o packed.glb");
  judge("three_bounds.mjs", "packed.glb --every 1 --against small.glb --tolerance 5.5e-4");
  tool("krok-export in.anim -o joints.csv");
  judge("three_bounds.mjs", "packed.glb --joints joints.csv --tolerance 2e-6");
  EXPECT_LT(content("packed.glb").size(), 0.7 * content("rig.glb").size());
  EXPECT_LT(content("quantized.glb").size(), 0.7 * content("reduced.glb").size());
  EXPECT_LT(content("small.glb").size(), 0.7 * content("quantized.glb").size());
  tool("krok-skin in.model in.anim --as rig --compress -o small.gltf", 2);
  tool("krok-skin in.model in.anim --as baked --reduce 1mm -o small.glb", 2);
  tool("krok-skin in.model in.anim --as rig --reduce 0mm -o small.glb", 2);
}

// three.js reads no second set of influences: with four, it has to show what Krok shows.
TEST_F(GltfJudges, FourInfluencesAreTheLargest) {
  Model model = test::tube_model(human());
  const auto joints = static_cast<std::uint16_t>(model.skeleton.joint_count());
  model.influences_per_vertex = 6;
  model.influence_joints.clear();
  model.influence_weights.clear();
  for (int v = 0; v < model.vertex_count(); ++v) {
    for (int k = 0; k < 6; ++k) {
      model.influence_joints.push_back(static_cast<std::uint16_t>((v + 3 * k) % joints));
      model.influence_weights.push_back(std::array{0.4f, 0.3f, 0.1f, 0.1f, 0.06f, 0.04f}[k]);
    }
  }
  write_clip(test::swinging_clip(human(), 11, 30));
  write_model(model);
  tool("krok-skin in.model in.anim --as rig -o six.glb --json=six.json");
  EXPECT_THAT(content("six.json"), testing::HasSubstr("skin-influences"));
  tool("krok-skin in.model in.anim --as rig --influences 4 -o four.glb --json=four.json");
  EXPECT_THAT(content("four.json"), testing::Not(testing::HasSubstr("skin-influences")));
  tool("krok-skin in.model in.anim --as baked --influences 4 -o four_clip.glb");
  tool("krok-skin in.model in.anim --as baked -o six_clip.glb");
  valid("six.glb four.glb");
  judge("three_bounds.mjs", "four.glb --against four_clip.glb --tolerance 1e-5");
  // The error in the report is what the bakes are apart by.
  const auto report = nlohmann::json::parse(content("four.json"));
  const double error = report["result"]["influences"]["largest_error"];
  EXPECT_GT(error, 1e-3);
  const auto within = [&](double tolerance, int exit_code) {
    judge("three_bounds.mjs",
          fmt::format("four_clip.glb --every 1 --against six_clip.glb --tolerance {}", tolerance),
          exit_code);
  };
  within(1.001 * error + 1e-6, 0);
  within(0.999 * error - 1e-6, 1);
}

TEST_F(GltfJudges, PosesAndFramesShowTheBake) {
  write_clip(test::swinging_clip(human(), 21, 25));
  write_model(test::tube_model(human()));
  tool("krok-skin in.model in.anim --as baked --from 10f --to 10f -o clip.glb");
  tool("krok-skin in.model in.anim --as pose --time 10f -o pose.glb");
  tool("krok-skin in.model in.anim --as frames --from 8f --every 2 --to 12f -o out.glb");
  valid(".");
  judge("three_bounds.mjs", "pose.glb --against clip.glb --tolerance 1e-6");
  judge("three_bounds.mjs", "out_0010.glb --against clip.glb --tolerance 1e-6");
  judge("three_bounds.mjs", "out_0008.glb --against clip.glb --tolerance 1e-3", 1);
}

TEST_F(GltfJudges, ThreadsDoNotChangeTheBytes) {
  write_clip(test::swinging_clip(human(), 5, 25));
  write_model(test::tube_model(human(), 4, 24, 16));  // several tiles of the kernel
  for (const char* as : {"baked", "pose", "rig"}) {
    tool(fmt::format("krok-skin in.model in.anim --as {} -j 1 -o one.glb", as));
    tool(fmt::format("krok-skin in.model in.anim --as {} -j 4 -o four.glb", as));
    EXPECT_EQ(content("one.glb"), content("four.glb")) << as;
    EXPECT_GT(content("one.glb").size(), 10000u);
  }
}

TEST_F(GltfJudges, AClipTooLongToBakeSaysWhatToDo) {
  write_clip(test::swinging_clip(human(), 2200, 30));
  write_model(test::tube_model(human(), 1, 2, 4));
  tool("krok-skin in.model in.anim --as baked -o clip.glb", 2);
  EXPECT_THAT(content("log.txt"), testing::HasSubstr("[skin-clip-too-long]"));
  EXPECT_THAT(content("log.txt"), testing::HasSubstr("--every 2"));
  EXPECT_FALSE(fs::exists(path("clip.glb")));
  tool("krok-skin in.model in.anim --as baked --every 2 -o clip.glb");
  EXPECT_THAT(content("log.txt"), testing::HasSubstr("[skin-many-targets]"));
  valid("clip.glb");
}

TEST_F(GltfJudges, OddFilesAreValid) {
  Skeleton odd = human();
  odd.names[1] = "spine: \"a/b\" [c].d";
  odd.names[2] = "bones_mesh";  // what the mesh's node would like to be called
  odd.names[3] = "\xc5\x99\xc3\xadha";
  for (const int frames : {0, 1, 2}) {
    write_clip(test::swinging_clip(odd, frames, 29.97));
    write_model(test::tube_model(odd, 8));
    const std::string n = std::to_string(frames);
    tool(fmt::format("krok-export in.anim -o export{}.glb", n));
    tool(fmt::format("krok-export in.anim --no-bones -o plain{}.gltf", n));
    tool(fmt::format("krok-skin in.model in.anim --as rig -o rig{}.glb", n));
    tool(fmt::format("krok-skin in.model in.anim --as pose -o pose{}.glb", n));
    tool(fmt::format("krok-skin in.model in.anim --as baked -o clip{}.glb", n), frames > 0 ? 0 : 2);
  }
  Skeleton lone;
  lone.add("only", Skeleton::kNoParent, {});
  write_clip(test::swinging_clip(lone, 3, 10));
  tool("krok-export in.anim -o lone.glb");
  // A figure that does not move at all.
  Clip still;
  still.skeleton = odd;
  still.resize(4);
  for (int f = 0; f < 4; ++f) still.set_pose(f, odd.reference);
  write_clip(still);
  tool("krok-export in.anim -o still.glb");
  tool("krok-export in.anim --no-bones -o still_plain.glb");
  valid(".");
}

TEST_F(GltfJudges, TheJudgesFindFaults) {
  write_clip(test::swinging_clip(human(), 12, 30));
  tool("krok-export in.anim -o a.glb");
  tool("krok-export in.anim -o a.csv");
  replace_in("a.glb", "b.glb", "\"LINEAR\"", "\"LINEAL\"");
  judge("validate_gltf.mjs", "b.glb", 1);
  judge("validate_gltf.mjs", "missing.glb", 2);
  // A joint of the first frame is moved in the table; then it is no number.
  judge("three_bounds.mjs", "a.glb --joints a.csv");
  replace_in("a.csv", "b.csv", "\n0,0,Hips,", "\n0,0,Hips,1");
  judge("three_bounds.mjs", "a.glb --joints b.csv", 1);
  replace_in("a.csv", "c.csv", "\n0,0,Hips,", "\n0,0,Hips,x");
  judge("three_bounds.mjs", "a.glb --joints c.csv", 2);
}

}  // namespace
}  // namespace krok
