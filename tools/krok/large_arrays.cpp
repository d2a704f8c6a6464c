// Operators new and delete of the tools: large arrays live in files.
//
// A motion of a million frames takes gigabytes while it is edited, in memory that the system cannot
// take back. Beyond kInMemory of them, arrays of kLarge and more are mapped from files without
// names in $TMPDIR, or else /var/tmp, where large temporary files belong (file-hierarchy(7)): the
// system writes out what is not in use and drops it as it drops what it has read of files. Results
// are the same either way. Without such a folder, without room in it, or where it is memory itself
// (tmpfs), all arrays are in memory.
#include <fcntl.h>
#include <linux/magic.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/statfs.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <new>

// Sanitizers have operators of their own.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(KROK_GUIDED)

namespace {

constexpr std::size_t kLarge = std::size_t{8} << 20;       // bytes
constexpr std::size_t kInMemory = std::size_t{128} << 20;  // bytes, of large arrays
constexpr std::uintptr_t kPage = 4096;

std::atomic<std::size_t> large_in_memory{0};

struct Mapped {
  void* begin = nullptr;
  std::size_t size = 0;
};
constexpr std::size_t kMaxMapped = 1024;
Mapped mapped[kMaxMapped];
std::mutex changing_mapped;

int open_unnamed() {
  const char* folder = std::getenv("TMPDIR");
  if (folder == nullptr || *folder == 0) folder = "/var/tmp";
  const int file = ::open(folder, O_RDWR | O_TMPFILE | O_EXCL | O_CLOEXEC, 0600);
  struct statfs where {};
  if (file >= 0 && fstatfs(file, &where) == 0 && where.f_type != TMPFS_MAGIC) return file;
  if (file >= 0) ::close(file);
  return -1;
}

// Null if there is no room.
void* map_file(std::size_t size) noexcept {
  const std::lock_guard lock(changing_mapped);
  Mapped* slot = mapped;
  while (slot != mapped + kMaxMapped && slot->begin != nullptr) ++slot;
  if (slot == mapped + kMaxMapped) return nullptr;
  const int file = open_unnamed();
  if (file < 0) return nullptr;
  // Reserved, so that a full disk is not found on the way.
  void* begin = MAP_FAILED;
  if (fallocate(file, 0, 0, static_cast<off_t>(size)) == 0) {
    begin = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  }
  ::close(file);
  if (begin == MAP_FAILED) return nullptr;
  *slot = {begin, size};
  return begin;
}

bool unmap(void* begin) noexcept {
  const std::lock_guard lock(changing_mapped);
  for (Mapped& one : mapped) {
    if (one.begin != begin) continue;
    munmap(begin, one.size);
    one = {};
    return true;
  }
  return false;
}

void* allocate(std::size_t size) noexcept {
  if (size >= kLarge && large_in_memory.load() + size > kInMemory) {
    if (void* memory = map_file(size)) return memory;
  }
  void* memory = std::malloc(size == 0 ? 1 : size);
  if (size >= kLarge && memory != nullptr) large_in_memory += malloc_usable_size(memory);
  return memory;
}

// Not inlined, so that the compiler cannot pair an allocation with its release.
[[gnu::noinline]] void release(void* memory) noexcept {
  if (memory == nullptr) return;
  if (reinterpret_cast<std::uintptr_t>(memory) % kPage == 0 && unmap(memory)) return;
  const std::size_t size = malloc_usable_size(memory);
  if (size >= kLarge) large_in_memory -= size;
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) {
  for (;;) {
    if (void* memory = allocate(size)) return memory;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return allocate(size);
}
void operator delete(void* memory) noexcept {
  release(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  release(memory);
}

#endif
