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

Result<std::vector<std::byte>> Archive::read(const std::string& name,
                                             std::uint64_t most_bytes) const {
  zip_t* archive = handle_->archive;
  const zip_int64_t index = zip_name_locate(archive, name.c_str(), ZIP_FL_ENC_GUESS);
  if (index < 0) {
    return Error("file-missing", fmt::format("the archive has no file {}", shown(name)));
  }
  const auto too_large = [&] {
    return Error("file-too-large", fmt::format("{} in the archive exceeds the limit of {} bytes",
                                               shown(name), most_bytes));
  };
  const auto place = static_cast<zip_uint64_t>(index);
  zip_stat_t facts;
  zip_stat_init(&facts);
  if (zip_stat_index(archive, place, 0, &facts) == 0 && (facts.valid & ZIP_STAT_SIZE) != 0 &&
      facts.size > most_bytes) {
    return too_large();
  }
  zip_file_t* file = zip_fopen_index(archive, place, 0);
  if (file == nullptr) {
    return damaged(fmt::format("{} cannot be unpacked: {}", shown(name), zip_strerror(archive)));
  }
  // By what comes out, as the archive may say anything.
  const std::size_t step = std::clamp<std::uint64_t>(facts.size + 1, 1024, std::uint64_t{1} << 20);
  std::vector<std::byte> bytes;
  zip_int64_t got = 0;
  do {
    const std::size_t before = bytes.size();
    bytes.resize(before + step);
    got = zip_fread(file, bytes.data() + before, step);
    bytes.resize(before + static_cast<std::size_t>(std::max<zip_int64_t>(got, 0)));
  } while (got > 0 && bytes.size() <= most_bytes);
  const bool whole = zip_fclose(file) == 0 && got == 0;  // checks the checksum, too
  if (bytes.size() > most_bytes) return too_large();
  if (!whole) return damaged(fmt::format("{} in the archive is damaged", shown(name)));
  return bytes;
}

Result<std::vector<std::byte>> pack(
    std::span<const std::pair<std::string, std::vector<std::byte>>> files) {
  constexpr zip_uint16_t kFirstDate = 1 << 5 | 1;  // 1980-01-01
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* target = zip_source_buffer_create(nullptr, 0, 0, &error);
  zip_t* archive = target == nullptr ? nullptr : zip_open_from_source(target, ZIP_TRUNCATE, &error);
  if (archive == nullptr) {
    if (target != nullptr) zip_source_free(target);
    return damaged("the ZIP archive cannot be written");
  }
  zip_source_keep(target);
  bool good = true;
  for (const auto& [name, bytes] : files) {
    zip_source_t* source = zip_source_buffer(archive, bytes.data(), bytes.size(), 0);
    const zip_int64_t place =
        source == nullptr ? -1 : zip_file_add(archive, name.c_str(), source, ZIP_FL_ENC_UTF_8);
    good = good && place >= 0 &&
           zip_file_set_dostime(archive, static_cast<zip_uint64_t>(place), 0, kFirstDate, 0) == 0;
  }
  good = good && zip_close(archive) == 0;
  if (!good) zip_discard(archive);
  std::vector<std::byte> packed;
  zip_stat_t facts;
  zip_stat_init(&facts);
  if (good && zip_source_stat(target, &facts) == 0 && zip_source_open(target) == 0) {
    packed.resize(facts.size);
    good = zip_source_read(target, packed.data(), packed.size()) ==
           static_cast<zip_int64_t>(packed.size());
    zip_source_close(target);
  }
  zip_source_free(target);
  if (!good || packed.empty()) return damaged("the ZIP archive cannot be written");
  return packed;
}

}  // namespace krok::zip
