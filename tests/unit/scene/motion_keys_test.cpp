// If these fail, contacts and keytimes that a motion does not have pass for sound, and whoever uses
// them reads joints and times that are not there.

#include "scene/motion_keys.h"

#include <gtest/gtest.h>

#include <limits>

namespace krok {
namespace {

Skeleton two_joints() {
  Skeleton skeleton;
  skeleton.names = {"root", "foot"};
  skeleton.parents = {-1, 0};
  skeleton.reference.resize(2);
  return skeleton;
}

MotionKeys sound_keys() {
  MotionKeys keys;
  keys.contacts = {{1, 0.0, 0.5, Vec3(0, 0, 0.1)}, {1, 1.0, 2.0, Vec3(0, 0, 0.9)}};
  keys.keytimes = {{0.0, "left_strike"}, {0.5, "left_off"}, {2.0, "end"}};
  return keys;
}

std::string code_of_keys(const MotionKeys& keys) {
  const Status status = check(keys, two_joints(), 2.0);
  return status ? "" : status.error().code;
}

TEST(MotionKeys, SoundOnesPass) {
  EXPECT_EQ(code_of_keys(sound_keys()), "");
  EXPECT_EQ(code_of_keys(MotionKeys()), "");
  MotionKeys rounded = sound_keys();
  rounded.contacts[1].end = 2.0004;  // as a file with three digits has it
  EXPECT_EQ(code_of_keys(rounded), "");
}

TEST(MotionKeys, FaultsAreFound) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto code_after = [](const auto& change) {
    MotionKeys keys = sound_keys();
    change(keys);
    return code_of_keys(keys);
  };
  using Keys = MotionKeys;
  EXPECT_EQ(code_after([](Keys& keys) { keys.contacts[0].joint = 2; }), "keys-joint");
  EXPECT_EQ(code_after([](Keys& keys) { keys.contacts[0].joint = -1; }), "keys-joint");
  EXPECT_EQ(code_after([](Keys& keys) { keys.contacts[0].end = -0.5; }), "keys-time");
  EXPECT_EQ(code_after([](Keys& keys) { keys.contacts[1].end = 2.1; }), "keys-time");
  EXPECT_EQ(code_after([&](Keys& keys) { keys.contacts[1].start = nan; }), "keys-time");
  EXPECT_EQ(code_after([&](Keys& keys) { keys.contacts[1].place.y() = nan; }), "keys-place");
  EXPECT_EQ(code_after([](Keys& keys) { keys.keytimes[1].time = 0.0; }), "keys-time");
  EXPECT_EQ(code_after([&](Keys& keys) { keys.keytimes[0].time = nan; }), "keys-time");
  EXPECT_EQ(code_after([](Keys& keys) { keys.keytimes[2].name.clear(); }), "keys-name");
}

TEST(MotionKeys, APartCountsFromItsBeginningAndCutsContacts) {
  MotionKeys keys;
  keys.contacts = {{0, 0.0, 0.5, Vec3(1, 2, 3)},
                   {1, 0.8, 1.6, Vec3::Zero()},
                   {2, 1.5, 1.9, Vec3::Zero()},
                   {3, 0.2, 2.5, Vec3::Zero()}};
  keys.keytimes = {{0.9, "early"}, {1.0, "begin"}, {1.25, "middle"}, {1.5, "end"}, {1.6, "late"}};
  const MotionKeys part = part_of(keys, 1.0, 1.5);
  ASSERT_EQ(part.contacts.size(), 3u);
  EXPECT_EQ(part.contacts[0].joint, 1);
  EXPECT_EQ(part.contacts[0].start, 0);
  EXPECT_EQ(part.contacts[0].end, 0.5);
  EXPECT_EQ(part.contacts[1].joint, 2);
  EXPECT_EQ(part.contacts[1].start, 0.5);
  EXPECT_EQ(part.contacts[2].end, 0.5);
  ASSERT_EQ(part.keytimes.size(), 3u);
  EXPECT_EQ(part.keytimes[0].name, "begin");
  EXPECT_EQ(part.keytimes[0].time, 0);
  EXPECT_EQ(part.keytimes[1].time, 0.25);
  EXPECT_EQ(part.keytimes[2].time, 0.5);
}

}  // namespace
}  // namespace krok
