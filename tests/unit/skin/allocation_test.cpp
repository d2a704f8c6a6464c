// Would fail if setting a pose, skinning or morphing took memory: every operator new of this
// program is counted.

#include "skin/morph.h"
#include "skinned.h"
#include "support/counted_allocations.h"

namespace krok::test {
namespace {

TEST(SkinAllocation, IsCounted) {
  const long before = allocations;
  // A call, not an expression, which compilers may leave out.
  ::operator delete(::operator new(3));
  EXPECT_GT(allocations, before);
}

TEST(SkinAllocation, PosesAndVerticesTakeNone) {
  const Model model = random_model(5000, 4, 9, 1);
  const auto pose_of = random_pose(9, 2);
  const auto palette = random_palette(9, 3);
  for (const SkinMethod method : kMethods) {
    const SkinBinding binding(model, method);
    SkinPose pose(binding);
    const SkinSurface in = skin_surface(model);
    Skinned out(in);
    const long before = allocations;
    pose.set(pose_of);
    skin(binding, pose, in, out.view());
    pose.set_palette(palette);
    skin(binding, pose, in, out.view());
    EXPECT_EQ(allocations, before) << static_cast<int>(method);
  }
}

TEST(SkinAllocation, MorphingTakesNone) {
  const Model model = random_model(1000, 1, 2, 4);
  MorphSet morphs;
  morphs.names = {"a"};
  morphs.vertex_count = 1000;
  morphs.positions = model.positions;
  morphs.normals = model.normals;
  Skinned out(skin_surface(model));
  const float weight = 0.5f;
  const long before = allocations;
  apply_morphs(morphs, {&weight, 1}, {model.positions, model.normals},
               {out.positions, out.normals});
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace krok::test
