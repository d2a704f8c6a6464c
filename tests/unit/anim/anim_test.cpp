// If these fail, motions do not survive being stored, invalid ones are stored or read, or the bytes
// depend on the number of threads.

#include "formats/anim/anim.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "golden/samples/samples.h"
#include "math/quaternion.h"

namespace krok {
namespace {

using testing::ElementsAreArray;
using testing::HasSubstr;
constexpr auto kXyz = OrientationEncoding::xyz;
constexpr auto kXyzw = OrientationEncoding::xyzw;

// A chain of joints that turn at different speeds.
Clip turning_chain(int joints, int frames) {
  Clip clip;
  for (int i = 0; i < joints; ++i) {
    clip.skeleton.add("joint " + std::to_string(i), i - 1,
                      {Vec3(0, 0.1 * i, 0), from_rotation_vector(Vec3(0, 0.3 * i, 0.1))},
                      i == joints - 1 && i > 0);
  }
  clip.rate = 120;
  clip.resize(frames);
  for (int frame = 0; frame < frames; ++frame) {
    for (int i = 0; i < joints; ++i) {
      const auto k = static_cast<std::size_t>(frame * joints + i);
      const double angle = 0.01 * frame * (i + 1);
      clip.positions[k] = Vec3(std::cos(angle), 0.1 * i, frame * 1e-3).cast<float>();
      clip.orientations[k] = from_rotation_vector(Vec3(0.2, angle, 0.05 * i)).cast<float>();
    }
  }
  return clip;
}

Status write_to_nothing(const Clip& clip) {
  auto file = OutputFile::create("/dev/null");
  return anim::write(clip, {}, *file);
}

TEST(Anim, RoundTripKeepsPositionsExactlyAndOrientationsClosely) {
  const Clip clip = turning_chain(20, 500);
  for (const auto encoding : {kXyz, kXyzw}) {
    const auto back = anim::read(samples::bytes_of(clip, encoding));
    ASSERT_TRUE(back.ok()) << back.error().message;
    EXPECT_EQ(back->rate, 120);
    EXPECT_EQ(back->frame_count(), 500);
    EXPECT_EQ(back->skeleton.names, clip.skeleton.names);
    EXPECT_EQ(back->skeleton.parents, clip.skeleton.parents);
    EXPECT_EQ(back->skeleton.end_sites, clip.skeleton.end_sites);
    EXPECT_THAT(back->positions, ElementsAreArray(clip.positions));
    for (std::size_t i = 0; i < clip.orientations.size(); ++i) {
      const Quat a = clip.orientations[i].cast<double>(), b = back->orientations[i].cast<double>();
      if (encoding == kXyzw) {
        ASSERT_EQ(a.coeffs(), b.coeffs());
      } else {
        ASSERT_LE(b.w(), 0);
        ASSERT_LT(angle_between(a.normalized(), b.normalized()), 1e-4);
      }
    }
  }
}

TEST(Anim, WritingWhatWasReadGivesTheSameBytes) {
  for (const auto encoding : {kXyz, kXyzw}) {
    const auto bytes = samples::bytes_of(turning_chain(7, 300), encoding);
    EXPECT_EQ(samples::bytes_of(*anim::read(bytes), encoding), bytes);
  }
}

TEST(Anim, BytesDoNotDependOnTheNumberOfThreads) {
  const Clip clip = turning_chain(30, 4000);  // more than one block
  const auto with_jobs = [&](int jobs) {
    return samples::bytes_of(
        [&](OutputFile& file) { return anim::write(clip, {.jobs = jobs}, file); });
  };
  const auto one = with_jobs(1);
  EXPECT_EQ(with_jobs(2), one);
  EXPECT_EQ(with_jobs(5), one);
}

TEST(Anim, NoFramesAndOneJointAreFine) {
  for (const int frames : {0, 1}) {
    for (const int joints : {1, 2}) {
      const Clip clip = turning_chain(joints, frames);
      const auto back = anim::read(samples::bytes_of(clip));
      ASSERT_TRUE(back.ok()) << back.error().message;
      EXPECT_EQ(back->frame_count(), frames);
      EXPECT_EQ(back->joint_count(), joints);
    }
  }
}

TEST(Anim, WriterRefusesWhatIsNoMotion) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto code = [](const std::function<void(Clip&)>& change) {
    Clip clip = samples::clip();
    change(clip);
    const Status status = write_to_nothing(clip);
    return status ? std::string() : status.error().code;
  };
  EXPECT_EQ(code([](Clip&) {}), "");
  EXPECT_EQ(code([&](Clip& c) { c.positions[4].y() = nan; }), "clip-value");
  EXPECT_EQ(code([&](Clip& c) { c.orientations[4].x() = nan; }), "clip-value");
  EXPECT_EQ(code([](Clip& c) { c.orientations[4].coeffs() *= 2; }), "clip-value");
  EXPECT_EQ(code([](Clip& c) { c.orientations[4].coeffs().setZero(); }), "clip-value");
  EXPECT_EQ(code([](Clip& c) { c.rate = 0; }), "clip-rate");
  EXPECT_EQ(code([](Clip& c) { c.rate = HUGE_VAL; }), "clip-rate");
  EXPECT_EQ(code([](Clip& c) { c.positions.pop_back(); }), "clip-shape");
  EXPECT_EQ(code([](Clip& c) { c.skeleton = {}; }), "skeleton-shape");
  EXPECT_EQ(code([](Clip& c) { c.skeleton.parents[1] = 2; }), "skeleton-parent");
  EXPECT_EQ(code([&](Clip& c) { c.skeleton.reference[1].position.x() = double{nan}; }),
            "skeleton-value");
}

// A reference position may be finite in doubles and infinite in floats.
TEST(Anim, WriterRefusesAReferencePoseTooLargeForFloats) {
  Clip clip = samples::clip();
  clip.skeleton.reference[1].position.x() = 1e300;
  const Status status = write_to_nothing(clip);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, "skeleton-value");
}

std::uint64_t section_offset(const std::vector<std::byte>& file, int index) {
  std::uint64_t offset;
  std::memcpy(&offset, &file[static_cast<std::size_t>(64 + 32 * index + 8)], sizeof offset);
  return offset;
}

TEST(Anim, ReaderNamesJointFrameAndByteOfABadValue) {
  auto file = samples::bytes_of(samples::clip());
  const std::uint64_t place = section_offset(file, 4) + 24 * (3 * 1 + 2);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(&file[place], &nan, sizeof nan);
  samples::repair_header(file);
  const auto read = anim::read(file);
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.error().code, "clip-value");
  EXPECT_EQ(read.error().frame, 1);
  EXPECT_EQ(read.error().joint, samples::clip().skeleton.names[2]);
  EXPECT_EQ(read.error().where.byte_offset, static_cast<std::int64_t>(place));
}

// Would fail if parts of a long file, or the place of a bad value there, were another's.
TEST(Anim, FramesReadOnDemandAreThoseOfTheFile) {
  const Clip clip = turning_chain(7, 60);
  const auto bytes = samples::bytes_of(clip);
  const auto opened = anim::open(bytes);
  ASSERT_TRUE(opened.ok());
  EXPECT_EQ(opened->frames.frame_count, 60);
  EXPECT_EQ(opened->frames.rate, 120);
  EXPECT_FALSE(opened->stretched);
  const Clip whole = anim::read(bytes).value();
  std::vector<Vec3f> positions(5 * 7);
  std::vector<Quatf> orientations(5 * 7);
  ASSERT_TRUE(opened->frames.read(41, 5, positions, orientations));
  for (std::size_t i = 0; i < positions.size(); ++i) {
    EXPECT_EQ(positions[i], whole.positions[41 * 7 + i]);
    EXPECT_EQ(orientations[i].coeffs(), whole.orientations[41 * 7 + i].coeffs());
  }
}

TEST(Anim, ReaderRefusesCountsThatTheFileHasNoBytesFor) {
  const auto with_counts = [](std::uint64_t frames, std::uint32_t joints) {
    auto file = samples::bytes_of(samples::clip());
    const std::uint64_t info = section_offset(file, 0);
    std::memcpy(&file[info + 8], &frames, sizeof frames);
    std::memcpy(&file[info + 16], &joints, sizeof joints);
    samples::repair_header(file);
    const auto read = anim::read(file);
    return read ? std::string() : read.error().code;
  };
  EXPECT_EQ(with_counts(2, 3), "");
  EXPECT_EQ(with_counts(3, 3), "container-section");
  EXPECT_EQ(with_counts(2, 2), "container-section");
  EXPECT_EQ(with_counts(0x7FFFFFFF, 65535), "container-section");
  EXPECT_EQ(with_counts(0x80000000, 1), "anim-shape");
  EXPECT_EQ(with_counts(~std::uint64_t{0}, 3), "anim-shape");
  EXPECT_EQ(with_counts(2, 0), "anim-shape");
  EXPECT_EQ(with_counts(2, 65536), "anim-shape");
}

TEST(Anim, ReaderRefusesBadNamesAndParents) {
  const auto changed = [](const std::function<void(std::vector<std::byte>&)>& change) {
    auto file = samples::bytes_of(samples::clip());
    change(file);
    samples::repair_header(file);
    const auto read = anim::read(file);
    EXPECT_FALSE(read.ok());
    return read.ok() ? Error() : read.error();
  };
  using Bytes = std::vector<std::byte>;
  const auto utf8 = changed([](Bytes& f) { f[section_offset(f, 2) + 1] = std::byte{0xFF}; });
  EXPECT_EQ(utf8.code, "container-section");
  EXPECT_THAT(utf8.message, HasSubstr("UTF-8"));
  const auto split = changed([](Bytes& f) { f[section_offset(f, 2) + 1] = std::byte{0}; });
  EXPECT_THAT(split.message, HasSubstr("has 4 texts, expected 3"));
  const auto empty = changed([](Bytes& f) {
    // The first name's end moves to its start: an empty name and still three zeros.
    f[section_offset(f, 2)] = std::byte{0};
    f[section_offset(f, 2) + 4] = std::byte{'x'};
  });
  EXPECT_EQ(empty.code, "skeleton-name");
  const auto parent = changed([](Bytes& f) { f[section_offset(f, 1) + 8] = std::byte{2}; });
  EXPECT_EQ(parent.code, "skeleton-parent");
  EXPECT_GT(parent.where.byte_offset, 0);
  const auto flags = changed([](Bytes& f) { f[section_offset(f, 1) + 4] = std::byte{2}; });
  EXPECT_EQ(flags.code, "container-section");
}

TEST(Anim, OtherFilesAreNamed) {
  const auto model = anim::read(samples::bytes_of(samples::model()));
  ASSERT_FALSE(model.ok());
  EXPECT_EQ(model.error().message, "is a Krok model (.model), not a .anim file");
}

TEST(Anim, FramesMadeWhenAskedForGiveTheSameFile) {
  Clip clip = turning_chain(20, 700);
  clip.provenance.tool = "test";
  for (const auto encoding : {kXyz, kXyzw}) {
    const auto expected = samples::bytes_of(clip, encoding);
    for (const int jobs : {1, 2, 5}) {
      FrameSource source = frames_of(clip);
      int released = 0;
      source.release = [&](int frame) {
        EXPECT_GT(frame, released);
        released = frame;
      };
      const std::string path =
          testing::TempDir() + "krok-anim-source-" + std::to_string(getpid()) + ".anim";
      auto file = OutputFile::create(path);
      ASSERT_TRUE(file.ok());
      bool all_read = false;
      const auto provenance = [&] {
        all_read = released == 700;
        return clip.provenance;
      };
      const Status status =
          anim::write(source, provenance, {.orientation = encoding, .jobs = jobs}, *file);
      ASSERT_TRUE(status) << status.error().message;
      ASSERT_TRUE(file->commit());
      EXPECT_TRUE(all_read);
      const auto input = InputFile::open(path);
      EXPECT_THAT(input->bytes(), ElementsAreArray(expected));
      std::remove(path.c_str());
    }
  }
}

TEST(Anim, PassesOnWhatTheSourceOfFramesSays) {
  const Clip clip = turning_chain(20, 700);
  FrameSource source = frames_of(clip);
  source.read = [](int first, int, std::span<Vec3f> positions, std::span<Quatf> orientations) {
    std::fill(positions.begin(), positions.end(), Vec3f::Zero());
    std::fill(orientations.begin(), orientations.end(), Quatf::Identity());
    return first > 300 ? Status(Error("test", "no such frame")) : Status();
  };
  auto file = OutputFile::create("/dev/null");
  bool asked = false;
  const Status status = anim::write(
      source,
      [&] {
        asked = true;
        return Provenance();
      },
      {.jobs = 2}, *file);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, "test");
  EXPECT_FALSE(asked);
}

}  // namespace
}  // namespace krok
