// Would fail if a viewer that multiplies the nodes of a glTF file up again put joints elsewhere
// than the motion has them, or interpolated the long way round between two keys.

#include "formats/gltf/joint_tracks.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/test_scenes.h"

namespace krok {
namespace {

using gltf::joint_tracks;
using gltf::JointTracks;
using test::turned_human;

// What a viewer shows at a frame, from the floats in the file.
std::vector<Transform> viewed(const JointTracks& tracks, const Skeleton& skeleton, int frame) {
  std::vector<Transform> pose(skeleton.names.size());
  for (std::size_t j = 0; j < pose.size(); ++j) {
    const auto& track = tracks.joints[j];
    const auto f = static_cast<std::size_t>(frame);
    const Vec3f t = track.translations.empty() ? track.rest_translation : track.translations[f];
    const Quatf r = track.rotations.empty() ? track.rest_rotation : track.rotations[f];
    pose[j] = {t.cast<double>(), r.cast<double>().normalized()};
  }
  local_to_world(skeleton.parents, pose, pose);
  return pose;
}

void expect_shown(const JointTracks& tracks, const Clip& clip) {
  std::vector<Transform> pose(clip.skeleton.names.size());
  for (int f = 0; f < clip.frame_count(); ++f) {
    clip.get_pose(f, pose);
    const auto shown = viewed(tracks, clip.skeleton, f);
    for (std::size_t j = 0; j < pose.size(); ++j) {
      ASSERT_LT((shown[j].position - pose[j].position).norm(), 1.2e-6) << f << " " << j;
      ASSERT_LT(angle_between(shown[j].orientation, pose[j].orientation), 1.2e-6) << f << " " << j;
    }
  }
}

TEST(JointTracks, RigidBonesNeedNoTranslations) {
  const Clip clip = test::swinging_clip(turned_human(), 30, 30);
  const auto tracks = joint_tracks(clip.skeleton, clip);
  ASSERT_TRUE(tracks.ok());
  expect_shown(*tracks, clip);
  for (int j = 0; j < clip.joint_count(); ++j) {
    EXPECT_EQ(tracks->joints[j].translations.empty(), j > 0) << clip.skeleton.names[j];
  }
}

TEST(JointTracks, RoundedOrientationsStillPutJointsInPlace) {
  // As the three stored components of a quaternion leave them: up to 1e-4 rad off.
  Clip clip = test::swinging_clip(turned_human(), 30, 30);
  for (std::size_t i = 0; i < clip.orientations.size(); ++i) {
    const double x = static_cast<double>(i);
    const Quat turn =
        from_rotation_vector(1e-4 * Vec3(std::sin(x), std::cos(2 * x), std::sin(3 * x)));
    clip.orientations[i] = (clip.orientations[i].cast<double>() * turn).cast<float>();
  }
  const auto tracks = joint_tracks(clip.skeleton, clip);
  ASSERT_TRUE(tracks.ok());
  expect_shown(*tracks, clip);
}

TEST(JointTracks, AJointThatMovesInItsParentGetsATranslation) {
  Clip clip = test::swinging_clip(turned_human(), 10, 30);
  const int hand = clip.skeleton.find("LeftHand_end");
  clip.frame_positions(4)[hand].x() += 0.01f;
  const auto tracks = joint_tracks(clip.skeleton, clip);
  ASSERT_TRUE(tracks.ok());
  expect_shown(*tracks, clip);
  for (int j = 1; j < clip.joint_count(); ++j) {
    EXPECT_EQ(tracks->joints[j].translations.empty(), j != hand) << clip.skeleton.names[j];
  }
}

TEST(JointTracks, ALongChainDoesNotDrift) {
  Skeleton chain;
  for (int j = 0; j < 200; ++j) {
    chain.add("j" + std::to_string(j), j - 1, {Vec3(0.05 * j, 1, 0), Quat::Identity()});
  }
  const Clip clip = test::swinging_clip(test::with_turned_joints(chain), 5, 10);
  const auto tracks = joint_tracks(clip.skeleton, clip);
  ASSERT_TRUE(tracks.ok());
  expect_shown(*tracks, clip);
}

TEST(JointTracks, SuccessiveRotationsLieInOneHemisphere) {
  Clip clip = test::swinging_clip(turned_human(), 40, 10);
  for (std::size_t i = 0; i < clip.orientations.size(); i += 3) {
    clip.orientations[i].coeffs() *= -1.0f;
  }
  const auto tracks = joint_tracks(clip.skeleton, clip);
  ASSERT_TRUE(tracks.ok());
  expect_shown(*tracks, clip);
  for (const auto& joint : tracks->joints) {
    for (std::size_t f = 1; f < joint.rotations.size(); ++f) {
      EXPECT_GE(joint.rotations[f].dot(joint.rotations[f - 1]), 0);
    }
  }
}

TEST(JointTracks, AActorAtRestHasNone) {
  Clip clip;
  clip.skeleton = turned_human();
  clip.resize(5);
  for (int f = 0; f < 5; ++f) clip.set_pose(f, clip.skeleton.reference);
  const auto tracks = joint_tracks(clip.skeleton, clip);
  ASSERT_TRUE(tracks.ok());
  EXPECT_EQ(tracks->times.size(), 5u);
  for (const auto& joint : tracks->joints) {
    EXPECT_TRUE(joint.translations.empty());
    EXPECT_TRUE(joint.rotations.empty());
  }
}

TEST(JointTracks, AnotherRestPoseIsBridged) {
  const Clip clip = test::swinging_clip(turned_human(), 6, 30);
  const auto tracks = joint_tracks(test::human_skeleton(1.6), clip);
  ASSERT_TRUE(tracks.ok());
  expect_shown(*tracks, clip);
}

TEST(KeyTimes, AreTheFramesOverTheRate) {
  const double rate = 120 / 1.001;
  const auto times = gltf::key_times(1000, rate);
  ASSERT_TRUE(times.ok());
  EXPECT_EQ(times->front(), 0.0f);
  for (int f = 0; f < 1000; ++f) EXPECT_EQ((*times)[f], static_cast<float>(f / rate));
  EXPECT_TRUE(gltf::key_times(0, 30)->empty());
}

TEST(KeyTimes, RefuseFramesThatFloatsCannotTellApart) {
  for (const double rate : {1e-300, 1e300}) {
    const auto times = gltf::key_times(3, rate);
    ASSERT_FALSE(times.ok()) << rate;
    EXPECT_EQ(times.error().code, "gltf-times");
  }
  EXPECT_TRUE(gltf::key_times(1 << 20, 1e9).ok());
  EXPECT_FALSE(gltf::key_times((1 << 24) + 8, 1.0).ok());
}

// A motion long enough for many blocks, of which the first and a few others are looked at before:
// a short one again and again, so that it does not walk to where floats are coarse.
Clip long_clip() {
  const Clip part = test::swinging_clip(turned_human(), 30, 30);
  Clip clip = part;
  clip.resize(1500);
  for (int f = 0; f < clip.frame_count(); ++f) {
    std::copy_n(part.frame_positions(f % 30).begin(), part.joint_count(),
                clip.frame_positions(f).begin());
    std::copy_n(part.frame_orientations(f % 30).begin(), part.joint_count(),
                clip.frame_orientations(f).begin());
  }
  return clip;
}

bool same(const JointTracks& a, const JointTracks& b) {
  for (std::size_t j = 0; j < a.joints.size(); ++j) {
    if (a.joints[j].translations != b.joints[j].translations) return false;
    if (a.joints[j].rotations.size() != b.joints[j].rotations.size()) return false;
    for (std::size_t f = 0; f < a.joints[j].rotations.size(); ++f) {
      if (a.joints[j].rotations[f].coeffs() != b.joints[j].rotations[f].coeffs()) return false;
    }
  }
  return true;
}

TEST(JointTracks, DoNotDependOnTheNumberOfThreads) {
  const Clip clip = long_clip();
  const auto alone = joint_tracks(clip.skeleton, frames_of(clip), 1);
  ASSERT_TRUE(alone.ok());
  expect_shown(*alone, clip);
  for (const int jobs : {2, 5}) {
    const auto together = joint_tracks(clip.skeleton, frames_of(clip), jobs);
    ASSERT_TRUE(together.ok());
    EXPECT_TRUE(same(*alone, *together)) << jobs;
  }
}

TEST(JointTracks, OneFrameFarFromTheStartIsEnoughForATrack) {
  Clip clip = long_clip();
  const int late = 1111;
  // A spine joint that moves once, with all that hangs on it.
  const int moved = 2;
  std::vector<bool> below(clip.skeleton.names.size(), false);
  for (int j = moved; j < clip.joint_count(); ++j) {
    const int parent = clip.skeleton.parents[j];
    below[j] = j == moved || (parent >= 0 && below[parent]);
    if (below[j]) clip.frame_positions(late)[j] += Vec3f(0, 0.01f, 0);
  }
  const auto tracks = joint_tracks(clip.skeleton, frames_of(clip), 2);
  ASSERT_TRUE(tracks.ok());
  expect_shown(*tracks, clip);
  EXPECT_EQ(tracks->joints[moved].translations.size(), 1500u);
  EXPECT_TRUE(tracks->joints[moved + 1].translations.empty());
}

TEST(JointTracks, SuccessiveRotationsOfLongMotionsLieInOneHemisphere) {
  Clip clip = long_clip();
  for (std::size_t i = 0; i < clip.orientations.size(); i += 3) {
    clip.orientations[i].coeffs() = -clip.orientations[i].coeffs();
  }
  const auto tracks = joint_tracks(clip.skeleton, frames_of(clip), 2);
  ASSERT_TRUE(tracks.ok());
  expect_shown(*tracks, clip);
  for (const auto& joint : tracks->joints) {
    Quatf before = joint.rest_rotation;
    for (const Quatf& rotation : joint.rotations) {
      ASSERT_GE(before.dot(rotation), 0);
      before = rotation;
    }
  }
}

TEST(JointTracks, TheSourceIsToldWhatWasRead) {
  const Clip clip = long_clip();
  for (const int jobs : {1, 3}) {
    FrameSource source = frames_of(clip);
    int released = 0;
    source.release = [&](int frame) {
      EXPECT_TRUE(frame > released || released == clip.frame_count()) << "but for another pass";
      released = frame;
    };
    ASSERT_TRUE(joint_tracks(clip.skeleton, source, jobs).ok());
    EXPECT_EQ(released, clip.frame_count());
  }
}

TEST(JointTracks, PassOnWhatTheSourceSays) {
  const Clip clip = long_clip();
  FrameSource source = frames_of(clip);
  source.read = [&](int first, int, std::span<Vec3f>, std::span<Quatf>) -> Status {
    if (first > 0) return Error("test", "no such frame");
    return {};
  };
  const auto tracks = joint_tracks(clip.skeleton, source, 2);
  ASSERT_FALSE(tracks.ok());
  EXPECT_EQ(tracks.error().code, "test");
}

}  // namespace
}  // namespace krok
