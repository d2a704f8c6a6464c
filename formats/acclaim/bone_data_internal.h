#pragma once

#include <vector>

#include "core/result.h"
#include "formats/acclaim/bone_tree_internal.h"
#include "formats/acclaim/item_parser_internal.h"
#include "formats/acclaim/source_text_internal.h"

namespace krok::acclaim {

// A bone as printed: its axes and limits in the file's unit of angles, which may come later.
struct PrintedBone : LooseBone {
  PrintedAxes axes;
};

// Reads the section :bonedata from after its keyword and adds its bones to `bones`.
Status parse_bones(SourceText& source, TokenCursor& cursor, const ReadOptions& options,
                   std::vector<PrintedBone>& bones);

}  // namespace krok::acclaim
