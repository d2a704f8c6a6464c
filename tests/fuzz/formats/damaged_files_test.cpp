// If these fail, a damaged or malicious .anim, .model, .cam or .steps file crashes a program or is
// accepted as valid. Run with the address and undefined-behaviour sanitizers.

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <random>

#include "formats/anim/anim.h"
#include "formats/cam/cam.h"
#include "formats/model/model_format.h"
#include "formats/steps/steps.h"
#include "golden/samples/samples.h"

namespace krok {
namespace {

using Bytes = std::vector<std::byte>;

// Reads a file by its extension. A value must pass check(), an Error must have a code and a
// message.
Status read_and_check(const std::string& ending, const Bytes& bytes) {
  // An exact-size copy, so that the sanitizer detects reads past the end.
  const std::unique_ptr<std::byte[]> copy(new std::byte[bytes.size()]);
  std::copy(bytes.begin(), bytes.end(), copy.get());
  const std::span<const std::byte> file(copy.get(), bytes.size());
  const auto judge = [](const auto& value) -> Status {
    if (value.ok()) {
      const Status status = check(*value);
      EXPECT_TRUE(status.ok()) << "a value that does not hold was given";
      return {};
    }
    EXPECT_FALSE(value.error().code.empty());
    EXPECT_FALSE(value.error().message.empty());
    return value.error();
  };
  Stretches stretches;
  if (ending == ".anim") return judge(anim::read(file, &stretches));
  if (ending == ".model") return judge(model::read(file));
  if (ending == ".steps") return judge(steps::read(file));
  return judge(cam::read(file));
}

std::string ending_of(const samples::Sample& sample) {
  return extension(sample.file_name);
}

TEST(DamagedFiles, EveryTruncationIsAnError) {
  for (const auto& sample : samples::all()) {
    const Bytes whole = samples::bytes_of(sample.write);
    ASSERT_TRUE(read_and_check(ending_of(sample), whole).ok()) << sample.file_name;
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_FALSE(read_and_check(ending_of(sample), cut).ok())
          << sample.file_name << " cut to " << size << " bytes";
    }
  }
}

TEST(DamagedFiles, EveryTruncationWithARightHeaderIsHandled) {
  for (const auto& sample : samples::all()) {
    const Bytes whole = samples::bytes_of(sample.write);
    for (std::size_t size = 64; size < whole.size(); ++size) {
      Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      samples::repair_header(cut);
      EXPECT_FALSE(read_and_check(ending_of(sample), cut).ok())
          << sample.file_name << " cut to " << size << " bytes";
    }
  }
}

TEST(DamagedFiles, EveryChangedByteIsNoticed) {
  for (const auto& sample : samples::all()) {
    Bytes bytes = samples::bytes_of(sample.write);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const std::byte was = bytes[i];
      for (int bit = 0; bit < 8; ++bit) {
        bytes[i] = was ^ static_cast<std::byte>(1 << bit);
        EXPECT_FALSE(read_and_check(ending_of(sample), bytes).ok())
            << sample.file_name << " byte " << i << " bit " << bit;
      }
      bytes[i] = was;
    }
  }
}

// With a valid checksum the reader itself must handle every invalid count, offset, name and number.
TEST(DamagedFiles, EveryByteToEveryValueWithARightChecksumIsHandled) {
  for (const auto& sample : samples::all()) {
    const Bytes whole = samples::bytes_of(sample.write);
    for (std::size_t i = 0; i < whole.size(); ++i) {
      for (const int value : {0x00, 0x01, 0x02, 0x3F, 0x40, 0x7F, 0x80, 0xC0, 0xFE, 0xFF}) {
        Bytes bytes = whole;
        bytes[i] = static_cast<std::byte>(value);
        samples::repair_header(bytes);
        (void)read_and_check(ending_of(sample), bytes).ok();
      }
    }
  }
}

// Whole words changed: counts of 2^31, offsets near 2^64, infinities.
TEST(DamagedFiles, EveryWordToAnExtremeWithARightChecksumIsHandled) {
  const std::uint64_t extremes[] = {0,
                                    1,
                                    0x7FFFFFFF,
                                    0x80000000,
                                    0xFFFFFFFF,
                                    0x100000000,
                                    0x7FFFFFFFFFFFFFFF,
                                    0x8000000000000000,
                                    0xFFFFFFFFFFFFFFC0,
                                    0xFFFFFFFFFFFFFFFF,
                                    0x7F8000007F800000,
                                    0x7FC000007FC00000};
  for (const auto& sample : samples::all()) {
    const Bytes whole = samples::bytes_of(sample.write);
    for (std::size_t i = 8; i + 8 <= whole.size(); i += 4) {
      for (const std::uint64_t value : extremes) {
        Bytes bytes = whole;
        std::memcpy(&bytes[i], &value, sizeof value);
        samples::repair_header(bytes);
        (void)read_and_check(ending_of(sample), bytes).ok();
      }
    }
  }
}

TEST(DamagedFiles, RandomDamageWithARightChecksumIsHandled) {
  std::mt19937 random(7);
  for (const auto& sample : samples::all()) {
    const Bytes whole = samples::bytes_of(sample.write);
    for (int round = 0; round < 2000; ++round) {
      Bytes bytes = whole;
      const int changes = 1 + static_cast<int>(random() % 8);
      for (int k = 0; k < changes; ++k) {
        bytes[random() % bytes.size()] = static_cast<std::byte>(random() % 256);
      }
      samples::repair_header(bytes);
      (void)read_and_check(ending_of(sample), bytes).ok();
    }
  }
}

TEST(DamagedFiles, SomethingAppendedIsAnError) {
  for (const auto& sample : samples::all()) {
    Bytes bytes = samples::bytes_of(sample.write);
    bytes.push_back(std::byte{0});
    const Status status = read_and_check(ending_of(sample), bytes);
    ASSERT_FALSE(status.ok());
    EXPECT_EQ(status.error().code, "container-size");
  }
}

TEST(DamagedFiles, NotANumberIsRefused) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const auto& sample : samples::all()) {
    const Bytes whole = samples::bytes_of(sample.write);
    int refused = 0;
    for (std::size_t i = 256; i + 4 <= whole.size(); i += 4) {
      Bytes bytes = whole;
      std::memcpy(&bytes[i], &nan, sizeof nan);
      samples::repair_header(bytes);
      if (!read_and_check(ending_of(sample), bytes)) ++refused;
    }
    EXPECT_GT(refused, 10) << sample.file_name;
  }
}

}  // namespace
}  // namespace krok
