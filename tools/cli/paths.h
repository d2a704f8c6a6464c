#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "core/result.h"

namespace krok::cli {

// Whether two paths refer to the same regular file, which need not exist yet. False for devices and
// standard streams, which can be read and written at once.
bool same_file(const std::string& first, const std::string& second);

// Device and inode number of a regular file; empty if there is none.
using FileNumber = std::pair<std::uint64_t, std::uint64_t>;
std::optional<FileNumber> file_number(const std::string& path);

// Canonical path of a regular file, with links resolved; the file need not exist. Empty for
// standard streams and devices.
std::string place_of(const std::string& path);

// Error (code usage): an output would overwrite this input.
Error replaced_error(const std::string& path);

// Error (code usage): two outputs have this path.
Error twice_error(const std::string& path);

// `path` if absolute, otherwise `path` relative to `folder`; an empty folder is the current one.
std::string below(const std::string& folder, const std::string& path);

// Absolute path without ".", ".." and double slashes; links are not resolved.
std::string absolute_path(const std::string& path);

}  // namespace krok::cli
