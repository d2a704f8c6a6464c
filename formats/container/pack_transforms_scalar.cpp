#include "formats/container/orientation_search_internal.h"
#include "formats/container/sections.h"

namespace krok::pack_transforms_detail {

void pack_scalar(const float* positions, const float* orientations, std::size_t count,
                 std::byte* out) {
  constexpr auto kEncoding = OrientationEncoding::xyz;
  for (std::size_t i = 0; i < count; ++i) {
    const float* q = orientations + 4 * i;
    const float* p = positions + 3 * i;
    write_transform({p[0], p[1], p[2]}, Quatf(q[3], q[0], q[1], q[2]).cast<double>(), kEncoding,
                    out + i * transform_size(kEncoding));
  }
}

}  // namespace krok::pack_transforms_detail
