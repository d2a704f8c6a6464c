#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "formats/acclaim/skeleton_file_internal.h"
#include "formats/acclaim/source_text_internal.h"

namespace krok::acclaim {

// A bone of :bonedata, before its parent is known.
struct LooseBone {
  std::string_view name;  // as in the file
  std::size_t offset = 0;
  SkeletonFile::Joint joint;
};

// A child named on a line of :hierarchy.
struct HierarchyLink {
  std::string_view parent, child;
  std::size_t parent_offset = 0, child_offset = 0;
};

// Attaches the bones to the root, which is already in `skeleton`: fills its joints (depth first,
// with unique UTF-8 names) and its name maps. Bones not connected to the root are dropped with a
// warning.
Status hang_bones(std::vector<LooseBone>& bones, const std::vector<HierarchyLink>& links,
                  SourceText& source, SkeletonFile& skeleton);

}  // namespace krok::acclaim
