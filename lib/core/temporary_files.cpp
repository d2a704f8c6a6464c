#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cstring>
#include <filesystem>
#include <functional>
#include <mutex>
#include <new>
#include <set>
#include <span>
#include <string_view>

#include "core/file.h"
#include "core/hash.h"
#include "core/temporary_files_internal.h"

namespace krok {

namespace {

// Temporary files to remove on a signal. A signal handler must not allocate or lock, so they are
// kept in tables that never move: a slot is claimed, filled, and marked ready once its file exists.
// Another table is allocated when all are full, and never freed.
enum SlotState : int { slot_free, slot_changing, slot_opening, slot_ready };
struct Table {
  static constexpr std::size_t kSlots = 256;
  std::array<std::atomic<int>, kSlots> states{};
  char paths[kSlots][PATH_MAX];
  std::atomic<Table*> next{nullptr};
};
Table first_table;
std::atomic<bool> ending{false};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler must not wait");
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler must not wait");
static_assert(std::atomic<Table*>::is_always_lock_free, "a signal handler must not wait");

// The table after `table`; null if there is none and no memory for one.
Table* following(Table& table) {
  if (Table* next = table.next.load()) return next;
  Table* added = new (std::nothrow) Table;
  Table* other = nullptr;
  if (added == nullptr || table.next.compare_exchange_strong(other, added)) return added;
  delete added;  // another thread was first
  return other;
}

// Null if the path cannot be registered.
std::atomic<int>* remember_temporary(const std::string& path) {
  if (path.size() >= PATH_MAX) return nullptr;
  for (Table* table = &first_table; table != nullptr; table = following(*table)) {
    for (std::size_t i = 0; i < Table::kSlots; ++i) {
      int free = slot_free;
      if (!table->states[i].compare_exchange_strong(free, slot_changing)) continue;
      std::memcpy(table->paths[i], path.c_str(), path.size() + 1);
      table->states[i].store(slot_opening);
      return &table->states[i];
    }
  }
  return nullptr;
}

bool any_is_opening() {
  for (Table* table = &first_table; table != nullptr; table = table->next.load()) {
    for (const auto& state : table->states) {
      if (state.load() == slot_opening) return true;
    }
  }
  return false;
}

extern "C" void remove_temporaries_and_end(int signal_number) {
  remove_temporaries();
  signal(signal_number, SIG_DFL);
  raise(signal_number);
}

// Creates no new file once the program is about to end.
void stop_if_ending(std::atomic<int>* slot) {
  if (!ending.load()) return;
  forget_temporary(slot);
  for (;;) pause();
}

// The prefix of temporary file names, before the process id: identifies the machine and process
// namespace of that id, since a folder may be shared.
const std::string& temporary_prefix() {
  static const std::string prefix = [] {
    std::array<char, 256> host{};
    (void)gethostname(host.data(), host.size() - 1);
    std::error_code unknown;
    const std::string place = std::string(host.data()) + "/" +
                              std::filesystem::read_symlink("/proc/self/ns/pid", unknown).string();
    return fmt::format(".krok-{}-", hex(xxh3(std::as_bytes(std::span(place)))));
  }();
  return prefix;
}

// When a process started, in clock ticks since the machine did (proc(5), "starttime"), which tells
// it from a later one with the same id; 0 if unknown.
std::uint64_t start_of(pid_t process) {
  std::array<char, 1024> buffer;
  const int file = ::open(fmt::format("/proc/{}/stat", process).c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  const ssize_t count = ::read(file, buffer.data(), buffer.size());
  ::close(file);
  const std::string_view text(buffer.data(), count > 0 ? static_cast<std::size_t>(count) : 0);
  // The second of the fields is a name in parentheses, which may hold anything.
  std::size_t at = text.rfind(')');
  constexpr int kFields = 20;
  for (int i = 0; i < kFields && at != std::string::npos; ++i) at = text.find(' ', at + 1);
  std::uint64_t start = 0;
  if (at != std::string::npos) {
    (void)std::from_chars(text.data() + at + 1, text.data() + text.size(), start);
  }
  return start;
}

// Whether the process that a temporary file's name gives as "id-start-" exists no longer.
bool is_of_gone_process(std::string_view numbers) {
  pid_t process = 0;
  std::uint64_t start = 0;
  const char* const end = numbers.data() + numbers.size();
  const auto id = std::from_chars(numbers.data(), end, process);
  if (id.ec != std::errc() || process <= 0 || id.ptr == end || *id.ptr != '-') return false;
  if (::kill(process, 0) != 0) return errno == ESRCH;
  const auto since = std::from_chars(id.ptr + 1, end, start);
  if (since.ec != std::errc() || since.ptr == end || *since.ptr != '-') return false;
  const std::uint64_t now = start_of(process);
  return start != 0 && now != 0 && start != now;
}

// Signals that end a program by default: requests, limits, faults.
constexpr int kEndingSignals[] = {SIGINT,    SIGTERM, SIGHUP,  SIGPIPE, SIGQUIT, SIGALRM,
                                  SIGVTALRM, SIGPROF, SIGUSR1, SIGUSR2, SIGPOLL, SIGXCPU,
                                  SIGABRT,   SIGBUS,  SIGSEGV, SIGFPE,  SIGILL,  SIGSYS};

// Creates a temporary file under an unused name with `make`, which returns its descriptor, or -1
// and sets errno. The name is registered before the file exists.
Temporary with_new_name(const std::string& folder,
                        const std::function<int(const char* path)>& make) {
  static std::atomic<unsigned> counter{0};
  constexpr int kAttempts = 1000;  // names left by killed programs
  Temporary temporary;
  for (int i = 0; i < kAttempts; ++i) {
    temporary.path = fmt::format("{}/{}{}-{}-{}", folder, temporary_prefix(), getpid(),
                                 start_of(getpid()), counter.fetch_add(1));
    temporary.slot = remember_temporary(temporary.path);
    stop_if_ending(temporary.slot);
    temporary.descriptor = make(temporary.path.c_str());
    if (temporary.descriptor >= 0) {
      if (temporary.slot != nullptr) temporary.slot->store(slot_ready);
      break;
    }
    const int why = errno;
    forget_temporary(temporary.slot);
    errno = why;
    if (why != EEXIST) break;
  }
  return temporary;
}

}  // namespace

mode_t mode_mask() {
  static const mode_t mask = [] {
    const mode_t current = umask(0);
    umask(current);
    return current;
  }();
  return mask;
}

Temporary create_temporary(const std::string& folder) {
  return with_new_name(folder, [](const char* path) {
    return ::open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  });
}

int create_unnamed(const std::string& folder) {
  // Files are named through /proc, which some sandboxes do not have.
  static const bool can_be_named = access("/proc/self/fd", X_OK) == 0;
  if (!can_be_named) return -1;
  return ::open(folder.c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666);
}

std::string path_of_unnamed(int descriptor) {
  return fmt::format("/proc/self/fd/{}", descriptor);
}

int name_unnamed(int descriptor, const std::string& path) {
  const int done = linkat(AT_FDCWD, path_of_unnamed(descriptor).c_str(), AT_FDCWD, path.c_str(),
                          AT_SYMLINK_FOLLOW);
  return done == 0 ? 0 : errno;
}

Temporary name_as_temporary(int unnamed, const std::string& folder) {
  return with_new_name(folder, [unnamed](const char* path) {
    const int trouble = name_unnamed(unnamed, path);
    errno = trouble;
    return trouble == 0 ? unnamed : -1;
  });
}

void remove_temporaries() {
  // Other threads run until the process ends. Waits briefly for one that is just opening a file: it
  // may be the very thread that the signal interrupted.
  ending.store(true);
  constexpr int kWaits = 50;
  for (int i = 0; i < kWaits && any_is_opening(); ++i) {
    const timespec millisecond{0, 1'000'000};
    nanosleep(&millisecond, nullptr);
  }
  for (Table* table = &first_table; table != nullptr; table = table->next.load()) {
    for (std::size_t i = 0; i < Table::kSlots; ++i) {
      const int state = table->states[i].load();
      if (state == slot_opening || state == slot_ready) unlink(table->paths[i]);
    }
  }
}

void forget_temporary(std::atomic<int>* slot) {
  if (slot != nullptr) slot->store(slot_free);
}

void remove_temporaries_of_killed(const std::string& folder) {
  std::error_code unreadable;
  for (std::filesystem::directory_iterator entry(folder, unreadable), end; entry != end;
       entry.increment(unreadable)) {
    const std::string name = entry->path().filename().string();
    if (name.rfind(temporary_prefix(), 0) != 0) continue;
    const std::string numbers = name.substr(temporary_prefix().size());
    if (is_of_gone_process(numbers)) unlink(entry->path().c_str());
  }
}

void tidy_once(const std::string& folder) {
  static std::mutex changing;
  static std::set<std::string> tidied;
  const std::lock_guard lock(changing);
  if (tidied.insert(folder).second) remove_temporaries_of_killed(folder);
}

void remove_temporaries_on_signals() {
  (void)mode_mask();  // while there is only one thread
  struct sigaction action {};
  action.sa_handler = remove_temporaries_and_end;
  sigemptyset(&action.sa_mask);
  for (const int signal_number : kEndingSignals) {
    // Signals that are ignored stay ignored (nohup, background jobs of a shell), and those handled
    // by a profiler or a sanitizer are left alone.
    struct sigaction before {};
    if (sigaction(signal_number, nullptr, &before) == 0 && before.sa_handler != SIG_DFL) continue;
    sigaction(signal_number, &action, nullptr);
  }
  // Makes exceeding the file size limit an error of write().
  signal(SIGXFSZ, SIG_IGN);
}

}  // namespace krok
