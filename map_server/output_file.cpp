// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/output_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace rumi {

OutputFile::OutputFile(const std::string& file) : file_(file), temporary_(file + ".tmp") {
  stream_ = std::fopen(temporary_.c_str(), "wb");
  if (!stream_) note_error();
}

OutputFile::~OutputFile() {
  if (!stream_) return;
  std::fclose(stream_);
  std::remove(temporary_.c_str());
}

void OutputFile::note_error() {
  if (problem_.empty()) problem_ = fmt::format("cannot write {}: {}", file_, std::strerror(errno));
}

void OutputFile::write(std::string_view bytes) {
  if (stream_ && std::fwrite(bytes.data(), 1, bytes.size(), stream_) != bytes.size()) note_error();
}

std::string OutputFile::commit() {
  if (!stream_) return problem_;
  if (std::fflush(stream_) != 0 || fsync(fileno(stream_)) != 0) note_error();
  if (std::fclose(stream_) != 0) note_error();
  stream_ = nullptr;
  if (problem_.empty() && std::rename(temporary_.c_str(), file_.c_str()) != 0) note_error();
  if (!problem_.empty()) std::remove(temporary_.c_str());
  return problem_;
}

}  // namespace rumi
