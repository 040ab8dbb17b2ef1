// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/image_stream.h"

#include <string>

#include "base/text/number_text.h"
#include "bus/wire/image_codec.h"

namespace rumi {

int64_t stream_of(const image_t& image) {
  const auto stream = parse_number<int64_t>(metadata(image, kStreamKey));
  return stream && *stream > 0 ? *stream : kNoStream;
}

void set_stream(int64_t stream, image_t* image) { set_metadata(image, kStreamKey, std::to_string(stream)); }

}  // namespace rumi
