// Damaged arrays: each prefix of a small .npy and .npz, and each byte of them changed. If these
// fail, a damaged file crashes or hangs a tool, or is read as a clip that fails check().

#include <gtest/gtest.h>

#include "formats/npy/array_reader.h"
#include "formats/npy/npy.h"
#include "formats/npy/npz_motion.h"

namespace {

void read_anyway(std::vector<std::byte> file) {
  krok::npy::ReadOptions options;
  options.jobs = 1;
  const auto capture = krok::npy::read(file, "a.npz", options);
  if (capture.ok()) {
    const auto whole = check(capture->clip);
    ASSERT_TRUE(whole.ok()) << whole.error().message;
  } else {
    ASSERT_FALSE(capture.error().code.empty());
    ASSERT_FALSE(capture.error().message.empty());
  }
  // What is read in parts is what is read whole.
  const auto opened = krok::npy::open(file, "a.npz", options);
  const auto parts = opened ? load(opened->frames, 1) : krok::Result<krok::Clip>(krok::Error());
  if (!parts.ok()) return;
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  ASSERT_EQ(parts->positions, capture->clip.positions);
}

void damage(const std::vector<std::byte>& file) {
  for (std::size_t n = 0; n < file.size(); ++n) {
    read_anyway({file.begin(), file.begin() + static_cast<std::ptrdiff_t>(n)});
    std::vector<std::byte> changed = file;
    for (const unsigned char value : {0x00, 0xFF, 0x31}) {
      changed[n] = std::byte{value};
      read_anyway(changed);
    }
  }
}

TEST(NpyFuzz, positions) {
  std::vector<float> values;
  for (int i = 0; i < 3 * 17 * 2; ++i) values.push_back(static_cast<float>((i * 37) % 101) / 50);
  krok::npy::ReadOptions options;
  options.columns = krok::named_skeleton("h36m17");
  const auto file = krok::npy::write(krok::npy::array_of(values, {2, 17, 3}));
  ASSERT_TRUE(krok::npy::read(file, "a.npy", options).ok());
  damage(file);
}

TEST(NpyFuzz, motion) {
  krok::Clip clip;
  clip.skeleton.add("hips", -1, {});
  clip.skeleton.add("spine", 0, {{0, 1, 0}, krok::Quat::Identity()});
  clip.resize(2);
  for (krok::Quatf& q : clip.orientations) q.setIdentity();
  for (krok::Vec3f& p : clip.positions) p.setOnes();
  const krok::Contact contact{.joint = 1};
  const auto file = krok::npy::write_motion(frames_of(clip), std::span(&contact, 1));
  ASSERT_TRUE(file.ok());
  const auto read = krok::npy::read(*file, "a.npz");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->keys.contacts.size(), 1U);
  damage(*file);
}

}  // namespace
