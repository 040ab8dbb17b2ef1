// SPDX-License-Identifier: BSD-3-Clause
#include "formats/recording/file_kind.h"

#include <algorithm>
#include <cctype>
#include <fstream>

namespace rumi {

std::string beginning_of(const std::filesystem::path& file, size_t bytes) {
  std::string text(bytes, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(text.data(), static_cast<std::streamsize>(bytes));
  text.resize(static_cast<size_t>(std::max<std::streamsize>(0, in.gcount())));
  return text;
}

std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace rumi
