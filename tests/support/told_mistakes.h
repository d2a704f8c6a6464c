#pragma once

#include <gtest/gtest.h>

#include <random>
#include <span>
#include <string>

#include "core/result.h"

// Mistakes in hand-written text files: each must be reported with its location.

namespace krok::test {

// `text` with the first occurrence of `from` replaced.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto place = text.find(from);
  EXPECT_NE(place, std::string::npos) << from;
  return place == std::string::npos ? text : text.replace(place, from.size(), to);
}

// "json-syntax 3:7": the code, line and column.
inline std::string place_of(const Error& error) {
  return error.code + " " + std::to_string(error.where.line) + ":" +
         std::to_string(error.where.column);
}

// A text with up to three places damaged: characters are lost, or become others of JSON.
inline std::string damaged(std::string text, std::mt19937& random) {
  for (unsigned k = random() % 3 + 1; k > 0; --k) {
    const std::size_t place = random() % text.size();
    if (random() % 3 == 0) text.erase(place, random() % 4 + 1);
    if (place < text.size())
      text[place] = static_cast<char>("0123456789-.,[]{}\"e:"[random() % 20]);
  }
  return text;
}

struct Mistake {
  const char* from;  // in the valid text
  const char* to;
  const char* place;      // as from place_of()
  const char* says = "";  // in the message or the hint
};

// Makes each mistake in `good` and compares the Error of `read` with it; `file` is the file name
// expected in the Error.
template <class Read>
void expect_told(const std::string& good, std::span<const Mistake> mistakes, const Read& read,
                 const std::string& file = {}) {
  for (const Mistake& mistake : mistakes) {
    const auto result = read(replaced(good, mistake.from, mistake.to));
    ASSERT_FALSE(result.ok()) << mistake.from << " -> " << mistake.to;
    const Error& error = result.error();
    EXPECT_EQ(place_of(error), mistake.place)
        << mistake.from << " -> " << mistake.to << ": " << error.message;
    EXPECT_NE((error.message + error.hint).find(mistake.says), std::string::npos)
        << error.message << " / " << error.hint;
    EXPECT_EQ(error.where.file, file);
  }
}

}  // namespace krok::test
