#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "formats/assimp/assimp_reader.h"
#include "formats/assimp/memory_files_internal.h"
#include "formats/registry/registry.h"
#include "nodes/scene.h"

namespace krok::assimp {

// Assimp and the conversion, in this process and without any limit: what read_file() runs in its
// child. The first file is the one to read, the others its companions; their names end in their
// kind's extension.
Result<nodes::Scene> run_assimp(std::vector<MemoryFile> files, registry::Kind kind,
                                const ReadOptions& options);

}  // namespace krok::assimp
