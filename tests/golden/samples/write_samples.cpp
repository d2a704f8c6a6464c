// Writes the sample files of the formats into a folder: write_samples FOLDER.

#include <cstdio>
#include <string>

#include "golden/samples/samples.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: write_samples FOLDER\n", stderr);
    return 2;
  }
  auto samples = krok::samples::all();
  for (auto& text : krok::samples::texts()) samples.push_back(std::move(text));
  for (const auto& sample : samples) {
    const std::string path = std::string(argv[1]) + "/" + sample.file_name;
    auto file = krok::OutputFile::create(path);
    krok::Status status = file ? sample.write(*file) : krok::Status(file.error());
    if (status) status = file->commit();
    if (!status) {
      std::fprintf(stderr, "%s: %s\n", path.c_str(), status.error().message.c_str());
      return 2;
    }
    std::printf("%s\n", path.c_str());
  }
  return 0;
}
