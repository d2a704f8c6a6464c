#include "captures/paired.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

namespace krok::bench {

namespace {

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

template <typename Value>
double median_of(const std::vector<ProcessCost>& runs, Value value) {
  std::vector<double> values;
  for (const ProcessCost& run : runs) values.push_back(value(run));
  return median(std::move(values));
}

}  // namespace

ProcessCost run_process(const std::vector<std::string>& command) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
  }
  ProcessCost cost;
  const auto begin = std::chrono::steady_clock::now();
  pid_t child = 0;
  const int trouble =
      posix_spawn(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  rusage usage{};
  if (trouble != 0 || wait4(child, &status, 0, &usage) != child) {
    cost.failed = true;
    return cost;
  }
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  cost.wall = wall.count();
  cost.cpu = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  cost.peak_mib = static_cast<double>(usage.ru_maxrss) / 1024;
  cost.failed = !WIFEXITED(status) || WEXITSTATUS(status) != 0;
  return cost;
}

double PairedRuns::median_wall(std::size_t command) const {
  return median_of(runs[command], [](const ProcessCost& run) { return run.wall; });
}

double PairedRuns::median_cpu(std::size_t command) const {
  return median_of(runs[command], [](const ProcessCost& run) { return run.cpu; });
}

double PairedRuns::median_peak(std::size_t command) const {
  return median_of(runs[command], [](const ProcessCost& run) { return run.peak_mib; });
}

double PairedRuns::ratio(std::size_t command, std::size_t to) const {
  std::vector<double> ratios;
  for (std::size_t round = 0; round < runs[command].size(); ++round) {
    ratios.push_back(runs[command][round].wall / runs[to][round].wall);
  }
  return median(std::move(ratios));
}

PairedRuns run_paired(const std::vector<std::vector<std::string>>& commands, int rounds,
                      const std::function<void(std::size_t)>& prepare) {
  PairedRuns result;
  result.runs.resize(commands.size());
  for (int round = -1; round < rounds; ++round) {
    for (std::size_t i = 0; i < commands.size(); ++i) {
      prepare(i);
      const ProcessCost cost = run_process(commands[i]);
      if (round >= 0 || cost.failed) result.runs[i].push_back(cost);
    }
  }
  return result;
}

}  // namespace krok::bench
