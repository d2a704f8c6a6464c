#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "parametric/library.h"
#include "rbf/weight_function.h"
#include "scene/provenance.h"

// Krok's format for step libraries, .steps: examples, their measured parameters, and the weight
// function. formats/steps/SPEC.md describes the bytes.

namespace krok::steps {

struct StepsFile {
  parametric::Library library;                 // with at least one example
  std::optional<rbf::WeightFunction> weights;  // nullopt: not fitted yet
  std::string report;                          // fit report, a JSON object; may be empty
  Provenance provenance;
};

// Checks that library and weights are valid and match, names can be stored and the report is a JSON
// object of at most 16 MiB. Codes: those of check(Library) and WeightFunction::check(),
// steps-shape, steps-report.
Status check(const StepsFile& steps);

// Reads a file; the result passes check(). Orientations stored as x, y, z are read with w <= 0.
// Safe for untrusted input: memory use is bounded by the file size. Codes: those of
// formats/container/container.h and of check(), with byte offsets.
Result<StepsFile> read(std::span<const std::byte> file);

struct WriteOptions {
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

// Writes to `file`, which must be empty; the caller commits. Deterministic; a library that was read
// from a file gives the bytes of that file. An Error if check() fails, before anything is written.
Status write(const StepsFile& steps, const WriteOptions& options, OutputFile& file);

// Names of the library's parameters, [parameters]: from its report (the member "parameters", an
// array of objects with a "name"), or else the part after the last dot of the measure: "length" for
// "step.length".
std::vector<std::string> parameter_names(const StepsFile& steps);

}  // namespace krok::steps
