#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "math/transform.h"
#include "scene/skeleton.h"

// Reader and writer for the alignment of two skeletons (JSON); see formats/alignment/SPEC.md.

namespace krok::alignment {

// A pose of each skeleton, in which both actors stand alike: joint_to_world, shape [joints].
struct AlignedPoses {
  std::vector<Transform> source, target;
};

// Safe for untrusted input. Codes, each with line and column: json-syntax, json-limit,
// alignment-structure, alignment-value, alignment-joint (a joint that a skeleton does not have, or
// one of its joints is missing: the file is of other skeletons).
Result<AlignedPoses> read(std::string_view text, const Skeleton& source, const Skeleton& target);

// A file that read() gives the same poses from, bit for bit.
std::string write(const AlignedPoses& poses, const Skeleton& source, const Skeleton& target);

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::alignment
