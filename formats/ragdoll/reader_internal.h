#pragma once

#include <string>
#include <string_view>

#include "formats/json/members.h"
#include "formats/ragdoll/values_internal.h"
#include "ragdoll/joint_rules.h"
#include "scene/skeleton.h"

namespace krok::ragdoll_file {

inline constexpr double kMaxSize = 100;  // metres

// Reads a file's bodies, then the joints between them.
class Reader {
 public:
  Reader(std::string_view text, const Skeleton* skeleton)
      : text_(text), in_(text, "ragdoll"), values_(in_), skeleton_(skeleton) {}

  Result<ragdoll::Ragdoll> read();

 private:
  using ReadEntry = Status (Reader::*)(const json::Value&);
  Status read_list(const json::Value& root, std::string_view key, std::size_t least,
                   std::size_t most, ReadEntry entry);
  Status read_body(const json::Value& item);
  Status read_shape(const json::Value& item, const std::string& what, ragdoll::Shape& shape) const;
  Status find_joint(const json::Value& item, const std::string& what, ragdoll::Body& body);
  Status read_mode(const json::Value& item, const std::string& what, ragdoll::Body& body) const;
  Status read_joint(const json::Value& item);
  Result<int> body_named(const json::Value& name) const;
  Status read_ends(const json::Value& item, ragdoll::JointRule& rule) const;
  Status check_keys(const json::Value& item, const std::string& what,
                    const ragdoll::JointRule& rule) const;
  Status check_animated(const json::Value& item, const std::string& what,
                        const ragdoll::JointRule& rule) const;
  Status read_turn(const json::Value& item, const std::string& what,
                   ragdoll::JointRule& rule) const;
  Status read_cone(const json::Value& cone, const std::string& what, ik::JointLimit& turn) const;
  Status read_slides(const json::Value& item, const std::string& what,
                     ragdoll::JointRule& rule) const;
  Status read_strength(const json::Value& item, const std::string& what,
                       ragdoll::JointRule& rule) const;
  Status check_ties(const json::Value& root) const;

  std::string_view text_;
  json::Members in_;
  Values values_;
  const Skeleton* skeleton_;
  ragdoll::Ragdoll read_;
};

}  // namespace krok::ragdoll_file
