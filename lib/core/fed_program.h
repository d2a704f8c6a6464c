#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"

// Runs another program, such as an encoder, that reads its standard input and writes a file.

namespace krok {

// The path of an executable, by the folders of PATH; empty if there is none.
std::optional<std::string> find_program(const std::string& name);

// A running program. It gets no environment but PATH and the descriptors 0 to 3: its standard input
// comes from feed(), its standard output is discarded, what it prints as errors is kept, and
// kResult is an empty file in memory that it can write, seek in and open again by that name. It is
// killed if the object is destroyed before finish(); if the caller dies, its input ends.
class FedProgram {
 public:
  static constexpr const char* kResult = "/proc/self/fd/3";

  // `arguments` without the program's own name. Code: program-start.
  static Result<FedProgram> start(const std::string& path,
                                  const std::vector<std::string>& arguments);
  FedProgram(FedProgram&&) noexcept;
  FedProgram& operator=(FedProgram&&) noexcept;
  ~FedProgram();

  // Waits until the program has read enough. Code program-failed, with what it printed, if it has
  // ended or closed its input.
  Status feed(std::span<const std::byte> bytes);

  // Ends its input and waits for it. Returns what it wrote to kResult. Code program-failed if its
  // exit code is not 0 or a signal ended it.
  Result<std::vector<std::byte>> finish();

 private:
  struct State;
  explicit FedProgram(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace krok
