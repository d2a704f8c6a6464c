#pragma once

#include <string>
#include <string_view>

namespace krok {

// A joint's name as a reader may keep it: UTF-8 (bytes that are not are read as Latin-1), with a _
// for each control character but the tab.
std::string readable_joint_name(std::string_view bytes);

}  // namespace krok
