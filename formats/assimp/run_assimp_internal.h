#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "formats/assimp/assimp_reader.h"
#include "formats/assimp/memory_files_internal.h"
#include "formats/registry/registry.h"
#include "nodes/scene.h"

namespace krok::assimp {

// Runs Assimp and the conversion in this process, without limits; read_file() calls it in the child
// process. The first file is the one to read, the others its companions; names have the extension
// of their kind.
Result<nodes::Scene> run_assimp(std::vector<MemoryFile> files, registry::Kind kind,
                                const ReadOptions& options);

}  // namespace krok::assimp
