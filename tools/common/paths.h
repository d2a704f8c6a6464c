#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "core/result.h"

namespace krok {

// Whether two paths lead to one regular file, which need not exist yet. Devices and standard
// streams can be read and written at once.
bool same_file(const std::string& first, const std::string& second);

// A regular file as the system numbers it, whatever it is called; nothing where there is none.
using FileNumber = std::pair<std::uint64_t, std::uint64_t>;
std::optional<FileNumber> file_number(const std::string& path);

// The one name that all paths to a regular file lead to, through links; the file need not exist.
// Empty for standard streams and devices.
std::string place_of(const std::string& path);

// An Error (code usage) that a result would replace this file.
Error replaced_error(const std::string& path);

// An Error (code usage) that two results would go there.
Error twice_error(const std::string& path);

// `path` itself where it is absolute, otherwise the file of that name below `folder`;
// an empty folder is the current one.
std::string below(const std::string& folder, const std::string& path);

// An absolute path without . and .. and doubled slashes; links are not looked at.
std::string absolute_path(const std::string& path);

}  // namespace krok
