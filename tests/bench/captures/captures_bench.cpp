// The tools as whole processes on captures, in ratios against number_loop, which only parses the
// numbers of the same file. All commands of a table run in turn in each round, and the ratios are
// medians over the rounds; seconds alone say little on a shared machine. "plain write" writes as
// many bytes as the .anim file has, without computing anything: the part of the time that no reader
// can save. Results are put away before each run. Beside the figures it prints a hash of each
// result, which must be the same on every machine and for every number of threads.
//
// ext4 looks for inodes longer where files were deleted in the last five minutes
// (recently_deleted() in its ialloc.c): compiling right before makes a thousand files cost up to
// half as much again.
//
//   captures [CAPTURE.bvh [ROUNDS]]
//
// The captures are made by repeating the frames of CAPTURE.bvh: 94,419 of them (71 MB of 31
// joints), as many as make 1 MB, and a thousand times 20.

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "captures/long_capture.h"
#include "captures/paired.h"
#include "core/file.h"
#include "core/hash.h"
#include "support/this_build.h"

namespace {

namespace fs = std::filesystem;
using namespace krok;
using bench::PairedRuns;
using Command = std::vector<std::string>;

constexpr int kLongFrames = 94419;
constexpr int kShortFrames = 1380;
constexpr int kFiles = 1000;
constexpr int kFramesOfEach = 20;

struct Row {
  std::string name;
  Command command;
  std::string result;  // the file or folder that it makes, or empty
};

std::string hash_of(const std::string& path) {
  if (path.empty() || fs::is_directory(path)) return "";
  const auto file = InputFile::open(path);
  return file ? fmt::format("{} MB  {}", (file->bytes().size() + 500000) / 1000000,
                            hex(file->checksum()))
              : "missing";
}

// Returns whether all commands succeeded. Ratios are to the wall time of the first row.
bool print_table(const std::string& title, const std::vector<Row>& rows, int rounds) {
  std::vector<Command> commands;
  for (const Row& row : rows) commands.push_back(row.command);
  const PairedRuns runs = bench::run_paired(commands, rounds, [&](std::size_t i) {
    std::error_code none;
    if (fs::is_directory(rows[i].result, none)) {
      // Moved, not removed (see above).
      static int moved = 0;
      fs::rename(rows[i].result, fmt::format("{}-{}", rows[i].result, moved++), none);
    } else if (!rows[i].result.empty()) {
      fs::remove(rows[i].result, none);
    }
  });
  fmt::print("\n{}, medians of {} rounds\n", title, rounds);
  fmt::print("{:<30}{:>9}{:>9}{:>8}{:>10}  {}\n", "", "wall ms", "cpu ms", "ratio", "peak MiB",
             "result");
  bool good = true;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const auto& run : runs.runs[i]) good = good && !run.failed;
    fmt::print("{:<30}{:>9.1f}{:>9.1f}{:>8.2f}{:>10.1f}  {}\n", rows[i].name,
               1e3 * runs.median_wall(i), 1e3 * runs.median_cpu(i), runs.ratio(i, 0),
               runs.median_peak(i), hash_of(rows[i].result));
  }
  if (!good) fmt::print("a command failed\n");
  return good;
}

// The corpus's, where it is at hand; otherwise the project's own.
std::string default_capture() {
  const std::string corpus = test::corpus_folder() + "/bvh/assimp_testmodels/01_01.bvh";
  return fs::exists(corpus) ? corpus : test::source_folder() + "/samples/captures/walk.bvh";
}

struct Folder {
  fs::path path;
  explicit Folder(const std::string& parent) {
    std::string pattern = parent + "/krok-bench-XXXXXX";
    path = mkdtemp(pattern.data()) == nullptr ? fs::path() : fs::path(pattern);
  }
  ~Folder() {
    std::error_code ignored;
    if (!path.empty()) fs::remove_all(path, ignored);
  }
};

std::string tool(const char* name) {
  return test::tools_folder() + "/" + name;
}

bool print_batches(const std::string& title, const fs::path& from, const fs::path& folder,
                   int rounds) {
  const auto in = [&](const char* name) { return (folder / name).string(); };
  const auto batch = [&](const char* to, const char* jobs) {
    return Command{tool("krok-import"), from.string(), "--out-dir", in(to), "-q", "-j", jobs};
  };
  // What two programs that share nothing but the machine make of it.
  const std::string part = fmt::format("'{}' '{}' --out-dir '{}' -q -j 1 --shard ",
                                       tool("krok-import"), from.string(), in("parts"));
  const Command two_programs = {"/bin/sh", "-c", part + "1/2 & " + part + "2/2; wait"};
  return print_table(title,
                     {{"BVH to .anim, -j 2", batch("two", "2"), in("two")},
                      {"BVH to .anim, -j 1", batch("one", "1"), in("one")},
                      {"two programs, half of it each", two_programs, in("parts")}},
                     rounds);
}

int run(const std::string& capture, int rounds) {
  const Folder folder(test::tools_folder());
  if (folder.path.empty()) {
    fmt::print("no folder can be made in {}\n", test::tools_folder());
    return 1;
  }
  const auto in = [&](const char* name) { return (folder.path / name).string(); };
  const std::string parts = test::bench_parts();
  for (const auto& [frames, name] :
       {std::pair(kLongFrames, "long.bvh"), std::pair(kShortFrames, "short.bvh")}) {
    if (Status status = bench::write_long_capture(capture, frames, in(name)); !status) {
      fmt::print("{}: {}\n", status.error().where.file, status.error().message);
      return 1;
    }
  }
  fmt::print("captures of the frames of {}\n", fs::path(capture).filename().string());
  const auto import = [&](const char* from, const char* to, const char* jobs) {
    return Command{tool("krok-import"), in(from), "-o", in(to), "-q", "-j", jobs};
  };
  const auto to_glb = [&](const char* jobs) {
    return Command{tool("krok-export"), in("long.bvh"), "-o", in("long.glb"), "-q", "-j", jobs};
  };
  const Command loop = {parts + "/number_loop", in("long.bvh")};
  const Command short_loop = {parts + "/number_loop", in("short.bvh")};

  if (bench::run_process(import("long.bvh", "long.anim", "2")).failed) {
    fmt::print("krok-import failed\n");
    return 1;
  }
  const auto size = std::to_string(fs::file_size(in("long.anim")));
  bool good = print_table(
      fmt::format("{} frames, {} MB of BVH", kLongFrames, fs::file_size(in("long.bvh")) / 1000000),
      {{"number loop, one thread", loop, ""},
       {"BVH to .anim, -j 1", import("long.bvh", "long.anim", "1"), in("long.anim")},
       {"BVH to .anim, -j 2", import("long.bvh", "long.anim", "2"), in("long.anim")},
       {"BVH to .glb, -j 1", to_glb("1"), in("long.glb")},
       {"BVH to .glb, -j 2", to_glb("2"), in("long.glb")},
       {"plain write, .anim's size", {parts + "/plain_write", size, in("plain")}, in("plain")}},
      rounds);
  good = print_table(fmt::format("{} frames, {:.1f} MB of BVH", kShortFrames,
                                 static_cast<double>(fs::file_size(in("short.bvh"))) / 1e6),
                     {{"number loop, one thread", short_loop, ""},
                      {"BVH to .anim", import("short.bvh", "short.anim", "0"), in("short.anim")}},
                     5 * rounds) &&
         good;
  fs::create_directory(in("many"));
  for (int i = 0; i < kFiles; ++i) {
    const std::string path = in("many") + fmt::format("/{:04}.bvh", i);
    if (!bench::write_long_capture(capture, kFramesOfEach, path)) return 1;
  }
  const std::string title = fmt::format("{} files of {} frames", kFiles, kFramesOfEach);
  good = print_batches(title, in("many"), folder.path, rounds) && good;
  // Without a disk: what is left of the ratio is the program's own.
  const Folder memory("/dev/shm");
  if (memory.path.empty()) return good ? 0 : 1;
  fs::copy(in("many"), memory.path / "many");
  good = print_batches(title + ", in memory", memory.path / "many", memory.path, rounds) && good;
  return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 2 ? std::atoi(argv[2]) : 9;
  return run(argc > 1 ? argv[1] : default_capture(), rounds < 1 ? 1 : rounds);
}
