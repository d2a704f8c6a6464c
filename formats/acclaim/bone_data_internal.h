#pragma once

#include <vector>

#include "core/result.h"
#include "formats/acclaim/bone_tree_internal.h"
#include "formats/acclaim/item_parser_internal.h"
#include "formats/acclaim/source_text_internal.h"

namespace krok::acclaim {

// A bone with axes and limits in the file's angle unit, which may be defined later in the file.
struct PrintedBone : LooseBone {
  PrintedAxes axes;
};

// Parses the section :bonedata after its keyword and appends its bones to `bones`.
Status parse_bones(SourceText& source, TokenCursor& cursor, const ReadOptions& options,
                   std::vector<PrintedBone>& bones);

}  // namespace krok::acclaim
