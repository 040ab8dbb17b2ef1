// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/jpeg_image.h"

#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <vector>

// jpeglib.h needs <cstdio> and does not include it.
#include <jpeglib.h>

#include "bus/wire/image_codec.h"

namespace rumi {
namespace {

struct ErrorManager {
  jpeg_error_mgr base;  // first: libjpeg hands back a pointer to it
  jmp_buf escape;
};

void fail(j_common_ptr info) { longjmp(reinterpret_cast<ErrorManager*>(info->err)->escape, 1); }

struct Encoded {
  unsigned char* bytes = nullptr;
  unsigned long size = 0;  // NOLINT(google-runtime-int): libjpeg's
  ~Encoded() { std::free(bytes); }
};

// Returns false if libjpeg refuses the image. Local variables must be trivial: an error leaves by longjmp, which runs
// no destructors.
bool encode(const cv::Mat& image, int quality, Encoded* encoded) {
  jpeg_compress_struct jpeg;
  ErrorManager errors;
  jpeg.err = jpeg_std_error(&errors.base);
  errors.base.error_exit = fail;
  if (setjmp(errors.escape)) {
    jpeg_destroy_compress(&jpeg);
    return false;
  }
  jpeg_create_compress(&jpeg);
  jpeg_mem_dest(&jpeg, &encoded->bytes, &encoded->size);
  jpeg.image_width = static_cast<JDIMENSION>(image.cols);
  jpeg.image_height = static_cast<JDIMENSION>(image.rows);
  jpeg.input_components = image.channels();
  jpeg.in_color_space = image.channels() == 1 ? JCS_GRAYSCALE : JCS_EXT_BGR;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, quality, TRUE);
  jpeg_start_compress(&jpeg, TRUE);
  while (jpeg.next_scanline < jpeg.image_height) {
    JSAMPROW row = const_cast<JSAMPROW>(image.ptr(static_cast<int>(jpeg.next_scanline)));
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  return true;
}

}  // namespace

image_t make_jpeg_image(int64_t utime_us, const cv::Mat& image, int quality) {
  Encoded encoded;
  if (!encode(image, quality, &encoded)) throw std::runtime_error("the image cannot be encoded as JPEG");
  return wrap_jpeg(utime_us, image.cols, image.rows, std::vector<uint8_t>(encoded.bytes, encoded.bytes + encoded.size));
}

}  // namespace rumi
