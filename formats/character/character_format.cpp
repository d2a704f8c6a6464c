#include "formats/character/character_format.h"

#include <fmt/format.h>

#include <set>

#include "core/numbers.h"
#include "core/path_inside.h"
#include "core/text.h"
#include "formats/json/fields.h"

namespace krok::character_file {

namespace {

using json::Given;
using Eye = Character::Eye;
using Expression = Character::Expression;
using Part = Character::Part;
using Range = Character::EyeRange;
using Socket = Character::Socket;

json::Kind<Vec3f> position() {
  return json::kind<Vec3f>(json::schema_of_numbers(3),
                           [](const Given& given, Vec3f& to) -> Status {
                             Vec3 place;
                             if (Status status = given.is(json::Value::Kind::array); !status)
                               return status;
                             if (json::vector(Character::kFurthest).read(given, &place)) {
                               to = place.cast<float>();
                               return {};
                             }
                             return given.wrong(
                                 fmt::format("the position of {} is not three numbers within {} m",
                                             given.what, readable(Character::kFurthest)),
                                 "write [x, y, z] in metres, in the model's reference pose");
                           })
      .written([](const Vec3f& from) {
        return fmt::format("[{}, {}, {}]", shortest(from.x()), shortest(from.y()),
                           shortest(from.z()));
      });
}

json::Kind<float> weight() {
  json::Kind<float> made = json::single(-Character::kMaxWeight, Character::kMaxWeight);
  made.read = [read = made.read](const Given& given, void* to) -> Status {
    if (Status status = given.is(json::Value::Kind::number); !status) return status;
    return read(given.as("the weight of " + std::string(given.what)), to);
  };
  return made;
}

json::Kind<std::string> joint() {
  json::Kind<std::string> made = json::text();
  made.read = [read = made.read](const Given& given, void* to) -> Status {
    Status status = read(given, to);
    if (!status || is_name(given.value.text)) return status;
    return given.wrong(fmt::format("the joint of {} is not a name", given.what));
  };
  return made;
}

// A list of items with unique names.
template <typename T>
json::Kind<std::vector<T>> named_list(json::Object<T> item, const std::string& each) {
  const auto added = [names = std::set<std::string>()](
                         const Given& given, const std::vector<T>& items) mutable -> Status {
    if (names.insert(items.back().name).second) return {};
    return given.member("name").wrong(fmt::format("{} has the name '{}', which is already used",
                                                  given.what, shown(items.back().name)));
  };
  return json::list<T>(json::object(std::move(item)),
                       {each, 0, 100'000, "\"{1}\" has {0} items, expected at most {3}", true},
                       added);
}

json::Object<Character> table() {
  json::Object<Part> part;
  part.field("name", &Part::name, json::name()).required();
  part.field("material", &Part::material, json::text()).required().comment();
  json::Object<Eye> eye;
  eye.field("name", &Eye::name, json::name()).required();
  eye.field("joint", &Eye::joint, joint()).required();
  eye.field("position", &Eye::position, position(), "metres").required();
  json::Object<Range> range("\"range\"");
  for (const auto& [key, angle] : {std::pair{"in", &Range::in},
                                   {"out", &Range::out},
                                   {"up", &Range::up},
                                   {"down", &Range::down}}) {
    range.field(key, angle, json::single(0, 90), "degrees");
  }
  eye.field("range", &Eye::range, json::object(std::move(range)))
      .written_if([](const Eye& of) { return of.range != Range(); })
      .comment();
  json::Object<Socket> socket;
  socket.field("name", &Socket::name, json::name()).required();
  socket.field("joint", &Socket::joint, joint()).required();
  socket.field("offset", &Socket::offset, position(), "metres, in the joint's frame");
  socket
      .field("orientation", &Socket::orientation,
             json::rotation().written([](const Quat& of) { return json::list_text(of); }),
             "x, y, z, w in the joint's frame")
      .comment();
  json::Object<Expression> expression;
  expression.field("name", &Expression::name, json::name()).required();
  expression.field("target", &Expression::target, json::text())
      .written_if([](const Expression& of) { return !of.target.empty(); });
  expression.field("weight", &Expression::weight, weight())
      .written_if([](const Expression& of) { return of.weight != 0; })
      .comment();

  const auto given = [](auto member) {
    return [member](const Character& of) { return !(of.*member).empty(); };
  };
  json::Object<Character> file;
  file.lines(2).file("krok.character/1", "A character (krok.character/1)").comment();
  file.field("name", &Character::name, json::text()).written_if(given(&Character::name));
  file.field("model", &Character::model, json::path(), "path relative to this file").required();
  file.field("materials", &Character::materials,
             json::list<std::string>(
                 json::path("a file path"),
                 {"material file {0}", 0, 100'000, "\"{1}\" has {0} items, expected at most {3}"}))
      .written_if(given(&Character::materials));
  file.field("parts", &Character::parts, named_list(std::move(part), "part {0}"))
      .written_if(given(&Character::parts));
  file.field("eyes", &Character::eyes, named_list(std::move(eye), "eye {0}"))
      .written_if(given(&Character::eyes));
  file.field("sockets", &Character::sockets, named_list(std::move(socket), "socket {0}"))
      .written_if(given(&Character::sockets));
  file.field("morphs", &Character::morphs, json::path("a file path"))
      .written_if(given(&Character::morphs));
  file.field("expressions", &Character::expressions,
             named_list(std::move(expression), "expression {0}"))
      .written_if(given(&Character::expressions));
  file.check([](const Given& root, const Character& of) -> Status {
    if (of.expressions.empty() || !of.morphs.empty()) return {};
    return root.member("expressions")
        .wrong("the file has \"expressions\" but no \"morphs\"",
               "name the file with the morph targets, such as \"morphs\": \"hero.exr\"");
  });
  file.field("role_map", &Character::role_map, json::path("a file path"))
      .written_if(given(&Character::role_map));
  return file;
}

Status check_paths(const Character& character) {
  std::vector<std::string> paths = character.materials;
  paths.push_back(character.model);
  if (!character.morphs.empty()) paths.push_back(character.morphs);
  if (!character.role_map.empty()) paths.push_back(character.role_map);
  for (const std::string& path : paths) {
    const std::string fault = path_fault(path);
    if (fault.empty()) continue;
    return Error("character-path", fmt::format("the path '{}' {}", shown(path), fault));
  }
  return {};
}

}  // namespace

Result<Character> read(std::string_view text) {
  return table().read_text(text, "character");
}

Result<std::string> write(const Character& character) {
  if (Status status = check(character); !status) return status.error();
  if (Status status = check_paths(character); !status) return status.error();
  return table().write(&character) + '\n';
}

std::string schema() {
  return table().schema();
}

}  // namespace krok::character_file
