#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/json/members.h"
#include "formats/keys/keys.h"
#include "formats/keys/written_internal.h"

namespace krok::keys {

namespace {

using json::Value;
using Kind = Value::Kind;

constexpr double kBeyond = 1e-3;        // seconds: written times are rounded
constexpr double kMinReadGap = 1.5e-6;  // seconds, between keytimes
constexpr double kFurthest = 1e6;       // metres
constexpr std::size_t kLongestName = 200;
constexpr std::string_view kRebuild =
    "is this the file of another motion, or was the motion changed? krok-keys --discard-edits "
    "rebuilds it";

class Reader {
 public:
  // `ordered`: whether contacts that start at one time are in the order of the skeleton's joints,
  // else in that of the file.
  Reader(std::string_view text, const Skeleton& skeleton, double duration, bool ordered)
      : text_(text),
        in_(text, "keys"),
        skeleton_(skeleton),
        duration_(duration),
        ordered_(ordered) {
    for (std::size_t j = 0; j < skeleton.names.size(); ++j) {
      joints_.emplace(skeleton.names[j], static_cast<int>(j));
    }
  }

  Result<Sidecar> read() {
    const auto root = json::parse(text_);
    if (!root) return root.error();
    if (Status status = in_.only(
            *root, "the file",
            {"schema", "comment", "duration", "edited", "found_xxh3", "contacts", "keytimes"});
        !status) {
      return status.error();
    }
    if (Status status = in_.has_schema(*root, "the file", kSchema); !status) return status.error();
    for (const auto part : {&Reader::read_facts, &Reader::read_contacts, &Reader::read_keytimes}) {
      if (Status status = (this->*part)(*root); !status) return status.error();
    }
    // A file without a checksum was written by hand.
    sidecar_.edited = sidecar_.edited || checksum(sidecar_, skeleton_) != checksum_;
    return std::move(sidecar_);
  }

 private:
  Status read_facts(const Value& root) {
    const auto edited = in_.find(root, "the file", "edited", Kind::boolean);
    if (!edited) return edited.error();
    sidecar_.edited = *edited != nullptr && (*edited)->truth;
    const auto sum = in_.find(root, "the file", "found_xxh3", Kind::string);
    if (!sum) return sum.error();
    if (*sum != nullptr) checksum_ = (*sum)->text;
    if (root.find("duration") == nullptr) return {};
    const auto duration = number(root, "the file", "duration");
    if (!duration) return duration.error();
    if (*duration < 0) {
      return in_.wrong(*root.find("duration"), "\"duration\" is negative, expected seconds from 0");
    }
    sidecar_.duration = *duration;
    return {};
  }

  Result<double> number(const Value& object, std::string_view what, std::string_view key) const {
    const auto value = in_.get(object, what, key, Kind::number);
    if (!value) return value.error();
    if (!std::isfinite((*value)->number)) {
      return in_.wrong(**value, fmt::format("\"{}\" of {} is not finite", key, what));
    }
    return (*value)->number;
  }

  // A time within the motion.
  Result<double> moment(const Value& object, std::string_view what, std::string_view key) const {
    const auto time = number(object, what, key);
    if (!time) return time.error();
    if (*time < -kBeyond || *time > duration_ + kBeyond) {
      return json::error_at(text_, object.find(key)->offset, "keys-time",
                            fmt::format("\"{}\" of {} is {} s, outside the motion's 0 to {} s", key,
                                        what, readable(*time, 9), readable(duration_, 9)),
                            std::string(kRebuild));
    }
    return time;
  }

  // Whether it was set by hand.
  Result<bool> mark(const Value& object, std::string_view what) const {
    const auto by = in_.find(object, what, "by", Kind::string);
    if (!by) return by.error();
    if (*by == nullptr) return false;
    if ((*by)->text != "hand") {
      return in_.wrong(**by, fmt::format("\"by\" of {} is '{}', expected \"hand\" or no \"by\"",
                                         what, shown((*by)->text)));
    }
    return true;
  }

  Result<int> joint(const Value& object) const {
    const auto name = in_.get(object, "a contact", "joint", Kind::string);
    if (!name) return name.error();
    const auto found = joints_.find((*name)->text);
    if (found == joints_.end()) {
      return json::error_at(text_, (*name)->offset, "keys-joint",
                            fmt::format("the motion has no joint '{}'", shown((*name)->text)),
                            std::string(kRebuild));
    }
    return found->second;
  }

  Result<Vec3> place(const Value& object, std::string_view what) const {
    const auto list = in_.get(object, what, "place", Kind::array);
    if (!list) return list.error();
    Vec3 place;
    bool good = (*list)->items.size() == 3;
    for (std::size_t i = 0; good && i < 3; ++i) {
      const Value& item = (*list)->items[i];
      good = item.kind == Kind::number && std::abs(item.number) <= kFurthest;
      place[static_cast<Eigen::Index>(i)] = item.number;
    }
    if (good) return place;
    return in_.wrong(**list, fmt::format("\"place\" of {} must be three numbers (metres)", what));
  }

  Result<Contact> read_contact(const Value& item) {
    if (Status status = in_.only(item, "a contact", {"joint", "start", "end", "place", "by"});
        !status) {
      return status.error();
    }
    Contact contact;
    const auto on = joint(item);
    if (!on) return on.error();
    contact.joint = *on;
    const std::string what = fmt::format(
        "a contact of {}", shown(skeleton_.names[static_cast<std::size_t>(contact.joint)]));
    const auto start = moment(item, what, "start");
    if (!start) return start.error();
    const auto end = moment(item, what, "end");
    if (!end) return end.error();
    if (*end < *start) {
      return json::error_at(text_, item.find("end")->offset, "keys-time",
                            fmt::format("{} ends at {} s, before it starts at {} s", what,
                                        readable(*end, 9), readable(*start, 9)));
    }
    contact.start = *start;
    contact.end = *end;
    const auto at = place(item, what);
    if (!at) return at.error();
    contact.place = *at;
    const auto hand = mark(item, what);
    if (!hand) return hand.error();
    sidecar_.contacts_by_hand.push_back(*hand ? 1 : 0);
    return contact;
  }

  Status read_contacts(const Value& root) {
    const auto list = in_.find(root, "the file", "contacts", Kind::array);
    if (!list) return list.error();
    if (*list == nullptr) return {};
    std::vector<Contact> contacts;
    for (const Value& item : (*list)->items) {
      auto contact = read_contact(item);
      if (!contact) return contact.error();
      contacts.push_back(*contact);
    }
    sort(contacts, sidecar_.contacts_by_hand,
         [this](const Contact& c) { return std::tuple(c.start, ordered_ ? c.joint : 0); });
    sidecar_.keys.contacts = std::move(contacts);
    return {};
  }

  Result<Keytime> read_keytime(const Value& item) {
    if (Status status = in_.only(item, "a keytime", {"name", "time", "by"}); !status) {
      return status.error();
    }
    const auto name = in_.get(item, "a keytime", "name", Kind::string);
    if (!name) return name.error();
    const std::string& text = (*name)->text;
    const bool plain = std::ranges::none_of(
        text, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
    if (text.empty() || !plain || text.size() > kLongestName) {
      return in_.wrong(**name, fmt::format("'{}' is not a valid keytime name", shown(text)),
                       fmt::format("use 1 to {} bytes and no control characters", kLongestName));
    }
    const auto time = moment(item, fmt::format("'{}'", shown(text)), "time");
    if (!time) return time.error();
    const auto hand = mark(item, fmt::format("'{}'", shown(text)));
    if (!hand) return hand.error();
    sidecar_.keytimes_by_hand.push_back(*hand ? 1 : 0);
    return Keytime{*time, text};
  }

  Status read_keytimes(const Value& root) {
    const auto list = in_.find(root, "the file", "keytimes", Kind::array);
    if (!list) return list.error();
    if (*list == nullptr) return {};
    std::vector<Keytime> keytimes;
    std::vector<std::size_t> offsets;
    for (const Value& item : (*list)->items) {
      auto keytime = read_keytime(item);
      if (!keytime) return keytime.error();
      offsets.push_back(item.offset);
      keytimes.push_back(std::move(*keytime));
    }
    sort(
        keytimes, sidecar_.keytimes_by_hand, [](const Keytime& key) { return key.time; }, &offsets);
    for (std::size_t i = 1; i < keytimes.size(); ++i) {
      if (keytimes[i].time - keytimes[i - 1].time >= kMinReadGap) continue;
      return json::error_at(
          text_, std::max(offsets[i - 1], offsets[i]), "keys-time",
          fmt::format("'{}' and '{}' are both at {} s", shown(keytimes[i - 1].name),
                      shown(keytimes[i].name), readable(keytimes[i].time, 9)),
          "keytimes must be at least 2 microseconds apart");
    }
    sidecar_.keys.keytimes = std::move(keytimes);
    return {};
  }

  // Sorts items by a key, together with their marks.
  template <typename Item, typename Key>
  static void sort(std::vector<Item>& items, std::vector<std::uint8_t>& marks, const Key& key,
                   std::vector<std::size_t>* offsets = nullptr) {
    std::vector<std::size_t> order(items.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return key(items[i]); });
    const auto in_order = [&](auto& list) {
      auto old = list;
      for (std::size_t i = 0; i < order.size(); ++i) list[i] = old[order[i]];
    };
    in_order(items);
    in_order(marks);
    if (offsets != nullptr) in_order(*offsets);
  }

  std::string_view text_;
  json::Members in_;
  const Skeleton& skeleton_;
  double duration_;
  std::unordered_map<std::string, int> joints_;
  std::string checksum_;
  bool ordered_;
  Sidecar sidecar_;
};

}  // namespace

bool Sidecar::has_edits() const {
  return edited || std::ranges::count(contacts_by_hand, 1) > 0 ||
         std::ranges::count(keytimes_by_hand, 1) > 0;
}

Result<Sidecar> read_sidecar(std::string_view text, const std::string& path,
                             const Skeleton& skeleton, double duration) {
  auto sidecar = Reader(text, skeleton, duration, true).read();
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
  if (const Value* contacts = root->find("contacts")) {
    for (const Value& contact : contacts->items) {
      const Value* joint = contact.find("joint");
      if (joint == nullptr || named.find(joint->text) >= 0) continue;
      named.add(joint->text, named.joint_count() - 1, {});
    }
  }
  const auto sidecar = Reader(text, named, HUGE_VAL, false).read();
  return !sidecar || sidecar->has_edits();
}

Result<MotionKeys> read(std::string_view text, const std::string& path, const Skeleton& skeleton,
                        double duration) {
  auto sidecar = read_sidecar(text, path, skeleton, duration);
  if (!sidecar) return std::move(sidecar).error();
  return std::move(sidecar->keys);
}

}  // namespace krok::keys
