// If these fail, cameras do not survive being stored, or invalid ones are stored or read.

#include "formats/cam/cam.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "golden/samples/samples.h"
#include "math/quaternion.h"

namespace krok {
namespace {

using testing::ElementsAreArray;

TEST(Cam, RoundTrip) {
  CameraTrack camera;
  camera.rate = 24000.0 / 1001.0;
  for (int i = 0; i < 300; ++i) {
    camera.positions.emplace_back(0.01f * static_cast<float>(i), 1.5f, 4.0f);
    camera.orientations.push_back(from_rotation_vector(Vec3(0.1, 0.05 * i, 0)).cast<float>());
    camera.fields_of_view.push_back(0.5f + 0.001f * static_cast<float>(i));
  }
  for (const auto encoding : {OrientationEncoding::xyz, OrientationEncoding::xyzw}) {
    const auto bytes = samples::bytes_of(camera, encoding);
    const auto back = cam::read(bytes);
    ASSERT_TRUE(back.ok()) << back.error().message;
    EXPECT_EQ(back->rate, camera.rate);
    EXPECT_THAT(back->positions, ElementsAreArray(camera.positions));
    EXPECT_EQ(back->fields_of_view, camera.fields_of_view);
    for (std::size_t i = 0; i < camera.positions.size(); ++i) {
      ASSERT_LT(angle_between(back->orientations[i].cast<double>().normalized(),
                              camera.orientations[i].cast<double>().normalized()),
                1e-4);
    }
    EXPECT_EQ(samples::bytes_of(*back, encoding), bytes);
  }
}

TEST(Cam, KeepsCuts) {
  CameraTrack camera = samples::camera();
  const auto without = samples::bytes_of(camera);
  camera.cuts = {1};
  const auto bytes = samples::bytes_of(camera);
  const auto back = cam::read(bytes);
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(back->cuts, camera.cuts);
  EXPECT_EQ(samples::bytes_of(*back), bytes);
  EXPECT_TRUE(cam::read(without)->cuts.empty());
}

TEST(Cam, NoFramesAreFine) {
  CameraTrack camera;
  const auto back = cam::read(samples::bytes_of(camera));
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->frame_count(), 0);
}

TEST(Cam, WriterRefusesWhatIsNoCamera) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto code = [](const std::function<void(CameraTrack&)>& change) {
    CameraTrack camera = samples::camera();
    change(camera);
    auto file = OutputFile::create("/dev/null");
    const Status status = cam::write(camera, {}, *file);
    return status ? std::string() : status.error().code;
  };
  EXPECT_EQ(code([](CameraTrack&) {}), "");
  EXPECT_EQ(code([&](CameraTrack& c) { c.positions[0].z() = nan; }), "camera-value");
  EXPECT_EQ(code([&](CameraTrack& c) { c.orientations[0].w() = nan; }), "camera-value");
  EXPECT_EQ(code([&](CameraTrack& c) { c.fields_of_view[0] = nan; }), "camera-value");
  EXPECT_EQ(code([](CameraTrack& c) { c.fields_of_view[0] = 0; }), "camera-value");
  EXPECT_EQ(code([](CameraTrack& c) { c.fields_of_view[0] = 3.2f; }), "camera-value");
  EXPECT_EQ(code([](CameraTrack& c) { c.rate = -1; }), "camera-rate");
  EXPECT_EQ(code([](CameraTrack& c) { c.positions.pop_back(); }), "camera-shape");
  EXPECT_EQ(code([](CameraTrack& c) { c.cuts = {0}; }), "camera-cut");
  EXPECT_EQ(code([](CameraTrack& c) { c.cuts = {1, 1}; }), "camera-cut");
  EXPECT_EQ(code([](CameraTrack& c) { c.cuts = {c.frame_count()}; }), "camera-cut");
}

TEST(Cam, ReaderRefusesCountsThatTheFileHasNoBytesFor) {
  const auto whole = samples::bytes_of(samples::camera());
  std::uint64_t info = 0;
  std::memcpy(&info, &whole[64 + 8], sizeof info);
  const auto with_frames = [&](std::uint64_t frames) {
    auto file = whole;
    std::memcpy(&file[info + 8], &frames, sizeof frames);
    samples::repair_header(file);
    const auto read = cam::read(file);
    return read ? std::string() : read.error().code;
  };
  EXPECT_EQ(with_frames(2), "");
  EXPECT_EQ(with_frames(1), "container-section");
  EXPECT_EQ(with_frames(0x7FFFFFFF), "container-section");
  EXPECT_EQ(with_frames(0x80000000), "camera-shape");
  EXPECT_EQ(with_frames(~std::uint64_t{0}), "camera-shape");
}

}  // namespace
}  // namespace krok
