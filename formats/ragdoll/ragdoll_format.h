#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "ragdoll/joint_rules.h"
#include "scene/skeleton.h"

// Reader and writer for rigid bodies and their joints (JSON); see formats/ragdoll/SPEC.md.

namespace krok::ragdoll_file {

// Without a skeleton, Body::joint is -1 and only what needs none is checked. Safe for untrusted
// input. Codes, each with line and column: json-syntax, json-limit, ragdoll-structure,
// ragdoll-value, ragdoll-joint (the skeleton has no joint of that name, or another body has it; the
// hint names the nearest), ragdoll-body (no body of that name, or one that is tied to nothing).
Result<ragdoll::Ragdoll> read(std::string_view text, const Skeleton* skeleton);

// A file that read() gives the same values from, bit for bit where angles are multiples of a
// millionth of a degree, as those of ragdoll::rules_of() are.
std::string write(const ragdoll::Ragdoll& what, const Skeleton& skeleton);

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::ragdoll_file
