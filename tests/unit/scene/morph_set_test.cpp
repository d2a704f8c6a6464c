// If these fail, morph targets that do not belong to a mesh, or hold no numbers, pass for sound.

#include "scene/morph_set.h"

#include <gtest/gtest.h>

#include <limits>

namespace krok {
namespace {

MorphSet sound_morphs() {
  MorphSet set;
  set.names = {"smile", "frown"};
  set.vertex_count = 3;
  for (int i = 0; i < 6; ++i) set.positions.emplace_back(static_cast<float>(i), 0.0f, 0.0f);
  set.normals.assign(6, Vec3f::UnitY());
  return set;
}

TEST(MorphSet, ASoundOnePasses) {
  EXPECT_TRUE(check(sound_morphs()).ok());
  EXPECT_TRUE(check(MorphSet()).ok());
  MorphSet plain = sound_morphs();
  plain.normals.clear();
  EXPECT_TRUE(check(plain).ok());
  EXPECT_TRUE(plain.target_normals(1).empty());
}

TEST(MorphSet, TargetsStandOneAfterTheOther) {
  const MorphSet set = sound_morphs();
  EXPECT_EQ(set.find("frown"), 1);
  EXPECT_EQ(set.find("Frown"), -1);
  EXPECT_EQ(set.target_positions(1)[0].x(), 3.0f);
  EXPECT_EQ(set.target_positions(1).size(), 3u);
}

TEST(MorphSet, FaultsAreFound) {
  MorphSet set = sound_morphs();
  set.positions.pop_back();
  EXPECT_EQ(check(set).error().code, "morph-shape");
  set = sound_morphs();
  set.vertex_count = -1;
  EXPECT_EQ(check(set).error().code, "morph-shape");
  set = sound_morphs();
  set.normals.pop_back();
  EXPECT_EQ(check(set).error().code, "morph-shape");
  for (const char* name : {"", "smile", "\xff"}) {
    set = sound_morphs();
    set.names[1] = name;
    EXPECT_EQ(check(set).error().code, "morph-name");
  }
  set = sound_morphs();
  set.positions[2].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(check(set).error().code, "morph-value");
}

}  // namespace
}  // namespace krok
