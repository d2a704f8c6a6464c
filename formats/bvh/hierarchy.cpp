#include "formats/bvh/hierarchy.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/bvh/row_lines_internal.h"
#include "formats/bvh/text_cursor.h"
#include "formats/registry/registry.h"

namespace krok::bvh {

namespace {

struct ChannelMeaning {
  ChannelKind kind = ChannelKind::ignored;
  Axis axis = Axis::x;
};

struct ChannelName {
  std::string_view name;
  ChannelMeaning meaning;
};

constexpr std::array kChannelNames = {ChannelName{"Xposition", {ChannelKind::position, Axis::x}},
                                      ChannelName{"Yposition", {ChannelKind::position, Axis::y}},
                                      ChannelName{"Zposition", {ChannelKind::position, Axis::z}},
                                      ChannelName{"Xrotation", {ChannelKind::rotation, Axis::x}},
                                      ChannelName{"Yrotation", {ChannelKind::rotation, Axis::y}},
                                      ChannelName{"Zrotation", {ChannelKind::rotation, Axis::z}}};

// Parses a channel name, case-insensitive; nullopt if it is not a BVH channel.
std::optional<ChannelMeaning> channel_meaning(std::string_view name) {
  for (const ChannelName& candidate : kChannelNames) {
    if (same_word(name, candidate.name)) return candidate.meaning;
  }
  return std::nullopt;
}

// "Xrotation"; "unknown" for ignored channels.
std::string_view channel_name(ChannelKind kind, Axis axis) {
  for (const ChannelName& candidate : kChannelNames) {
    if (candidate.meaning.kind == kind && candidate.meaning.axis == axis) return candidate.name;
  }
  return "unknown";
}

// Start of the hierarchy in a text with other lines before it.
struct HierarchyStart {
  std::size_t offset = 0;  // of HIERARCHY, or of ROOT if HIERARCHY is missing
  long long lines = 0;     // lines of text before it
};

std::string hint_for(registry::Kind kind, std::string_view what, const std::string& file_name) {
  switch (kind) {
    case registry::Kind::anim:
    case registry::Kind::model:
    case registry::Kind::cam:
      return "this is a Krok file already; no import is needed";
    default:
      break;
  }
  if (what.find("archive") != std::string_view::npos) return "unpack it first";
  if (what.find("Git LFS") != std::string_view::npos) return "fetch the file with: git lfs pull";
  if (what.find("web page") != std::string_view::npos) return "download the file itself";
  if (what.find("OpenPose") != std::string_view::npos) {
    return "krok-import reads 3D positions as .npy, (frames, joints, 3); these are 2D";
  }
  if (what.find("markers") != std::string_view::npos) {
    return "write the solved skeleton as BVH or FBX from the capture software";
  }
  if (what.find("Unity") != std::string_view::npos) {
    return "export the character and its clips from Unity as FBX or glTF";
  }
  if (ascii_lower(file_name).ends_with(".csv")) {
    return "krok-plot draws tables; arrays of positions are read as .npz and .npy, which "
           "krok-export writes, too";
  }
  if (ascii_lower(file_name).ends_with(".mot") || ascii_lower(file_name).ends_with(".sto")) {
    return "tables of OpenSim have no skeleton and are only written; keep the .bvh or .anim they "
           "are from";
  }
  if (what.find("OBJ") != std::string_view::npos) return "krok-morph takes shapes of a mesh";
  if (what.find("binary file") != std::string_view::npos || what.ends_with(')')) {
    return registry::advice(registry::Kind::unknown, registry::Kind::anim);
  }
  return "a BVH file is text that begins with HIERARCHY";
}

// UTF-16 with a byte-order mark, or without: every other byte of ASCII letters is 0.
bool is_utf16(std::string_view text) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) return true;
  const std::string_view head = text.substr(0, 8);
  if (head.size() < 8) return false;
  for (const std::size_t zero : {0, 1}) {
    bool fits = true;
    for (std::size_t i = 0; i < head.size(); ++i) fits &= (head[i] == 0) == (i % 2 == zero);
    if (fits) return true;
  }
  return false;
}

// nullopt if none of the first lines begins with HIERARCHY, or the bytes before it are not text.
std::optional<HierarchyStart> find_start(std::string_view text) {
  constexpr std::size_t kFarthest = std::size_t{64} << 10;
  const std::string_view head = text.substr(0, kFarthest);
  TextCursor cursor(head);
  if (same_word(cursor.peek(), "ROOT")) {
    cursor.skip_space();
    return HierarchyStart{cursor.position(), 0};
  }
  if (cursor.peek().starts_with('<')) return std::nullopt;  // a web page that shows the file
  HierarchyStart start;
  while (!cursor.at_end()) {
    cursor.skip_space();
    start.offset = cursor.position();
    if (same_word(cursor.peek(), "HIERARCHY")) return start;
    const std::string_view line = cursor.line();
    if (line.find('\0') != std::string_view::npos) return std::nullopt;
    ++start.lines;
  }
  return std::nullopt;
}

// Checks that `text` can be a BVH file: it begins with HIERARCHY (case-insensitive) after optional
// white space or a byte-order mark. The error (bvh-kind) says what the file looks like instead.
Status check_file_kind(std::string_view text, const std::string& file_name) {
  const auto not_bvh = [&](std::string message, std::string hint) -> Status {
    return Error("bvh-kind", std::move(message), std::move(hint)).in_file(file_name);
  };
  const auto content = std::as_bytes(std::span(text));
  const registry::Kind kind = registry::kind_of_content(content);
  if (kind == registry::Kind::bvh) return {};
  if (text.empty()) return not_bvh("the file is empty", "export or copy it again");
  if (is_utf16(text)) return not_bvh("is UTF-16 text", "save it as UTF-8");
  if (text.find_first_not_of(" \t\r\n\v\f") == std::string_view::npos) {
    return not_bvh("the file has only white space", "export or copy it again");
  }
  const std::string_view what = registry::describe_content(content);
  return not_bvh(fmt::format("not a BVH file: it is {}", what), hint_for(kind, what, file_name));
}

constexpr const char* kChannelsHint = "after CHANNELS write the number of channels and their names";

class HierarchyParser {
 public:
  HierarchyParser(std::string_view text, const std::string& file_name, const ReadOptions& options,
                  Diagnostics& diagnostics)
      : text_(text),
        file_name_(file_name),
        options_(options),
        diagnostics_(diagnostics),
        locate_(text, file_name),
        cursor_(text) {}

  Result<Hierarchy> parse() {
    if (Status status = parse_start(); !status) return status.error();
    for (;;) {
      const std::string_view word = cursor_.word();
      if (word.empty()) {
        if (Status status = end_of_file(); !status) return status.error();
        break;
      }
      if (same_word(word, "MOTION")) {
        if (!open_.empty()) {
          return fail("bvh-syntax",
                      fmt::format("MOTION, but {} is not closed: a '}}' is missing", open_name()),
                      "write the '}' that ends the joint");
        }
        break;
      }
      if (Status status = parse_item(word); !status) return status.error();
    }
    result_.end = cursor_.position();
    if (result_.joints.empty()) {
      return fail("bvh-syntax", "the hierarchy has no ROOT", "the file has no skeleton");
    }
    if (Status status = check_channels(result_, file_name_, diagnostics_); !status) {
      Error error = std::move(status).error();
      error.where = locate_(cursor_.word_begin());
      return error;
    }
    const std::size_t reported = diagnostics_.size();
    join_roots(result_, name_places_, file_name_, diagnostics_);
    if (warnings_ > kMaxWarnings) {
      report_in_file(Severity::warning, "bvh-syntax",
                     fmt::format("{} more such warnings", warnings_ - kMaxWarnings), file_name_,
                     diagnostics_);
    }
    name_joints(result_, name_places_, text_, file_name_, diagnostics_);
    if (options_.strictness == Strictness::strict && diagnostics_.size() > reported) {
      Error error(diagnostics_[reported]);
      error.severity = Severity::error;
      error.hint = "without --strict this is a warning";
      return error;
    }
    report_zero_bones(result_, file_name_, diagnostics_);
    report_long_ends(result_, file_name_, diagnostics_);
    return std::move(result_);
  }

 private:
  Error fail_at(std::size_t offset, std::string code, std::string message, std::string hint = {}) {
    Error error(std::move(code), std::move(message), std::move(hint));
    error.where = locate_(offset);
    return error;
  }
  // At the last word read.
  Error fail(std::string code, std::string message, std::string hint = {}) {
    return fail_at(cursor_.word_begin(), std::move(code), std::move(message), std::move(hint));
  }

  // A fault that is an error only if strict.
  Status warn_at(std::size_t offset, std::string code, std::string message, std::string joint) {
    Error warning = fail_at(offset, std::move(code), std::move(message));
    warning.joint = std::move(joint);
    if (options_.strictness == Strictness::strict) return warning;
    warning.severity = Severity::warning;
    if (++warnings_ <= kMaxWarnings) diagnostics_.push_back(std::move(warning));
    return {};
  }

  // The text may begin with a byte-order mark. Lines before HIERARCHY and a missing HIERARCHY are
  // warnings.
  Status parse_start() {
    const std::size_t begin = text_.size() - without_byte_order_mark(text_).size();
    cursor_.seek(begin);
    if (cursor_.accept("HIERARCHY")) return {};
    const auto start = find_start(text_.substr(begin));
    if (!start) {
      Status status = check_file_kind(text_, file_name_);
      if (!status) return status;
      return fail("bvh-kind", "not a BVH file: it does not begin with HIERARCHY",
                  "give a BVH capture");
    }
    cursor_.seek(begin + start->offset);
    if (start->lines > 0) {
      Status status =
          warn_at(begin, "bvh-text-before",
                  fmt::format("{} before the hierarchy {} ignored", counted(start->lines, "line"),
                              start->lines == 1 ? "is" : "are"),
                  {});
      if (!status) return status;
    }
    if (cursor_.accept("HIERARCHY")) return {};
    return warn_at(begin + start->offset, "bvh-syntax", "the word HIERARCHY is missing before ROOT",
                   {});
  }

  std::string open_name() const {
    const auto& joint = result_.joints[static_cast<std::size_t>(open_.back())];
    return joint.end_site ? "an End Site" : readable_name(joint.name);
  }

  Status end_of_file() {
    if (!open_.empty()) {
      return fail("bvh-syntax",
                  fmt::format("the file ends inside the hierarchy, {} is not closed", open_name()),
                  "the file is truncated; export or copy it again");
    }
    result_.no_motion = true;
    return warn_at(text_.size(), "bvh-no-motion",
                   "there is no MOTION section: read as a skeleton without frames", {});
  }

  Status parse_item(std::string_view word) {
    if (same_word(word, "ROOT")) {
      if (!open_.empty()) return fail("bvh-syntax", "ROOT inside another joint");
      return open_joint(false);
    }
    if (same_word(word, "JOINT")) {
      if (open_.empty()) return fail("bvh-syntax", "JOINT outside ROOT");
      return open_joint(false);
    }
    if (same_word(word, "End") || same_word(word, "EndSite") || same_word(word, "End_Site")) {
      if (open_.empty()) return fail("bvh-syntax", "End Site outside ROOT");
      return open_joint(true);
    }
    if (word.starts_with('#') || word.starts_with("//")) {
      const std::size_t place = cursor_.word_begin();
      cursor_.seek(place);
      return warn_at(place, "bvh-syntax",
                     fmt::format("the comment '{}' is ignored", shown(cursor_.line())), {});
    }
    if (open_.empty()) {
      return fail("bvh-syntax", fmt::format("'{}' where ROOT or MOTION is expected", shown(word)),
                  word == "}" ? "there is one '}' too many" : "");
    }
    if (same_word(word, "OFFSET")) return parse_offset();
    if (same_word(word, "CHANNELS")) return parse_channels();
    if (word == "}") {
      return close_joint();
    }
    return fail("bvh-syntax",
                fmt::format("'{}' where OFFSET, CHANNELS, JOINT, End Site or '}}' is expected",
                            shown(word)),
                channel_meaning(word) ? kChannelsHint : "");
  }

  Status open_joint(bool end_site) {
    if (!open_.empty() && result_.joints[static_cast<std::size_t>(open_.back())].end_site) {
      return fail("bvh-syntax", "a joint inside an End Site");
    }
    if (static_cast<int>(result_.joints.size()) >= options_.max_joints) {
      return fail("bvh-limit", fmt::format("more than {} joints", options_.max_joints),
                  "no character has that many; check the file");
    }
    const std::size_t keyword = cursor_.word_begin();
    // "End" is followed by "Site" and, with some exporters, a name that is not used.
    const std::string_view name = end_site ? cursor_.to_brace() : cursor_.name();
    Hierarchy::Joint joint;
    joint.parent = open_.empty() ? -1 : open_.back();
    joint.end_site = end_site;
    name_places_.push_back(cursor_.word_begin());
    if (!end_site) {
      joint.name = std::string(name);
      if (name.empty()) {
        if (options_.strictness == Strictness::strict) {
          return fail_at(keyword, "bvh-name", "a joint without a name",
                         "without --strict a name is generated");
        }
        name_places_.back() = keyword;  // the warning comes with the name that it gets
      }
    }
    if (const std::string_view brace = cursor_.word(); brace != "{") {
      if (brace.empty()) return cut("after " + (end_site ? "End Site" : readable_name(joint.name)));
      return fail("bvh-syntax",
                  fmt::format("a '{{' is expected after {}",
                              end_site ? "End Site" : readable_name(joint.name)),
                  "write the '{' that begins the joint");
    }
    open_.push_back(static_cast<int>(result_.joints.size()));
    result_.joints.push_back(std::move(joint));
    has_offset_.push_back(false);
    has_channels_.push_back(false);
    return {};
  }

  Status close_joint() {
    const auto index = static_cast<std::size_t>(open_.back());
    const bool has_offset = has_offset_[index];
    const std::string name = open_name();
    open_.pop_back();
    if (has_offset) return {};
    return warn_at(cursor_.word_begin(), "bvh-offset",
                   fmt::format("{} has no OFFSET, assumed to be 0 0 0", name), name);
  }

  Status cut(const std::string& where) {
    return fail("bvh-syntax", "the file ends " + where,
                "the file is truncated; export or copy it again");
  }
  Status cut_in(std::string_view item) {
    return cut(fmt::format("in the {} of {}", item, open_name()));
  }

  Status parse_offset() {
    const auto index = static_cast<std::size_t>(open_.back());
    if (has_offset_[index]) return fail("bvh-syntax", "a second OFFSET for one joint");
    has_offset_[index] = true;
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view word = cursor_.word();
      if (word.empty()) return cut_in("OFFSET");
      const auto value = parse_finite(word);
      if (!value) {
        return fail("bvh-number",
                    fmt::format("'{}' in the OFFSET of {} is not a finite number", shown(word),
                                open_name()),
                    glued_numbers(word) > 0 ? RowFaults::hint_for(word)
                    : word.find(',') == std::string_view::npos
                        ? "OFFSET needs three numbers"
                        : "write numbers with a decimal point and without commas between them");
      }
      if (std::abs(*value) > std::numeric_limits<float>::max()) {
        return fail("bvh-number",
                    fmt::format("'{}' in the OFFSET of {} is too large", shown(word), open_name()),
                    "no bone is that long; check the file");
      }
      result_.joints[index].offset[axis] = *value;
    }
    return {};
  }

  Status parse_channels() {
    const auto index = static_cast<std::size_t>(open_.back());
    if (has_channels_[index]) return fail("bvh-syntax", "a second CHANNELS for one joint");
    has_channels_[index] = true;
    const std::string_view count_word = cursor_.word();
    if (count_word.empty()) return cut_in("CHANNELS");
    const auto count = parse_integer(count_word);
    if (!count || *count < 0) {
      return fail("bvh-channels",
                  fmt::format("'{}' is not a number of channels", shown(count_word)),
                  kChannelsHint);
    }
    const std::size_t count_place = cursor_.word_begin();
    result_.joints[index].first_channel = result_.channels.size();
    seen_positions_.fill(false);
    seen_rotations_.fill(false);
    if (*count > 0 && result_.joints[index].end_site) {
      Status status = warn_at(count_place, "bvh-channels",
                              "an End Site has channels; it is animated like a joint", {});
      if (!status) return status;
    }
    for (long long i = 0; i < *count; ++i) {
      const std::string_view word = cursor_.peek();
      if (word.empty()) return cut_in("CHANNELS");
      if (word == "{" || word == "}" || same_word(word, "JOINT") || same_word(word, "End") ||
          same_word(word, "OFFSET")) {
        return fail_at(count_place, "bvh-channels",
                       fmt::format("{} declares {} channels and names {}", open_name(), *count, i),
                       kChannelsHint);
      }
      cursor_.word();
      if (Status status = add_channel(word, index); !status) return status;
    }
    result_.joints[index].channel_count =
        result_.channels.size() - result_.joints[index].first_channel;
    return {};
  }

  Status add_channel(std::string_view word, std::size_t joint) {
    std::string_view name = word;
    while (!name.empty() && (name.back() == ',' || name.back() == ';')) name.remove_suffix(1);
    if (name.size() != word.size() && !commas_reported_) {
      commas_reported_ = true;
      Status status = warn_at(cursor_.word_begin(), "bvh-channels",
                              "channel names are separated by commas, which are ignored", {});
      if (!status) return status;
    }
    Channel channel;
    channel.joint = static_cast<int>(joint);
    const auto meaning = channel_meaning(name);
    Status status;
    if (meaning) {
      channel.kind = meaning->kind;
      channel.axis = meaning->axis;
      status = check_repeated(channel, name);
    } else if (same_word(name, "Wrotation")) {
      status =
          fail("bvh-channels",
               fmt::format("{} has a channel Wrotation: its rotation is a quaternion", open_name()),
               "BVH has Euler angles; export them");
    } else {
      status =
          warn_at(cursor_.word_begin(), "bvh-channels",
                  fmt::format("the channel '{}' of {} is neither a position nor a rotation; its "
                              "values are ignored",
                              shown(word), open_name()),
                  open_name());
    }
    if (status.ok()) result_.channels.push_back(channel);
    return status;
  }

  // A joint may rotate about one axis twice, though it is rarely intended.
  Status check_repeated(const Channel& channel, std::string_view name) {
    auto& seen_kind = channel.kind == ChannelKind::position ? seen_positions_ : seen_rotations_;
    bool& seen = seen_kind[static_cast<std::size_t>(channel.axis)];
    if (!seen) {
      seen = true;
      return {};
    }
    std::string twice = fmt::format("{} has {} twice", open_name(), shown(name));
    if (channel.kind == ChannelKind::position) return fail("bvh-channels", std::move(twice));
    return warn_at(cursor_.word_begin(), "bvh-channels",
                   twice + "; both rotations are applied, in channel order", open_name());
  }

  // Limits the number of messages.
  static constexpr int kMaxWarnings = 20;

  std::string_view text_;
  const std::string& file_name_;
  const ReadOptions& options_;
  Diagnostics& diagnostics_;
  Locator locate_;
  int warnings_ = 0;
  bool commas_reported_ = false;
  std::array<bool, 3> seen_positions_{}, seen_rotations_{};  // of the joint being read
  TextCursor cursor_;
  Hierarchy result_;
  std::vector<int> open_;
  std::vector<bool> has_offset_, has_channels_;
  std::vector<std::size_t> name_places_;
};

}  // namespace

std::string Hierarchy::channel_name(std::size_t channel) const {
  const Channel& c = channels[channel];
  const std::string& joint = joints[static_cast<std::size_t>(c.joint)].name;
  return fmt::format("{}.{}", joint, krok::bvh::channel_name(c.kind, c.axis));
}

Result<Hierarchy> parse_hierarchy(std::string_view text, const std::string& file_name,
                                  const ReadOptions& options, Diagnostics& diagnostics) {
  return HierarchyParser(text, file_name, options, diagnostics).parse();
}

}  // namespace krok::bvh
