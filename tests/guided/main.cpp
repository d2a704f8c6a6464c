#include <sys/prctl.h>

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "guided/memory_watch.h"
#include "guided/seeds.h"
#include "guided/targets.h"

// krok_targets --list: the targets' names.
// krok_targets --seeds FOLDER: writes inputs to start from, FOLDER/TARGET/NAME.
// krok_targets TARGET FILE|FOLDER...: runs a target on files, each once. `make test` does so with
// what fuzzing has found before (kept/TARGET).
// krok_targets TARGET: under afl-fuzz, in builds for it.

namespace {

using krok::guided::Target;

void run_exact(const Target& target, const unsigned char* bytes, std::size_t size) {
  // An exact-size copy, so that the sanitizer detects reads past the end.
  const std::unique_ptr<std::byte[]> copy(new std::byte[size]);
  for (std::size_t i = 0; i < size; ++i) copy[i] = static_cast<std::byte>(bytes[i]);
  krok::guided::begin_memory_watch();
  target.run(std::span<const std::byte>(copy.get(), size));
  if (target.writes) return;  // measures by itself
  // The limit that the process of another library has by default.
  const auto most = static_cast<std::int64_t>((std::size_t{256} << 20) + 64 * size);
  if (krok::guided::peak_memory() > most) {
    krok::guided::fail(std::to_string(krok::guided::peak_memory() >> 20) + " MiB for " +
                       std::to_string(size) + " bytes");
  }
}

void run_file(const Target& target, const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  std::cerr << target.name << " " << path.string() << "\n";
  run_exact(target, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
}

}  // namespace

#ifdef KROK_GUIDED
// AFL++'s interface of persistent mode, as its headers for compilers expand it.
// NOLINTBEGIN(bugprone-reserved-identifier)
extern "C" {
extern unsigned int* __afl_fuzz_len;
extern unsigned char* __afl_fuzz_ptr;
extern int __afl_sharedmem_fuzzing;
int __afl_persistent_loop(unsigned int most);
void __afl_manual_init();
}

static int run_under_afl(const Target& target) {
  // afl-fuzz looks for these in the program.
  static const volatile char* const persistent = "##SIG_AFL_PERSISTENT##";
  static const volatile char* const deferred = "##SIG_AFL_DEFER_FORKSRV##";
  (void)*persistent;
  (void)*deferred;
  __afl_sharedmem_fuzzing = 1;
  __afl_manual_init();
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // afl-fuzz may leave this process stopped behind
  while (__afl_persistent_loop(5000) != 0) run_exact(target, __afl_fuzz_ptr, *__afl_fuzz_len);
  return 0;
}
// NOLINTEND(bugprone-reserved-identifier)
#else
static int run_under_afl(const Target&) {
  std::cerr << "krok_targets: built without coverage; give files\n";
  return 2;
}
#endif

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.empty() || arguments[0] == "--list") {
    for (const Target& target : krok::guided::targets()) std::cout << target.name << "\n";
    return 0;
  }
  if (arguments.size() == 2 && arguments[0] == "--seeds") {
    krok::guided::write_seeds(arguments[1]);
    return 0;
  }
  for (const Target& target : krok::guided::targets()) {
    if (target.name != arguments[0]) continue;
    if (arguments.size() == 1) return run_under_afl(target);
    for (std::size_t i = 1; i < arguments.size(); ++i) {
      if (!std::filesystem::is_directory(arguments[i])) {
        run_file(target, arguments[i]);
        continue;
      }
      for (const auto& entry : std::filesystem::recursive_directory_iterator(arguments[i])) {
        if (entry.is_regular_file()) run_file(target, entry.path());
      }
    }
    return 0;
  }
  std::cerr << "krok_targets: no target '" << arguments[0] << "'; see --list\n";
  return 2;
}
