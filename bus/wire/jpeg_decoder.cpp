// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/jpeg_decoder.h"

#include <csetjmp>
#include <cstdio>

// jpeglib.h needs <cstdio> and does not include it.
#include <jpeglib.h>
// jerror.h needs jpeglib.h.
#include <jerror.h>

#include "slam/geometry/max_side.h"

namespace rumi {
namespace {

// Webcams are known to leave a few stray bytes before a marker; more of them is damage.
constexpr int kTolerableStrayBytes = 16;

struct ErrorManager {
  jpeg_error_mgr base;  // first: libjpeg hands back a pointer to it
  jmp_buf escape;
  char message[JMSG_LENGTH_MAX];
};

ErrorManager* manager_of(j_common_ptr info) { return reinterpret_cast<ErrorManager*>(info->err); }

void fail(j_common_ptr info) {
  info->err->format_message(info, manager_of(info)->message);
  longjmp(manager_of(info)->escape, 1);
}

void on_message(j_common_ptr info, int level) {
  const bool warning = level < 0;
  const bool stray = info->err->msg_code == JWRN_EXTRANEOUS_DATA && info->err->msg_parm.i[0] <= kTolerableStrayBytes;
  if (warning && !stray) fail(info);
}

// Returns false if the JPEG is damaged; errors.message then says how. Local variables must be trivial: an error leaves
// by longjmp, which runs no destructors. `out` belongs to the caller.
bool decode_into(std::span<const uint8_t> data, bool grey, int reduction, cv::Mat& out, ErrorManager& errors) {
  jpeg_decompress_struct jpeg;
  jpeg.err = jpeg_std_error(&errors.base);
  errors.base.error_exit = fail;
  errors.base.emit_message = on_message;
  if (setjmp(errors.escape)) {
    jpeg_destroy_decompress(&jpeg);
    return false;
  }
  jpeg_create_decompress(&jpeg);
  jpeg_mem_src(&jpeg, data.data(), data.size());
  jpeg_read_header(&jpeg, TRUE);
  jpeg.out_color_space = grey ? JCS_GRAYSCALE : JCS_EXT_BGR;
  jpeg.scale_num = 1;
  jpeg.scale_denom = static_cast<unsigned>(reduction);
  jpeg_start_decompress(&jpeg);
  while (jpeg.output_scanline < jpeg.output_height) {
    JSAMPROW row = out.ptr(static_cast<int>(jpeg.output_scanline));
    jpeg_read_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_decompress(&jpeg);
  jpeg_destroy_decompress(&jpeg);
  return true;
}

Error corrupt(const char* why) { return {std::string("corrupt JPEG (") + why + ")"}; }

// Returns the position behind the last end marker after `begin`, or 0 if there is none. Some cameras leave bytes behind
// it.
size_t end_of_jpeg(std::span<const uint8_t> data, size_t begin) {
  for (size_t end = data.size(); end >= begin + 2; --end)
    if (data[end - 2] == 0xFF && data[end - 1] == 0xD9) return end;
  return 0;
}

}  // namespace

Result<JpegSize> inspect_jpeg(std::span<const uint8_t> data) {
  JpegSize size;
  if (data.size() < 4 || data[0] != 0xFF || data[1] != 0xD8) return corrupt("no start marker");
  for (size_t at = 2; at + 9 < data.size();) {
    if (data[at] != 0xFF) return corrupt("a marker was expected");
    const uint8_t marker = data[at + 1];
    if (marker == 0xFF) {  // fill byte
      ++at;
      continue;
    }
    const bool is_frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (is_frame) {
      size.height = data[at + 5] << 8 | data[at + 6];
      size.width = data[at + 7] << 8 | data[at + 8];
      if (size.width == 0 || size.height == 0) return corrupt("its size is 0");
    }
    if (marker == 0xDA) {
      if (size.width == 0) break;  // pixels before a frame header
      size.bytes = end_of_jpeg(data, at);
      if (size.bytes == 0) return corrupt("truncated: no end marker");
      return size;
    }
    at += 2 + static_cast<size_t>(data[at + 2] << 8 | data[at + 3]);
  }
  return corrupt(size.width > 0 ? "truncated: no pixels" : "no frame header");
}

Result<cv::Mat> decode_jpeg(std::span<const uint8_t> data, bool grey, int reduction) {
  CV_Assert(reduction == 1 || reduction == 2 || reduction == 4 || reduction == 8);
  const Result<JpegSize> size = inspect_jpeg(data);
  if (!size) return size.error();
  if (size->width > kMaxSide || size->height > kMaxSide) return corrupt("more than 16384 pixels wide or high");
  const auto reduced = [reduction](int side) { return (side + reduction - 1) / reduction; };
  cv::Mat out(reduced(size->height), reduced(size->width), grey ? CV_8UC1 : CV_8UC3);
  ErrorManager errors{};
  if (decode_into(data, grey, reduction, out, errors)) return out;
  return corrupt(errors.message);
}

}  // namespace rumi
