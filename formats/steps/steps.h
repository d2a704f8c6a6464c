#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/file.h"
#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "parametric/library.h"
#include "rbf/weight_function.h"
#include "scene/provenance.h"

// Krok's own format for step libraries, .steps: examples, what is measured on them, and the weights
// by parameters. formats/steps/SPEC.md describes its bytes.

namespace krok::steps {

struct StepsFile {
  parametric::Library library;                 // with one example or more
  std::optional<rbf::WeightFunction> weights;  // nothing: not fitted yet
  std::string report;                          // how it was fitted, a JSON object; may be empty
  Provenance provenance;
};

// Whether library and weights hold and belong together, names can be stored and the report is a
// JSON object of at most 16 MiB. Codes: those of check(Library) and WeightFunction::check(),
// steps-shape, steps-report.
Status check(const StepsFile& steps);

// A file for which check() holds. Orientations stored as x, y, z come back with w <= 0. Trusts
// nothing in `file`: memory is taken only for what the file has bytes for. Codes: those of
// formats/container/container.h and of check(), with byte offsets.
Result<StepsFile> read(std::span<const std::byte> file);

struct WriteOptions {
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

// Appends the whole file to `file`, to which nothing was written before; the caller commits. The
// same library gives the same bytes, and one that was read from a file gives that file's. An Error
// for what check() refuses, before anything is written.
Status write(const StepsFile& steps, const WriteOptions& options, OutputFile& file);

}  // namespace krok::steps
