// If these fail, a damaged or malicious point cache crashes a program, or gives vertices that are
// not in the file. Run with the address and undefined-behaviour sanitizers.

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <random>
#include <string>

#include "formats/pc2/pc2.h"

namespace krok::pc2 {
namespace {

// Three vertices, two samples.
std::string sample_file() {
  std::string bytes("POINTCACHE2\0\1\0\0\0\3\0\0\0", 20);
  const float times[] = {0, 1};
  bytes.append(reinterpret_cast<const char*>(times), sizeof times);
  bytes.append("\2\0\0\0", 4);
  for (int i = 0; i < 18; ++i) {
    const auto value = static_cast<float>(i);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  return bytes;
}

// Reads a file and samples of it, which must be consistent with the file.
bool read_and_check(const std::string& bytes) {
  // An exact-size copy, so that the sanitizer detects reads past the end.
  const std::unique_ptr<std::byte[]> copy(new std::byte[bytes.size()]);
  if (!bytes.empty()) std::memcpy(copy.get(), bytes.data(), bytes.size());
  const auto cache = PointCache::read({copy.get(), bytes.size()});
  if (!cache) {
    EXPECT_EQ(cache.error().code.rfind("pc2-", 0), 0u);
    EXPECT_FALSE(cache.error().message.empty());
    return false;
  }
  const auto points = static_cast<std::uint64_t>(cache->points());
  const auto samples = static_cast<std::uint64_t>(cache->samples());
  EXPECT_EQ(32 + points * samples * 12 + cache->bytes_left(), bytes.size());
  // Memory for a sample is allocated only if the file has one.
  if (samples == 0) return true;
  std::vector<Vec3f> positions(points);
  for (const std::uint64_t sample : {std::uint64_t{0}, samples / 2, samples - 1}) {
    const Status status = cache->get(static_cast<std::int64_t>(sample), positions);
    if (!status) {
      EXPECT_EQ(status.error().code, "pc2-value");
      continue;
    }
    for (const Vec3f& position : positions) EXPECT_TRUE(position.allFinite());
  }
  return true;
}

TEST(DamagedCaches, EveryTruncationIsAnError) {
  const std::string whole = sample_file();
  ASSERT_TRUE(read_and_check(whole));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(read_and_check(whole.substr(0, size))) << size;
  }
}

TEST(DamagedCaches, AnyByteAnywhereIsHandled) {
  const std::string whole = sample_file();
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (int byte = 0; byte < 256; ++byte) {
      std::string bytes = whole;
      bytes[at] = static_cast<char>(byte);
      read_and_check(bytes);
    }
  }
}

TEST(DamagedCaches, EveryPairOfExtremeCountsIsHandled) {
  const std::string whole = sample_file();
  const std::uint32_t extremes[] = {0,          1,          2,          0x7FFFFFFF, 0x80000000,
                                    0xFFFFFFFF, 0x55555555, 0x15555556, 0x40000000, 0x10000};
  for (const std::uint32_t points : extremes) {
    for (const std::uint32_t samples : extremes) {
      std::string bytes = whole;
      std::memcpy(&bytes[16], &points, 4);
      std::memcpy(&bytes[28], &samples, 4);
      read_and_check(bytes);
    }
  }
}

TEST(DamagedCaches, RandomDamageIsHandled) {
  std::mt19937 random(7);
  const std::string whole = sample_file();
  for (int round = 0; round < 20000; ++round) {
    std::string bytes = whole;
    for (std::size_t change = 0; change < 1 + random() % 6; ++change) {
      bytes[random() % bytes.size()] = static_cast<char>(random() % 256);
    }
    bytes.resize(random() % 2 == 0 ? bytes.size() : random() % (bytes.size() + 8));
    read_and_check(bytes);
  }
}

}  // namespace
}  // namespace krok::pc2
