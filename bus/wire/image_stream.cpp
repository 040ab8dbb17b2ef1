// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/image_stream.h"

#include <charconv>
#include <string>

#include "bus/wire/image_codec.h"

namespace rumi {

int64_t stream_of(const image_t& image) {
  const std::string text = metadata(image, kStreamKey);
  int64_t stream = kNoStream;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), stream);
  const bool is_number = error == std::errc() && end == text.data() + text.size();
  return is_number && stream > 0 ? stream : kNoStream;
}

void set_stream(int64_t stream, image_t* image) { set_metadata(image, kStreamKey, std::to_string(stream)); }

}  // namespace rumi
