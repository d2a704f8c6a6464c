// Writes a file of a given size by an OutputFile, as the tools do, from a buffer that does not
// change: what writing alone costs.
//
//   plain_write BYTES FILE

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "core/file.h"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  auto left = static_cast<std::size_t>(std::strtoull(argv[1], nullptr, 10));
  auto file = krok::OutputFile::create(argv[2]);
  if (!file) return 2;
  const std::vector<std::byte> block(std::size_t{1} << 18, std::byte{1});
  while (left > 0) {
    const std::size_t count = std::min(left, block.size());
    if (const krok::Status status = file->write(std::span(block).first(count)); !status) return 1;
    left -= count;
  }
  const krok::Status status = file->commit();
  return status ? 0 : 1;
}
