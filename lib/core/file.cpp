#include "core/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <span>
#include <vector>

#include "core/hash.h"

namespace krok {

namespace {

Error file_error(const char* code, const std::string& path, std::string message,
                 std::string hint = {}) {
  return Error(code, std::move(message), std::move(hint)).in_file(path);
}

std::string system_text(int error_number) {
  return std::strerror(error_number);
}

// Temporary files that a signal must remove. A fixed table, because a signal handler may not
// allocate or lock: a slot is claimed, filled, and marked ready once its file is there.
enum SlotState : int { slot_free, slot_changing, slot_opening, slot_ready };
struct TemporarySlot {
  std::atomic<int> state{slot_free};
  char path[PATH_MAX];
};
std::array<TemporarySlot, 256> temporary_slots;
std::atomic<bool> ending_by_signal{false};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may not wait");
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may not wait");

int remember_temporary(const std::string& path) {
  if (path.size() >= PATH_MAX) return -1;
  for (std::size_t i = 0; i < temporary_slots.size(); ++i) {
    int free = slot_free;
    if (!temporary_slots[i].state.compare_exchange_strong(free, slot_changing)) continue;
    std::memcpy(temporary_slots[i].path, path.c_str(), path.size() + 1);
    temporary_slots[i].state.store(slot_opening);
    return static_cast<int>(i);
  }
  return -1;
}

void mark_ready(int slot) {
  if (slot >= 0) temporary_slots[static_cast<std::size_t>(slot)].state.store(slot_ready);
}

void forget_temporary(int slot) {
  if (slot >= 0) temporary_slots[static_cast<std::size_t>(slot)].state.store(slot_free);
}

extern "C" void remove_temporaries_and_end(int signal_number) {
  // Other threads go on until the process ends. One that is just opening a file is waited for, not
  // for long: it may be the very thread that this handler interrupted.
  ending_by_signal.store(true);
  constexpr int kWaits = 50;
  for (int i = 0; i < kWaits; ++i) {
    bool opening = false;
    for (auto& slot : temporary_slots) opening |= slot.state.load() == slot_opening;
    if (!opening) break;
    const timespec millisecond{0, 1'000'000};
    nanosleep(&millisecond, nullptr);
  }
  for (auto& slot : temporary_slots) {
    const int state = slot.state.load();
    if (state == slot_opening || state == slot_ready) unlink(slot.path);
  }
  signal(signal_number, SIG_DFL);
  raise(signal_number);
}

// Once a signal is about to end the program, no new file is begun.
void stop_if_ending(int slot) {
  if (!ending_by_signal.load()) return;
  forget_temporary(slot);
  for (;;) pause();
}

// The process's file mode mask. It can only be read by setting it, which would race between
// threads, so that is done once.
mode_t mode_mask() {
  static const mode_t mask = [] {
    const mode_t current = umask(0);
    umask(current);
    return current;
  }();
  return mask;
}

// What a chain of symbolic links ends in, whether or not that exists.
std::filesystem::path link_target(std::filesystem::path path) {
  constexpr int kMaxLinks = 40;
  for (int i = 0; i < kMaxLinks; ++i) {
    std::error_code no_link;
    const std::filesystem::path target = std::filesystem::read_symlink(path, no_link);
    if (no_link) break;
    path = target.is_absolute() ? target : path.parent_path() / target;
  }
  return path;
}

// What the names of temporary files begin with, before the number of their process: which machine
// and process namespace that number belongs to, for a folder may be shared.
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

struct Temporary {
  std::string path;
  int descriptor = -1;
  int slot = -1;
};

// A new file in `folder`, private to the user. Its name is remembered before it exists, so that a
// signal at any moment removes it. errno tells why the descriptor is -1.
Temporary create_temporary(const std::string& folder) {
  static std::atomic<unsigned> counter{0};
  constexpr int kAttempts = 1000;  // names that killed programs left behind
  Temporary temporary;
  for (int i = 0; i < kAttempts; ++i) {
    temporary.path =
        fmt::format("{}/{}{}-{}", folder, temporary_prefix(), getpid(), counter.fetch_add(1));
    temporary.slot = remember_temporary(temporary.path);
    stop_if_ending(temporary.slot);
    temporary.descriptor =
        ::open(temporary.path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (temporary.descriptor >= 0) {
      mark_ready(temporary.slot);
      break;
    }
    const int why = errno;
    forget_temporary(temporary.slot);
    errno = why;
    if (why != EEXIST) break;
  }
  return temporary;
}

// Gives the temporary file its name; EEXIST where `no_clobber` and the name is taken. Two programs
// with --no-clobber cannot both win.
int put_in_place(const std::string& temporary, const std::string& target, bool no_clobber) {
  if (!no_clobber) return ::rename(temporary.c_str(), target.c_str()) == 0 ? 0 : errno;
  if (renameat2(AT_FDCWD, temporary.c_str(), AT_FDCWD, target.c_str(), RENAME_NOREPLACE) == 0) {
    return 0;
  }
  if (errno != EINVAL && errno != ENOSYS) return errno;
  // A file system that cannot do that in one step: link() refuses an existing name too.
  if (link(temporary.c_str(), target.c_str()) != 0) return errno;
  unlink(temporary.c_str());
  return 0;
}

Error exists_error(const std::string& path) {
  return file_error("file-exists", path, "exists already and --no-clobber was given",
                    "choose another name or leave --no-clobber out");
}

}  // namespace

struct InputFile::Content {
  void* mapped = nullptr;
  std::size_t mapped_size = 0;
  std::size_t released = 0;  // what before is given back already
  std::vector<std::byte> owned;

  ~Content() {
    if (mapped != nullptr) munmap(mapped, mapped_size);
  }
};

InputFile::InputFile(std::string path, std::unique_ptr<Content> content)
    : path_(std::move(path)), content_(std::move(content)) {}
InputFile::InputFile(InputFile&&) noexcept = default;
InputFile& InputFile::operator=(InputFile&&) noexcept = default;
InputFile::~InputFile() = default;

std::span<const std::byte> InputFile::bytes() const {
  if (content_->mapped != nullptr) {
    return {static_cast<const std::byte*>(content_->mapped), content_->mapped_size};
  }
  return content_->owned;
}

std::string_view InputFile::text() const {
  const auto all = bytes();
  return {reinterpret_cast<const char*>(all.data()), all.size()};
}

std::uint64_t InputFile::checksum() const {
  constexpr std::size_t kStretch = std::size_t{4} << 20;
  const auto all = bytes();
  if (all.size() <= kStretch) return xxh3(all);
  Xxh3Stream stream;
  for (std::size_t at = 0; at < all.size(); at += kStretch) {
    stream.update(all.subspan(at, std::min(kStretch, all.size() - at)));
    release_before(at + kStretch);
  }
  return stream.digest();
}

void InputFile::release_before(std::size_t offset) const {
  constexpr std::size_t kStretch = std::size_t{4} << 20;  // worth a call; whole pages
  Content& content = *content_;
  if (content.mapped == nullptr) return;
  const std::size_t end = std::min(offset, content.mapped_size) / kStretch * kStretch;
  // Going back means that the file is read once more from its front.
  if (end < content.released) content.released = 0;
  if (end == content.released) return;
  // The mapping is private and nothing was written to it, so the file's bytes come back. Where the
  // system does not follow, nothing is lost but memory.
  (void)madvise(static_cast<std::byte*>(content.mapped) + content.released, end - content.released,
                MADV_DONTNEED);
  content.released = end;
}

Result<InputFile> InputFile::open(const std::string& path, std::uint64_t limit) {
  const bool standard_input = path == "-";
  const int descriptor = standard_input ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    if (errno == ENOENT || errno == ENOTDIR) {
      return file_error("file-missing", path, "no such file", "check the path");
    }
    return file_error("file-unreadable", path,
                      fmt::format("cannot be opened: {}", system_text(errno)));
  }
  struct Closer {
    int descriptor;
    ~Closer() {
      if (descriptor > STDERR_FILENO) ::close(descriptor);
    }
  } closer{descriptor};

  struct stat status {};
  if (fstat(descriptor, &status) != 0) {
    return file_error("file-unreadable", path,
                      fmt::format("cannot be examined: {}", system_text(errno)));
  }
  if (S_ISDIR(status.st_mode)) {
    return file_error("file-directory", path, "is a folder, not a file", "name a file inside it");
  }
  const auto too_large = [&] {
    return file_error("file-too-large", path, fmt::format("is larger than {} bytes", limit));
  };
  auto content = std::make_unique<Content>();
  if (S_ISREG(status.st_mode) && status.st_size > 0) {
    const auto size = static_cast<std::uint64_t>(status.st_size);
    if (size > limit) return too_large();
    void* mapped = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (mapped != MAP_FAILED) {
      content->mapped = mapped;
      content->mapped_size = size;
      return InputFile(path, std::move(content));
    }
  }
  // What cannot be mapped takes memory byte by byte, and a device may never end.
  limit = std::min(limit, InputFile::kStreamLimit);
  std::array<std::byte, 1 << 16> buffer;
  for (;;) {
    const ssize_t count = ::read(descriptor, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      return file_error("file-unreadable", path,
                        fmt::format("cannot be read: {}", system_text(errno)));
    }
    if (count == 0) break;
    content->owned.insert(content->owned.end(), buffer.begin(), buffer.begin() + count);
    if (content->owned.size() > limit) return too_large();
  }
  return InputFile(path, std::move(content));
}

struct OutputFile::State {
  std::string path;       // as the caller wrote it, for messages
  std::string target;     // what is replaced, through symbolic links
  std::string temporary;  // empty where bytes go to `path` directly
  int descriptor = -1;
  int slot = -1;
  bool no_clobber = false;
  std::uint64_t written = 0;  // by the caller
  std::uint64_t given = 0;    // of these, to the system
  std::uint64_t storing = 0;  // of these, told to be stored
  std::vector<std::byte> pending;
  Status failure;

  ~State() { discard(); }

  void close() {
    if (descriptor > STDERR_FILENO) ::close(descriptor);
    descriptor = -1;
  }

  void discard() {
    close();
    if (!temporary.empty()) {
      unlink(temporary.c_str());
      forget_temporary(slot);
      temporary.clear();
    }
  }

  Status fail(int error_number, const char* what) {
    failure =
        file_error("file-unwritable", path, fmt::format("{}: {}", what, system_text(error_number)),
                   error_number == ENOSPC ? "free some space, nothing was changed" : "");
    return failure;
  }

  Status write_now(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) return fail(errno, "cannot be written");
      bytes = bytes.subspan(static_cast<std::size_t>(count));
      given += static_cast<std::uint64_t>(count);
    }
    start_storing();
    return {};
  }

  // Has the disk begin with what was written, so that fsync() at the end has little to wait for.
  // Only a beginning: what fails here, fsync() tells.
  void start_storing() {
    constexpr std::uint64_t kStretch = std::uint64_t{8} << 20;
    if (temporary.empty() || given - storing < kStretch) return;
    (void)sync_file_range(descriptor, static_cast<off_t>(storing),
                          static_cast<off_t>(given - storing), SYNC_FILE_RANGE_WRITE);
    storing = given;
  }

  Status flush_pending() {
    const Status done = write_now(pending);
    pending.clear();
    return done;
  }
};

OutputFile::OutputFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
OutputFile::OutputFile(OutputFile&&) noexcept = default;
OutputFile& OutputFile::operator=(OutputFile&&) noexcept = default;
OutputFile::~OutputFile() = default;

Result<OutputFile> OutputFile::create(const std::string& path, Options options) {
  auto state = std::make_unique<State>();
  state->path = path;
  state->no_clobber = options.no_clobber;
  if (path == "-") {
    state->descriptor = STDOUT_FILENO;
    return OutputFile(std::move(state));
  }
  if (path.empty()) return Error("file-unwritable", "the output has no name");
  struct stat status {};
  const bool exists = stat(path.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) {
    return file_error("file-directory", path, "is a folder, not a file",
                      "give the output a file name");
  }
  if (exists && !S_ISREG(status.st_mode)) {
    state->descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (state->descriptor < 0) {
      return file_error("file-unwritable", path,
                        fmt::format("cannot be opened: {}", system_text(errno)));
    }
    return OutputFile(std::move(state));
  }
  if (exists && options.no_clobber) {
    return exists_error(path);
  }
  if (exists && access(path.c_str(), W_OK) != 0) {
    return file_error("file-unwritable", path,
                      fmt::format("cannot be replaced: {}", system_text(errno)));
  }
  // Through a link, the file that it points to is replaced, not the link.
  state->target = link_target(path).string();
  std::string folder = std::filesystem::path(state->target).parent_path().string();
  if (folder.empty()) folder = ".";
  Temporary temporary = create_temporary(folder);
  if (temporary.descriptor < 0) {
    const int why = errno;
    std::error_code unknown;
    if (!std::filesystem::is_directory(folder, unknown)) {
      return file_error("file-unwritable", path, fmt::format("there is no folder {}", folder),
                        "create the folder first");
    }
    return file_error("file-unwritable", path,
                      fmt::format("cannot be created: {}", system_text(why)));
  }
  state->descriptor = temporary.descriptor;
  state->temporary = std::move(temporary.path);
  state->slot = temporary.slot;
  // The result gets the mode it would have had, or had before; not the bits that lend out rights.
  (void)fchmod(state->descriptor, exists ? (status.st_mode & 0777) : (0666 & ~mode_mask()));
  return OutputFile(std::move(state));
}

Status OutputFile::write(std::span<const std::byte> bytes) {
  if (!state_->failure) return state_->failure;
  state_->written += bytes.size();
  constexpr std::size_t kBuffer = std::size_t{1} << 18;
  // Enough to be worth a call of its own is not copied.
  constexpr std::size_t kLarge = std::size_t{1} << 16;
  if (bytes.size() < kLarge && state_->pending.size() + bytes.size() < kBuffer) {
    state_->pending.insert(state_->pending.end(), bytes.begin(), bytes.end());
    return {};
  }
  if (Status flushed = state_->flush_pending(); !flushed) return flushed;
  if (bytes.size() >= kLarge) return state_->write_now(bytes);
  state_->pending.assign(bytes.begin(), bytes.end());
  return {};
}

bool OutputFile::can_overwrite() const {
  return !state_->temporary.empty();
}

Status OutputFile::overwrite(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (!state_->failure) return state_->failure;
  if (state_->temporary.empty()) {
    return file_error("file-unwritable", state_->path, "is a stream and cannot be rewritten");
  }
  if (Status flushed = state_->flush_pending(); !flushed) return flushed;
  while (!bytes.empty()) {
    const ssize_t count =
        pwrite(state_->descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return state_->fail(errno, "cannot be written");
    offset += static_cast<std::uint64_t>(count);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return {};
}

std::uint64_t OutputFile::size() const {
  return state_->written;
}

Status OutputFile::sync() {
  State& state = *state_;
  if (!state.failure) return state.failure;
  if (Status flushed = state.flush_pending(); !flushed) return flushed;
  if (!state.temporary.empty() && fsync(state.descriptor) != 0) {
    return state.fail(errno, "cannot be written");
  }
  return {};
}

Status OutputFile::commit() {
  State& state = *state_;
  if (state.failure) {
    if (Status flushed = state.flush_pending(); !flushed) return flushed;
  }
  if (!state.failure) {
    const Status failure = state.failure;
    state.discard();
    return failure;
  }
  if (state.temporary.empty()) {
    if (state.descriptor > STDERR_FILENO && ::close(state.descriptor) != 0) {
      state.descriptor = -1;
      return state.fail(errno, "cannot be written");
    }
    state.descriptor = -1;
    return {};
  }
  if (fsync(state.descriptor) != 0) {
    const Status failure = state.fail(errno, "cannot be written");
    state.discard();
    return failure;
  }
  if (::close(state.descriptor) != 0) {
    state.descriptor = -1;
    const Status failure = state.fail(errno, "cannot be written");
    state.discard();
    return failure;
  }
  state.descriptor = -1;
  const int trouble = put_in_place(state.temporary, state.target, state.no_clobber);
  if (trouble != 0) {
    if (trouble == EEXIST && state.no_clobber) {
      state.failure = exists_error(state.path);
    } else {
      state.failure = state.fail(trouble, "cannot be put in place");
    }
    const Status failure = state.failure;
    state.discard();
    return failure;
  }
  forget_temporary(state.slot);
  state.temporary.clear();
  return {};
}

Status write_file(const std::string& path, std::span<const std::byte> bytes,
                  OutputFile::Options options) {
  auto file = OutputFile::create(path, options);
  if (!file) return file.error();
  if (Status written = file->write(bytes); !written) return written;
  return file->commit();
}

Status write_file(const std::string& path, std::string_view text, OutputFile::Options options) {
  return write_file(path, std::as_bytes(std::span(text)), options);
}

void remove_temporaries_of_killed(const std::string& folder) {
  std::error_code unreadable;
  for (std::filesystem::directory_iterator entry(folder, unreadable), end; entry != end;
       entry.increment(unreadable)) {
    const std::string name = entry->path().filename().string();
    if (name.rfind(temporary_prefix(), 0) != 0) continue;
    const std::string numbers = name.substr(temporary_prefix().size());
    pid_t process = 0;
    const auto parsed = std::from_chars(numbers.data(), numbers.data() + numbers.size(), process);
    if (parsed.ec != std::errc() || process <= 0 || *parsed.ptr != '-') continue;
    if (::kill(process, 0) != 0 && errno == ESRCH) unlink(entry->path().c_str());
  }
}

void remove_temporaries_on_signals() {
  (void)mode_mask();  // while there is one thread
  struct sigaction action {};
  action.sa_handler = remove_temporaries_and_end;
  sigemptyset(&action.sa_mask);
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    // What the caller ignores stays ignored: nohup, a shell's background jobs.
    struct sigaction before {};
    if (sigaction(signal_number, nullptr, &before) == 0 && before.sa_handler == SIG_IGN) continue;
    sigaction(signal_number, &action, nullptr);
  }
}

std::string base_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

std::string extension(const std::string& path) {
  std::string text = std::filesystem::path(path).extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace krok
