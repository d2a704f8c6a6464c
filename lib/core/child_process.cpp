#include "core/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <span>

namespace krok {

namespace {

// Sanitizers reserve terabytes of address space and inspect memory through pipes that they open.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

using Clock = std::chrono::steady_clock;

constexpr double kMaxSeconds = 1e6;
// A busy machine must not stop work that takes a second, and a child that waits forever must end.
constexpr double kWallPerCpu = 10;

// The pipe carries one header, then `size` bytes.
struct Header {
  std::uint32_t magic = kMagic;
  std::uint32_t end = 0;
  std::uint64_t size = 0;

  static constexpr std::uint32_t kMagic = 0x6B726F6B;
};

struct Pipe {
  int read_end = -1;
  int write_end = -1;
  ~Pipe() {
    close_end(read_end);
    close_end(write_end);
  }
  static void close_end(int& end) {
    if (end >= 0) ::close(end);
    end = -1;
  }
};

// ---- In the child. Nothing here returns to the caller's code. ----

int result_descriptor = -1;

void send(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(result_descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return;  // the caller is gone
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

[[noreturn]] void finish(ChildEnd end, std::span<const std::byte> bytes) {
  Header header;
  header.end = static_cast<std::uint32_t>(end);
  header.size = bytes.size();
  send(std::as_bytes(std::span(&header, 1)));
  send(bytes);
  _exit(0);  // skips exit handlers: buffers, leak checks
}

[[noreturn]] void report_out_of_memory() {
  finish(ChildEnd::out_of_memory, {});
}

void set_limit(int resource, std::uint64_t value) {
  rlimit limit{};
  if (getrlimit(static_cast<__rlimit_resource>(resource), &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max = std::min<rlim_t>(value, limit.rlim_max);
  (void)setrlimit(static_cast<__rlimit_resource>(resource), &limit);
}

// SIGPROF ends the process after so many seconds of CPU time, SIGKILL if it ignores that.
void limit_cpu_time(double seconds) {
  itimerval timer{};
  const double whole = std::floor(seconds);
  timer.it_value.tv_sec = static_cast<time_t>(whole);
  timer.it_value.tv_usec = static_cast<suseconds_t>(std::ceil((seconds - whole) * 999'999));
  if (whole < 1 && timer.it_value.tv_usec == 0) timer.it_value.tv_usec = 1;
  (void)setitimer(ITIMER_PROF, &timer, nullptr);
  set_limit(RLIMIT_CPU, static_cast<std::uint64_t>(whole) + 2);
}

// Address space in use, bytes; read without allocating.
std::uint64_t address_space() {
  const int descriptor = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return 0;
  char text[64] = {};
  const ssize_t count = ::read(descriptor, text, sizeof(text) - 1);
  ::close(descriptor);
  if (count <= 0) return 0;
  return std::strtoull(text, nullptr, 10) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

// The caller's handlers would remove the caller's temporary files.
void forget_signal_handlers() {
  for (int number = 1; number < NSIG; ++number) ::signal(number, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

// Keeps the result's descriptor and points the standard ones to /dev/null.
void close_descriptors() {
  result_descriptor = fcntl(result_descriptor, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (nowhere >= 0) {
      dup2(nowhere, standard);
    } else {
      ::close(standard);
    }
  }
  const auto result = static_cast<unsigned>(result_descriptor);
  if (result > STDERR_FILENO + 1u) close_range(STDERR_FILENO + 1u, result - 1, 0);
  close_range(result + 1, ~0u, 0);
}

[[noreturn]] void run_here(const std::function<std::vector<std::byte>()>& work,
                           const ChildLimits& limits, pid_t caller) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != caller) _exit(1);
  forget_signal_handlers();
  close_descriptors();
  if (result_descriptor < 0) _exit(1);
  if (!kSanitized) {
    const std::uint64_t used = address_space();
    if (used > 0 && limits.memory_bytes < RLIM_INFINITY - used) {
      set_limit(RLIMIT_AS, used + limits.memory_bytes);
    }
  }
  set_limit(RLIMIT_CORE, 0);
  prctl(PR_SET_DUMPABLE, 0);  // no core for a collector either
  limit_cpu_time(std::clamp(limits.seconds, 0.0, kMaxSeconds));
  set_limit(RLIMIT_FSIZE, 0);
  if (!kSanitized) set_limit(RLIMIT_NOFILE, 0);  // nothing more can be opened
  std::set_new_handler(report_out_of_memory);
  const auto text = [](const char* what) {
    return std::as_bytes(std::span(what, std::min<std::size_t>(std::strlen(what), 4096)));
  };
  try {
    finish(ChildEnd::returned, work());
  } catch (const std::bad_alloc&) {
    report_out_of_memory();
  } catch (const std::exception& exception) {
    finish(ChildEnd::threw, text(exception.what()));
  } catch (...) {
    finish(ChildEnd::threw, text("an exception of unknown type"));
  }
}

// ---- In the caller. ----

enum class Arrival { whole, ended, late };

// Appends `count` bytes to `bytes`. Memory grows with the data received, not with the announced
// size.
Arrival receive(int descriptor, std::uint64_t count, Clock::time_point deadline,
                std::vector<std::byte>& bytes) {
  const std::size_t begin = bytes.size();
  std::size_t received = 0;
  while (received < count) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return Arrival::late;
    pollfd waiting{descriptor, POLLIN, 0};
    const int ready = poll(&waiting, 1, static_cast<int>(std::min<long long>(left, 60'000)));
    if (ready < 0 && errno != EINTR) return Arrival::ended;
    if (ready <= 0) continue;
    const std::size_t room = std::clamp<std::size_t>(received, 1 << 16, 1 << 26);
    const std::size_t part = std::min<std::uint64_t>(room, count - received);
    if (bytes.size() < begin + received + part) bytes.resize(begin + received + part);
    const ssize_t got = ::read(descriptor, bytes.data() + begin + received, part);
    if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (got <= 0) return Arrival::ended;
    received += static_cast<std::size_t>(got);
  }
  bytes.resize(begin + received);
  return Arrival::whole;
}

ChildReport report_of(ChildEnd end) {
  ChildReport report;
  report.end = end;
  return report;
}

// The child's report; `crashed` if it is incomplete.
ChildReport receive_report(int descriptor, const ChildLimits& limits, Clock::time_point deadline) {
  std::vector<std::byte> bytes;
  const auto unfinished = [](Arrival arrival) {
    return report_of(arrival == Arrival::late ? ChildEnd::out_of_time : ChildEnd::crashed);
  };
  Arrival arrival = receive(descriptor, sizeof(Header), deadline, bytes);
  if (arrival != Arrival::whole) return unfinished(arrival);
  Header header;
  std::memcpy(&header, bytes.data(), sizeof(header));
  const auto end = static_cast<ChildEnd>(header.end);
  const bool known = header.magic == Header::kMagic &&
                     (header.end == static_cast<std::uint32_t>(ChildEnd::returned) ||
                      header.end == static_cast<std::uint32_t>(ChildEnd::threw) ||
                      header.end == static_cast<std::uint32_t>(ChildEnd::out_of_memory));
  if (!known) return report_of(ChildEnd::crashed);
  constexpr std::uint64_t kMaxText = 4096;
  const std::uint64_t most = end == ChildEnd::returned ? limits.result_bytes : kMaxText;
  if (header.size > most) return report_of(ChildEnd::result_too_large);
  bytes.clear();
  arrival = receive(descriptor, header.size, deadline, bytes);
  if (arrival != Arrival::whole) return unfinished(arrival);
  ChildReport report = report_of(end);
  if (end == ChildEnd::returned) {
    report.bytes = std::move(bytes);
  } else {
    report.what.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  return report;
}

// Waits for the child to end; kills it at the deadline, or immediately if `at_once`. Returns
// whether it was killed here; `status` is that of wait4(), -1 if unknown, as `usage` is.
bool reap(pid_t child, bool at_once, Clock::time_point deadline, int& status, rusage& usage) {
  bool killed = false;
  for (long nap = 50'000;; nap = std::min(nap * 2, 10'000'000L)) {
    if (!killed && (at_once || Clock::now() >= deadline)) {
      ::kill(child, SIGKILL);
      killed = true;
    }
    const pid_t done = wait4(child, &status, killed ? 0 : WNOHANG, &usage);
    if (done == child) return killed;
    if (done < 0 && errno != EINTR) {
      status = -1;  // the caller ignores SIGCHLD, and the system has reaped it
      return killed;
    }
    if (!killed) {
      const timespec pause{0, nap};
      nanosleep(&pause, nullptr);
    }
  }
}

// Describes a crash from the child's exit status.
void describe_crash(int status, bool killed, ChildReport& report) {
  if (status == -1) {
    report.what = "the process ended before it was done";
  } else if (WIFSIGNALED(status)) {
    report.signal = WTERMSIG(status);
    report.what = signal_text(report.signal);
    const bool late = report.signal == SIGPROF || (killed && report.signal == SIGKILL);
    if (late) report = report_of(ChildEnd::out_of_time);
  } else {
    report.what = fmt::format("the process exited with code {} before it was done",
                              WIFEXITED(status) ? WEXITSTATUS(status) : -1);
  }
}

// Which clock stopped the child.
void describe_end_of_time(int status, const rusage& usage, double wall, ChildReport& report) {
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  const double cpu = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  report.signal = WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF ? SIGPROF : 0;
  report.what = fmt::format("{:.3g} seconds of CPU time", cpu);
  if (report.signal == 0) report.what = fmt::format("{:.4g} seconds with {}", wall, report.what);
}

}  // namespace

std::string signal_text(int signal) {
  switch (signal) {
    case SIGSEGV:
      return "segmentation fault";
    case SIGABRT:
      return "abort";
    case SIGBUS:
      return "bus error";
    case SIGFPE:
      return "arithmetic fault";
    case SIGILL:
      return "illegal instruction";
    case SIGKILL:
      return "killed, perhaps because the system is out of memory";
    case SIGXFSZ:
      return "attempt to write a file";
    default:
      return fmt::format("signal {}", signal);
  }
}

ChildReport run_in_child(const std::function<std::vector<std::byte>()>& work,
                         const ChildLimits& limits) {
  const auto not_started = [](int why) {
    ChildReport report;
    report.what = std::strerror(why);
    return report;
  };
  const double wall = kWallPerCpu * std::clamp(limits.seconds, 0.0, kMaxSeconds);
  Pipe pipe;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return not_started(errno);
  pipe.read_end = ends[0];
  pipe.write_end = ends[1];

  // The child must not run the caller's handlers before it has reset them.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t caller = getpid();
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(wall));
  const pid_t child = fork();
  if (child == 0) {
    result_descriptor = pipe.write_end;
    run_here(work, limits, caller);
  }
  const int why = errno;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (child < 0) return not_started(why);
  Pipe::close_end(pipe.write_end);

  ChildReport report;
  int status = 0;
  rusage usage{};
  try {
    report = receive_report(pipe.read_end, limits, deadline);
  } catch (...) {  // no memory for the result
    (void)reap(child, true, deadline, status, usage);
    throw;
  }
  const bool killed = reap(child, report.end != ChildEnd::crashed, deadline, status, usage);
  if (report.end == ChildEnd::crashed) describe_crash(status, killed, report);
  if (report.end == ChildEnd::out_of_time) describe_end_of_time(status, usage, wall, report);
  return report;
}

}  // namespace krok
