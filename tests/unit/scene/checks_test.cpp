// If these fail, broken data passes the gate that readers and tools rely on, or good data does not.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "scene/camera_track.h"
#include "scene/clip.h"
#include "scene/model.h"
#include "scene/skeleton.h"
#include "support/special_values.h"

namespace krok {
namespace {

using test::kNan;
using test::kNanF;

// Breaks one promise of a good value and names the code that must come.
template <typename T>
struct Breach {
  const char* promise;
  const char* code;
  std::function<void(T&)> breaking;
};

template <typename T>
void expect_refused(const T& good, const std::vector<Breach<T>>& breaches) {
  ASSERT_TRUE(check(good).ok()) << check(good).error().message;
  for (const auto& breach : breaches) {
    T bad = good;
    breach.breaking(bad);
    const Status status = check(bad);
    ASSERT_FALSE(status.ok()) << breach.promise;
    EXPECT_EQ(status.error().code, breach.code) << breach.promise;
    EXPECT_FALSE(status.error().message.empty());
  }
}

Skeleton good_skeleton() {
  Skeleton s;
  s.add("hips", -1, {});
  s.add("spine", 0, {Vec3(0, 0.5, 0), Quat::Identity()});
  s.add("leg", 0, {Vec3(0, -0.5, 0), Quat::Identity()});
  s.add("leg_end", 2, {Vec3(0, -1, 0), Quat::Identity()}, true);
  return s;
}

TEST(CheckSkeleton, RefusesEachBrokenPromise) {
  expect_refused<Skeleton>(
      good_skeleton(),
      {{"same lengths", "skeleton-shape", [](Skeleton& s) { s.parents.pop_back(); }},
       {"same lengths", "skeleton-shape", [](Skeleton& s) { s.end_sites.pop_back(); }},
       {"same lengths", "skeleton-shape", [](Skeleton& s) { s.reference.pop_back(); }},
       {"joints", "skeleton-shape", [](Skeleton& s) { s = {}; }},
       {"names", "skeleton-name", [](Skeleton& s) { s.names[1].clear(); }},
       {"unique names", "skeleton-name", [](Skeleton& s) { s.names[1] = "hips"; }},
       {"UTF-8", "skeleton-name", [](Skeleton& s) { s.names[1] = "K\xf6rper"; }},
       {"a root", "skeleton-parent", [](Skeleton& s) { s.parents[0] = 0; }},
       {"one root", "skeleton-parent", [](Skeleton& s) { s.parents[1] = -1; }},
       {"parents first", "skeleton-parent", [](Skeleton& s) { s.parents[1] = 2; }},
       {"no own parent", "skeleton-parent", [](Skeleton& s) { s.parents[1] = 1; }},
       {"valid parent", "skeleton-parent", [](Skeleton& s) { s.parents[3] = 99; }},
       {"leaf end sites", "skeleton-parent", [](Skeleton& s) { s.end_sites[2] = 1; }},
       {"finite", "skeleton-value", [](Skeleton& s) { s.reference[1].position.x() = kNan; }},
       {"finite", "skeleton-value",
        [](Skeleton& s) { s.reference[1].orientation.coeffs().x() = kNan; }},
       {"unit", "skeleton-value", [](Skeleton& s) { s.reference[1].orientation.coeffs() *= 1.1; }},
       {"unit", "skeleton-value",
        [](Skeleton& s) { s.reference[1].orientation.coeffs().setZero(); }}});
}

TEST(CheckClip, RefusesEachBrokenPromise) {
  Clip clip;
  clip.skeleton = good_skeleton();
  ASSERT_TRUE(check(clip).ok()) << "a clip without frames";
  clip.resize(3);
  expect_refused<Clip>(
      clip,
      {{"skeleton", "skeleton-name", [](Clip& c) { c.skeleton.names[0].clear(); }},
       {"same lengths", "clip-shape", [](Clip& c) { c.positions.pop_back(); }},
       {"same lengths", "clip-shape", [](Clip& c) { c.orientations.pop_back(); }},
       {"whole frames", "clip-shape",
        [](Clip& c) {
          c.positions.pop_back();
          c.orientations.pop_back();
        }},
       {"rate", "clip-rate", [](Clip& c) { c.rate = 0; }},
       {"rate", "clip-rate", [](Clip& c) { c.rate = -30; }},
       {"rate", "clip-rate", [](Clip& c) { c.rate = kNan; }},
       {"rate", "clip-rate", [](Clip& c) { c.rate = std::numeric_limits<double>::infinity(); }},
       {"rate", "clip-rate", [](Clip& c) { c.rate = 1e300; }},
       {"rate", "clip-rate", [](Clip& c) { c.rate = 5e-324; }},
       {"finite", "clip-value", [](Clip& c) { c.positions[5].y() = kNanF; }},
       {"finite", "clip-value", [](Clip& c) { c.orientations[5].coeffs().y() = kNanF; }},
       {"unit", "clip-value", [](Clip& c) { c.orientations[5].coeffs() *= 0.99f; }}});
}

TEST(CheckClip, NamesJointAndFrame) {
  Clip clip;
  clip.skeleton = good_skeleton();
  clip.resize(3);
  clip.positions[4 + 1].x() = kNanF;
  const Status status = check(clip);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().joint, "spine");
  EXPECT_EQ(status.error().frame, 1);
}

Model good_model() {
  Model m;
  m.skeleton = good_skeleton();
  m.positions = {Vec3f(0, 0, 0), Vec3f(1, 0, 0), Vec3f(0, 1, 0), Vec3f(0, 0, 1)};
  m.normals.assign(4, Vec3f::UnitY());
  m.texture_coordinates.assign(4, Vec2f(0.5f, 0.5f));
  m.tangents.assign(4, Vec4f(1, 0, 0, 1));
  m.influences_per_vertex = 2;
  for (int v = 0; v < 4; ++v) {
    m.influence_joints.insert(m.influence_joints.end(), {2, 1});
    m.influence_weights.insert(m.influence_weights.end(), {0.75f, 0.25f});
  }
  m.triangles = {{0, 1, 2}, {0, 2, 3}};
  m.parts = {{"a", "", 0, 1}, {"b", "", 1, 1}};
  return m;
}

TEST(CheckModel, RefusesEachBrokenPromise) {
  expect_refused<Model>(
      good_model(),
      {{"skeleton", "skeleton-shape", [](Model& m) { m.skeleton = {}; }},
       {"normals", "model-shape", [](Model& m) { m.normals.pop_back(); }},
       {"texture coordinates", "model-shape", [](Model& m) { m.texture_coordinates.pop_back(); }},
       {"tangents", "model-shape", [](Model& m) { m.tangents.pop_back(); }},
       {"influences", "model-shape", [](Model& m) { m.influence_joints.pop_back(); }},
       {"influences", "model-shape", [](Model& m) { m.influence_weights.pop_back(); }},
       {"influences", "model-shape", [](Model& m) { m.influences_per_vertex = 0; }},
       {"influences", "model-shape", [](Model& m) { m.influences_per_vertex = 9; }},
       {"joint index", "model-index", [](Model& m) { m.influence_joints[3] = 4; }},
       {"vertex index", "model-index", [](Model& m) { m.triangles[1][2] = 4; }},
       {"sum of weights", "model-weight", [](Model& m) { m.influence_weights[0] = 0.7f; }},
       {"positive weights", "model-weight",
        [](Model& m) {
          m.influence_weights[0] = 1.25f;
          m.influence_weights[1] = -0.25f;
        }},
       {"finite weights", "model-weight", [](Model& m) { m.influence_weights[0] = kNanF; }},
       {"falling order", "model-weight",
        [](Model& m) { std::swap(m.influence_weights[0], m.influence_weights[1]); }},
       {"unused influences", "model-weight",
        [](Model& m) {
          m.influence_weights[0] = 1;
          m.influence_weights[1] = 0;
        }},
       {"finite", "model-value", [](Model& m) { m.positions[1].x() = kNanF; }},
       {"normal", "model-value", [](Model& m) { m.normals[1] *= 1.01f; }},
       {"tangent", "model-value", [](Model& m) { m.tangents[1].w() = 0.5f; }},
       {"finite", "model-value", [](Model& m) { m.normals[1].x() = kNanF; }},
       {"finite", "model-value", [](Model& m) { m.texture_coordinates[1].x() = kNanF; }},
       {"finite", "model-value", [](Model& m) { m.tangents[1].x() = kNanF; }},
       {"parts cover all", "model-shape", [](Model& m) { m.parts.pop_back(); }},
       {"parts in order", "model-shape", [](Model& m) { std::swap(m.parts[0], m.parts[1]); }},
       {"parts within", "model-shape", [](Model& m) { m.parts[1].triangle_count = 2; }}});
}

TEST(CheckModel, OptionalDataMayBeAbsent) {
  Model m = good_model();
  m.normals.clear();
  m.texture_coordinates.clear();
  m.tangents.clear();
  EXPECT_TRUE(check(m).ok());
}

TEST(CheckCamera, RefusesEachBrokenPromise) {
  CameraTrack camera;
  ASSERT_TRUE(check(camera).ok()) << "a camera without frames";
  camera.positions.assign(2, Vec3f::Zero());
  camera.orientations.assign(2, Quatf::Identity());
  camera.fields_of_view.assign(2, 1.0f);
  expect_refused<CameraTrack>(
      camera,
      {{"lengths", "camera-shape", [](CameraTrack& c) { c.orientations.pop_back(); }},
       {"lengths", "camera-shape", [](CameraTrack& c) { c.fields_of_view.pop_back(); }},
       {"rate", "camera-rate", [](CameraTrack& c) { c.rate = 0; }},
       {"rate", "camera-rate", [](CameraTrack& c) { c.rate = kNan; }},
       {"finite", "camera-value", [](CameraTrack& c) { c.positions[1].z() = kNanF; }},
       {"unit", "camera-value", [](CameraTrack& c) { c.orientations[1].coeffs() *= 2; }},
       {"field of view", "camera-value", [](CameraTrack& c) { c.fields_of_view[1] = 0; }},
       {"field of view", "camera-value", [](CameraTrack& c) { c.fields_of_view[1] = 3.2f; }},
       {"field of view", "camera-value", [](CameraTrack& c) { c.fields_of_view[1] = kNanF; }}});
}

}  // namespace
}  // namespace krok
