#pragma once

#include <string>
#include <string_view>

#include "formats/json/members.h"
#include "math/types.h"
#include "ragdoll/joint.h"

namespace krok::ragdoll_file {

// Lists of numbers that stand for something.
class Values {
 public:
  explicit Values(const json::Members& in) : in_(in) {}

  // Optional members stay what they are.
  Status vector(const json::Value& object, const std::string& what, std::string_view key,
                bool needed, Vec3& vector) const;
  Status rotation(const json::Value& object, const std::string& what, std::string_view key,
                  Quat& rotation) const;
  // Required, of length 1.
  Status direction(const json::Value& object, const std::string& what, std::string_view key,
                   Vec3& direction) const;
  // [min, max] in `unit`, both within lowest and highest; null does not limit.
  Result<ragdoll::Range> range(const json::Value& list, const std::string& what,
                               std::string_view key, double unit, double lowest,
                               double highest) const;

 private:
  const json::Members& in_;
};

}  // namespace krok::ragdoll_file
