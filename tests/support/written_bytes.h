#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <string>

#include "core/file.h"

namespace krok::test {

// The bytes that `write` writes to a file; `status` receives its result.
inline std::string bytes_of(const std::function<Status(OutputFile&)>& write, Status& status) {
  const auto* info = testing::UnitTest::GetInstance()->current_test_info();
  const std::string path =
      testing::TempDir() + "krok_written_" + info->name() + std::to_string(getpid());
  auto file = OutputFile::create(path);
  EXPECT_TRUE(file.ok());
  status = write(*file);
  if (!status) return {};
  EXPECT_TRUE(file->commit().ok());
  const auto input = InputFile::open(path);
  EXPECT_TRUE(input.ok());
  std::string bytes(input->text());
  std::filesystem::remove(path);
  return bytes;
}

// As above; expects no error.
inline std::string bytes_of(const std::function<Status(OutputFile&)>& write) {
  Status status;
  std::string bytes = bytes_of(write, status);
  EXPECT_TRUE(status.ok()) << (status ? "" : status.error().message);
  return bytes;
}

// The error code of `write`; "none" if it succeeds.
inline std::string error_code(const std::function<Status(OutputFile&)>& write) {
  Status status;
  bytes_of(write, status);
  return status ? "none" : status.error().code;
}

}  // namespace krok::test
