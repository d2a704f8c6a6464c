#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace krok::bench {

// What the operating system says of a finished process.
struct ProcessCost {
  double wall = 0;      // seconds
  double cpu = 0;       // seconds, user and system
  double peak_mib = 0;  // the most memory it held at once, mapped files included
  bool failed = false;
};

// Runs a program and waits for it. What it prints is thrown away.
ProcessCost run_process(const std::vector<std::string>& command);

// What several commands cost, each run in turn in every round, so that a machine whose speed drifts
// treats them alike. A first round is not counted.
struct PairedRuns {
  std::vector<std::vector<ProcessCost>> runs;  // [commands][rounds]

  double median_wall(std::size_t command) const;
  double median_cpu(std::size_t command) const;
  double median_peak(std::size_t command) const;
  // The median over the rounds of one command's wall time over another's in the same round.
  double ratio(std::size_t command, std::size_t to) const;
};

// `prepare` is called before each run with the command's index; its time is not counted.
PairedRuns run_paired(const std::vector<std::vector<std::string>>& commands, int rounds,
                      const std::function<void(std::size_t)>& prepare);

}  // namespace krok::bench
