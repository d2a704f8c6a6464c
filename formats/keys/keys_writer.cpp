#include <fmt/format.h>

#include <algorithm>

#include "core/hash.h"
#include "formats/json/json_text.h"
#include "formats/keys/keys.h"
#include "formats/keys/written_internal.h"

namespace krok::keys {

using json::in_quotes;

namespace {

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

}  // namespace

std::string written_time(double seconds) {
  return fixed(seconds, 6);
}

std::string written_place(const Vec3& place) {
  return fmt::format("[{}, {}, {}]", fixed(place.x(), 5), fixed(place.y(), 5), fixed(place.z(), 5));
}

bool by_hand(const std::vector<std::uint8_t>& marks, std::size_t index) {
  return index < marks.size() && marks[index] != 0;
}

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

}  // namespace krok::keys
