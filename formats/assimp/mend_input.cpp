#include "formats/assimp/run_assimp_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <locale>
#include <span>

#include "core/numbers.h"
#include "core/text.h"

namespace krok::assimp {

using registry::Kind;

namespace {

std::string_view take_line(std::string_view& text) {
  const std::size_t end = text.find_first_of("\r\n");
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end, text.size()));
  if (text.starts_with("\r\n")) {
    text.remove_prefix(2);
  } else if (!text.empty()) {
    text.remove_prefix(1);
  }
  return line;
}

std::string_view take_word(std::string_view& text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  std::size_t end = 0;
  while (end < text.size() && !is_space(text[end])) ++end;
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(end);
  return word;
}

std::size_t count_words(std::string_view text) {
  std::size_t count = 0;
  while (!take_word(text).empty()) ++count;
  return count;
}

// ---- SMD ----

// Assimp ends a material's name at the first space and parses the rest as a vertex. It parses
// comments as data. It loops forever if a section has no end.
Result<std::string> mend_smd(std::string_view text) {
  std::string mended;
  mended.reserve(text.size() + 1);
  bool in_triangles = false;
  std::string_view part;  // the open section
  int vertices_left = 0;
  while (!text.empty()) {
    const std::string_view line = trimmed(take_line(text));
    const bool comment = line.starts_with("//") || line.starts_with('#') || line.starts_with(';');
    if (line.empty() || comment) continue;
    if (in_triangles && vertices_left == 0 && line != "end") {
      for (const char c : line) mended += is_space(c) ? '_' : c;
      vertices_left = 3;
    } else {
      mended += line;
      if (vertices_left > 0) --vertices_left;
    }
    if (line == "triangles") in_triangles = true;
    if (line == "end") in_triangles = false;
    const bool begins =
        line == "nodes" || line == "skeleton" || line == "triangles" || line == "vertexanimation";
    if (begins) part = line;
    if (line == "end") part = {};
    mended += '\n';
  }
  if (!part.empty()) {
    return Error("assimp-refused", fmt::format("section '{}' has no end", part),
                 "the file is truncated; export or copy it again");
  }
  return mended;
}

// ---- MD5 ----

// Assimp creates no keys for static joints if no values of animated joints follow, and they fall
// back to the mesh's pose; an additional unused number at the end of each frame avoids this. It
// also accepts frames with too few numbers.
Result<std::string> mend_md5anim(std::string_view text) {
  std::string mended;
  mended.reserve(text.size() + 1024);
  std::size_t components = 0;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::string_view line = take_line(rest);
    mended += line;
    mended += '\n';
    std::string_view words = line;
    const std::string_view first = take_word(words);
    if (first == "numAnimatedComponents") {
      components =
          static_cast<std::size_t>(std::max(parse_integer(take_word(words)).value_or(0), 0LL));
    }
    if (first != "frame") continue;
    const std::string_view number = take_word(words);
    if (line.find('{') == std::string_view::npos) continue;
    const std::size_t end = rest.find('}');
    if (end == std::string_view::npos) {
      return Error("assimp-refused",
                   fmt::format("frame {} of the motion has no end", shown(number)),
                   "the file is truncated; export or copy it again");
    }
    const std::string_view numbers = rest.substr(0, end);
    const std::size_t found = count_words(numbers);
    if (found != components) {
      return Error("assimp-refused",
                   fmt::format("frame {} of the motion has {} numbers, expected {} "
                               "(numAnimatedComponents)",
                               shown(number), found, components),
                   "the file is damaged; export or copy it again");
    }
    mended += numbers;
    mended += "\n0\n}\n";
    rest.remove_prefix(end + 1);
  }
  return mended;
}

// ---- MS3D ----

// Assimp misreads the data after the joints, which read_ms3d reads instead. Keys are in seconds,
// and are lost if the frame rate is 0.
std::string mend_ms3d(std::string_view text) {
  const auto file = read_ms3d(std::as_bytes(std::span(text)));
  if (!file) return {};
  std::string mended(text.substr(0, file->end_of_joints));
  if (!(file->rate > 0) || !std::isfinite(file->rate)) {
    const float usual = 25.0f;
    std::memcpy(mended.data() + file->place_of_rate, &usual, sizeof(usual));
  }
  return mended;
}

// ---- COLLADA ----

// Where a list of numbers begins with white space, Assimp 5.2 rejects it or reads one 0 more, which
// shifts all indices and makes it crash.
std::string mend_collada(std::string_view text) {
  std::string mended;
  std::size_t taken = 0;
  for (std::size_t at = text.find('>'); at != std::string_view::npos; at = text.find('>', at + 1)) {
    std::size_t content = at + 1;
    while (content < text.size() && is_space(text[content])) ++content;
    if (content == at + 1 || content == text.size() || text[content] == '<') continue;
    mended += text.substr(taken, at + 1 - taken);
    taken = content;
  }
  if (taken > 0) mended += text.substr(taken);
  return mended;
}

}  // namespace

Result<std::string> mend_input(Kind kind, std::string_view text) {
  switch (kind) {
    case Kind::smd:
      return mend_smd(text);
    case Kind::md5anim:
      return mend_md5anim(text);
    case Kind::ms3d:
      return mend_ms3d(text);
    case Kind::collada:
      return mend_collada(text);
    default:
      return std::string();
  }
}

std::string utf8_of(std::string_view text) {
  const bool big = text.starts_with("\xFE\xFF");
  if (!big && !text.starts_with("\xFF\xFE")) return {};
  std::u16string units;
  for (std::size_t i = 2; i + 1 < text.size(); i += 2) {
    const auto low = static_cast<unsigned char>(text[i + (big ? 1 : 0)]);
    const auto high = static_cast<unsigned char>(text[i + (big ? 0 : 1)]);
    units += static_cast<char16_t>(low | high << 8);
  }
  using Converter = std::codecvt<char16_t, char8_t, std::mbstate_t>;
  std::u8string out(3 * units.size(), u8'\0');
  std::mbstate_t state{};
  const char16_t* from = units.data();
  char8_t* to = out.data();
  std::use_facet<Converter>(std::locale::classic())
      .out(state, from, from + units.size(), from, to, to + out.size(), to);
  return {reinterpret_cast<const char*>(out.data()), reinterpret_cast<const char*>(to)};
}

std::string md5_joints(std::string_view text) {
  std::string joints;
  bool inside = false;
  while (!text.empty()) {
    const std::string_view line = trimmed(take_line(text));
    std::string_view words = line;
    const std::string_view first = take_word(words);
    if (first == "joints" || first == "hierarchy") {
      inside = true;
    } else if (inside && first.starts_with('}')) {
      break;
    } else if (inside && line.starts_with('"')) {
      const std::size_t end = line.find('"', 1);
      if (end == std::string_view::npos) continue;
      std::string_view after = line.substr(end + 1);
      joints += line.substr(1, end - 1);
      joints += '\t';
      joints += take_word(after);
      joints += '\n';
    }
  }
  return joints;
}

}  // namespace krok::assimp
