#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "formats/timeline/items_internal.h"

namespace krok::timeline_file {

namespace {

using json::Value;
using timeline::BaseItem;
using timeline::Change;
using timeline::ChangeKind;
using timeline::Mark;
using timeline::Play;
using Kind = Value::Kind;

}  // namespace

// Many locations are stored, so line offsets are found once.
Items::Items(std::string_view text, const std::string& path, const Fields& fields,
             const std::vector<std::string>& source_names, const double& rate)
    : lines_{0}, path_(path), fields_(fields), source_names_(source_names), rate_(rate) {
  const std::string_view content = without_byte_order_mark(text);
  for (std::size_t i = 0; i < content.size(); ++i) {
    const bool pair = content[i] == '\r' && i + 1 < content.size() && content[i + 1] == '\n';
    if (is_line_end(content[i]) && !pair) lines_.push_back(i + 1);
  }
}

Location Items::place_of(const Value& value) const {
  const auto line = std::ranges::upper_bound(lines_, value.offset) - lines_.begin();
  Location where;
  where.file = path_;
  where.line = line;
  where.column =
      static_cast<std::int64_t>(value.offset - lines_[static_cast<std::size_t>(line - 1)]) + 1;
  return where;
}

// Members shared by items of the base and of layers.
Status Items::read_play(const Value& item, std::string_view what, std::string& name, Play& play,
                        std::vector<Mark>& marks) const {
  const auto source = fields_.members().get(item, what, "source", Kind::string);
  if (!source) return source.error();
  const auto index = fields_.word_index({*source, "source", what}, source_names_);
  if (!index) return index.error();
  play.source = static_cast<int>(*index);
  name = (*source)->text;
  const auto time = [&](const Field& field) { return fields_.time(field); };
  const auto text = [&](const Field& field) { return fields_.name(field); };
  Taker take(item, what);
  take("sequence", play.part, text);
  take.check("sequence", [&](const Field& field) -> Status {
    name += ":" + play.part;
    if (item.find("from") == nullptr && item.find("to") == nullptr) return {};
    return fields_.members().wrong(*field.value, "a sequence has its own \"from\" and \"to\"");
  });
  take("from", play.from, time)("to", play.to, time)("until", play.until, time);
  take("speed", play.speed, [&](const Field& field) { return fields_.number(field); });
  take("loop", play.rounds, [&](const Field& field) -> Result<int> {
    if (field.value->kind == Kind::boolean) return field.value->truth ? 0 : 1;
    return fields_.whole(field, 1, 100'000);
  });
  take("name", name, text);
  if (Status status = take.done(); !status) return status;
  return fields_.each(item, what, "marks", [&](const Value& entry) -> Status {
    auto made = mark(entry);
    if (!made) return made.error();
    marks.push_back(std::move(*made));
    return {};
  });
}

Result<Mark> Items::mark(const Value& value) const {
  constexpr std::string_view kMark = "a mark";
  if (Status status = fields_.only(value, kMark, {"name", "at", "source_at"}); !status) {
    return status.error();
  }
  const auto name = fields_.members().get(value, kMark, "name", Kind::string);
  if (!name) return name.error();
  Mark mark;
  mark.of_source = value.find("source_at") != nullptr;
  if (mark.of_source == (value.find("at") != nullptr)) {
    return fields_.members().wrong(value, "a mark has either \"at\" or \"source_at\"");
  }
  Taker take(value, kMark);
  take("name", mark.name, [&](const Field& field) { return fields_.name(field); });
  take(mark.of_source ? "source_at" : "at", mark.at,
       [&](const Field& field) { return fields_.time(field); });
  if (Status status = take.done(); !status) return status.error();
  return mark;
}

Result<GroundFrame> Items::ground_frame(const Value& value) const {
  constexpr std::string_view kPlace = "\"place\"";
  if (Status status = fields_.only(value, kPlace, {"x", "z", "heading"}); !status) {
    return status.error();
  }
  GroundFrame place;
  const auto length = [&](const Field& field) { return fields_.length(field); };
  Taker take(value, kPlace);
  take("x", place.x, length)("z", place.z, length);
  take("heading", place.heading, [&](const Field& field) { return fields_.angle(field); });
  if (Status status = take.done(); !status) return status.error();
  return place;
}

Result<BaseItem> Items::base_item(const Value& value, bool is_first) const {
  constexpr std::string_view kItem = "an item";
  if (Status status = fields_.only(value, kItem,
                                   {"name", "source", "sequence", "from", "to", "speed", "loop",
                                    "until", "at", "place", "change", "marks", "comment"});
      !status) {
    return status.error();
  }
  BaseItem item;
  item.where = place_of(value);
  if (Status status = read_play(value, kItem, item.name, item.play, item.marks); !status) {
    return status.error();
  }
  Taker take(value, kItem);
  take("at", item.at, [&](const Field& field) { return fields_.time(field); });
  take("place", item.place, [&](const Field& field) { return ground_frame(*field.value); });
  take("change", item.change, [&](const Field& field) -> Result<Change> {
    if (!is_first) return change(field);
    return fields_.members().wrong(
        *field.value, "the first item cannot have a change: there is no item before it");
  });
  if (Status status = take.done(); !status) return status.error();
  return item;
}

Result<timeline::Easing> Items::easing(const Field& field) const {
  if (field.value->kind == Kind::string) {
    if (const auto parsed = timeline::parse_easing(field.value->text)) return *parsed;
  }
  const auto names = timeline::easing_names();
  const auto index = fields_.word_index(field, names);
  if (!index) return index.error();
  return *timeline::parse_easing(names[*index]);
}

// An object, or only the string "cut".
Result<Change> Items::change(const Field& field) const {
  constexpr std::string_view kChange = "a change";
  const std::vector<std::pair<std::string, ChangeKind>> kinds = {
      {"cut", ChangeKind::cut},
      {"crossfade", ChangeKind::crossfade},
      {"smooth", ChangeKind::smooth},
      {"inertial", ChangeKind::inertial}};
  Change change;
  const Value& value = *field.value;
  if (value.kind == Kind::string) {
    const auto kind = fields_.choice(field, kinds);
    if (!kind) return kind.error();
    change.kind = *kind;
    if (change.kind == ChangeKind::cut) return change;
    return fields_.members().wrong(
        value, fmt::format("a change of kind {} needs a duration", value.text),
        fmt::format("write {{\"kind\": \"{}\", \"duration\": \"0.3s\"}}", value.text));
  }
  if (Status status =
          fields_.only(value, kChange, {"kind", "duration", "easing", "sync", "align", "guard"});
      !status) {
    return status.error();
  }
  if (const auto kind = fields_.members().get(value, kChange, "kind", Kind::string); !kind) {
    return kind.error();
  }
  Taker take(value, kChange);
  take("kind", change.kind, [&](const Field& inner) { return fields_.choice(inner, kinds); });
  take.check("kind", [&](const Field&) { return check_change_keys(value, change.kind); });
  take("duration", change.duration, [&](const Field& inner) -> Result<double> {
    auto lasts = fields_.duration(inner, rate_);
    if (lasts && !(*lasts > 0)) return fields_.wrong(inner, "more than 0 s");
    return lasts;
  });
  take("easing", change.easing, [&](const Field& inner) { return easing(inner); });
  take("sync", change.sync, [&](const Field& inner) {
    return fields_.choice<timeline::Sync>(inner, {{"auto", timeline::Sync::automatic},
                                                  {"keytimes", timeline::Sync::keytimes},
                                                  {"clock", timeline::Sync::clock}});
  });
  take("align", change.align, [&](const Field& inner) {
    return fields_.choice<timeline::Align>(
        inner, {{"root", timeline::Align::root}, {"stance", timeline::Align::stance}});
  });
  take("guard", change.guard, [&](const Field& inner) { return fields_.truth(inner); });
  if (Status status = take.done(); !status) return status.error();
  return change;
}

// A key that a kind of change does not use is an error, as is a missing duration.
Status Items::check_change_keys(const Value& value, ChangeKind kind) const {
  if (kind != ChangeKind::cut && value.find("duration") == nullptr) {
    return fields_.members().wrong(value, fmt::format("a change of kind {} needs a \"duration\"",
                                                      timeline::change_name(kind)));
  }
  const std::pair<std::string_view, std::vector<ChangeKind>> uses[] = {
      {"duration", {ChangeKind::crossfade, ChangeKind::smooth, ChangeKind::inertial}},
      {"easing", {ChangeKind::crossfade, ChangeKind::smooth}},
      {"sync", {ChangeKind::crossfade}},
      {"guard", {ChangeKind::inertial}}};
  for (const auto& [key, kinds] : uses) {
    const Value* found = value.find(key);
    if (found == nullptr || std::ranges::find(kinds, kind) != kinds.end()) continue;
    return fields_.members().wrong(
        *found, fmt::format("a change of kind {} has no \"{}\"", timeline::change_name(kind), key));
  }
  return {};
}

}  // namespace krok::timeline_file
