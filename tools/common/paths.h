#pragma once

#include <string>

namespace krok {

// Whether two paths lead to one regular file, which need not exist yet. Devices and standard
// streams can be read and written at once.
bool same_file(const std::string& first, const std::string& second);

// `path` itself where it is absolute, otherwise the file of that name below `folder`;
// an empty folder is the current one.
std::string below(const std::string& folder, const std::string& path);

// An absolute path without . and .. and doubled slashes; links are not looked at.
std::string absolute_path(const std::string& path);

}  // namespace krok
