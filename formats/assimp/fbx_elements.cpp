#include "formats/assimp/fbx_elements_internal.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "core/bytes.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/assimp/curve_internal.h"

namespace krok::assimp {

namespace {

constexpr std::size_t kListHeader = 13;  // type, count, whether compressed, size

ByteReader reader_of(std::string_view text) {
  return ByteReader(std::as_bytes(std::span(text)));
}

std::size_t size_of_type(char type) {
  const std::size_t found = std::string_view("CBbYIiFfLlDd").find(type);
  return found == std::string_view::npos ? 0
                                         : static_cast<std::size_t>("111244448888"[found] - '0');
}

std::size_t size_of_value(std::string_view text) {
  ByteReader in = reader_of(text);
  const char type = in.read<char>();
  const std::size_t each = size_of_type(type), count = in.read<std::uint32_t>();
  if (type == 'S' || type == 'R') return 5 + count;
  if (each == 0 || type < 'a') return each == 0 ? 0 : 1 + each;
  const bool compressed = in.read<std::uint32_t>() != 0;
  const std::size_t size = in.read<std::uint32_t>();
  return kListHeader + (compressed ? size : count * each);
}

double read_number(ByteReader& in, char type) {
  switch (ascii_lower(type)) {
    case 'i':
      return in.read<std::int32_t>();
    case 'l':
      return static_cast<double>(in.read<std::int64_t>());
    case 'f':
      return static_cast<double>(in.read<float>());
    default:
      return type == 'd' || type == 'D' ? in.read<double>() : 0;
  }
}

bool read_binary(FbxElements& elements, std::size_t at) {
  std::vector<std::size_t> ends = {elements.file.size()};  // of the elements around
  while (true) {
    while (ends.size() > 1 && at >= ends.back()) ends.pop_back();
    ByteReader in = reader_of(elements.file.substr(0, ends.back()));
    in.seek(at);
    const auto word = [&] {
      return elements.word == 8 ? in.read<std::uint64_t>() : in.read<std::uint32_t>();
    };
    FbxElement element{.begin = at, .end = word()};
    const std::uint64_t count = word();
    word();
    element.name = in.take_text(in.read<std::uint8_t>());
    if (!in.ok()) return false;
    if (element.end == 0 && ends.size() == 1) return true;
    if (element.end == 0) {
      at = ends.back();
      continue;
    }
    if (element.end > ends.back() || element.end < in.position()) return false;
    for (std::uint64_t v = 0; v < count; ++v) {
      const std::size_t size = size_of_value(elements.file.substr(in.position()));
      if (size == 0 || size > element.end - in.position()) return false;
      element.values.push_back(in.take_text(size));
    }
    at = in.position();
    ends.push_back(element.end);
    elements.list.push_back(std::move(element));
  }
}

// An element a line, but for lists: `Name: *2 {`, `a: 1,2`, `}`.
void read_ascii(FbxElements& elements) {
  const std::string_view file = elements.file;
  for (std::size_t at = 0; at < file.size(); ++at) {
    std::size_t end = std::min(file.find('\n', at), file.size());
    std::string_view line = trimmed(file.substr(at, end - at));
    const std::size_t colon = line.find(':');
    if (colon != std::string_view::npos && line[0] != ';') {
      const auto begin = static_cast<std::size_t>(line.data() - file.data());
      FbxElement element{.name = line.substr(0, colon), .begin = begin};
      line = trimmed(line.substr(colon + 1));
      if (line.starts_with('*') && line.ends_with('{')) {
        const std::size_t first = std::min(file.find(':', end), file.size() - 1) + 1;
        end = std::min(file.find('}', first), file.size() - 1) + 1;
        element.values.push_back(file.substr(first, std::max(end, first + 1) - first - 1));
      }
      while (!line.empty() && element.values.size() < 8) {
        const std::size_t comma = std::min(line.find(','), line.size());
        element.values.push_back(trimmed(line.substr(0, comma)));
        line.remove_prefix(std::min(comma + 1, line.size()));
      }
      element.end = end;
      elements.list.push_back(std::move(element));
    }
    at = end;
  }
}

std::vector<double> binary_numbers(std::string_view value) {
  ByteReader in = reader_of(value);
  const char type = in.read<char>();
  const std::size_t count = in.read<std::uint32_t>(), size = count * size_of_type(type);
  const bool compressed = in.read<std::uint32_t>() != 0;
  in.take(4);
  std::string plain;
  if (compressed) {
    constexpr std::size_t kMaxRatio = 1032;  // of Deflate
    if (size / kMaxRatio > in.remaining()) return {};
    plain.resize(size);
    auto plain_size = static_cast<uLongf>(size);
    const std::string_view bytes = in.take_text(in.remaining());
    if (uncompress(reinterpret_cast<Bytef*>(plain.data()), &plain_size,
                   reinterpret_cast<const Bytef*>(bytes.data()),
                   static_cast<uLong>(bytes.size())) != Z_OK) {
      return {};
    }
    in = reader_of(plain);
  }
  if (in.remaining() < size || size == 0) return {};
  std::vector<double> numbers;
  for (std::size_t i = 0; i < count; ++i) numbers.push_back(read_number(in, type));
  return numbers;
}

template <typename Number>
void append_list(std::string& out, const FbxElement& element, std::size_t word, char type,
                 const std::vector<Number>& numbers) {
  if (word == 0) {
    out +=
        fmt::format("{}: *{} {{\na: {}\n}}", element.name, numbers.size(), fmt::join(numbers, ","));
    return;
  }
  const auto put = [&](std::uint64_t number, std::size_t size) {
    out.append(reinterpret_cast<const char*>(&number), size);
  };
  const std::size_t size = numbers.size() * sizeof(Number);
  put(0, word);  // the end is written at last
  put(1, word);
  put(kListHeader + size, word);
  put(element.name.size(), 1);
  out += element.name;
  out += type;
  put(numbers.size(), 4);
  put(0, 4);
  put(size, 4);
  out.append(reinterpret_cast<const char*>(numbers.data()), size);
}

}  // namespace

std::optional<FbxElements> fbx_elements(std::string_view file) {
  constexpr std::string_view kMagic = "Kaydara FBX Binary  ";
  FbxElements elements{.file = file};
  if (!file.starts_with(kMagic)) {
    read_ascii(elements);
    return elements;
  }
  ByteReader in = reader_of(file);
  in.seek(kMagic.size() + 3);
  const auto version = in.read<std::uint32_t>();
  elements.word = version < 7500 ? 4 : 8;
  if (version < 7000 || !read_binary(elements, in.position())) return std::nullopt;
  return elements;
}

double FbxElements::number(std::string_view value) const {
  if (word == 0) return parse_finite(value).value_or(0);
  ByteReader in = reader_of(value);
  return read_number(in, in.read<char>());
}

std::vector<double> FbxElements::numbers(std::string_view value) const {
  return word == 0 ? numbers_of(value) : binary_numbers(value);
}

std::string FbxElements::with(const std::map<std::size_t, std::vector<double>>& lists) const {
  std::string out;
  std::map<std::size_t, std::size_t> moved = {{0, 0}};  // place -> new place, of what follows
  std::size_t taken = 0;
  for (const auto& [index, numbers] : lists) {
    out += file.substr(taken, list[index].begin - taken);
    if (list[index].name == "KeyTime") {
      append_list(out, list[index], word, 'l',
                  std::vector<std::int64_t>(numbers.begin(), numbers.end()));
    } else {
      append_list(out, list[index], word, 'f', std::vector<float>(numbers.begin(), numbers.end()));
    }
    taken = list[index].end;
    moved[taken] = out.size();
  }
  out += file.substr(taken);
  const auto new_place = [&](std::size_t place) {
    const auto before = std::prev(moved.upper_bound(place));
    return before->second + place - before->first;
  };
  for (const FbxElement& element : list) {
    const std::uint64_t end = new_place(element.end);
    std::memcpy(out.data() + new_place(element.begin), &end, word);
  }
  return out;
}

std::vector<double> fbx_target_weights(std::string_view text) {
  std::vector<double> weights;
  const auto elements = fbx_elements(text);
  for (std::size_t e = 0; elements && e < elements->list.size(); ++e) {
    const FbxElement& element = elements->list[e];
    if (element.name == "DeformPercent") {
      weights.push_back(elements->number(element.value(0)) / 100);
    }
  }
  return weights;
}

int fbx_version(std::string_view text) {
  constexpr std::string_view kBinary = "Kaydara FBX Binary  ", kAscii = "FBXVersion:";
  constexpr std::size_t kVersionAt = 23;
  if (text.starts_with(kBinary)) {
    std::uint32_t version = 0;
    if (text.size() < kVersionAt + sizeof version) return 0;
    std::memcpy(&version, text.data() + kVersionAt, sizeof version);
    return static_cast<int>(std::min<std::uint32_t>(version, 100000));
  }
  const std::size_t place = text.substr(0, 4096).find(kAscii);
  if (place == std::string_view::npos) return 0;
  const std::string_view number = text.substr(place + kAscii.size(), 16);
  return static_cast<int>(
      parse_integer(trimmed(number.substr(0, number.find_first_of("\r\n")))).value_or(0));
}

std::size_t fbx_object_count(std::string_view text, std::string_view kind) {
  const auto elements = fbx_elements(text);
  if (!elements) return 0;
  return static_cast<std::size_t>(std::ranges::count(elements->list, kind, &FbxElement::name));
}

std::set<std::string> fbx_limb_names(std::string_view text) {
  std::set<std::string> names;
  const auto elements = fbx_elements(text);
  for (std::size_t e = 0; elements && e < elements->list.size(); ++e) {
    const FbxElement& element = elements->list[e];
    const std::string_view title = element.value(1), kind = element.value(2);
    if (element.name != "Model" || kind.find("LimbNode") == std::string_view::npos) continue;
    // ASCII: "Model::Hips"; binary: a letter, a length, Hips, two bytes, Model.
    const std::size_t begin = elements->word == 0 ? title.find("::") + 2 : 5;
    if (begin > title.size()) continue;
    names.insert(to_utf8(title.substr(begin, title.find_first_of({"\"\0", 2}, begin) - begin)));
  }
  return names;
}

}  // namespace krok::assimp
