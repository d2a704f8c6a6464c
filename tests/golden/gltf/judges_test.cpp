// Would fail if a glTF file that the tools write broke the standard, or showed something else in
// three.js than Krok computed: another pose of the joints, another shape of the mesh.

#include <gmock/gmock.h>

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
  tool("krok-skin in.model in.anim -o clip.glb");
  tool("krok-skin in.model in.anim --as rig -o rig.glb");
  tool("krok-skin in.model in.anim --as rig -o rig.gltf");
  tool("krok-export in.anim -o joints.csv");
  valid("clip.glb rig.glb rig.gltf");
  judge("three_bounds.mjs", "rig.glb --against clip.glb --tolerance 1e-5");
  judge("three_bounds.mjs", "rig.gltf --against clip.glb --tolerance 1e-5");
  judge("three_bounds.mjs", "rig.glb --joints joints.csv --tolerance 2e-6");
}

TEST_F(GltfJudges, PosesAndFramesShowTheBake) {
  write_clip(test::swinging_clip(human(), 21, 25));
  write_model(test::tube_model(human()));
  tool("krok-skin in.model in.anim --from 10f --to 10f -o clip.glb");
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
  for (const char* as : {"clip", "pose", "rig"}) {
    tool(fmt::format("krok-skin in.model in.anim --as {} -j 1 -o one.glb", as));
    tool(fmt::format("krok-skin in.model in.anim --as {} -j 4 -o four.glb", as));
    EXPECT_EQ(content("one.glb"), content("four.glb")) << as;
    EXPECT_GT(content("one.glb").size(), 10000u);
  }
}

TEST_F(GltfJudges, AClipTooLongToBakeSaysWhatToDo) {
  write_clip(test::swinging_clip(human(), 2200, 30));
  write_model(test::tube_model(human(), 1, 2, 4));
  tool("krok-skin in.model in.anim -o clip.glb", 2);
  EXPECT_THAT(content("log.txt"), testing::HasSubstr("[skin-clip-too-long]"));
  EXPECT_THAT(content("log.txt"), testing::HasSubstr("--every 2"));
  EXPECT_FALSE(fs::exists(path("clip.glb")));
  tool("krok-skin in.model in.anim --every 2 -o clip.glb");
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
    tool(fmt::format("krok-skin in.model in.anim --as clip -o clip{}.glb", n), frames > 0 ? 0 : 2);
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
