#include <fmt/format.h>

#include <cmath>
#include <set>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/character/character_format.h"
#include "formats/character/schema_internal.h"
#include "formats/json/members.h"

namespace krok::character_file {

namespace {

using json::Value;
using Kind = Value::Kind;

constexpr std::size_t kMaxItems = 100'000;  // per list

class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text), in_(text, "character") {}

  Result<Character> read() {
    const auto root = json::parse(text_);
    if (!root) return root.error();
    if (Status status = in_.only(*root, kWhole,
                                 {"schema", "comment", "name", "model", "materials", "parts",
                                  "eyes", "morphs", "expressions", "role_map"});
        !status) {
      return status.error();
    }
    if (Status status = in_.has_schema(*root, kWhole, kSchema); !status) return status.error();
    for (const auto part : {&Reader::read_files, &Reader::read_materials, &Reader::read_parts,
                            &Reader::read_eyes, &Reader::read_expressions}) {
      if (Status status = (this->*part)(*root); !status) return status.error();
    }
    return std::move(character_);
  }

 private:
  static constexpr std::string_view kWhole = "the file";

  Status read_files(const Value& root) {
    const auto name = in_.find(root, kWhole, "name", Kind::string);
    if (!name) return name.error();
    if (*name != nullptr) character_.name = (*name)->text;
    if (const auto model = in_.get(root, kWhole, "model", Kind::string); !model) {
      return model.error();
    }
    for (const auto& [key, path] : {std::pair{"model", &character_.model},
                                    {"morphs", &character_.morphs},
                                    {"role_map", &character_.role_map}}) {
      const Value* value = root.find(key);
      if (value == nullptr) continue;
      auto found = in_.path(*value, fmt::format("\"{}\" of the file", key));
      if (!found) return found.error();
      *path = *std::move(found);
    }
    return {};
  }

  Status read_materials(const Value& root) {
    const auto list = items_of(root, "materials");
    if (!list) return list.error();
    for (const Value& item : *list) {
      auto path = in_.path(item, fmt::format("material file {}", character_.materials.size()));
      if (!path) return path.error();
      character_.materials.push_back(*std::move(path));
    }
    return {};
  }

  Status read_parts(const Value& root) {
    const auto list = items_of(root, "parts");
    if (!list) return list.error();
    std::set<std::string> names;
    for (const Value& item : *list) {
      Character::Part& part = character_.parts.emplace_back();
      const std::string what = fmt::format("part {}", character_.parts.size() - 1);
      if (Status status = in_.only(item, what, {"name", "material", "comment"}); !status)
        return status;
      if (Status status = read_name(item, what, names, part.name); !status) return status;
      const auto material = in_.get(item, what, "material", Kind::string);
      if (!material) return material.error();
      part.material = (*material)->text;
    }
    return {};
  }

  Status read_eyes(const Value& root) {
    const auto list = items_of(root, "eyes");
    if (!list) return list.error();
    std::set<std::string> names;
    for (const Value& item : *list) {
      Character::Eye& eye = character_.eyes.emplace_back();
      const std::string what = fmt::format("eye {}", character_.eyes.size() - 1);
      if (Status status = in_.only(item, what, {"name", "joint", "position", "comment"}); !status) {
        return status;
      }
      if (Status status = read_name(item, what, names, eye.name); !status) return status;
      const auto joint = in_.get(item, what, "joint", Kind::string);
      if (!joint) return joint.error();
      if (!is_name((*joint)->text)) {
        return in_.wrong(**joint, fmt::format("the joint of {} is not a name", what));
      }
      eye.joint = (*joint)->text;
      const auto position = in_.get(item, what, "position", Kind::array);
      if (!position) return position.error();
      if (Status status = read_place(**position, what, eye.position); !status) return status;
    }
    return {};
  }

  Status read_place(const Value& list, const std::string& what, Vec3f& place) {
    bool good = list.items.size() == 3;
    for (std::size_t i = 0; good && i < 3; ++i) {
      const Value& item = list.items[i];
      good = item.kind == Kind::number && std::abs(item.number) <= Character::kFurthest;
      place[static_cast<int>(i)] = static_cast<float>(item.number);
    }
    if (good) return {};
    return in_.wrong(list,
                     fmt::format("the position of {} is not three numbers within {} m", what,
                                 readable(Character::kFurthest)),
                     "write [x, y, z] in metres, in the model's reference pose");
  }

  Status read_expressions(const Value& root) {
    const auto list = items_of(root, "expressions");
    if (!list) return list.error();
    const Value* value = root.find("expressions");
    if (!list->empty() && character_.morphs.empty()) {
      return in_.wrong(*value, "the file has \"expressions\" but no \"morphs\"",
                       "name the file with the morph targets, such as \"morphs\": \"hero.exr\"");
    }
    std::set<std::string> names;
    for (const Value& item : *list) {
      Character::Expression& expression = character_.expressions.emplace_back();
      const std::string what = fmt::format("expression {}", character_.expressions.size() - 1);
      if (Status status = in_.only(item, what, {"name", "target", "weight", "comment"}); !status) {
        return status;
      }
      if (Status status = read_name(item, what, names, expression.name); !status) return status;
      const auto target = in_.find(item, what, "target", Kind::string);
      if (!target) return target.error();
      if (*target != nullptr) expression.target = (*target)->text;
      const auto weight = in_.find(item, what, "weight", Kind::number);
      if (!weight) return weight.error();
      if (*weight == nullptr) continue;
      const double found = (*weight)->number;
      if (!(std::abs(found) <= Character::kMaxWeight)) {
        return in_.wrong(
            **weight, fmt::format("the weight of {} is {}, expected {} to {}", what,
                                  readable(found), -Character::kMaxWeight, Character::kMaxWeight));
      }
      expression.weight = static_cast<float>(found);
    }
    return {};
  }

  // An optional list.
  Result<std::vector<Value>> items_of(const Value& root, std::string_view key) {
    const auto list = in_.find(root, kWhole, key, Kind::array);
    if (!list) return list.error();
    if (*list == nullptr) return std::vector<Value>();
    if ((*list)->items.size() <= kMaxItems) return (*list)->items;
    return in_.wrong(**list, fmt::format("\"{}\" has {} items, expected at most {}", key,
                                         (*list)->items.size(), kMaxItems));
  }

  // The member "name", which must be unique in the list.
  Status read_name(const Value& item, std::string_view what, std::set<std::string>& names,
                   std::string& name) {
    const auto value = in_.get(item, what, "name", Kind::string);
    if (!value) return value.error();
    name = (*value)->text;
    if (!is_name(name)) {
      return in_.wrong(**value, fmt::format("the name of {} is empty, longer than {} bytes or has "
                                            "a zero byte",
                                            what, kLongestName));
    }
    if (names.insert(name).second) return {};
    return in_.wrong(**value,
                     fmt::format("{} has the name '{}', which is already used", what, shown(name)));
  }

  std::string_view text_;
  json::Members in_;
  Character character_;
};

}  // namespace

Result<Character> read(std::string_view text) {
  return Reader(text).read();
}

}  // namespace krok::character_file
