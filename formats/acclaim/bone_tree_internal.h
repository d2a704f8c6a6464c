#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "formats/acclaim/skeleton_file_internal.h"
#include "formats/acclaim/source_text_internal.h"

namespace krok::acclaim {

// A bone of :bonedata, before it is known where it hangs.
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

// Hangs the bones on the root that stands in `skeleton` already: fills its joints (depth first,
// names made unique and UTF-8) and its maps of names. Bones that no chain of links joins to the
// root are left out with a warning.
Status hang_bones(std::vector<LooseBone>& bones, const std::vector<HierarchyLink>& links,
                  SourceText& source, SkeletonFile& skeleton);

}  // namespace krok::acclaim
