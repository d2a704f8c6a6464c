#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "formats/zip/zip_archive.h"

// Reads and writes the array files of numpy: .npy, versions 1 to 3, and .npz, a ZIP archive of
// them. Format: numpy.lib.format, "NEP 1: A simple file format for NumPy arrays". Nothing in a file
// is ever executed: arrays of Python objects, which are pickles, are refused.

namespace krok::npy {

enum class Element : unsigned char { boolean, integer, natural, real, text, bytes };

// An array as it stands in a file.
struct Array {
  Element element = Element::real;
  std::size_t item_size = 8;  // bytes; for text and bytes of all characters
  bool big_endian = false;
  bool column_major = false;       // "fortran_order"
  std::vector<std::size_t> shape;  // empty for a single value
  std::vector<std::byte> data;     // item_size * count() bytes
  // Of an array that is packed or unpacked in parts, in place of `data`: gives the next bytes, as
  // many as are asked for.
  std::function<Status(std::span<std::byte> bytes)> read;

  std::size_t count() const;
  bool is_number() const { return element != Element::text && element != Element::bytes; }
  // Values row by row (the last index changes first), at most so many from `first` on, which is at
  // most count(); text has none.
  std::vector<double> numbers(std::size_t first = 0,
                              std::size_t most = std::numeric_limits<std::size_t>::max()) const;
  // All texts as UTF-8; empty for numbers.
  std::vector<std::string> texts() const;
};

// "(170, 22, 3)".
std::string shape_text(std::span<const std::size_t> shape);

// `file`: the content of a .npy file. Codes: npy-damaged (no array, a shape that is not that of the
// bytes), npy-objects (Python objects), npy-type (other elements that are not read).
Result<Array> parse(std::vector<std::byte> file);

// The arrays of a .npy or .npz file. An array is unpacked when it is asked for.
class Arrays {
 public:
  // `file` must outlive the value. Codes: npy-damaged, zip-damaged.
  static Result<Arrays> open(std::span<const std::byte> file);

  // Without ".npy"; the one array of a .npy file has an empty name.
  const std::vector<std::string>& names() const { return names_; }
  bool has(const std::string& name) const;

  // Codes: those of parse(), zip-damaged, file-too-large: a compressed array may be a thousand
  // times the file, as one of zeros is, if it has less than 32 MB, 100 times otherwise.
  Result<Array> read(const std::string& name) const;
  // An array of an archive to be unpacked in parts, with Array::read in place of the data; valid as
  // long as the value is, and used as zip::Archive::stream(). Codes: those of parse() for the
  // header, file-missing, file-too-large, zip-damaged.
  Result<Array> open_array(const std::string& name) const;

 private:
  std::span<const std::byte> file_;
  std::optional<zip::Archive> archive_;
  std::vector<std::string> names_;
};

// Arrays of a file to be written, little-endian and row by row.
Array array_of(std::span<const float> values, std::vector<std::size_t> shape);
Array array_of(std::span<const double> values, std::vector<std::size_t> shape);
Array array_of(std::span<const std::int32_t> values, std::vector<std::size_t> shape);
Array array_of_flags(std::span<const std::uint8_t> values, std::vector<std::size_t> shape);
Array array_of_texts(std::span<const std::string> texts);

// The bytes of a .npy file, version 1.
std::vector<std::byte> write(const Array& array);

// The bytes of a .npz file, compressed: the same for the same arrays.
Result<std::vector<std::byte>> write(
    std::span<const std::pair<std::string, Array>> names_and_arrays);
Status write(std::span<const std::pair<std::string, Array>> names_and_arrays, OutputFile& file);

}  // namespace krok::npy
