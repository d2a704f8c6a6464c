#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/written_bytes.h"

// A reader of GLB for tests, of its own so that a fault of the project's reader cannot hide one of
// its writer.

namespace krok::test {

struct Glb {
  std::string bytes;
  nlohmann::json json;
  std::string data;

  // The components of an accessor without sparse values, as the numbers in the file.
  template <typename T>
  std::vector<T> values(int accessor) const {
    const auto& a = json.at("accessors").at(accessor);
    const auto& view = json.at("bufferViews").at(a.at("bufferView").get<int>());
    const std::string type = a.at("type");
    const std::size_t components = type == "SCALAR" ? 1 : type == "MAT4" ? 16 : type[3] - '0';
    std::vector<T> result(a.at("count").get<std::size_t>() * components);
    const std::size_t offset = view.value("byteOffset", 0u) + a.value("byteOffset", 0u);
    EXPECT_EQ(view.at("byteLength").get<std::size_t>(), result.size() * sizeof(T));
    EXPECT_LE(offset + result.size() * sizeof(T), data.size());
    EXPECT_EQ(offset % 4, 0u);
    std::memcpy(result.data(), data.data() + offset, result.size() * sizeof(T));
    return result;
  }
};

inline Glb written(const std::function<Status(OutputFile&)>& write) {
  Status status;
  Glb glb;
  glb.bytes = bytes_of(write, status);
  EXPECT_TRUE(status.ok()) << (status ? "" : status.error().message);
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, glb.bytes.data() + at, 4);
    return value;
  };
  if (glb.bytes.size() < 20) return glb;
  EXPECT_EQ(glb.bytes.substr(0, 4), "glTF");
  EXPECT_EQ(number(4), 2u);
  EXPECT_EQ(number(8), glb.bytes.size());
  const std::uint32_t text_length = number(12);
  glb.json = nlohmann::json::parse(glb.bytes.substr(20, text_length));
  if (glb.bytes.size() > 20 + text_length) glb.data = glb.bytes.substr(28 + text_length);
  return glb;
}

}  // namespace krok::test
