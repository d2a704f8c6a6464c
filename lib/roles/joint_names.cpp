#include "roles/joint_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <optional>
#include <span>
#include <utility>

namespace krok {

namespace {

using Tokens = std::vector<std::string>;

struct Word {
  std::string_view text;
  Part part;
};

// Words for joints that exist on each side, as spelled by the exporters listed in roles.h.
// Acclaim's bone names (humerus, radius, femur, tibia) stand for the bone's first joint. Some joint
// names (sternoclavicular, midtarsal, skullbase) are those of H-Anim, ISO/IEC 19774, also used by
// SmartBody.
constexpr std::array kSidedWords = {
    Word{"clavicle", Part::collar}, Word{"clav", Part::collar}, Word{"collar", Part::collar},
    Word{"collarbone", Part::collar}, Word{"scapula", Part::collar},
    Word{"sternoclavicular", Part::collar}, Word{"acromioclavicular", Part::collar},
    Word{"shoulder", Part::shoulder}, Word{"shldr", Part::shoulder},
    Word{"shldrbend", Part::upper_arm}, Word{"upperarm", Part::upper_arm},
    Word{"uparm", Part::upper_arm}, Word{"uarm", Part::upper_arm},
    Word{"armupper", Part::upper_arm}, Word{"armup", Part::upper_arm},
    Word{"humerus", Part::upper_arm}, Word{"arm", Part::arm}, Word{"forearm", Part::lower_arm},
    Word{"forearmbend", Part::lower_arm}, Word{"lowerarm", Part::lower_arm},
    Word{"lowarm", Part::lower_arm}, Word{"loarm", Part::lower_arm}, Word{"farm", Part::lower_arm},
    Word{"armlower", Part::lower_arm}, Word{"armlow", Part::lower_arm},
    Word{"elbow", Part::lower_arm}, Word{"radius", Part::lower_arm}, Word{"hand", Part::hand},
    Word{"wrist", Part::hand}, Word{"hip", Part::hip}, Word{"upperleg", Part::upper_leg},
    Word{"upleg", Part::upper_leg}, Word{"uleg", Part::upper_leg},
    Word{"legupper", Part::upper_leg}, Word{"legup", Part::upper_leg},
    Word{"thigh", Part::upper_leg}, Word{"thighbend", Part::upper_leg},
    Word{"femur", Part::upper_leg}, Word{"leg", Part::leg}, Word{"lowerleg", Part::lower_leg},
    Word{"lowleg", Part::lower_leg}, Word{"loleg", Part::lower_leg},
    Word{"leglower", Part::lower_leg}, Word{"leglow", Part::lower_leg},
    Word{"shin", Part::lower_leg}, Word{"shank", Part::lower_leg}, Word{"calf", Part::lower_leg},
    Word{"knee", Part::lower_leg}, Word{"tibia", Part::lower_leg}, Word{"foot", Part::foot},
    Word{"ankle", Part::foot}, Word{"toe", Part::toes}, Word{"toes", Part::toes},
    Word{"toebase", Part::toes}, Word{"forefoot", Part::toes}, Word{"midtarsal", Part::toes},
    Word{"ball", Part::toes},
    // 3ds Max's biped in German
    Word{"schluesselbein", Part::collar}, Word{"oberarm", Part::upper_arm},
    Word{"unterarm", Part::lower_arm}, Word{"oberschenkel", Part::upper_leg},
    Word{"unterschenkel", Part::lower_leg}, Word{"wade", Part::lower_leg}, Word{"fuss", Part::foot},
    Word{"zeh", Part::toes}, Word{"zehe", Part::toes}};

constexpr std::array kMiddleWords = {
    Word{"hips", Part::hips},         Word{"hip", Part::hips},
    Word{"pelvis", Part::hips},       Word{"head", Part::head},
    Word{"skull", Part::head},        Word{"lowerback", Part::spine},
    Word{"skullbase", Part::head},    Word{"upperback", Part::spine},
    Word{"back", Part::spine},        Word{"abdomen", Part::spine},
    Word{"ab", Part::spine},          Word{"waist", Part::spine},
    Word{"torso", Part::spine},       Word{"thorax", Part::spine},
    Word{"tospine", Part::spine},     Word{"ribcage", Part::spine},
    Word{"becken", Part::hips},       Word{"kopf", Part::head},
    Word{"wirbelsaeule", Part::spine}};

// Matched anywhere in the name.
constexpr std::array<std::string_view, 27> kHelperWords = {
    "twist",  "roll",  "share",  "jaw",    "tongue", "teeth",    "face",     "facial",  "breast",
    "brow",   "cheek", "eyelid", "marker", "target", "effector", "control",  "ctrl",    "helper",
    "weapon", "prop",  "dummy",  "hair",   "cloth",  "skirt",    "hipjoint", "buttock", "glute"};
// Matched as whole words only.
constexpr std::array<std::string_view, 11> kHelperTokens = {
    "ik", "pole", "goal", "eye", "eyes", "ear", "lip", "nose", "tail", "nub", "heel"};

// Of joints without a part in a body's shape, matched as words.
constexpr std::array<std::string_view, 25> kShapelessWords = {
    "ik",     "pole",   "goal",   "target", "effector", "control", "ctrl", "helper", "dummy",
    "marker", "prop",   "weapon", "eye",    "eyes",     "eyelid",  "lid",  "brow",   "eyebrow",
    "cheek",  "tongue", "teeth",  "lip",    "lips",     "mouth",   "face"};

std::optional<Part> find_word(std::span<const Word> words, std::string_view text) {
  const auto found = std::find_if(words.begin(), words.end(),
                                  [text](const Word& word) { return word.text == text; });
  if (found == words.end()) return std::nullopt;
  return found->part;
}

bool is_number(std::string_view token) {
  return !token.empty() && std::isdigit(static_cast<unsigned char>(token[0]));
}

Side side_of(std::string_view token) {
  if (token == "l" || token == "left" || token == "lft" || token == "lt") return Side::left;
  if (token == "r" || token == "right" || token == "rgt" || token == "rt") return Side::right;
  return Side::middle;
}

// All tokens except numbers, concatenated.
std::string joined(const Tokens& tokens) {
  std::string text;
  for (const std::string& token : tokens) {
    if (!is_number(token)) text += token;
  }
  return text;
}

bool is_trunk_word(std::string_view text) {
  return text.starts_with("spine") || text.ends_with("spine") || text.starts_with("chest") ||
         text.starts_with("abdomen") || find_word(kMiddleWords, text) == Part::spine;
}

bool is_neck_word(std::string_view text) {
  return text.starts_with("neck") || text == "lowerneck" || text == "upperneck" || text == "hals";
}

Part middle_part(std::string_view text) {
  if (is_neck_word(text)) return Part::neck;
  if (is_trunk_word(text)) return Part::spine;
  return find_word(kMiddleWords, text).value_or(Part::unknown);
}

// Removes the side from the tokens and returns it.
Side take_side(Tokens& tokens) {
  // The first and last words are tried before those between: "arm_r_l" is on the left.
  std::vector<std::size_t> places;
  if (!tokens.empty()) places = {0, tokens.size() - 1};
  for (std::size_t i = 1; i + 1 < tokens.size(); ++i) places.push_back(i);
  for (const std::size_t place : places) {
    const Side side = side_of(tokens[place]);
    if (side == Side::middle) continue;
    Tokens rest = tokens;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(place));
    if (joined(rest).empty()) continue;  // "L5" is a vertebra
    tokens = rest;
    return side;
  }
  return Side::middle;
}

// Splits a side that is part of a word ("leftarm", "handright", "lhand") from the rest of it.
std::pair<Side, std::string> split_side(const std::string& text) {
  for (const auto& [word, side] :
       {std::pair<std::string_view, Side>{"left", Side::left}, {"right", Side::right}}) {
    if (text.size() <= word.size()) continue;
    if (text.starts_with(word)) return {side, text.substr(word.size())};
    if (text.ends_with(word)) return {side, text.substr(0, text.size() - word.size())};
  }
  if (text.size() > 1 && (text[0] == 'l' || text[0] == 'r')) {
    const std::string rest = text.substr(1);
    const bool known = find_word(kSidedWords, rest).has_value() || rest == "hipjoint" ||
                       rest == "buttock" || rest == "thumb" || rest == "fingers" ||
                       rest == "finger" || rest == "eye";
    if (known && !find_word(kSidedWords, text)) {
      return {text[0] == 'l' ? Side::left : Side::right, rest};
    }
  }
  return {Side::middle, text};
}

// Removes words without meaning, as in "Skeleton_arm_joint_L". "Hip joint" is kept, as it is a
// helper (CMU's LHipJoint between hips and thigh).
void drop_filler_words(Tokens& tokens) {
  constexpr std::array<std::string_view, 6> kFillers = {"joint", "jnt",      "bone",
                                                        "bn",    "skeleton", "armature"};
  for (std::size_t i = tokens.size(); i-- > 0 && tokens.size() > 1;) {
    const bool filler = std::find(kFillers.begin(), kFillers.end(), tokens[i]) != kFillers.end();
    const bool hip_joint = i > 0 && tokens[i - 1] == "hip";
    if (filler && !hip_joint) tokens.erase(tokens.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

JointName read_name(Tokens tokens) {
  JointName name;
  if (tokens.size() > 1 && (tokens.front() == "c" || tokens.front() == "center")) {
    tokens.erase(tokens.begin());
  }
  drop_filler_words(tokens);
  const auto is_helper_token = [](const std::string& token) {
    return std::find(kHelperTokens.begin(), kHelperTokens.end(), token) != kHelperTokens.end();
  };
  name.side = take_side(tokens);
  std::string text = joined(tokens);
  if (name.side == Side::middle) {
    name.part = middle_part(text);
    if (name.part != Part::unknown) return name;
    std::tie(name.side, text) = split_side(text);
  }
  const bool helper =
      std::any_of(tokens.begin(), tokens.end(), is_helper_token) || is_helper_token(text) ||
      std::any_of(kHelperWords.begin(), kHelperWords.end(),
                  [&](std::string_view word) { return text.find(word) != std::string::npos; });
  if (helper) {
    name.part = Part::helper;
  } else if (name.side != Side::middle) {
    // A pelvis with a side is a helper between hips and leg.
    name.part =
        text == "pelvis" ? Part::helper : find_word(kSidedWords, text).value_or(Part::unknown);
  }
  return name;
}

bool is_body_word(const std::string& token) {
  return side_of(token) != Side::middle || find_word(kSidedWords, token) ||
         middle_part(token) != Part::unknown || split_side(token).first != Side::middle;
}

// Removes words that more than half of the names start or end with, unless they name a body part.
void strip_common_words(std::vector<Tokens>& names, bool at_end) {
  constexpr int kMaxWords = 6;
  if (names.size() < 4) return;
  const auto place = [at_end](const Tokens& tokens) {
    return at_end ? tokens.end() - 1 : tokens.begin();
  };
  for (int round = 0; round < kMaxWords; ++round) {
    std::map<std::string, std::size_t> counts;
    for (const Tokens& tokens : names) {
      if (!tokens.empty()) ++counts[*place(tokens)];
    }
    const auto most =
        std::max_element(counts.begin(), counts.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most == counts.end() || most->second * 2 <= names.size() || is_body_word(most->first) ||
        (at_end && is_number(most->first))) {
      return;
    }
    for (Tokens& tokens : names) {
      if (!tokens.empty() && *place(tokens) == most->first) tokens.erase(place(tokens));
    }
  }
}

// Removes words in front that keep names from being read, however few names have them: of a body
// among the joints of hair and clothes, whose names begin otherwise.
void strip_words_before_parts(std::vector<Tokens>& names) {
  constexpr std::size_t kMinNames = 4;
  // Copies of a joint for constraints, beside those of the skeleton (Rigify of Blender).
  constexpr std::array<std::string_view, 2> kCopies = {"mch", "org"};
  const auto is_read = [](const Tokens& tokens) {
    const Part part = read_name(tokens).part;
    return part != Part::unknown && part != Part::helper;
  };
  const auto is_copy = [&](const std::string& word) {
    return std::ranges::find(kCopies, word) != kCopies.end() || names_no_shape(word);
  };
  for (;;) {
    std::map<std::string, std::size_t> counts;
    for (const Tokens& tokens : names) {
      if (tokens.size() < 2 || is_body_word(tokens[0]) || is_copy(tokens[0])) continue;
      if (is_read(tokens) || !is_read(Tokens(tokens.begin() + 1, tokens.end()))) continue;
      ++counts[tokens[0]];
    }
    const auto most =
        std::ranges::max_element(counts, {}, [](const auto& entry) { return entry.second; });
    if (most == counts.end() || most->second < kMinNames) return;
    for (Tokens& tokens : names) {
      if (tokens.size() > 1 && tokens[0] == most->first) tokens.erase(tokens.begin());
    }
  }
}

// For rigs that only number the joints of a limb ("leg_joint_L_1" to "leg_joint_L_5"): a chain of
// at least three joints with `word`, if no joint of that side is named by one of `others`, is
// assigned the parts of `limb` from its root on.
void read_numbered_limb(const Skeleton& skeleton, Part word, std::span<const Part> others,
                        std::span<const Part> limb, Side side, std::vector<JointName>& names) {
  std::vector<std::size_t> chain;
  for (std::size_t j = 0; j < names.size(); ++j) {
    if (names[j].side != side) continue;
    if (std::find(others.begin(), others.end(), names[j].part) != others.end()) return;
    if (names[j].part != word) continue;
    if (!chain.empty() && skeleton.parents[j] != static_cast<int>(chain.back())) return;
    chain.push_back(j);
  }
  if (chain.size() < 3) return;
  for (std::size_t i = 0; i < chain.size() && i < limb.size(); ++i) names[chain[i]].part = limb[i];
}

void read_numbered_limbs(const Skeleton& skeleton, std::vector<JointName>& names) {
  constexpr std::array kArm = {Part::upper_arm, Part::lower_arm, Part::hand};
  constexpr std::array kOtherArm = {Part::collar, Part::shoulder, Part::upper_arm, Part::lower_arm,
                                    Part::hand};
  constexpr std::array kLeg = {Part::upper_leg, Part::lower_leg, Part::foot, Part::toes};
  constexpr std::array kOtherLeg = {Part::hip, Part::upper_leg, Part::lower_leg, Part::foot};
  for (const Side side : {Side::left, Side::right}) {
    read_numbered_limb(skeleton, Part::arm, kOtherArm, kArm, side, names);
    read_numbered_limb(skeleton, Part::leg, kOtherLeg, kLeg, side, names);
  }
}

struct Spelling {
  std::string_view text, in_ascii;
};

// German letters as they are written where there are none ("Fuß" is "Fuss"), and the names of MMD's
// standard skeleton; those that others are part of come first.
constexpr std::array kSpellings = {
    Spelling{"ä", "ae"},           Spelling{"ö", "oe"},           Spelling{"ü", "ue"},
    Spelling{"ß", "ss"},           Spelling{"Ä", "Ae"},           Spelling{"Ö", "Oe"},
    Spelling{"Ü", "Ue"},           Spelling{"左", " left "},      Spelling{"右", " right "},
    Spelling{"手首", " wrist "},   Spelling{"足首", " ankle "},   Spelling{"つま先", " toe "},
    Spelling{"ひじ", " elbow "},   Spelling{"肘", " elbow "},     Spelling{"ひざ", " knee "},
    Spelling{"膝", " knee "},      Spelling{"捩", " twist "},     Spelling{"補助", " helper "},
    Spelling{"ダミー", " dummy "}, Spelling{"親指", " thumb "},   Spelling{"人指", " index "},
    Spelling{"人差指", " index "}, Spelling{"中指", " middle "},  Spelling{"薬指", " ring "},
    Spelling{"小指", " little "},  Spelling{"上半身", " spine "}, Spelling{"肩", " shoulder "},
    Spelling{"腕", " arm "},       Spelling{"手", " hand "},      Spelling{"足", " leg "},
    Spelling{"腰", " waist "},     Spelling{"首", " neck "},      Spelling{"頭", " head "},
    Spelling{"目", " eye "}};

// Letters, digits and signs as wide as a Japanese letter, U+FF01 to U+FF5E, in ASCII.
void narrow(std::string& name) {
  for (std::size_t at = name.find('\xef'); at != std::string::npos;
       at = name.find('\xef', at + 1)) {
    if (at + 2 >= name.size()) return;
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(name[at + i]); };
    const int code = (byte(1) - 0xbc) * 0x40 + byte(2) - 0x80;
    if (code >= 1 && code <= 0x5e) name.replace(at, 3, 1, static_cast<char>(code + 0x20));
  }
}

std::string in_ascii(std::string_view name) {
  std::string result(name);
  if (std::ranges::none_of(name, [](char c) { return static_cast<unsigned char>(c) >= 0x80; })) {
    return result;
  }
  narrow(result);
  for (const auto& [text, ascii] : kSpellings) {
    for (std::size_t at = result.find(text); at != std::string::npos; at = result.find(text)) {
      result.replace(at, text.size(), ascii);
    }
  }
  return result;
}

// Of names such as "Arm:Left:Upper", where what is before is no namespace.
bool is_part_of_a_limb(std::string_view name) {
  constexpr std::array<std::string_view, 8> kParts = {"Upper", "Lower", "Left", "Right",
                                                      "upper", "lower", "left", "right"};
  return std::ranges::find(kParts, name) != kParts.end();
}

}  // namespace

bool names_no_shape(std::string_view name) {
  return std::ranges::any_of(name_tokens(name), [](const std::string& token) {
    const auto is = [&](const std::string& word) {
      return std::ranges::find(kShapelessWords, word) != kShapelessWords.end();
    };
    return is(token) || is(split_side(token).second);
  });
}

std::vector<std::string> name_tokens(std::string_view full_name) {
  const std::size_t space = full_name.find_last_of(":|");
  if (space != std::string_view::npos && space + 1 < full_name.size() &&
      !is_part_of_a_limb(full_name.substr(space + 1))) {
    full_name.remove_prefix(space + 1);
  }
  const std::string name = in_ascii(full_name);
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(name[i]); };
  Tokens tokens;
  bool open = false;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const unsigned char c = at(i);
    const bool digit = std::isdigit(c) != 0;
    if (!digit && !std::isalpha(c) && c < 0x80) {
      open = false;
      continue;
    }
    bool begins = !open;
    if (open) {
      const unsigned char before = at(i - 1);
      const bool digit_before = std::isdigit(before) != 0;
      // "leftArm" splits before A; "LThigh" before T, the last of several capitals.
      const bool hump = std::isupper(c) &&
                        (!std::isupper(before) || (i + 1 < name.size() && std::islower(at(i + 1))));
      begins = digit != digit_before || hump;
    }
    if (begins) tokens.emplace_back();
    tokens.back() += static_cast<char>(c < 0x80 ? std::tolower(c) : c);
    open = true;
  }
  // OptiTrack's LUArm and LFArm: the tokens "lu", "arm" become "l", "u", "arm".
  for (std::size_t i = 0; i + 1 < tokens.size(); ++i) {
    const std::string token = tokens[i];
    if (token.size() == 2 && (token[0] == 'l' || token[0] == 'r') &&
        (token[1] == 'u' || token[1] == 'f') && tokens[i + 1] == "arm") {
      tokens[i] = token[1];
      tokens.insert(tokens.begin() + static_cast<std::ptrdiff_t>(i), std::string(1, token[0]));
      ++i;
    }
  }
  return tokens;
}

std::vector<JointName> read_joint_names(const Skeleton& skeleton) {
  std::vector<std::size_t> joints;
  std::vector<Tokens> tokens;
  for (std::size_t j = 0; j < skeleton.names.size(); ++j) {
    if (skeleton.end_sites[j] != 0) continue;
    joints.push_back(j);
    tokens.push_back(name_tokens(skeleton.names[j]));
  }
  strip_common_words(tokens, false);
  strip_common_words(tokens, true);
  strip_words_before_parts(tokens);
  std::vector<JointName> names(skeleton.names.size());
  std::vector<const Tokens*> tokens_of(skeleton.names.size(), nullptr);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    names[joints[i]] = read_name(tokens[i]);
    tokens_of[joints[i]] = &tokens[i];
  }
  // If a joint and its parent have the same name (MakeHuman's "__UpLeg_L" and "UpLeg_L"), the
  // parent is a helper between trunk and limb.
  for (const std::size_t j : joints) {
    const int above = skeleton.parents[j];
    if (above < 0 || names[j].part == Part::unknown) continue;
    const Tokens* tokens_above = tokens_of[static_cast<std::size_t>(above)];
    if (tokens_above != nullptr && *tokens_above == *tokens_of[j]) {
      names[static_cast<std::size_t>(above)].part = Part::helper;
    }
  }
  read_numbered_limbs(skeleton, names);
  return names;
}

}  // namespace krok
