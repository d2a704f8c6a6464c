#pragma once

#include <array>
#include <cstdint>

#include "core/result.h"
#include "formats/container/sections.h"
#include "scene/skeleton.h"

// The records in the sections of a .steps file; see formats/steps/SPEC.md.

namespace krok::steps::detail {

inline constexpr ContainerFormat kStepsFormat = {registry::Kind::steps, registry::kStepsMagic, 1,
                                                 kFlagFourComponents};

struct Info {
  double rate;
  std::uint32_t joints;
  std::uint32_t keytimes;
  std::uint32_t parameters;
  std::uint32_t examples;
  std::uint32_t swing;  // 0 left, 1 right
  float ground;         // metres
};
static_assert(sizeof(Info) == 32);

struct Foot {
  std::int32_t joint;
  float toe_out;  // radians
  std::array<double, 3> heel;
  std::array<double, 3> forward;
  double length;
};
static_assert(sizeof(Foot) == 64);

struct ParameterRecord {
  std::uint32_t quantity;
  std::int32_t keytime;
  std::int32_t joint;
  std::uint32_t direction;
  double tolerance;
};
static_assert(sizeof(ParameterRecord) == 24);

struct ExampleRecord {
  double rate;
  std::uint32_t frames;
  std::uint32_t contacts;
  std::uint32_t flags;
  std::uint32_t reserved;
};
static_assert(sizeof(ExampleRecord) == 24);
inline constexpr std::uint32_t kMirrored = 1;

struct ContactRecord {
  std::int32_t joint;
  std::uint32_t reserved;
  double start;
  double end;
  std::array<double, 3> place;
};
static_assert(sizeof(ContactRecord) == 48);

struct WeightsInfo {
  std::uint32_t kernel;
  std::uint32_t reserved;
  std::uint64_t centres;
};
static_assert(sizeof(WeightsInfo) == 16);

inline constexpr std::uint32_t kMaxKeytimes = 1000;
inline constexpr std::uint32_t kMaxParameters = 64;
inline constexpr std::uint32_t kMaxExamples = 65535;
inline constexpr std::size_t kMaxReport = std::size_t{16} << 20;

// Each example stores the joint names in memory; this is the limit for all together.
inline constexpr std::uint64_t kMaxNames = std::uint64_t{64} << 20;  // bytes
Status check_names(const Skeleton& skeleton, std::uint64_t examples);

}  // namespace krok::steps::detail
