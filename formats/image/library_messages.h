// SPDX-License-Identifier: BSD-3-Clause
// Keeps messages of decoding libraries from the user's terminal: Rumi itself reports what is wrong with a file. The
// messages go to the log with --verbose, and FFmpeg's first error as a warning.
#pragma once

#include <cstdio>
#include <sstream>
#include <streambuf>

namespace rumi {

// From now on, sends FFmpeg's messages to our log.
void log_what_ffmpeg_says();

// While an object lives, messages of libpng (to stderr) and OpenCV (to std::cerr) are held back. Our own log goes on,
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
