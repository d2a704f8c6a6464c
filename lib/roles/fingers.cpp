#include "roles/fingers.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "roles/joint_names.h"

namespace krok {

namespace {

struct FingerWord {
  std::string_view text;
  Finger finger;
};

constexpr std::array kFingerWords = {
    FingerWord{"thumb", Finger::thumb},   FingerWord{"index", Finger::index},
    FingerWord{"pointer", Finger::index}, FingerWord{"middle", Finger::middle},
    FingerWord{"mid", Finger::middle},    FingerWord{"ring", Finger::ring},
    FingerWord{"little", Finger::little}, FingerWord{"pinky", Finger::little},
    FingerWord{"pinkie", Finger::little}, FingerWord{"fingers", Finger::all}};

// Xsens counts the fingers from the thumb.
constexpr std::array kOrdinalWords = {
    FingerWord{"first", Finger::thumb}, FingerWord{"second", Finger::index},
    FingerWord{"third", Finger::middle}, FingerWord{"fourth", Finger::ring},
    FingerWord{"fifth", Finger::little}};

// Words before or after the finger in names without separators: "righthandindex".
constexpr std::array<std::string_view, 7> kBefore = {"left",   "right", "hand", "in",
                                                     "finger", "l",     "r"};
constexpr std::array<std::string_view, 11> kAfter = {
    "left",   "right", "finger", "proximal", "intermediate", "medial",
    "distal", "tip",   "end",    "meta",     "metacarpal"};

struct FingerName {
  Finger finger = Finger::none;
  bool metacarpal = false;
  bool has_number = false;
  bool base = false;        // common base of all fingers: "LeftFingerBase"
  int counted_finger = -1;  // the 2 of "Finger21", resolved to a finger once all names are read
};

bool is_digits(std::string_view token) {
  return !token.empty() && std::isdigit(static_cast<unsigned char>(token[0])) != 0;
}

// The finger's word without the words of kBefore and kAfter around it.
std::string_view bare(std::string_view word) {
  const auto known = [](std::string_view text) {
    return std::any_of(kFingerWords.begin(), kFingerWords.end(),
                       [text](const FingerWord& entry) { return entry.text == text; });
  };
  for (bool changed = true; changed && !known(word);) {
    changed = false;
    for (const std::string_view before : kBefore) {
      if (word.size() > before.size() && word.starts_with(before)) {
        word.remove_prefix(before.size());
        changed = true;
        break;
      }
    }
  }
  for (bool changed = true; changed && !known(word);) {
    changed = false;
    for (const std::string_view after : kAfter) {
      if (word.size() > after.size() && word.ends_with(after)) {
        word.remove_suffix(after.size());
        changed = true;
        break;
      }
    }
  }
  return word;
}

FingerName read_finger_name(std::string_view joint_name) {
  FingerName name;
  const std::vector<std::string> tokens = name_tokens(joint_name);
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const std::string& token = tokens[i];
    if (is_digits(token)) {
      name.has_number = true;
      continue;
    }
    name.metacarpal = name.metacarpal || token.find("carpal") != std::string::npos ||
                      token == "mc" || token == "palm" || token == "meta" || token == "inhand" ||
                      (token == "in" && i + 1 < tokens.size() && tokens[i + 1] == "hand");
    name.base = name.base || token == "base" || token == "fingerbase";
    const std::string_view word = bare(token);
    for (const FingerWord& entry : kFingerWords) {
      if (word == entry.text) name.finger = entry.finger;
    }
    for (const FingerWord& entry : kOrdinalWords) {
      if (token == entry.text && name.finger == Finger::none) name.finger = entry.finger;
    }
    const bool counted = token.ends_with("finger") && i + 1 < tokens.size();
    if (counted && is_digits(tokens[i + 1])) {
      // "Finger01" is the second joint of the thumb; "finger_01" the first finger.
      const std::string& number = tokens[i + 1];
      const bool leading_zero_only = number.size() == 2 && number[0] == '0' &&
                                     i + 2 < tokens.size() && is_digits(tokens[i + 2]);
      name.counted_finger = number[leading_zero_only ? 1 : 0] - '0';
    }
  }
  return name;
}

class FingerFinder {
 public:
  FingerFinder(const Skeleton& skeleton, std::span<const int> joints)
      : skeleton_(skeleton),
        joints_(joints),
        names_(joints.size()),
        above_(joints.size(), -1),
        below_(joints.size()) {
    for (std::size_t i = 0; i < joints.size(); ++i) {
      names_[i] = read_finger_name(skeleton.names[at(joints[i])]);
      const int parent = skeleton.parents[at(joints[i])];
      const auto found = std::lower_bound(joints.begin(), joints.begin() + ptrdiff(i), parent);
      if (found != joints.begin() + ptrdiff(i) && *found == parent) {
        above_[i] = static_cast<int>(found - joints.begin());
        below_[at(above_[i])].push_back(static_cast<int>(i));
      }
    }
  }

  std::vector<FingerJoint> find() {
    name_counted_fingers();
    inherit();
    std::vector<FingerJoint> places(joints_.size());
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const Finger finger = names_[i].finger;
      if (finger == Finger::none) continue;
      const bool continues = above_[i] >= 0 && names_[at(above_[i])].finger == finger;
      int phalanx = 1;
      if (continues) {
        phalanx = std::min(places[at(above_[i])].phalanx + 1, FingerJoint::kTip);
      } else if (leads_to_knuckle(i)) {
        phalanx = FingerJoint::kMetacarpal;
      }
      places[i] = {finger, phalanx};
    }
    return places;
  }

 private:
  static std::size_t at(int index) { return static_cast<std::size_t>(index); }
  static std::ptrdiff_t ptrdiff(std::size_t index) { return static_cast<std::ptrdiff_t>(index); }

  // "Finger0" to "Finger4" are thumb to little finger. If counted from 1, finger 1 is the thumb,
  // unless a joint is named thumb.
  void name_counted_fingers() {
    bool from_zero = false;
    bool named_thumb = false;
    for (const FingerName& name : names_) {
      from_zero = from_zero || name.counted_finger == 0;
      named_thumb = named_thumb || name.finger == Finger::thumb;
    }
    const int thumb = from_zero || named_thumb ? 0 : 1;
    for (FingerName& name : names_) {
      if (name.finger != Finger::none || name.counted_finger < 0) continue;
      const int place = name.counted_finger - thumb;
      if (place < 0 || place > 4) continue;
      name.finger = static_cast<Finger>(static_cast<int>(Finger::thumb) + place);
    }
  }

  // A joint without a finger's name belongs to its parent's finger, or as a metacarpal to its only
  // child's finger.
  void inherit() {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (names_[i].finger != Finger::none || above_[i] < 0) continue;
      const FingerName& above = names_[at(above_[i])];
      if (above.finger != Finger::none && !names_[i].metacarpal) names_[i].finger = above.finger;
    }
    for (std::size_t i = names_.size(); i-- > 0;) {
      if (names_[i].finger != Finger::none) continue;
      if (below_[i].size() != 1 || names_[i].base) continue;
      const Finger only = names_[at(below_[i].front())].finger;
      if (only == Finger::none || only == Finger::all) continue;
      names_[i].finger = only;
      names_[i].metacarpal = true;
    }
  }

  // Whether the first joint of a finger is a metacarpal: named so (except for the thumb, whose
  // metacarpal is its first bone), or without a number and followed by a joint with one
  // ("LeftHandRing", "LeftHandRing1"), or of the same name as the next except for punctuation
  // ("__Ring1", "Ring1").
  bool leads_to_knuckle(std::size_t i) const {
    const FingerName& name = names_[i];
    for (const int c : below_[i]) {
      if (names_[at(c)].finger != name.finger) continue;
      const bool same_tokens = name_tokens(skeleton_.names[at(joints_[i])]) ==
                               name_tokens(skeleton_.names[at(joints_[at(c)])]);
      if (same_tokens) return true;
      if (name.finger == Finger::thumb) return false;
      if (name.metacarpal) return true;
      return name.counted_finger < 0 && !name.has_number && names_[at(c)].has_number;
    }
    return name.metacarpal && name.finger != Finger::thumb;
  }

  const Skeleton& skeleton_;
  std::span<const int> joints_;
  std::vector<FingerName> names_;        // [joints_]
  std::vector<int> above_;               // [joints_], index in joints_ of the parent, or -1
  std::vector<std::vector<int>> below_;  // [joints_], indices in joints_ of the children
};

constexpr std::array<std::string_view, 7> kFingerNames = {"",     "thumb",  "index", "middle",
                                                          "ring", "little", "all"};

}  // namespace

std::string finger_place_name(FingerJoint place) {
  if (place.finger == Finger::none) return {};
  std::string name(kFingerNames[static_cast<std::size_t>(place.finger)]);
  if (place.phalanx == FingerJoint::kMetacarpal) return name + "_metacarpal";
  if (place.phalanx == FingerJoint::kTip) return name + "_tip";
  return name + "_" + std::to_string(place.phalanx);
}

std::optional<FingerJoint> parse_finger_joint(std::string_view name) {
  for (std::size_t f = 1; f < kFingerNames.size(); ++f) {
    for (int phalanx = FingerJoint::kMetacarpal; phalanx <= FingerJoint::kTip; ++phalanx) {
      const FingerJoint place{static_cast<Finger>(f), phalanx};
      if (finger_place_name(place) == name) return place;
    }
  }
  return std::nullopt;
}

std::vector<FingerJoint> find_fingers(const Skeleton& skeleton, std::span<const int> beyond_wrist) {
  return FingerFinder(skeleton, beyond_wrist).find();
}

}  // namespace krok
