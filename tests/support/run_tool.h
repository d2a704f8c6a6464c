#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "support/this_build.h"

// Runs a program and captures its output. For tests of the real tools.

namespace krok::test {

struct ToolRun {
  int exit_code = -1;  // -1 if ended by a signal
  int signal = 0;      // the signal that ended the program, or 0
  bool timed_out = false;
  std::string out;  // standard output
  std::string err;  // standard error
};

struct ToolOptions {
  std::string input;        // standard input
  std::string output_path;  // redirects standard output, as to "/dev/full"
  std::string folder;       // the working directory
  double timeout = 60;      // seconds until the program is killed
  // Called repeatedly with the process id while the program runs, until it returns true.
  std::function<bool(pid_t)> meanwhile;
};

inline std::string text_of(std::FILE* file) {
  std::string text;
  std::rewind(file);
  char buffer[65536];
  for (std::size_t n = 0; (n = std::fread(buffer, 1, sizeof buffer, file)) > 0;)
    text.append(buffer, n);
  return text;
}

// `arguments` starts with the program's path. Standard streams are files, so that nothing blocks.
inline ToolRun run(const std::vector<std::string>& arguments, const ToolOptions& options = {}) {
  std::FILE* in = std::tmpfile();
  std::FILE* out = std::tmpfile();
  std::FILE* err = std::tmpfile();
  std::fwrite(options.input.data(), 1, options.input.size(), in);
  std::fflush(in);
  lseek(fileno(in), 0, SEEK_SET);
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);

  const pid_t child = fork();
  if (child == 0) {
    int output = fileno(out);
    if (!options.output_path.empty()) output = ::open(options.output_path.c_str(), O_WRONLY);
    dup2(fileno(in), STDIN_FILENO);
    dup2(output, STDOUT_FILENO);
    dup2(fileno(err), STDERR_FILENO);
    if (!options.folder.empty() && chdir(options.folder.c_str()) != 0) _exit(126);
    for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) signal(number, SIG_DFL);
    execv(argv[0], argv.data());
    _exit(127);
  }

  ToolRun result;
  const auto end = std::chrono::steady_clock::now() +
                   std::chrono::milliseconds(static_cast<int>(options.timeout * 1000));
  bool watching = static_cast<bool>(options.meanwhile);
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (watching) watching = !options.meanwhile(child);
    if (std::chrono::steady_clock::now() > end) {
      result.timed_out = true;
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
      break;
    }
    std::this_thread::sleep_for(std::chrono::microseconds(watching ? 200 : 2000));
  }
  if (WIFSIGNALED(status)) {
    result.signal = WTERMSIG(status);
  } else {
    result.exit_code = WEXITSTATUS(status);
  }
  result.out = text_of(out);
  result.err = text_of(err);
  for (std::FILE* file : {in, out, err}) std::fclose(file);
  return result;
}

// Keeps the report of a run, if it wrote one, for tests/support/check_reports.py.
inline void keep_report(const std::vector<std::string>& arguments, const ToolOptions& options,
                        const ToolRun& result) {
  static int count = 0;
  namespace fs = std::filesystem;
  std::string report;
  for (const std::string& argument : arguments) {
    if (argument == "--") break;
    if (argument == "--json" && options.output_path.empty()) report = result.out;
    if (!argument.starts_with("--json=")) continue;
    const fs::path path = fs::path(options.folder) / argument.substr(7);
    std::ifstream file(path, std::ios::binary);
    if (fs::is_regular_file(path)) {
      report.assign(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    }
  }
  // A refused report may name an input.
  if (!report.starts_with("{") || result.exit_code < 0) return;
  const fs::path folder = test::reports_folder();
  fs::create_directories(folder);
  std::ofstream kept(folder / (std::to_string(getpid()) + "_" + std::to_string(count++) + ".json"),
                     std::ios::binary);
  kept << report;
}

// A tool of this build.
inline ToolRun run_tool(const std::string& tool, std::vector<std::string> arguments,
                        const ToolOptions& options = {}) {
  arguments.insert(arguments.begin(), test::tools_folder() + "/" + tool);
  ToolRun result = run(arguments, options);
  keep_report(arguments, options, result);
  return result;
}

}  // namespace krok::test
