#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "formats/bvh/hierarchy.h"

// What follows once all joints of a hierarchy are parsed. `name_places` has the offset of each
// joint's name in the text, shape [joints].

namespace krok::bvh {

// An error if no channel is known: the character would not move, with no message. The error has no
// location. A note if there are no positions.
Status check_channels(const Hierarchy& hierarchy, const std::string& file_name,
                      Diagnostics& diagnostics);

// A skeleton has one root: several roots get a static parent at the origin.
void join_roots(Hierarchy& hierarchy, std::vector<std::size_t>& name_places,
                const std::string& file_name, Diagnostics& diagnostics);

// Makes the joint names unique.
void name_joints(Hierarchy& hierarchy, std::span<const std::size_t> name_places,
                 std::string_view text, const std::string& file_name, Diagnostics& diagnostics);

void report_zero_bones(const Hierarchy& hierarchy, const std::string& file_name,
                       Diagnostics& diagnostics);

// Warns (bvh-end-site) of end sites further from their joint than half of the size of a body of 15
// joints or more: bodies and pictures then have a hand that long, or none.
void report_long_ends(const Hierarchy& hierarchy, const std::string& file_name,
                      Diagnostics& diagnostics);

// A diagnostic about the whole file.
void report_in_file(Severity severity, std::string code, std::string message,
                    const std::string& file_name, Diagnostics& diagnostics);

}  // namespace krok::bvh
