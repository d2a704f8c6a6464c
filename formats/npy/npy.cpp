#include "formats/npy/npy.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <numeric>
#include <string_view>

#include "core/text.h"

namespace krok::npy {

namespace {

constexpr std::string_view kMagic("\x93NUMPY", 6);
constexpr std::size_t kMaxHeader = 65535;
constexpr std::size_t kMaxDimensions = 32;  // as numpy
constexpr std::uint64_t kSmallArray = std::uint64_t{32} << 20;

Error damaged(std::string what) {
  return Error("npy-damaged", std::move(what), "save the array again with numpy.save");
}

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Reads the header, a Python dictionary such as
// {'descr': '<f4', 'fortran_order': False, 'shape': (170, 22, 3), }.
class Header {
 public:
  explicit Header(std::string_view text) : rest_(text) {}

  Status read(Array& array) {
    bool has_type = false, has_order = false, has_shape = false;
    if (!take('{')) return fault("{");
    while (!take('}')) {
      const auto key = quoted();
      if (!key || !take(':')) return fault("a key");
      Status status;
      if (*key == "descr") {
        has_type = true;
        status = read_type(array);
      } else if (*key == "fortran_order") {
        has_order = true;
        array.column_major = take_word("True");
        if (!array.column_major && !take_word("False")) return fault("True or False");
      } else if (*key == "shape") {
        has_shape = true;
        status = read_shape(array);
      } else {
        return damaged(fmt::format("the header has an unknown key {}", shown(*key)));
      }
      if (!status) return status;
      if (!take(',') && !starts('}')) return fault("a comma");
    }
    if (has_type && has_order && has_shape) return {};
    return damaged("the header has no type, order or shape");
  }

 private:
  void skip_space() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\n"), rest_.size()));
  }
  bool starts(char c) {
    skip_space();
    return rest_.starts_with(c);
  }
  bool take(char c) {
    if (!starts(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }
  bool take_word(std::string_view word) {
    skip_space();
    if (!rest_.starts_with(word)) return false;
    rest_.remove_prefix(word.size());
    return true;
  }
  std::optional<std::string_view> quoted() {
    skip_space();
    if (!starts('\'') && !starts('"')) return std::nullopt;
    const std::size_t end = rest_.find(rest_.front(), 1);
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view text = rest_.substr(1, end - 1);
    rest_.remove_prefix(end + 1);
    return text;
  }
  Status fault(const char* expected) {
    return damaged(fmt::format("the header has {} where {} is expected", shown(rest_.substr(0, 20)),
                               expected));
  }

  Status read_type(Array& array) {
    const auto text = quoted();
    if (!text) {
      return Error("npy-type", "the array has elements of several fields",
                   "save each field as an array of its own");
    }
    std::string_view type = *text;
    array.big_endian = type.starts_with('>');
    if (!type.empty() && std::string_view("<>|=").find(type.front()) != std::string_view::npos) {
      type.remove_prefix(1);
    }
    const char letter = type.empty() ? ' ' : type.front();
    if (letter == 'O') {
      return Error("npy-objects",
                   "the array holds Python objects (a pickle), which can run any program and are "
                   "never opened",
                   "in Python, for a file you trust: x = numpy.load(FILE, allow_pickle=True), then "
                   "numpy.savez(\"motion.npz\", positions=...) with its arrays of numbers");
    }
    constexpr std::string_view kLetters = "biufUS";
    const std::size_t kind = kLetters.find(letter);
    std::size_t size = 0;
    if (kind != std::string_view::npos) {
      const auto [end, trouble] = std::from_chars(type.data() + 1, type.data() + type.size(), size);
      if (trouble != std::errc() || end != type.data() + type.size()) size = kMaxHeader + 1;
    }
    array.element = static_cast<Element>(std::min<std::size_t>(kind, 5));
    const bool whole = letter == 'i' || letter == 'u';
    const bool known = (letter == 'b' && size == 1) ||
                       (whole && std::has_single_bit(size) && size <= 8) ||
                       (letter == 'f' && (size == 2 || size == 4 || size == 8)) ||
                       ((letter == 'U' || letter == 'S') && size <= kMaxHeader);
    if (kind == std::string_view::npos || !known) {
      return Error("npy-type", fmt::format("elements of type {} are not read", shown(*text)),
                   "save numbers: array.astype(\"float32\")");
    }
    array.item_size = letter == 'U' ? 4 * size : size;
    return {};
  }

  Status read_shape(Array& array) {
    if (!take('(')) return fault("a shape");
    array.shape.clear();
    while (!take(')')) {
      skip_space();
      std::size_t size = 0;
      const auto [end, trouble] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), size);
      if (trouble != std::errc()) return fault("a number");
      rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
      if (array.shape.size() == kMaxDimensions) return damaged("the array has over 32 dimensions");
      array.shape.push_back(size);
      if (!take(',') && !starts(')')) return fault("a comma");
    }
    return {};
  }

  std::string_view rest_;
};

// Whether the shape is that of so many bytes, without overflow.
bool is_shape_of(const Array& array, std::size_t bytes) {
  if (std::ranges::find(array.shape, 0) != array.shape.end() || array.item_size == 0) {
    return bytes == 0;
  }
  std::size_t total = array.item_size;
  for (const std::size_t size : array.shape) {
    if (size > bytes / total) return false;
    total *= size;
  }
  return total == bytes;
}

template <typename Number>
Number number_at(const std::byte* place, bool swapped) {
  std::byte bytes[sizeof(Number)];
  std::memcpy(bytes, place, sizeof(Number));
  if (swapped) std::reverse(std::begin(bytes), std::end(bytes));
  Number number;
  std::memcpy(&number, bytes, sizeof(Number));
  return number;
}

// Calls take(place) with the elements from `first` on, `count` of them, row by row.
template <typename Take>
void in_row_order(const Array& array, std::size_t first, std::size_t count, const Take& take) {
  if (count == 0) return;
  const std::byte* const data = array.data.data();
  if (!array.column_major) {
    for (std::size_t i = first; i < first + count; ++i) take(data + i * array.item_size);
    return;
  }
  std::vector<std::size_t> index(array.shape.size(), 0);
  for (std::size_t d = index.size(), rest = first; d-- > 0; rest /= array.shape[d]) {
    index[d] = rest % array.shape[d];
  }
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t place = 0;
    for (std::size_t d = index.size(); d-- > 0;) place = place * array.shape[d] + index[d];
    take(data + place * array.item_size);
    for (std::size_t d = index.size(); d-- > 0 && ++index[d] == array.shape[d];) index[d] = 0;
  }
}

template <typename Number>
void add_numbers(const Array& array, std::size_t first, std::vector<double>& values) {
  double* value = values.data();
  in_row_order(array, first, values.size(), [&](const std::byte* place) {
    *value++ = static_cast<double>(number_at<Number>(place, array.big_endian));
  });
}

std::string type_of(const Array& array) {
  const char letter = "biufUS"[static_cast<std::size_t>(array.element)];
  const char order = array.item_size == 1 || letter == 'S' ? '|' : array.big_endian ? '>' : '<';
  return fmt::format("{}{}{}", order, letter,
                     letter == 'U' ? array.item_size / 4 : array.item_size);
}

template <typename Number>
Array make_array(Element element, std::span<const Number> values, std::vector<std::size_t> shape) {
  static_assert(std::endian::native == std::endian::little);
  Array array;
  array.element = element;
  array.item_size = sizeof(Number);
  array.shape = std::move(shape);
  const auto bytes = std::as_bytes(values);
  array.data.assign(bytes.begin(), bytes.end());
  return array;
}

}  // namespace

std::size_t Array::count() const {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

std::vector<double> Array::numbers(std::size_t first, std::size_t most) const {
  if (!is_number()) return {};
  std::vector<double> values(std::min(most, count() - first));
  using Add = void (*)(const Array&, std::size_t, std::vector<double>&);
  // For boolean, integer, natural and real elements of 1, 2, 4 and 8 bytes.
  constexpr Add kAdd[][4] = {
      {add_numbers<std::uint8_t>},
      {add_numbers<std::int8_t>, add_numbers<std::int16_t>, add_numbers<std::int32_t>,
       add_numbers<std::int64_t>},
      {add_numbers<std::uint8_t>, add_numbers<std::uint16_t>, add_numbers<std::uint32_t>,
       add_numbers<std::uint64_t>},
      {nullptr, add_numbers<Eigen::half>, add_numbers<float>, add_numbers<double>}};
  kAdd[static_cast<std::size_t>(element)][std::countr_zero(item_size)](*this, first, values);
  if (element == Element::boolean) {
    for (double& value : values) value = value != 0 ? 1 : 0;
  }
  return values;
}

std::vector<std::string> Array::texts() const {
  std::vector<std::string> texts;
  if (is_number()) return texts;
  in_row_order(*this, 0, count(), [&](const std::byte* place) {
    std::string& text = texts.emplace_back();
    if (element == Element::bytes) {
      text.assign(reinterpret_cast<const char*>(place), item_size);
      text.resize(text.find_last_not_of('\0') + 1);
      return;
    }
    for (std::size_t k = 0; k < item_size; k += 4) {
      const auto code = number_at<std::uint32_t>(place + k, big_endian);
      if (code == 0) break;
      append_utf8(code, text);
    }
  });
  return texts;
}

std::string shape_text(std::span<const std::size_t> shape) {
  return fmt::format("({}{})", fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
}

namespace {

// Where the header of a .npy file is. `size`: of the file.
struct HeaderPlace {
  std::size_t start = 0, length = 0;
};
Result<HeaderPlace> find_header(std::span<const std::byte> file, std::size_t size) {
  if (!text_of(file).starts_with(kMagic) || file.size() < 10) {
    return damaged("it does not begin as an array of numpy");
  }
  const auto byte = [&](std::size_t i) { return std::to_integer<std::size_t>(file[i]); };
  const std::size_t version = byte(6);
  if (version < 1 || version > 3) {
    return damaged(fmt::format("it has version {} of the format, known are 1 to 3", version));
  }
  const std::size_t start = version == 1 ? 10 : 12;
  if (file.size() < start) return damaged("it ends in the header");
  std::size_t length = byte(8) | byte(9) << 8;
  if (version > 1) length |= byte(10) << 16 | byte(11) << 24;
  if (length > kMaxHeader || length > size - start) {
    return damaged(
        fmt::format("its header has {} bytes, by the file; there are {}", length, size - start));
  }
  return HeaderPlace{start, length};
}

}  // namespace

Result<Array> parse(std::vector<std::byte> file) {
  const auto place = find_header(file, file.size());
  if (!place) return place.error();
  Array array;
  const std::span header = std::span(file).subspan(place->start, place->length);
  if (Status status = Header(text_of(header)).read(array); !status) {
    return status.error();
  }
  const auto end = static_cast<std::ptrdiff_t>(place->start + place->length);
  file.erase(file.begin(), file.begin() + end);
  if (!is_shape_of(array, file.size())) {
    return damaged(fmt::format("an array of shape {} with {} bytes each does not have {} bytes",
                               shape_text(array.shape), array.item_size, file.size()));
  }
  array.data = std::move(file);
  return array;
}

Result<Arrays> Arrays::open(std::span<const std::byte> file) {
  Arrays arrays;
  arrays.file_ = file;
  if (!text_of(file).starts_with("PK")) {
    arrays.names_.emplace_back();
    return arrays;
  }
  auto archive = zip::Archive::open(file);
  if (!archive) return archive.error();
  for (const std::string& name : archive->names()) {
    if (name.ends_with(".npy")) arrays.names_.push_back(name.substr(0, name.size() - 4));
  }
  if (arrays.names_.empty()) return damaged("the archive has no array");
  arrays.archive_ = *std::move(archive);
  return arrays;
}

bool Arrays::has(const std::string& name) const {
  return std::ranges::find(names_, name) != names_.end();
}

namespace {

// Of an array in an archive of `size` bytes.
std::uint64_t max_bytes(std::uint64_t size) {
  return std::max(std::min(1000 * size + 4096, kSmallArray), 100 * size);
}

}  // namespace

Result<Array> Arrays::read(const std::string& name) const {
  if (!archive_) return parse({file_.begin(), file_.end()});
  auto bytes = archive_->read(name + ".npy", max_bytes(file_.size()));
  if (!bytes) return bytes.error();
  auto array = parse(*std::move(bytes));
  if (!array) array.error().message = fmt::format("{}: {}", name, array.error().message);
  return array;
}

Result<Array> Arrays::open_array(const std::string& name) const {
  if (!archive_) return Error("file-missing", "the file is no archive of arrays");
  auto stream = archive_->stream(name + ".npy", max_bytes(file_.size()));
  if (!stream) return stream.error();
  std::vector<std::byte> start(12);
  if (Status status = (*stream)(start); !status) return status.error();
  const auto place = find_header(start, std::numeric_limits<std::size_t>::max());
  if (!place) return place.error();
  // Of version 1 the header begins in the bytes that are read.
  start.resize(place->start + place->length);
  if (start.size() < 12) return damaged("it ends in the header");
  if (Status status = (*stream)(std::span(start).subspan(12)); !status) return status.error();
  Array array;
  const Status status = Header(text_of(std::span(start).subspan(place->start))).read(array);
  if (!status) return status.error();
  std::uint64_t left = max_bytes(file_.size()) / std::max<std::size_t>(array.item_size, 1);
  for (const std::size_t size : array.shape) left /= std::max<std::size_t>(size, 1);
  if (left == 0) return Error("file-too-large", fmt::format("{} exceeds the limit", name));
  array.read = *std::move(stream);
  return array;
}

Array array_of(std::span<const float> values, std::vector<std::size_t> shape) {
  return make_array(Element::real, values, std::move(shape));
}

Array array_of(std::span<const double> values, std::vector<std::size_t> shape) {
  return make_array(Element::real, values, std::move(shape));
}

Array array_of(std::span<const std::int32_t> values, std::vector<std::size_t> shape) {
  return make_array(Element::integer, values, std::move(shape));
}

Array array_of_flags(std::span<const std::uint8_t> values, std::vector<std::size_t> shape) {
  return make_array(Element::boolean, values, std::move(shape));
}

Array array_of_texts(std::span<const std::string> texts) {
  std::vector<std::u32string> points;
  std::size_t longest = 1;
  for (const std::string& text : texts) {
    points.push_back(code_points(text));
    longest = std::max(longest, points.back().size());
  }
  std::u32string all;
  for (std::u32string& text : points) {
    text.resize(longest, 0);
    all += text;
  }
  Array array = make_array(Element::text, std::span<const char32_t>(all), {texts.size()});
  array.item_size = 4 * longest;
  return array;
}

namespace {

std::string start_of(const Array& array) {
  std::string header =
      fmt::format("{{'descr': '{}', 'fortran_order': {}, 'shape': {}, }}", type_of(array),
                  array.column_major ? "True" : "False", shape_text(array.shape));
  // Data is aligned to 64 bytes, and the header ends with a line break.
  header.append(63 - (10 + header.size()) % 64, ' ');
  header += '\n';
  std::string start(kMagic);
  start += {1, 0, static_cast<char>(header.size() & 255), static_cast<char>(header.size() >> 8)};
  return start + header;
}

std::vector<zip::FileToPack> files_of(std::span<const std::pair<std::string, Array>> arrays) {
  std::vector<zip::FileToPack> files;
  for (const auto& named : arrays) {
    const Array& array = named.second;
    const std::string start = start_of(array);
    const std::size_t size = start.size() + array.item_size * array.count();
    files.push_back(
        {named.first + ".npy", size, [start, &array, done = std::size_t{0}](auto bytes) mutable {
           const auto head = std::as_bytes(std::span(start)).subspan(std::min(done, start.size()));
           const std::size_t before = std::min(bytes.size(), head.size());
           std::ranges::copy(head.first(before), bytes.begin());
           const auto rest = bytes.subspan(before);
           const std::size_t from = done + before - start.size();  // of the data
           done += bytes.size();
           if (array.read && !rest.empty()) return array.read(rest);
           if (!rest.empty()) std::copy_n(&array.data[from], rest.size(), rest.begin());
           return Status();
         }});
  }
  return files;
}

}  // namespace

std::vector<std::byte> write(const Array& array) {
  const std::string start = start_of(array);
  const auto header = std::as_bytes(std::span(start));
  std::vector<std::byte> file(header.begin(), header.end());
  file.insert(file.end(), array.data.begin(), array.data.end());
  return file;
}

Result<std::vector<std::byte>> write(
    std::span<const std::pair<std::string, Array>> names_and_arrays) {
  return zip::pack(files_of(names_and_arrays));
}

Status write(std::span<const std::pair<std::string, Array>> names_and_arrays, OutputFile& file) {
  return zip::pack(files_of(names_and_arrays), file);
}

}  // namespace krok::npy
