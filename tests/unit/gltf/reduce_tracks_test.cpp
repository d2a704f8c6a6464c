// Would fail if a glTF file with fewer keys showed another motion than its tolerance allows, ended
// early, or came out larger than the one with all keys.

#include "formats/gltf/joint_tracks.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/file.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/gltf/reduce_for_mesh.h"
#include "math/quaternion.h"
#include "nodes/evaluate.h"
#include "support/folder_test.h"
#include "support/test_scenes.h"

namespace krok {
namespace {

class ReduceTracks : public test::FolderTest {
 protected:
  // Writes the tracks, reads the file back, and gives its size.
  std::size_t write(const Skeleton& skeleton, const gltf::JointTracks& tracks,
                    nodes::Scene& scene) {
    const std::string name = path("motion.glb");
    auto file = OutputFile::create(name);
    EXPECT_TRUE(file.ok());
    EXPECT_TRUE(gltf::write_skeleton(skeleton, tracks, {}, *file).ok());
    EXPECT_TRUE(file->commit().ok());
    auto read = gltf::read_file(name);
    EXPECT_TRUE(read.ok()) << read.error().message;
    scene = *std::move(read);
    return get(name).size();
  }
};

// The furthest that a joint or a point 3 cm beside it is off, at four moments a frame.
double largest_error(const nodes::Scene& all, const nodes::Scene& reduced, double duration,
                     int moments) {
  const auto a = nodes::Evaluator::create(all), b = nodes::Evaluator::create(reduced);
  nodes::Evaluation x, y;
  double worst = 0;
  for (int i = 0; i <= moments; ++i) {
    a->place_nodes(0, duration * i / moments, x);
    b->place_nodes(0, duration * i / moments, y);
    for (std::size_t n = 0; n < x.node_to_world.size(); ++n) {
      for (const Vec3& point :
           {Vec3(0, 0, 0), Vec3(0.03, 0, 0), Vec3(0, 0.03, 0), Vec3(0, 0, -0.03)}) {
        const Vec4 place = point.homogeneous();
        worst = std::max(worst, (x.node_to_world[n] * place - y.node_to_world[n] * place).norm());
      }
    }
  }
  return worst;
}

TEST_F(ReduceTracks, ShowsTheSameMotionWithinTheToleranceInASmallerFile) {
  const Clip clip = test::swinging_clip(test::turned_human(), 300, 60);
  auto tracks = gltf::joint_tracks(clip.skeleton, clip);
  ASSERT_TRUE(tracks.ok());
  nodes::Scene all, reduced;
  const std::size_t size = write(clip.skeleton, *tracks, all);
  for (const double tolerance : {1e-4, 1e-3, 1e-2}) {
    gltf::JointTracks fewer = *tracks;
    const auto reduction = gltf::reduce_tracks(clip.skeleton, {.tolerance = tolerance}, 2, fewer);
    ASSERT_TRUE(reduction.ok());
    EXPECT_LE(reduction->largest_error, tolerance);
    EXPECT_LT(write(clip.skeleton, fewer, reduced), tolerance < 1e-3 ? size : size * 3 / 4)
        << tolerance;
    EXPECT_LE(largest_error(all, reduced, clip.duration(), 4 * 299), 1.02 * tolerance);
    std::size_t keys = 0, before = 0;
    for (const gltf::JointTrack& track : fewer.joints)
      keys += track.rotations.size() + track.translations.size();
    for (const gltf::JointTrack& track : tracks->joints)
      before += track.rotations.size() + track.translations.size();
    EXPECT_EQ(reduction->keys_after, keys);
    EXPECT_EQ(reduction->keys_before, before);
  }
}

// What is attached to a joint turns with it, whether or not the joint moves a vertex.
TEST_F(ReduceTracks, JointsWithoutVerticesKeepTheirRotations) {
  Model model = test::tube_model(test::human_skeleton(), 1, 12, 12);
  std::ranges::fill(model.influence_joints, std::uint16_t{0});
  const Clip clip = test::swinging_clip(model.skeleton, 60, 30);
  const auto tracks = gltf::joint_tracks(clip.skeleton, clip);
  ASSERT_TRUE(tracks.ok());
  nodes::Scene all, reduced;
  write(clip.skeleton, *tracks, all);
  gltf::JointTracks fewer = *tracks;
  const gltf::TrackedMesh mesh{model};
  const double tolerance = 1e-3;
  ASSERT_TRUE(gltf::reduce_for_mesh(mesh, mesh, {tolerance, true, true}, 2, fewer).ok());
  write(clip.skeleton, fewer, reduced);
  EXPECT_LE(largest_error(all, reduced, clip.duration(), 2 * 59), 4 * tolerance);
}

TEST_F(ReduceTracks, NeverMakesAFileMuchLarger) {
  // Noise from frame to frame: nothing can go.
  Clip clip = test::swinging_clip(test::human_skeleton(), 50, 30);
  for (std::size_t i = 0; i < clip.orientations.size(); ++i) {
    const double noise = 0.05 * std::sin(12.9898 * static_cast<double>(i * i));
    clip.orientations[i] =
        clip.orientations[i] * from_rotation_vector(Vec3(noise, -noise, 0)).cast<float>();
  }
  auto tracks = gltf::joint_tracks(clip.skeleton, clip);
  ASSERT_TRUE(tracks.ok());
  nodes::Scene scene;
  const std::size_t size = write(clip.skeleton, *tracks, scene);
  for (const double tolerance : {1e-6, 1e-4, 1e-3}) {
    gltf::JointTracks fewer = *tracks;
    ASSERT_TRUE(gltf::reduce_tracks(clip.skeleton, {.tolerance = tolerance}, 1, fewer).ok());
    EXPECT_LE(write(clip.skeleton, fewer, scene), size) << tolerance;
  }
}

TEST_F(ReduceTracks, AnActorThatStandsStillLastsAsLong) {
  Clip clip;
  clip.skeleton = test::human_skeleton();
  clip.rate = 10;
  clip.resize(31);
  std::vector<Transform> pose = clip.skeleton.reference;
  for (const double angle : {0.4, 0.0}) {  // 0: at rest, where no track is needed but for the time
    pose[3].orientation = from_rotation_vector(Vec3(angle, 0, 0));
    for (int f = 0; f < 31; ++f) clip.set_pose(f, pose);
    auto tracks = gltf::joint_tracks(clip.skeleton, clip);
    ASSERT_TRUE(tracks.ok());
    nodes::Scene all, fewer;
    write(clip.skeleton, *tracks, all);
    ASSERT_TRUE(gltf::reduce_tracks(clip.skeleton, {.tolerance = 1e-3}, 1, *tracks).ok());
    write(clip.skeleton, *tracks, fewer);
    ASSERT_EQ(fewer.animations.size(), 1U) << angle;
    EXPECT_LE(fewer.animations[0].channels.size(), all.animations[0].channels.size()) << angle;
    double end = 0;
    for (const nodes::Channel& channel : fewer.animations[0].channels) {
      end = std::max(end, static_cast<double>(channel.times->back()));
    }
    EXPECT_NEAR(end, 3, 1e-6) << angle;
    EXPECT_LE(largest_error(all, fewer, 3, 7), 1e-3) << angle;
  }
}

// The neck turns by `angle` radians every third frame, from `rest` radians off its rest pose.
Clip nodding(double angle, double rest) {
  Clip clip = test::swinging_clip(test::human_skeleton(), 60, 30);
  std::vector<Transform> pose(clip.skeleton.names.size());
  const auto neck = static_cast<std::size_t>(clip.skeleton.find("Neck"));
  const auto parent = static_cast<std::size_t>(clip.skeleton.parents[neck]);
  const Transform to_parent =
      clip.skeleton.reference[parent].inverse() * clip.skeleton.reference[neck];
  for (int f = 0; f < clip.frame_count(); ++f) {
    clip.get_pose(f, pose);
    pose[neck] = pose[parent] * to_parent;
    const Vec3 turn(rest + angle * (f % 3), 0, 0);
    pose[neck].orientation = pose[neck].orientation * from_rotation_vector(turn);
    clip.set_pose(f, pose);
  }
  return clip;
}

// Would fail if a joint that does not leave its rest pose visibly had keys, or another pose.
TEST_F(ReduceTracks, JointsThatStayAtRestHaveNoTracks) {
  for (const double angle : {1e-5, 1e-3}) {
    const Clip clip = nodding(angle, 0);
    const auto neck = static_cast<std::size_t>(clip.skeleton.find("Neck"));
    auto tracks = gltf::joint_tracks(clip.skeleton, clip);
    ASSERT_TRUE(tracks.ok());
    ASSERT_FALSE(tracks->joints[neck].rotations.empty());
    nodes::Scene all, fewer;
    write(clip.skeleton, *tracks, all);
    ASSERT_TRUE(gltf::reduce_tracks(clip.skeleton, {.tolerance = 1e-3}, 1, *tracks).ok());
    EXPECT_TRUE(tracks->joints[neck].rotations.empty()) << angle;
    write(clip.skeleton, *tracks, fewer);
    EXPECT_LE(largest_error(all, fewer, clip.duration(), 240), 1e-3) << angle;
  }
}

// Would fail if a joint that all clips keep bent had a track in each.
TEST_F(ReduceTracks, ARestIsWhatTheClipsKeep) {
  const Clip clips[] = {nodding(0, 0.2), nodding(1e-4, 0.2), nodding(0.3, 0)};
  const Skeleton& skeleton = clips[0].skeleton;
  const auto neck = static_cast<std::size_t>(skeleton.find("Neck"));
  std::vector<gltf::JointTracks> tracks;
  for (const Clip& clip : clips) tracks.push_back(*gltf::joint_tracks(skeleton, clip));
  const std::vector<gltf::JointTracks> before = tracks;
  gltf::choose_rest(test::tube_model(skeleton), 1e-3, tracks);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    ASSERT_TRUE(gltf::reduce_tracks(skeleton, {.tolerance = 1e-3}, 1, tracks[i]).ok());
    EXPECT_EQ(tracks[i].joints[neck].rotations.empty(), i < 2) << i;
    nodes::Scene all, fewer;
    write(skeleton, before[i], all);
    write(skeleton, tracks[i], fewer);
    EXPECT_LE(largest_error(all, fewer, clips[i].duration(), 240), 1e-3) << i;
  }
}

TEST_F(ReduceTracks, SuccessiveRotationsThatStayLieInOneHemisphere) {
  const Clip clip = test::swinging_clip(test::turned_human(), 300, 60);
  auto tracks = gltf::joint_tracks(clip.skeleton, clip);
  ASSERT_TRUE(tracks.ok());
  ASSERT_TRUE(gltf::reduce_tracks(clip.skeleton, {.tolerance = 0.05}, 1, *tracks).ok());
  for (const gltf::JointTrack& track : tracks->joints) {
    for (std::size_t k = 1; k < track.rotations.size(); ++k) {
      EXPECT_GE(track.rotations[k].dot(track.rotations[k - 1]), 0);
    }
  }
}

TEST_F(ReduceTracks, OfNoFramesIsNothingAndNoToleranceAnError) {
  gltf::JointTracks tracks = gltf::rest_tracks(test::human_skeleton());
  EXPECT_TRUE(gltf::reduce_tracks(test::human_skeleton(), {.tolerance = 1e-3}, 1, tracks).ok());
  const auto refused = gltf::reduce_tracks(test::human_skeleton(), {.tolerance = 0}, 1, tracks);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, "reduce-tolerance");
}

}  // namespace
}  // namespace krok
