#pragma once

#include <fmt/format.h>

#include <string>
#include <variant>
#include <vector>

#include "unit/assimp/binary_text.h"
#include "unit/assimp/sample_rig.h"

// An FBX of one bone that turns by Euler curves, as ASCII or binary; and those curves, evaluated by
// halving their polygons.

namespace krok::test {

// A node of the file. Names of objects are "Class::name", which binary files have the other way.
struct FbxTree {
  using Value = std::variant<std::int64_t, int, double, std::string, std::vector<std::int64_t>,
                             std::vector<int>, std::vector<float>>;
  std::string name;
  std::vector<Value> values;
  std::vector<FbxTree> children;

  std::string ascii() const {
    std::string out = name + ":";
    for (std::size_t v = 0; v < values.size(); ++v) {
      out += v == 0 ? " " : ", ";
      const auto put = [&](const auto& value) {
        using T = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<T, std::string>) {
          out += '"' + value + '"';
        } else if constexpr (std::is_arithmetic_v<T>) {
          out += fmt::format("{}", value);
        } else {
          out += fmt::format("*{} {{\n\ta: {}\n}}", value.size(), fmt::join(value, ","));
        }
      };
      std::visit(put, values[v]);
    }
    if (!children.empty()) {
      out += " {\n";
      for (const FbxTree& child : children) out += child.ascii();
      out += "}";
    }
    return out + "\n";
  }

  // `word`: 4 bytes up to version 7400, 8 from 7500 on. Arrays are in a Deflate block that stores.
  std::string binary(std::size_t word, std::size_t place) const {
    std::string content;
    const auto put = [&](const auto& value) {
      using T = std::decay_t<decltype(value)>;
      BinaryText out;
      if constexpr (std::is_same_v<T, std::string>) {
        const std::size_t colons = value.find("::");
        const std::string text =
            colons == std::string::npos
                ? value
                : value.substr(colons + 2) + std::string("\0\1", 2) + value.substr(0, colons);
        out.put('S').put(static_cast<std::uint32_t>(text.size())).append(text);
      } else if constexpr (std::is_arithmetic_v<T>) {
        out.put(std::is_same_v<T, int> ? 'I' : std::is_same_v<T, double> ? 'D' : 'L').put(value);
      } else {
        using Number = typename T::value_type;
        const std::string bytes(reinterpret_cast<const char*>(value.data()),
                                value.size() * sizeof(Number));
        std::uint32_t a = 1, b = 0;  // Adler-32
        for (const char c : bytes) {
          a = (a + static_cast<unsigned char>(c)) % 65521;
          b = (b + a) % 65521;
        }
        const std::uint32_t sum = b << 16 | a;
        const auto size = static_cast<std::uint16_t>(bytes.size());
        out.put(std::is_same_v<Number, int> ? 'i' : std::is_same_v<Number, float> ? 'f' : 'l');
        out.put(static_cast<std::uint32_t>(value.size())).put(std::uint32_t{1});
        out.put(static_cast<std::uint32_t>(bytes.size() + 11)).append("\x78\x01\x01").put(size);
        out.put(static_cast<std::uint16_t>(~size)).append(bytes);
        for (int shift = 24; shift >= 0; shift -= 8) out.put(static_cast<char>(sum >> shift));
      }
      content += out.take();
    };
    for (const Value& value : values) std::visit(put, value);
    const std::size_t header = 3 * word + 1 + name.size(), size = content.size();
    for (const FbxTree& child : children) {
      content += child.binary(word, place + header + content.size());
    }
    if (!children.empty()) content.append(3 * word + 1, '\0');
    BinaryText out;
    for (const std::size_t number : {place + header + content.size(), values.size(), size}) {
      out.append(std::string(reinterpret_cast<const char*>(&number), word));
    }
    return out.put(static_cast<char>(name.size())).append(name + content).take();
  }
};

// A curve of the bone's rotation, degrees: its keys, and for each gap 'l'inear, 's'tep, 'b'ezier
// with slopes per second at its ends and the parts of the gap that the tangents take.
struct TurnCurve {
  struct Gap {
    char kind = 'l';
    double out = 0, in = 0, part_out = 1 / 3.0, part_in = 1 / 3.0;
  };
  std::vector<double> times, values;
  std::vector<Gap> gaps;

  std::array<Vec2, 4> polygon(std::size_t k) const {
    const Vec2 a(times[k], values[k]), b(times[k + 1], values[k + 1]);
    const double length = b[0] - a[0];
    const Gap& gap = gaps[k];
    return {a, a + gap.part_out * length * Vec2(1, gap.out),
            b - gap.part_in * length * Vec2(1, gap.in), b};
  }

  double at(double time) const {
    std::size_t k = 0;
    while (k + 2 < times.size() && time >= times[k + 1]) ++k;
    if (time >= times.back()) return values.back();
    const double part = (time - times[k]) / (times[k + 1] - times[k]);
    if (gaps[k].kind == 's') return values[k];
    if (gaps[k].kind == 'l') return values[k] + part * (values[k + 1] - values[k]);
    auto p = polygon(k);
    for (int i = 0; i < 50; ++i) {
      const Vec2 ab = (p[0] + p[1]) / 2, bc = (p[1] + p[2]) / 2, cd = (p[2] + p[3]) / 2;
      const Vec2 abc = (ab + bc) / 2, bcd = (bc + cd) / 2, middle = (abc + bcd) / 2;
      p = time < middle[0] ? std::array{p[0], ab, abc, middle} : std::array{middle, bcd, cd, p[3]};
    }
    return p[0][1];
  }
};

// "Hips", turned about x, then y, then z by the curves, and "Tip", 100 above it.
inline FbxTree turning_bone(const std::vector<TurnCurve>& curves) {
  using S = std::string;
  const auto id = [](int number) { return std::int64_t{number}; };
  const auto property = [](const char* name, auto value) {
    const bool whole = std::is_same_v<decltype(value), int>;
    return FbxTree{"P", {S(name), S(whole ? "int" : "double"), S("Number"), S(), value}, {}};
  };
  const auto model = [&](int number, const char* name, double height) {
    const FbxTree place = {
        "P", {S("Lcl Translation"), S("Lcl Translation"), S(), S("A"), 0.0, height, 0.0}, {}};
    return FbxTree{"Model",
                   {id(number), S("Model::") + name, S("LimbNode")},
                   {{"Version", {232}, {}}, {"Properties70", {}, {place}}}};
  };
  FbxTree objects = {"Objects", {}, {model(10, "Hips", 0), model(11, "Tip", 100)}};
  FbxTree links = {"Connections", {}, {}};
  const auto link = [&](int from, int to, const S& what = {}) {
    links.children.push_back({"C", {S(what.empty() ? "OO" : "OP"), id(from), id(to)}, {}});
    if (!what.empty()) links.children.back().values.emplace_back(what);
  };
  for (const auto& [name, number, title] :
       {std::tuple("AnimationStack", 20, "AnimStack::Take"),
        std::tuple("AnimationLayer", 21, "AnimLayer::Base"),
        std::tuple("AnimationCurveNode", 22, "AnimCurveNode::R")}) {
    objects.children.push_back({name, {id(number), S(title), S()}, {{"Version", {100}, {}}}});
  }
  link(10, 0);
  link(11, 10);
  link(21, 20);
  link(22, 21);
  link(22, 10, "Lcl Rotation");
  for (std::size_t axis = 0; axis < curves.size(); ++axis) {
    const TurnCurve& curve = curves[axis];
    std::vector<std::int64_t> times;
    std::vector<float> values(curve.values.begin(), curve.values.end()), data;
    std::vector<int> flags, uses(curve.times.size(), 1);
    for (const double time : curve.times) times.push_back(std::llround(time * 46186158000.0));
    for (std::size_t k = 0; k < times.size(); ++k) {
      const TurnCurve::Gap gap = k < curve.gaps.size() ? curve.gaps[k] : TurnCurve::Gap();
      flags.push_back(gap.kind == 's' ? 0x2 : gap.kind == 'l' ? 0x4 : 0x3000c08);
      const auto parts = static_cast<std::uint32_t>(std::lround(gap.part_out * 1e4)) |
                         static_cast<std::uint32_t>(std::lround(gap.part_in * 1e4)) << 16;
      data.insert(data.end(), {static_cast<float>(gap.out), static_cast<float>(gap.in),
                               std::bit_cast<float>(parts), 0.0f});
    }
    const int number = 30 + static_cast<int>(axis);
    objects.children.push_back({"AnimationCurve",
                                {id(number), S("AnimCurve::"), S()},
                                {{"KeyVer", {4008}, {}},
                                 {"KeyTime", {times}, {}},
                                 {"KeyValueFloat", {values}, {}},
                                 {"KeyAttrFlags", {flags}, {}},
                                 {"KeyAttrDataFloat", {data}, {}},
                                 {"KeyAttrRefCount", {uses}, {}}}});
    link(number, 22, fmt::format("d|{}", "XYZ"[axis]));
  }
  const FbxTree axes = {"Properties70",
                        {},
                        {property("UpAxis", 1), property("UpAxisSign", 1), property("FrontAxis", 2),
                         property("FrontAxisSign", 1), property("CoordAxis", 0),
                         property("CoordAxisSign", 1), property("UnitScaleFactor", 1.0)}};
  return {"",
          {},
          {{"FBXHeaderExtension", {}, {{"FBXVersion", {7400}, {}}}},
           {"GlobalSettings", {}, {axes}},
           objects,
           links}};
}

// `version`: 0 for ASCII, 7400 or 7500.
inline std::string fbx_file(const FbxTree& root, std::uint32_t version) {
  std::string out = "; FBX 7.4.0 project file\n";
  const std::size_t word = version < 7500 ? 4 : 8;
  if (version != 0) {
    out =
        BinaryText().text("Kaydara FBX Binary  ", 21).append("\x1a").put('\0').put(version).take();
  }
  for (const FbxTree& child : root.children) {
    out += version == 0 ? child.ascii() : child.binary(word, out.size());
  }
  if (version != 0) out.append(3 * word + 1, '\0');
  return out;
}

}  // namespace krok::test
