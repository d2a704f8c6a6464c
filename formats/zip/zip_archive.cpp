#include "formats/zip/zip_archive.h"

#include <fmt/format.h>
#include <zip.h>

#include <algorithm>

#include "core/text.h"

namespace krok::zip {

struct Archive::Handle {
  zip_t* archive = nullptr;
  Handle() = default;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (archive != nullptr) zip_discard(archive);
  }
};

namespace {

Error damaged(const std::string& what) {
  return Error("zip-damaged", what, "unpack it with another program, which may know better");
}

}  // namespace

Archive::Archive(std::unique_ptr<Handle> handle) : handle_(std::move(handle)) {}
Archive::Archive(Archive&&) noexcept = default;
Archive& Archive::operator=(Archive&&) noexcept = default;
Archive::~Archive() = default;

Result<Archive> Archive::open(std::span<const std::byte> bytes) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  auto handle = std::make_unique<Handle>();
  if (source != nullptr) handle->archive = zip_open_from_source(source, ZIP_RDONLY, &error);
  if (handle->archive == nullptr) {
    const std::string what = zip_error_strerror(&error);
    if (source != nullptr) zip_source_free(source);
    zip_error_fini(&error);
    return damaged("the ZIP archive cannot be read: " + what);
  }
  zip_error_fini(&error);
  Archive result(std::move(handle));
  const zip_int64_t count = zip_get_num_entries(result.handle_->archive, 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    const char* name =
        zip_get_name(result.handle_->archive, static_cast<zip_uint64_t>(i), ZIP_FL_ENC_GUESS);
    const std::string text = name == nullptr ? "" : name;
    if (!text.empty() && !text.ends_with('/')) result.names_.push_back(text);
  }
  return result;
}

namespace {

// A file inside, opened, with its size as the archive states it: 0 if it does not.
struct OpenedFile {
  std::shared_ptr<zip_file_t> file;
  std::uint64_t size = 0;
};

Error too_large(const std::string& name, std::uint64_t most_bytes) {
  return Error("file-too-large", fmt::format("{} in the archive exceeds the limit of {} bytes",
                                             shown(name), most_bytes));
}

Result<OpenedFile> open_file(zip_t* archive, const std::string& name, std::uint64_t most_bytes) {
  const zip_int64_t index = zip_name_locate(archive, name.c_str(), ZIP_FL_ENC_GUESS);
  if (index < 0) {
    return Error("file-missing", fmt::format("the archive has no file {}", shown(name)));
  }
  const auto place = static_cast<zip_uint64_t>(index);
  zip_stat_t facts;
  zip_stat_init(&facts);
  if (zip_stat_index(archive, place, 0, &facts) == 0 && (facts.valid & ZIP_STAT_SIZE) != 0 &&
      facts.size > most_bytes) {
    return too_large(name, most_bytes);
  }
  zip_file_t* const file = zip_fopen_index(archive, place, 0);
  if (file == nullptr) {
    return damaged(fmt::format("{} cannot be unpacked: {}", shown(name), zip_strerror(archive)));
  }
  return OpenedFile{{file, zip_fclose}, facts.size};
}

}  // namespace

Result<std::vector<std::byte>> Archive::read(const std::string& name,
                                             std::uint64_t most_bytes) const {
  auto opened = open_file(handle_->archive, name, most_bytes);
  if (!opened) return opened.error();
  zip_file_t* const file = opened->file.get();
  // By what comes out, as the archive may say anything.
  const std::size_t step =
      std::clamp<std::uint64_t>(opened->size + 1, 1024, std::uint64_t{1} << 20);
  std::vector<std::byte> bytes;
  zip_int64_t got = 0;
  do {
    const std::size_t before = bytes.size();
    bytes.resize(before + step);
    got = zip_fread(file, bytes.data() + before, step);
    bytes.resize(before + static_cast<std::size_t>(std::max<zip_int64_t>(got, 0)));
  } while (got > 0 && bytes.size() <= most_bytes);
  if (bytes.size() > most_bytes) return too_large(name, most_bytes);
  const bool whole = got == 0;  // the end, where the checksum is checked, too
  if (!whole) return damaged(fmt::format("{} in the archive is damaged", shown(name)));
  return bytes;
}

Result<Archive::Stream> Archive::stream(const std::string& name, std::uint64_t most_bytes) const {
  const auto opened = open_file(handle_->archive, name, most_bytes);
  if (!opened) return opened.error();
  return Stream([file = opened->file, name](std::span<std::byte> bytes) -> Status {
    std::byte none{};
    bool good = !bytes.empty() || zip_fread(file.get(), &none, 1) == 0;
    while (good && !bytes.empty()) {
      const zip_int64_t got = zip_fread(file.get(), bytes.data(), bytes.size());
      good = got > 0;
      if (good) bytes = bytes.subspan(static_cast<std::size_t>(got));
    }
    return good ? Status() : damaged(fmt::format("{} in the archive is damaged", shown(name)));
  });
}

namespace {

using WriteAt = std::function<Status(std::uint64_t offset, std::span<const std::byte> bytes)>;

// What libzip writes an archive to.
struct Target {
  const WriteAt& write_at;
  std::uint64_t offset = 0, size = 0;
  Status status = {};
  zip_error_t error{};
};

zip_int64_t run_command(void* state, void* data, zip_uint64_t length, zip_source_cmd_t command) {
  Target& target = *static_cast<Target*>(state);
  switch (command) {
    case ZIP_SOURCE_SUPPORTS:
      return ZIP_SOURCE_SUPPORTS_WRITABLE;
    case ZIP_SOURCE_STAT:
      zip_stat_init(static_cast<zip_stat_t*>(data));
      return sizeof(zip_stat_t);
    case ZIP_SOURCE_ERROR:
      return zip_error_to_data(&target.error, data, length);
    case ZIP_SOURCE_TELL_WRITE:
      return static_cast<zip_int64_t>(target.offset);
    case ZIP_SOURCE_SEEK_WRITE: {
      const zip_int64_t to =
          zip_source_seek_compute_offset(target.offset, target.size, data, length, &target.error);
      if (to >= 0) target.offset = static_cast<std::uint64_t>(to);
      return to < 0 ? -1 : 0;
    }
    case ZIP_SOURCE_WRITE:
      target.status = target.write_at(target.offset, {static_cast<const std::byte*>(data), length});
      if (!target.status) {
        zip_error_set(&target.error, ZIP_ER_WRITE, 0);
        return -1;
      }
      target.offset += length;
      target.size = std::max(target.size, target.offset);
      return static_cast<zip_int64_t>(length);
    default:
      return 0;
  }
}

// A file that libzip packs.
struct Entry {
  const FileToPack& file;
  Status& status;  // of reading, of all files
  std::uint64_t done = 0;
  zip_error_t error{};
};

zip_int64_t read_command(void* state, void* data, zip_uint64_t length, zip_source_cmd_t command) {
  Entry& entry = *static_cast<Entry*>(state);
  switch (command) {
    case ZIP_SOURCE_SUPPORTS:
      return ZIP_SOURCE_SUPPORTS_READABLE;
    case ZIP_SOURCE_STAT: {
      auto& facts = *static_cast<zip_stat_t*>(data);
      zip_stat_init(&facts);
      facts.size = entry.file.size;
      facts.valid |= ZIP_STAT_SIZE;
      return sizeof(zip_stat_t);
    }
    case ZIP_SOURCE_ERROR:
      return zip_error_to_data(&entry.error, data, length);
    case ZIP_SOURCE_READ: {
      const std::uint64_t count = std::min(length, entry.file.size - entry.done);
      if (count > 0) entry.status = entry.file.read({static_cast<std::byte*>(data), count});
      if (!entry.status) {
        zip_error_set(&entry.error, ZIP_ER_READ, 0);
        return -1;
      }
      entry.done += count;
      return static_cast<zip_int64_t>(count);
    }
    default:
      return 0;
  }
}

Status pack(std::span<const FileToPack> files, const WriteAt& write_at) {
  constexpr zip_uint16_t kFirstDate = 1 << 5 | 1;  // 1980-01-01
  zip_error_t error;
  zip_error_init(&error);
  Target state{write_at};
  zip_source_t* target = zip_source_function_create(run_command, &state, &error);
  zip_t* archive = target == nullptr ? nullptr : zip_open_from_source(target, ZIP_TRUNCATE, &error);
  if (archive == nullptr) {
    if (target != nullptr) zip_source_free(target);
    return damaged("the ZIP archive cannot be written");
  }
  bool good = true;
  std::vector<Entry> entries;
  entries.reserve(files.size());  // libzip keeps their addresses
  for (const FileToPack& file : files) {
    zip_source_t* source = zip_source_function(archive, read_command,
                                               &entries.emplace_back(Entry{file, state.status}));
    const zip_int64_t place =
        source == nullptr ? -1 : zip_file_add(archive, file.name.c_str(), source, ZIP_FL_ENC_UTF_8);
    good = good && place >= 0 &&
           zip_file_set_dostime(archive, static_cast<zip_uint64_t>(place), 0, kFirstDate, 0) == 0;
  }
  good = good && zip_close(archive) == 0;
  if (!good) zip_discard(archive);
  if (!state.status) return state.status;
  return good ? Status() : damaged("the ZIP archive cannot be written");
}

}  // namespace

Result<std::vector<std::byte>> pack(std::span<const FileToPack> files) {
  std::vector<std::byte> packed;
  const Status status = pack(files, [&](std::uint64_t offset, std::span<const std::byte> bytes) {
    packed.resize(std::max(packed.size(), offset + bytes.size()));
    std::ranges::copy(bytes, packed.begin() + static_cast<std::ptrdiff_t>(offset));
    return Status();
  });
  if (!status) return status.error();
  return packed;
}

Status pack(std::span<const FileToPack> files, OutputFile& file) {
  std::vector<std::byte> kept;  // of a stream, which cannot be written but in order
  const Status status = pack(files, [&](std::uint64_t offset, std::span<const std::byte> bytes) {
    if (!file.can_overwrite()) {
      kept.resize(std::max(kept.size(), offset + bytes.size()));
      std::ranges::copy(bytes, kept.begin() + static_cast<std::ptrdiff_t>(offset));
      return Status();
    }
    return offset < file.size() ? file.overwrite(offset, bytes) : file.write(bytes);
  });
  return status ? file.write(kept) : status;
}

}  // namespace krok::zip
