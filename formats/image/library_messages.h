// SPDX-License-Identifier: BSD-3-Clause
// Libraries that decode print what they find wrong where the user sees it. What is wrong with a file is said by us;
// what they say is in the log with --verbose, and FFmpeg's first error as a warning.
#pragma once

#include <cstdio>
#include <sstream>
#include <streambuf>

namespace rumi {

// FFmpeg's messages from now on.
void log_what_ffmpeg_says();

// While it lives, messages of libpng (to stderr) and OpenCV (to std::cerr) are held back. Our own log goes on,
// whichever thread writes it.
class DecoderMessages {
 public:
  DecoderMessages();
  ~DecoderMessages();
  DecoderMessages(const DecoderMessages&) = delete;
  DecoderMessages& operator=(const DecoderMessages&) = delete;

 private:
  std::FILE* stderr_;
  std::ostringstream text_;
  std::streambuf* cerr_;
};

}  // namespace rumi
