#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>

// For LD_PRELOAD: lets one call of a program's fail. KROK_FAIL_CALL names it (open, read, write,
// rename, sync, mmap or close), KROK_FAIL_AT says which of them in order, from 1. When it fails,
// the empty file KROK_FAIL_MARK is created. What ends in /dev/null and messages on standard error
// do not count.

namespace {

template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

// Whether this call is the one. Threads may call at the same time: one of them takes the number.
bool fails(const char* kind) {
  static std::atomic<int> count{0};
  static const char* const chosen = std::getenv("KROK_FAIL_CALL");
  if (chosen == nullptr || std::strcmp(chosen, kind) != 0) return false;
  static const int at = std::atoi(std::getenv("KROK_FAIL_AT"));
  if (++count != at) return false;
  const int mark = next<int(const char*, int, ...)>("open")(std::getenv("KROK_FAIL_MARK"),
                                                            O_WRONLY | O_CREAT, 0666);
  if (mark >= 0) next<int(int)>("close")(mark);
  return true;
}

bool is_device(const char* path) {
  return path == nullptr || std::strncmp(path, "/dev/", 5) == 0 ||
         std::strncmp(path, "/proc/", 6) == 0 || std::strncmp(path, "/sys/", 5) == 0;
}

int refuse(int error) {
  errno = error;
  return -1;
}

mode_t mode_of(int flags, va_list list) {
  const bool creates = (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE;
  return creates ? va_arg(list, mode_t) : 0;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list list;
  va_start(list, flags);
  const mode_t mode = mode_of(flags, list);
  va_end(list);
  if (!is_device(path) && fails("open")) return refuse(EIO);
  return next<int(const char*, int, ...)>("open")(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list list;
  va_start(list, flags);
  const mode_t mode = mode_of(flags, list);
  va_end(list);
  if (!is_device(path) && fails("open")) return refuse(EIO);
  return next<int(const char*, int, ...)>("open64")(path, flags, mode);
}

ssize_t read(int descriptor, void* bytes, size_t count) {
  if (fails("read")) return refuse(EIO);
  return next<ssize_t(int, void*, size_t)>("read")(descriptor, bytes, count);
}

// Closes all the same, as Linux does.
int close(int descriptor) {
  const bool failing = descriptor > STDERR_FILENO && fails("close");
  const int result = next<int(int)>("close")(descriptor);
  return failing ? refuse(EIO) : result;
}

ssize_t write(int descriptor, const void* bytes, size_t count) {
  if (descriptor != STDERR_FILENO && fails("write")) return refuse(ENOSPC);
  return next<ssize_t(int, const void*, size_t)>("write")(descriptor, bytes, count);
}

ssize_t writev(int descriptor, const iovec* parts, int count) {
  if (descriptor != STDERR_FILENO && fails("write")) return refuse(ENOSPC);
  return next<ssize_t(int, const iovec*, int)>("writev")(descriptor, parts, count);
}

ssize_t pwrite(int descriptor, const void* bytes, size_t count, off_t offset) {
  if (fails("write")) return refuse(ENOSPC);
  return next<ssize_t(int, const void*, size_t, off_t)>("pwrite")(descriptor, bytes, count, offset);
}

ssize_t pwrite64(int descriptor, const void* bytes, size_t count, off64_t offset) {
  if (fails("write")) return refuse(ENOSPC);
  return next<ssize_t(int, const void*, size_t, off64_t)>("pwrite64")(descriptor, bytes, count,
                                                                      offset);
}

int rename(const char* from, const char* to) {
  if (fails("rename")) return refuse(EIO);
  return next<int(const char*, const char*)>("rename")(from, to);
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  if (fails("rename")) return refuse(EIO);
  return next<int(int, const char*, int, const char*, unsigned)>("renameat2")(from_folder, from,
                                                                              to_folder, to, flags);
}

int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) {
  if (fails("rename")) return refuse(EIO);
  return next<int(int, const char*, int, const char*, int)>("linkat")(from_folder, from, to_folder,
                                                                      to, flags);
}

int fsync(int descriptor) {
  if (fails("sync")) return refuse(EIO);
  return next<int(int)>("fsync")(descriptor);
}

int syncfs(int descriptor) {
  if (fails("sync")) return refuse(EIO);
  return next<int(int)>("syncfs")(descriptor);
}

void* mmap(void* place, size_t size, int access, int flags, int descriptor, off_t offset) {
  if (descriptor >= 0 && fails("mmap")) {
    errno = ENOMEM;
    return MAP_FAILED;
  }
  return next<void*(void*, size_t, int, int, int, off_t)>("mmap")(place, size, access, flags,
                                                                  descriptor, offset);
}

void* mmap64(void* place, size_t size, int access, int flags, int descriptor, off64_t offset) {
  if (descriptor >= 0 && fails("mmap")) {
    errno = ENOMEM;
    return MAP_FAILED;
  }
  return next<void*(void*, size_t, int, int, int, off64_t)>("mmap64")(place, size, access, flags,
                                                                      descriptor, offset);
}
}
