// The yardstick of the benchmarks of reading: maps a BVH file and parses the numbers of its motion
// one after the other with fast_float, on one thread, and does nothing with them but add them up.
// A floor for a simple reader, not a reader.
//
//   number_loop FILE.bvh

#include <fast_float/fast_float.h>

#include <cstdio>

#include "core/file.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const auto file = krok::InputFile::open(argv[1]);
  if (!file) return 2;
  const std::string_view text = file->text();
  const std::string_view before = "Frame Time:";
  const std::size_t found = text.find(before);
  if (found == std::string_view::npos) return 2;
  const char* at = text.data() + found + before.size();
  const char* const end = text.data() + text.size();
  double sum = 0;
  long count = 0;
  for (;;) {
    while (at != end && (*at == ' ' || *at == '\t' || *at == '\n' || *at == '\r')) ++at;
    if (at == end) break;
    double value = 0;
    const auto parsed = fast_float::from_chars(at, end, value);
    if (parsed.ec != std::errc()) return 1;
    at = parsed.ptr;
    sum += value;
    ++count;
  }
  std::printf("%ld numbers, sum %.17g\n", count, sum);
  return 0;
}
