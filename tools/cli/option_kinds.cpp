#include "tools/cli/option_kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/file.h"
#include "core/text.h"

namespace krok::cli {

namespace {

// "from 0 to 0.1 m", "of 0 s or more".
std::string described(const Range& range, const char* unit) {
  const bool low = std::isfinite(range.low), high = std::isfinite(range.high);
  if (range.above) {
    const std::string most = high ? fmt::format(", at most {}{}", readable(range.high), unit) : "";
    return fmt::format("greater than {}{}{}", readable(range.low), range.low == 0 ? "" : unit,
                       most);
  }
  if (low && high) {
    return fmt::format("from {} to {}{}", readable(range.low), readable(range.high), unit);
  }
  return low ? fmt::format("of {}{} or more", readable(range.low), unit)
             : fmt::format("up to {}{}", readable(range.high), unit);
}

bool holds(const Range& range, double value) {
  return (range.above ? value > range.low : value >= range.low) && value <= range.high &&
         std::isfinite(value);
}

struct Quantity {
  const char* name;        // "length"
  const char* article;     // "a length"
  const char* value_name;  // "LENGTH"
  const char* unit;        // of the range: " m"
  double size = 1;         // of that unit, in what is read
};

ValueKind<double> quantity(const Quantity& what, Result<double> (*parse)(std::string_view),
                           Range range) {
  const auto read = [=](const std::string& text) -> Result<double> {
    const auto value = parse(text);
    if (!value) return value.error();
    // The ends of the range are in it, however they are converted.
    const double shown_value = *value / what.size;
    if (holds(range, shown_value) || holds(range, std::round(shown_value * 1e9) / 1e9))
      return *value;
    Error error = usage(
        fmt::format("'{}' is not {} {}", shown(text), what.article, described(range, what.unit)));
    if (what.size == kRadiansPerDegree && parse_finite(text) &&
        holds(range, *value / (what.size * what.size))) {
      error.hint = fmt::format("without a unit, angles are degrees: write {}rad", text);
    }
    return error;
  };
  return {what.name, what.value_name, read, {}};
}

// "5" of "5km/h" and "5 km/h".
std::string_view without(std::string_view text, std::string_view unit) {
  if (unit.empty() || !text.ends_with(unit)) return text;
  text.remove_suffix(unit.size());
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

// Whether a bare number is a part of a turn in radians, written with its digits: 1.57, 3.1416.
bool looks_like_radians(std::string_view text) {
  constexpr int kParts = 24;  // of a turn: steps of 15 degrees
  const auto value = parse_finite(text);
  const std::size_t point = text.find('.');
  const auto digits = point == std::string_view::npos ? 0 : text.size() - point - 1;
  if (!value || digits < 2) return false;
  const double turns = kParts * std::abs(*value) / (2 * kPi);
  const double nearest = std::clamp(std::round(turns), 1.0, double{kParts});
  // Rounded or cut after the last digit.
  return std::abs(turns - nearest) * 2 * kPi / kParts < std::pow(0.1, digits);
}

// Of "-40,110cm,50cm" the first would be metres.
Status alike_units(std::string_view text, char between) {
  std::string_view bare, unit;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(between, begin), text.size());
    const std::string_view word = trimmed(text.substr(begin, end - begin));
    const auto value = parse_finite(word);
    if (value && *value != 0) bare = word;
    const std::size_t digits = word.find_last_of("0123456789.") + 1;
    if (!value && word.substr(digits).ends_with("m")) unit = word.substr(digits);
    begin = end + 1;
  }
  if (bare.empty() || unit.empty()) return {};
  return Error("quantity-no-unit", fmt::format("'{}' has no unit, others have", shown(bare)),
               fmt::format("write {}{}", bare, unit));
}

Result<double> parse_seconds(std::string_view text) {
  const auto time = parse_clip_time(text);
  if (!time) return time.error();
  if (!time->in_frames) return time->value;
  return Error("quantity-unit", fmt::format("'{}' is not a time in seconds", text),
               "write 1ms or 0.001s");
}

}  // namespace

ValueKind<double> length(Range metres) {
  return quantity({"length", "a length", "LENGTH", " m"}, parse_length, metres);
}
ValueKind<double> length_with_unit(Range metres) {
  return quantity(
      {"length", "a length", "LENGTH", " m"},
      [](std::string_view text) { return parse_length_with_unit(text); }, metres);
}
ValueKind<double> angle(Range degrees) {
  auto kind =
      quantity({"angle", "an angle", "ANGLE", " degrees", kRadiansPerDegree}, parse_angle, degrees);
  kind.read = [read = kind.read](const std::string& text) -> Result<double> {
    if (!looks_like_radians(text)) return read(text);
    return Error("quantity-no-unit", fmt::format("'{}' has no unit", text),
                 fmt::format("write {0}rad, or {0}deg if degrees are meant", text));
  };
  return kind;
}
ValueKind<double> seconds(Range seconds) {
  return quantity({"duration", "a time", "TIME", " s"}, parse_seconds, seconds);
}
ValueKind<double> frequency(Range hertz) {
  return quantity({"frequency", "a frequency", "FREQUENCY", " Hz"}, parse_frequency, hertz);
}

ValueKind<ClipTime> clip_time(Range range) {
  const auto read = [range](const std::string& text) -> Result<ClipTime> {
    const auto time = parse_clip_time(text);
    if (!time || holds(range, time->value)) return time;
    return usage(fmt::format("'{}' is not a time {}", shown(text), described(range, "")));
  };
  return {"time", "TIME", read, {}};
}

ValueKind<double> number(Range range, const std::string& unit) {
  const auto read = [range, unit](const std::string& text) -> Result<double> {
    constexpr std::string_view kPerHour = "km/h";
    const bool per_hour = unit == "m/s" && text.ends_with(kPerHour);
    const std::string_view digits = without(text, per_hour ? kPerHour : unit);
    auto value = parse_finite(digits);
    if (value && per_hour) *value /= 3.6;
    if (unit.empty() && text.ends_with('%')) {
      value = parse_finite(digits.substr(0, digits.size() - 1));
      if (value) *value /= 100;
    }
    if (value && holds(range, *value)) return *value;
    const bool any = !std::isfinite(range.low) && !std::isfinite(range.high);
    const std::size_t last_digit = text.find_last_of("0123456789.");
    if (!value && !unit.empty() && last_digit != std::string::npos &&
        parse_finite(text.substr(0, last_digit + 1))) {
      return usage(fmt::format("'{}' is not in {}", shown(text), unit),
                   fmt::format("a number{}", any ? "" : " " + described(range, unit.c_str())));
    }
    return usage(fmt::format("'{}' is not a number{}", shown(text),
                             any ? "" : " " + described(range, unit.c_str())));
  };
  return {"number", "N", read, {}};
}

ValueKind<double> rate() {
  const auto read = [](const std::string& text) -> Result<double> {
    const std::string_view digits = without(without(text, "fps"), "Hz");
    // "30000/1001", as of video.
    const std::size_t slash = digits.find('/');
    auto value = parse_finite(digits.substr(0, slash));
    if (slash != std::string_view::npos) {
      const auto divisor = parse_finite(digits.substr(slash + 1));
      value = value && divisor ? std::optional(*value / *divisor) : std::nullopt;
    }
    // "1/60" is a frame's time.
    if (value && *value < 1 && digits.starts_with("1/")) {
      return usage(fmt::format("'{}' is the time of a frame", shown(text)),
                   fmt::format("a rate is frames per second: {}", digits.substr(2)));
    }
    if (value && *value >= 1e-3 && *value <= 1e6) return *value;
    return usage(fmt::format("'{}' is not a frame rate from 0.001 to 1000000", shown(text)));
  };
  return {"rate", "N", read, {}};
}

ValueKind<long long> whole(long long low, long long high) {
  const auto read = [low, high](const std::string& text) -> Result<long long> {
    const auto value = parse_integer(text);
    if (value && *value >= low && *value <= high) return *value;
    return usage(fmt::format("'{}' is not an integer from {} to {}", shown(text), low, high));
  };
  return {"whole", "N", read, {}};
}

ValueKind<std::vector<double>> numbers(const std::vector<ValueKind<double>>& kinds,
                                       std::size_t least, char between) {
  const auto read = [=](const std::string& text) -> Result<std::vector<double>> {
    std::vector<double> values;
    std::string_view rest = text;
    bool more = true;
    for (std::size_t i = 0; i < kinds.size() && more; ++i) {
      const std::size_t end = rest.find(between);
      const std::string word(trimmed(rest.substr(0, end)));
      const auto value = kinds[i].read(word);
      if (!value) {
        Error error = value.error();
        const bool in_another_place =
            error.code == "quantity-unit" &&
            std::ranges::any_of(kinds, [&](const auto& kind) { return kind.read(word).ok(); });
        if (in_another_place) error.hint.clear();  // what the option takes is shown
        return error;
      }
      values.push_back(*value);
      more = end != std::string_view::npos;
      if (more) rest.remove_prefix(end + 1);
    }
    const bool of_one_kind = std::ranges::all_of(
        kinds, [&](const ValueKind<double>& kind) { return kind.name == kinds.front().name; });
    if (of_one_kind) {
      if (Status status = alike_units(text, between); !status) return status.error();
    }
    if (!more && values.size() >= least) return values;
    const auto given = 1 + std::ranges::count(text, between);
    return usage(fmt::format("'{}' has too {} values, {}, separated by '{}'", shown(text),
                             more ? "many" : "few", given, between));
  };
  return {"list", "LIST", read, {}};
}

std::string frame_hint(const ClipTime& time, int frame_count) {
  const bool frame = !time.in_frames && time.value == std::floor(time.value);
  if (!frame || !(time.value < frame_count)) return {};
  return fmt::format("{0}f is frame {0}", readable(time.value));
}

std::string written(const ClipTime& time) {
  return readable(time.value) + (time.in_frames ? "f" : "s");
}

std::string maker_of(const std::string& ending) {
  static constexpr std::pair<std::string_view, const char*> kMakers[] = {
      {".png .jpg .gif .mp4 .webp .webm .avi .mov",
       "krok-render makes films and images, krok-plot --sheet OUT.png sheets"},
      {".html .htm", "krok-view makes pages, krok-walk with --save-page"},
      {".svg .pdf", "krok-plot draws charts"},
      {".csv .tsv", "krok-export writes tables of motions, krok-keys --table those of gait"},
      {".bvh .npz .mot .sto", "krok-export writes motions so"},
      {".npy .mat .h5 .pkl .parquet", "krok-export -o OUT.npz writes arrays of numpy"},
      {".anim", "krok-import makes motions of captures, krok-retarget those of another skeleton"},
      {".trc .c3d", "krok-export --what positions -o OUT.sto has the places of joints over time"},
      {".fbx .dae .usd .usda .usdz .blend .abc .vrm .ma .mb",
       "no tool writes that; Blender, Maya, Unity and Unreal read .glb"},
      {".obj .pc2", "krok-skin writes meshes as .obj and .pc2"}};
  for (const auto& [endings, maker] : kMakers) {
    if ((" " + std::string(endings) + " ").find(" " + ending + " ") != std::string::npos) {
      return maker;
    }
  }
  return {};
}

ValueKind<std::string> output(const std::vector<std::string>& endings) {
  const auto read = [endings](const std::string& text) -> Result<std::string> {
    const std::string ending = extension(text);
    const auto ends_so = [&](const std::string& one) { return ascii_lower(text).ends_with(one); };
    // Devices and names without an extension are taken as they are.
    if (ending.empty() || std::ranges::any_of(endings, ends_so)) return text;
    if (endings.empty()) {
      return usage(fmt::format("the output is a folder, not {}", shown(text)),
                   "give the name of a folder, without an extension");
    }
    const std::string maker = maker_of(ending);
    return usage(fmt::format("the output is a {} file, not {}", either_of(endings), shown(text)),
                 fmt::format("use the extension {}{}{}", either_of(endings),
                             maker.empty() ? "" : "; ", maker));
  };
  return {"output", "OUT", read, {}};
}

ValueKind<std::string> words(const std::vector<std::string>& words) {
  const auto read = [words](const std::string& text) -> Result<std::string> {
    for (const std::string& word : words) {
      if (ascii_lower(text) == ascii_lower(word)) return word;
    }
    return usage(not_one_of(text, words));
  };
  return {"choice", "WORD", read, words};
}

std::string either_of(const std::vector<std::string>& words) {
  std::string list;
  for (std::size_t i = 0; i < words.size(); ++i) {
    list += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  }
  return list;
}

std::string not_one_of(const std::string& text, const std::vector<std::string>& words) {
  const std::string near = nearest_name(text, words);
  return fmt::format("'{}' is not {}{}", shown(text), either_of(words),
                     text.find(',') != std::string::npos ? "; give one at a time"
                     : near.empty()                      ? ""
                                                         : "; did you mean '" + near + "'?");
}

using registry::Kind;

namespace {

// Hint which tool creates files of this kind; empty if none does.
std::string maker_of(Kind kind, Kind from) {
  switch (kind) {
    case Kind::glb:
    case Kind::gltf:
      return from == Kind::anim ? "krok-export converts .anim files to glTF, krok-skin MESH MOTION "
                                  "--retarget puts motions on a character"
                                : "krok-skin creates glTF from a .model and a .anim file";
    case Kind::bvh:
      return "krok-export converts .anim files to BVH";
    case Kind::character:
      return "krok-import --save-character writes one of a GLB or FBX file";
    case Kind::model:
      return "krok-import --save-model writes one of a GLB or FBX file, krok-body makes one for a "
             "motion";
    case Kind::anim:
      return "krok-import converts captures to .anim files, krok-retarget IN --onto TARGET puts a "
             "motion on another skeleton";
    default:
      return !registry::is_read_through_assimp(kind) ? ""
             : from == Kind::cam
                 ? "that is only read; krok-cam writes .glb, too, for other programs"
                 : "that is only read; krok-export writes .glb and .bvh for other programs";
  }
}

}  // namespace

Status check_output_kind(const std::string& path, const std::string& option, Kind written) {
  const auto read = output_of(written).read(path);
  if (read) return {};
  return usage(fmt::format("{}: {}", option, read.error().message), read.error().hint);
}

ValueKind<std::string> output_of(Kind written) {
  const auto read = [written](const std::string& path) -> Result<std::string> {
    const Kind named = registry::kind_of_name(path);
    // Devices and names without an extension are taken as they are.
    if (named == written || (named == Kind::unknown && extension(path).empty())) return path;
    const std::string_view own = registry::kind_name(written);
    const std::string maker =
        named == Kind::unknown ? maker_of(extension(path)) : maker_of(named, written);
    return usage(fmt::format("the output is a .{} file, not {}", own, shown(path)),
                 fmt::format("use the extension .{}{}{}", own, maker.empty() ? "" : "; ", maker));
  };
  return {"output", "OUT", read, {}};
}

}  // namespace krok::cli
