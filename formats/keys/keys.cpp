#include "formats/keys/keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <unordered_map>

#include "core/hash.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/json/fields.h"
#include "formats/json/located_json.h"

namespace krok::keys {

namespace {

constexpr std::string_view kSchema = "krok.keys/1";

using json::Given;
using json::in_quotes;
using JsonKind = json::Value::Kind;

constexpr double kBeyond = 1e-3;        // seconds: written times are rounded
constexpr double kMinReadGap = 1.5e-6;  // seconds, between keytimes
constexpr std::size_t kLongestName = 200;
constexpr const char* kRebuild =
    "is this the file of another motion, or was the motion changed? krok-keys --discard-edits "
    "rebuilds it";

// A number with up to `digits` decimals, without trailing zeros or negative zero.
std::string fixed(double value, int digits) {
  std::string text = fmt::format("{:.{}f}", value, digits);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string joined(const std::vector<std::string>& lines) {
  return lines.empty() ? "[]" : fmt::format("[\n    {}\n  ]", fmt::join(lines, ",\n    "));
}

constexpr const char* kMark = ", \"by\": \"hand\"";
constexpr double kMinWrittenGap =
    2e-6;  // seconds, so that keytimes are still distinct after rounding

void keep_apart(std::vector<Keytime>& keytimes) {
  for (std::size_t i = 1; i < keytimes.size(); ++i) {
    keytimes[i].time = std::max(keytimes[i].time, keytimes[i - 1].time + kMinWrittenGap);
  }
}

std::string written_time(double seconds) {
  return fixed(seconds, 6);
}

std::string written_place(const Vec3& place) {
  return fmt::format("[{}, {}, {}]", fixed(place.x(), 5), fixed(place.y(), 5), fixed(place.z(), 5));
}

bool by_hand(const std::vector<std::uint8_t>& marks, std::size_t index) {
  return index < marks.size() && marks[index] != 0;
}

// The XXH3 checksum, as 16 hexadecimal digits, of all entries not marked as set by hand: one line
// each, "contact NAME START END [x, y, z]" and "keytime NAME TIME", as written, ending with LF.
std::string checksum(const Sidecar& sidecar, const Skeleton& skeleton) {
  std::string text;
  for (std::size_t i = 0; i < sidecar.keys.contacts.size(); ++i) {
    const Contact& contact = sidecar.keys.contacts[i];
    if (by_hand(sidecar.contacts_by_hand, i)) continue;
    text += fmt::format(
        "contact {} {} {} {}\n", skeleton.names[static_cast<std::size_t>(contact.joint)],
        written_time(contact.start), written_time(contact.end), written_place(contact.place));
  }
  for (std::size_t i = 0; i < sidecar.keys.keytimes.size(); ++i) {
    const Keytime& key = sidecar.keys.keytimes[i];
    if (by_hand(sidecar.keytimes_by_hand, i)) continue;
    text += fmt::format("keytime {} {}\n", key.name, written_time(key.time));
  }
  return hex(xxh3(std::as_bytes(std::span(text))));
}

// Entries of the file; `hand`: whether set by hand.
struct ContactEntry {
  Contact contact;
  bool hand = false;
};
struct KeytimeEntry {
  Keytime keytime;
  bool hand = false;
  std::size_t offset = 0;
};

json::Kind<double> finite() {
  return json::kind<double>(R"({"type": "number"})", [](const Given& given, double& to) -> Status {
    if (Status status = given.is(JsonKind::number); !status) return status;
    to = given.value.number;
    if (std::isfinite(to)) return {};
    return given.wrong(fmt::format("{} is not finite", given.name()));
  });
}

json::Kind<double> file_duration() {
  return json::kind<double>(
      R"({"type": "number", "minimum": 0})", [](const Given& given, double& to) -> Status {
        Status status = finite().read(given, &to);
        if (!status || to >= 0) return status;
        return given.wrong("\"duration\" is negative, expected seconds from 0");
      });
}

json::Kind<bool> by() {
  return json::kind<bool>(R"({"const": "hand"})", [](const Given& given, bool& to) -> Status {
    if (Status status = given.is(JsonKind::string); !status) return status;
    to = given.value.text == "hand";
    if (to) return {};
    return given.wrong(fmt::format("{} is '{}', expected \"hand\" or no \"by\"", given.name(),
                                   shown(given.value.text)));
  });
}

json::Kind<Vec3> place() {
  return json::kind<Vec3>(json::schema_of_numbers(3), [](const Given& given, Vec3& to) -> Status {
    if (Status status = given.is(JsonKind::array); !status) return status;
    if (json::vector(1e6).read(given, &to)) return {};
    return given.wrong(fmt::format("{} must be three numbers (metres)", given.name()));
  });
}

json::Kind<std::string> keytime_name() {
  json::Kind<std::string> made =
      json::plain_text(kLongestName, "'{1}' is not a valid keytime name",
                       fmt::format("use 1 to {} bytes and no control characters", kLongestName));
  return made;
}

struct File {
  const Skeleton& skeleton;
  double duration;  // of the motion
  // Whether contacts that start at one time are in the order of the skeleton's joints, else in that
  // of the file.
  bool ordered;
  std::unordered_map<std::string, int> joints = {};
  std::string sum = {};
  std::vector<ContactEntry> contacts = {};
  std::vector<KeytimeEntry> keytimes = {};

  // A time within the motion.
  json::Kind<double> moment() const {
    return json::kind<double>(finite().schema(), [this](const Given& given, double& to) -> Status {
      Status status = finite().read(given, &to);
      if (!status || (to >= -kBeyond && to <= duration + kBeyond)) return status;
      return given.error("time",
                         fmt::format("{} is {} s, outside the motion's 0 to {} s", given.name(),
                                     readable(to, 9), readable(duration, 9)),
                         kRebuild);
    });
  }

  json::Kind<int> joint() const {
    return json::kind<int>(R"({"type": "string"})", [this](const Given& given, int& to) -> Status {
      if (Status status = given.is(JsonKind::string); !status) return status;
      const auto found = joints.find(given.value.text);
      if (found == joints.end()) {
        return given.error("joint",
                           fmt::format("the motion has no joint '{}'", shown(given.value.text)),
                           kRebuild);
      }
      to = found->second;
      return {};
    });
  }

  json::Object<ContactEntry> contact_table() const {
    const auto of_contact = [](auto member) {
      return [member](ContactEntry & of) -> auto& {
        return of.contact.*member;
      };
    };
    json::Object<ContactEntry> contact;
    contact.field("joint", of_contact(&Contact::joint), joint()).required();
    contact.described([this](const ContactEntry& of) {
      return fmt::format("a contact of {}",
                         shown(skeleton.names[static_cast<std::size_t>(of.contact.joint)]));
    });
    contact.field("start", of_contact(&Contact::start), moment(), "seconds").required();
    contact.field("end", of_contact(&Contact::end), moment(), "seconds").required();
    contact.check([](const Given& given, const ContactEntry& of) -> Status {
      if (of.contact.end >= of.contact.start) return {};
      return given.member("end").error(
          "time", fmt::format("{} ends at {} s, before it starts at {} s", given.what,
                              readable(of.contact.end, 9), readable(of.contact.start, 9)));
    });
    contact.field("place", of_contact(&Contact::place), place(), "metres").required();
    return contact.field("by", &ContactEntry::hand, by());
  }

  json::Object<KeytimeEntry> keytime_table() const {
    json::Object<KeytimeEntry> keytime;
    keytime
        .field(
            "name", [](KeytimeEntry & of) -> auto& { return of.keytime.name; }, keytime_name())
        .required();
    keytime.described(
        [](const KeytimeEntry& of) { return fmt::format("'{}'", shown(of.keytime.name)); });
    keytime
        .field(
            "time", [](KeytimeEntry & of) -> auto& { return of.keytime.time; }, moment(), "seconds")
        .required();
    keytime.field("by", &KeytimeEntry::hand, by());
    keytime.check([](const Given& given, KeytimeEntry& to) {
      to.offset = given.offset;
      return Status();
    });
    return keytime;
  }

  Status take_contacts(Sidecar& to) {
    std::ranges::stable_sort(contacts, {}, [this](const ContactEntry& of) {
      return std::tuple(of.contact.start, ordered ? of.contact.joint : 0);
    });
    for (const ContactEntry& of : contacts) {
      to.keys.contacts.push_back(of.contact);
      to.contacts_by_hand.push_back(of.hand ? 1 : 0);
    }
    return {};
  }

  Status take_keytimes(const Given& root, Sidecar& to) {
    std::ranges::stable_sort(keytimes, {}, [](const KeytimeEntry& of) { return of.keytime.time; });
    for (std::size_t i = 0; i < keytimes.size(); ++i) {
      const Keytime& key = keytimes[i].keytime;
      if (i > 0 && key.time - keytimes[i - 1].keytime.time < kMinReadGap) {
        Given later = root;
        later.offset = std::max(keytimes[i - 1].offset, keytimes[i].offset);
        return later.error(
            "time",
            fmt::format("'{}' and '{}' are both at {} s", shown(keytimes[i - 1].keytime.name),
                        shown(key.name), readable(key.time, 9)),
            "keytimes must be at least 2 microseconds apart");
      }
      to.keys.keytimes.push_back(key);
      to.keytimes_by_hand.push_back(keytimes[i].hand ? 1 : 0);
    }
    return {};
  }

  json::Object<Sidecar> table() {
    for (std::size_t j = 0; j < skeleton.names.size(); ++j) {
      joints.emplace(skeleton.names[j], static_cast<int>(j));
    }
    json::Object<Sidecar> file;
    file.file(kSchema, "Contacts and keytimes of a motion (krok.keys/1)").comment();
    file.field("duration", &Sidecar::duration, file_duration(), "seconds, of the motion");
    file.field("edited", &Sidecar::edited, json::boolean());
    file.context("found_xxh3", sum, json::text(), "checksum of the entries that were found");
    file.context("contacts", contacts,
                 json::list<ContactEntry>(json::object(contact_table()), {"a contact"}));
    file.check([this](const Given&, Sidecar& to) { return take_contacts(to); });
    file.context("keytimes", keytimes,
                 json::list<KeytimeEntry>(json::object(keytime_table()), {"a keytime"}));
    file.check([this](const Given& root, Sidecar& to) { return take_keytimes(root, to); });
    return file;
  }

  Result<Sidecar> read(std::string_view text) {
    auto sidecar = table().read_text(text, "keys");
    // A file without a checksum was written by hand.
    if (sidecar) sidecar->edited = sidecar->edited || checksum(*sidecar, skeleton) != sum;
    return sidecar;
  }
};

}  // namespace

bool Sidecar::has_edits() const {
  return edited || std::ranges::count(contacts_by_hand, 1) > 0 ||
         std::ranges::count(keytimes_by_hand, 1) > 0;
}

Result<Sidecar> read_sidecar(std::string_view text, const std::string& path,
                             const Skeleton& skeleton, double duration) {
  auto sidecar = File{skeleton, duration, true}.read(text);
  if (!sidecar) return std::move(sidecar).error().in_file(path);
  if (Status status = check(sidecar->keys, skeleton, duration); !status) {
    return std::move(status).error().in_file(path);
  }
  return sidecar;
}

bool has_edits(std::string_view text) {
  const auto root = json::parse(text);
  if (!root) return true;
  // A skeleton of the joints that it names, whose order in the motion is not known.
  Skeleton named;
  if (const json::Value* contacts = root->find("contacts")) {
    for (const json::Value& contact : contacts->items) {
      const json::Value* joint = contact.find("joint");
      if (joint == nullptr || named.find(joint->text) >= 0) continue;
      named.add(joint->text, named.joint_count() - 1, {});
    }
  }
  const auto sidecar = File{named, HUGE_VAL, false}.read(text);
  return !sidecar || sidecar->has_edits();
}

Result<MotionKeys> read(std::string_view text, const std::string& path, const Skeleton& skeleton,
                        double duration) {
  auto sidecar = read_sidecar(text, path, skeleton, duration);
  if (!sidecar) return std::move(sidecar).error();
  return std::move(sidecar->keys);
}

std::string write_sidecar(const Sidecar& given, const Skeleton& skeleton) {
  Sidecar sidecar = given;
  keep_apart(sidecar.keys.keytimes);
  std::vector<std::string> contacts, keytimes;
  for (std::size_t i = 0; i < sidecar.keys.contacts.size(); ++i) {
    const Contact& contact = sidecar.keys.contacts[i];
    contacts.push_back(fmt::format(
        "{{\"joint\": {}, \"start\": {}, \"end\": {}, \"place\": {}{}}}",
        in_quotes(skeleton.names[static_cast<std::size_t>(contact.joint)]),
        written_time(contact.start), written_time(contact.end), written_place(contact.place),
        by_hand(sidecar.contacts_by_hand, i) ? kMark : ""));
  }
  for (std::size_t i = 0; i < sidecar.keys.keytimes.size(); ++i) {
    const Keytime& key = sidecar.keys.keytimes[i];
    keytimes.push_back(fmt::format("{{\"name\": {}, \"time\": {}{}}}", in_quotes(key.name),
                                   written_time(key.time),
                                   by_hand(sidecar.keytimes_by_hand, i) ? kMark : ""));
  }
  return fmt::format(
      "{{\n  \"schema\": \"{}\",\n  \"duration\": {},\n  \"edited\": {},\n  \"found_xxh3\": "
      "\"{}\",\n  \"contacts\": {},\n  \"keytimes\": {}\n}}\n",
      kSchema, written_time(sidecar.duration), sidecar.edited, checksum(sidecar, skeleton),
      joined(contacts), joined(keytimes));
}

std::string write(const MotionKeys& keys, const Skeleton& skeleton, double duration) {
  return write_sidecar({keys, {}, {}, false, duration}, skeleton);
}

std::string schema() {
  const Skeleton none;
  return File{none, 0, true}.table().schema();
}

}  // namespace krok::keys
