#include "core/fed_program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>

#include "core/child_process.h"
#include "core/text.h"

namespace krok {

// Named, because State holds some.
namespace fed_program {

class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(); }

  int number() const { return number_; }
  bool valid() const { return number_ >= 0; }
  void close() {
    if (number_ >= 0) (void)::close(std::exchange(number_, -1));
  }

 private:
  int number_ = -1;
};

}  // namespace fed_program

namespace {

using fed_program::Descriptor;

constexpr int kResultNumber = 3;
constexpr std::size_t kMaxMessage = 400;  // characters of what a program printed

Error start_error(const std::string& path, int number) {
  return Error("program-start", fmt::format("cannot start {}: {}", path, std::strerror(number)));
}

std::vector<std::byte> content_of(const Descriptor& file) {
  struct stat status {};
  std::vector<std::byte> bytes;
  if (fstat(file.number(), &status) != 0 || status.st_size <= 0) return bytes;
  bytes.resize(static_cast<std::size_t>(status.st_size));
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count =
        pread(file.number(), bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  bytes.resize(done);
  return bytes;
}

// What a program printed, as one line that fits a message.
std::string printed(const Descriptor& errors) {
  const std::vector<std::byte> bytes = content_of(errors);
  std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  std::ranges::replace(text, '\n', ' ');
  if (text.size() > kMaxMessage) text = "..." + text.substr(text.size() - kMaxMessage);
  return shown(text);
}

}  // namespace

struct FedProgram::State {
  std::string path;
  pid_t process = -1;
  fed_program::Descriptor input, result, errors;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (process < 0) return;
    input.close();
    (void)kill(process, SIGKILL);
    (void)wait();
  }

  int wait() {
    int status = 0;
    while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    process = -1;
    return status;
  }

  Error failed(int status) const {
    const std::string text = printed(errors);
    const std::string how = WIFSIGNALED(status) ? "ended by " + signal_text(WTERMSIG(status))
                                                : fmt::format("exit code {}", WEXITSTATUS(status));
    return Error("program-failed",
                 fmt::format("{} failed ({}){}", path, how, text.empty() ? "" : ": " + text));
  }
};

std::optional<std::string> find_program(const std::string& name) {
  const char* folders = std::getenv("PATH");
  std::string_view left = folders == nullptr ? "/usr/bin:/bin" : folders;
  for (;;) {
    const std::size_t end = std::min(left.find(':'), left.size());
    const std::string folder(left.substr(0, end));
    std::string path = folder;
    path.append("/").append(name);
    struct stat status {};
    if (!folder.empty() && stat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode) &&
        access(path.c_str(), X_OK) == 0) {
      return path;
    }
    if (end == left.size()) return std::nullopt;
    left.remove_prefix(end + 1);
  }
}

FedProgram::FedProgram(std::unique_ptr<State> state) : state_(std::move(state)) {}
FedProgram::FedProgram(FedProgram&&) noexcept = default;
FedProgram& FedProgram::operator=(FedProgram&&) noexcept = default;
FedProgram::~FedProgram() = default;

Result<FedProgram> FedProgram::start(const std::string& path,
                                     const std::vector<std::string>& arguments) {
  auto state = std::make_unique<State>();
  state->path = path;
  // A socket: writing to one whose reader is gone can be kept from raising SIGPIPE.
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return start_error(path, errno);
  }
  state->input = Descriptor(ends[0]);
  const Descriptor other(ends[1]);
  (void)shutdown(ends[0], SHUT_RD);
  state->result = Descriptor(memfd_create("result", MFD_CLOEXEC));
  state->errors = Descriptor(memfd_create("errors", MFD_CLOEXEC));
  if (!state->result.valid() || !state->errors.valid()) return start_error(path, errno);

  std::vector<std::string> words = {path};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> word_pointers;
  for (std::string& word : words) word_pointers.push_back(word.data());
  word_pointers.push_back(nullptr);
  const char* folders = std::getenv("PATH");
  std::string variable = fmt::format("PATH={}", folders == nullptr ? "/usr/bin:/bin" : folders);
  std::array<char*, 2> environment = {variable.data(), nullptr};

  posix_spawn_file_actions_t actions;
  if (const int number = posix_spawn_file_actions_init(&actions); number != 0) {
    return start_error(path, number);
  }
  int number = posix_spawn_file_actions_adddup2(&actions, other.number(), STDIN_FILENO);
  if (number == 0) {
    number = posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  }
  if (number == 0) {
    number = posix_spawn_file_actions_adddup2(&actions, state->errors.number(), STDERR_FILENO);
  }
  if (number == 0) {
    number = posix_spawn_file_actions_adddup2(&actions, state->result.number(), kResultNumber);
  }
  if (number == 0) {
    number = posix_spawn(&state->process, path.c_str(), &actions, nullptr, word_pointers.data(),
                         environment.data());
  }
  (void)posix_spawn_file_actions_destroy(&actions);
  if (number != 0) {
    state->process = -1;
    return start_error(path, number);
  }
  return FedProgram(std::move(state));
}

Status FedProgram::feed(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = send(state_->input.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      state_->input.close();
      return state_->failed(state_->wait());
    }
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return {};
}

Result<std::vector<std::byte>> FedProgram::finish() {
  state_->input.close();
  const int status = state_->wait();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return state_->failed(status);
  return content_of(state_->result);
}

}  // namespace krok
