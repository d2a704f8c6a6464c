#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <filesystem>
#include <utility>

#include "core/appended_bytes_internal.h"
#include "core/file.h"
#include "core/temporary_files_internal.h"

namespace krok {

namespace {

// The target of a chain of symbolic links, whether or not it exists.
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

// Renames the temporary file; EEXIST if `no_clobber` and the name is taken. Of two programs with
// --no-clobber only one can succeed.
int put_in_place(const std::string& temporary, const std::string& target, bool no_clobber) {
  if (!no_clobber) return ::rename(temporary.c_str(), target.c_str()) == 0 ? 0 : errno;
  if (renameat2(AT_FDCWD, temporary.c_str(), AT_FDCWD, target.c_str(), RENAME_NOREPLACE) == 0) {
    return 0;
  }
  if (errno != EINVAL && errno != ENOSYS) return errno;
  // For file systems without RENAME_NOREPLACE: link() fails on an existing name too.
  if (link(temporary.c_str(), target.c_str()) != 0) return errno;
  unlink(temporary.c_str());
  return 0;
}

Error exists_error(const std::string& path) {
  return file_error("file-exists", path, "already exists and --no-clobber was given",
                    "choose another name or remove --no-clobber");
}

// Max sealed files without a name that wait to be put in place: each takes one of the descriptors
// that the process may have. Others get a temporary name.
int max_kept_open() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return 0;
  return static_cast<int>(std::min<rlim_t>(limit.rlim_cur, rlim_t{1} << 20) / 2);
}
std::atomic<int> kept_open{0};

constexpr mode_t kPermissions = 0777;  // without the setuid, setgid and sticky bits

// What no text has: a terminal would take other bytes for commands.
bool has_zero(std::span<const std::span<const std::byte>> parts) {
  return std::ranges::any_of(parts, [](std::span<const std::byte> part) {
    return std::ranges::find(part, std::byte{0}) != part.end();
  });
}

std::string folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

}  // namespace

struct OutputFile::State {
  std::string path;       // as given by the caller, for messages
  std::string target;     // the file to replace, symbolic links resolved
  std::string temporary;  // name until put in place; empty if it has none
  int descriptor = -1;
  // The file has no name until it is put in place, if the file system supports that: a program that
  // is killed leaves nothing.
  bool unnamed = false;
  std::string unnamed_path;  // where it can be read until then
  bool is_kept_open = false;
  std::atomic<int>* slot = nullptr;
  bool sealed = false;
  enum class Placed { no, anew, exchanged, for_good } placed = Placed::no;
  bool no_clobber = false;
  bool stored_later = false;
  bool to_terminal = false;
  AppendedBytes bytes;
  Status failure;

  ~State() { discard(); }

  // Whether bytes are written directly to `path`.
  bool direct() const { return temporary.empty() && !unnamed; }

  void open(int to, bool is_stream) {
    descriptor = to;
    to_terminal = is_stream && isatty(to) == 1;
    bytes = AppendedBytes(to, is_stream);
  }

  // Opens a file in the target's folder: one without a name if the file system supports that,
  // otherwise one with a temporary name.
  Status open_beside_target(const mode_t* replaced_mode) {
    const std::string folder = folder_of(target);
    tidy_once(folder);
    open(create_unnamed(folder), false);
    unnamed = descriptor >= 0;
    if (unnamed) {
      unnamed_path = path_of_unnamed(descriptor);
      if (replaced_mode) (void)fchmod(descriptor, *replaced_mode & kPermissions);
      return {};
    }
    Temporary created = create_temporary(folder);
    if (created.descriptor < 0) {
      const int why = errno;
      std::error_code unknown;
      if (!std::filesystem::is_directory(folder, unknown)) {
        return file_error(
            "file-unwritable", path, fmt::format("folder {} does not exist", folder),
            target.ends_with('/') ? "a file is written: add its name" : "create the folder first");
      }
      return file_error("file-unwritable", path,
                        fmt::format("cannot be created: {}", system_text(why)));
    }
    open(created.descriptor, false);
    temporary = std::move(created.path);
    slot = created.slot;
    // The mode of the replaced file, or the default.
    (void)fchmod(descriptor,
                 replaced_mode ? (*replaced_mode & kPermissions) : (0666 & ~mode_mask()));
    return {};
  }

  void close() {
    if (descriptor > STDERR_FILENO) ::close(descriptor);
    descriptor = -1;
    unnamed = false;
    if (std::exchange(is_kept_open, false)) --kept_open;
  }

  // Call when the temporary name no longer exists.
  void forget_name() {
    forget_temporary(slot);
    temporary.clear();
  }

  void discard() {
    close();
    if (temporary.empty()) return;
    unlink(temporary.c_str());
    forget_name();
  }

  Status fail(int error_number, const char* what) {
    failure =
        file_error("file-unwritable", path, fmt::format("{}: {}", what, system_text(error_number)),
                   error_number == ENOSPC ? "free some disk space; nothing was changed" : "");
    return failure;
  }

  Status written(int trouble) {
    return trouble == 0 ? Status() : fail(trouble, "cannot be written");
  }

  // Flushes to disk, unless store_files() is called later for many files.
  Status store() {
    const bool later = stored_later && access(target.c_str(), F_OK) != 0 && errno == ENOENT;
    if (later) {
      // For small files, starting writeback costs more than it saves at the end.
      constexpr std::uint64_t kWorthAStart = std::uint64_t{1} << 16;
      if (bytes.not_stored() >= kWorthAStart) bytes.start_storing();
      return {};
    }
    return written(fsync(descriptor) == 0 ? 0 : errno);
  }

  Status seal() {
    if (!failure) return failure;
    if (sealed) return {};
    if (Status status = written(bytes.flush()); !status) return status;
    bytes.end();
    if (!direct()) {
      if (Status status = store(); !status) return status;
    }
    sealed = true;
    if (unnamed) {
      is_kept_open = ++kept_open <= max_kept_open();
      if (is_kept_open) return {};
      --kept_open;
      if (Status status = give_temporary_name(); !status) return status;
    }
    const int closing = std::exchange(descriptor, -1);
    if (closing > STDERR_FILENO && ::close(closing) != 0) return written(errno);
    return {};
  }

  // Gives the file its name. With `can_go_back`, the replaced file is kept under the temporary name
  // for now.
  Status place(bool can_go_back) {
    placed = Placed::for_good;
    if (direct()) return {};
    if (unnamed) {
      const int trouble = name_unnamed(descriptor, target);
      if (trouble == 0) {
        close();
        placed = Placed::anew;
        return {};
      }
      if (trouble != EEXIST || no_clobber) return cannot_be_placed(trouble);
      // No call links a file in place of another one: it takes a name for a moment.
      if (Status status = give_temporary_name(); !status) return status;
      close();
    }
    bool is_new = no_clobber;
    struct stat status {};
    if (can_go_back && !no_clobber) {
      const bool is_file = lstat(target.c_str(), &status) == 0 && !S_ISDIR(status.st_mode);
      if (is_file && swap_names()) {
        placed = Placed::exchanged;
        return {};
      }
      is_new = !is_file;
    }
    const int trouble = put_in_place(temporary, target, no_clobber);
    if (trouble != 0) return cannot_be_placed(trouble);
    if (is_new) placed = Placed::anew;
    forget_name();
    return {};
  }

  Status cannot_be_placed(int trouble) {
    placed = Placed::no;
    failure = trouble == EEXIST ? Status(exists_error(path))
                                : fail(trouble, "cannot be moved into place");
    return failure;
  }

  // The descriptor stays open.
  Status give_temporary_name() {
    Temporary named = name_as_temporary(descriptor, folder_of(target));
    if (named.descriptor < 0) return cannot_be_placed(errno);
    temporary = std::move(named.path);
    slot = named.slot;
    unnamed = false;
    return {};
  }

  void take_back() {
    if (placed == Placed::anew) unlink(target.c_str());
    if (placed == Placed::exchanged) (void)swap_names();
    placed = Placed::no;
  }

  bool swap_names() const {
    return renameat2(AT_FDCWD, temporary.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0;
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
  state->stored_later = options.stored_later;
  if (path == "-") {
    state->open(STDOUT_FILENO, true);
    return OutputFile(std::move(state));
  }
  if (path.empty()) return Error("file-unwritable", "the output file name is empty");
  struct stat status {};
  bool exists = lstat(path.c_str(), &status) == 0;
  // A symbolic link is followed: its target is replaced, not the link.
  const bool is_link = exists && S_ISLNK(status.st_mode);
  state->target = is_link ? link_target(path).string() : path;
  if (is_link) exists = stat(path.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) {
    return file_error("file-directory", path, "is a folder, not a file",
                      "specify a file name for the output");
  }
  if (exists && !S_ISREG(status.st_mode)) {
    state->open(::open(path.c_str(), O_WRONLY | O_CLOEXEC), true);
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
  const mode_t* replaced_mode = exists ? &status.st_mode : nullptr;
  if (Status opened = state->open_beside_target(replaced_mode); !opened) return opened.error();
  return OutputFile(std::move(state));
}

Status OutputFile::write(std::span<const std::span<const std::byte>> parts) {
  assert(!state_->sealed);
  if (!state_->failure) return state_->failure;
  if (state_->to_terminal && has_zero(parts)) {
    state_->failure =
        file_error("file-terminal", state_->path, "is a terminal, and the output is not text",
                   "redirect it (> FILE or a pipe), or use -o FILE");
    return state_->failure;
  }
  return state_->written(state_->bytes.append(parts));
}

bool OutputFile::can_overwrite() const {
  return !state_->direct();
}

Status OutputFile::overwrite(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (!state_->failure) return state_->failure;
  if (state_->direct()) {
    return file_error("file-unwritable", state_->path, "is a stream and cannot be overwritten");
  }
  if (Status status = state_->written(state_->bytes.flush()); !status) return status;
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
  return state_->bytes.size();
}

Status OutputFile::seal() {
  return state_->seal();
}

const std::string& OutputFile::written_at() const {
  if (state_->unnamed) return state_->unnamed_path;
  return state_->temporary.empty() ? state_->path : state_->temporary;
}

Status OutputFile::place_all(std::span<OutputFile> files) {
  const auto give_up = [&](const Status& failure) {
    for (auto file = files.rbegin(); file != files.rend(); ++file) file->state_->take_back();
    for (OutputFile& file : files) file.state_->discard();
    return failure;
  };
  for (OutputFile& file : files) {
    if (const Status status = file.seal(); !status) return give_up(status);
  }
  for (OutputFile& file : files) {
    if (const Status status = file.state_->place(files.size() > 1); !status) return give_up(status);
  }
  // Removes the replaced files.
  for (OutputFile& file : files) file.state_->discard();
  return {};
}

Status OutputFile::commit() {
  return place_all({this, 1});
}

Status write_file(const std::string& path, std::span<const std::byte> bytes,
                  OutputFile::Options options) {
  auto file = OutputFile::create(path, options);
  if (!file) return file.error();
  if (Status status = file->write(bytes); !status) return status;
  return file->commit();
}

Status write_file(const std::string& path, std::string_view text, OutputFile::Options options) {
  return write_file(path, std::as_bytes(std::span(text)), options);
}

Status store_files(const std::string& folder) {
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) {
    return file_error("file-unwritable", folder,
                      fmt::format("cannot be opened: {}", system_text(errno)));
  }
  const int trouble = syncfs(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  if (trouble == 0) return {};
  return file_error("file-unwritable", folder,
                    fmt::format("data written there may be lost: {}", system_text(trouble)));
}

}  // namespace krok
