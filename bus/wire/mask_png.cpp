// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/mask_png.h"

#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstddef>
#include <cstring>
#include <vector>

namespace rumi {
namespace {

// libpng calls it for an error, and prints nothing then; it must not return.
void on_error(png_structp png, png_const_charp) { png_longjmp(png, 1); }
void on_warning(png_structp, png_const_charp) {}

void take_bytes(png_structp png, png_bytep to, size_t count) {
  std::string_view& rest = *static_cast<std::string_view*>(png_get_io_ptr(png));
  if (count > rest.size()) png_error(png, "the file ends too early");
  std::memcpy(to, rest.data(), count);
  rest.remove_prefix(count);
}

void add_bytes(png_structp png, png_bytep from, size_t count) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(from), count);
}

struct Reader {
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
};

struct Writer {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  ~Writer() { png_destroy_write_struct(&png, &info); }
};

// Reads all pixels into `rows`, bytes as they are in the PNG. Returns false if it is damaged. Local variables must be
// trivial: an error leaves by longjmp, which runs no destructors.
bool read_pixels(const Reader& reader, const cv::Size& size, std::vector<std::vector<png_byte>>* rows,
                 std::vector<png_bytep>* pointers) {
  png_structp png = reader.png;
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_user_limits(png, static_cast<png_uint_32>(size.width), static_cast<png_uint_32>(size.height));
  png_read_info(png, reader.info);
  png_set_expand(png);  // palettes and less than 8 bits
  png_set_interlace_handling(png);
  png_read_update_info(png, reader.info);
  rows->assign(png_get_image_height(png, reader.info), std::vector<png_byte>(png_get_rowbytes(png, reader.info)));
  for (std::vector<png_byte>& row : *rows) pointers->push_back(row.data());
  png_read_image(png, pointers->data());
  png_read_end(png, nullptr);
  return true;
}

bool write_pixels(const Writer& writer, const cv::Mat& pixels, std::vector<png_byte>* row) {
  png_structp png = writer.png;
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_IHDR(png, writer.info, static_cast<png_uint_32>(pixels.cols), static_cast<png_uint_32>(pixels.rows), 1,
               PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_BASE, PNG_FILTER_TYPE_BASE);
  png_write_info(png, writer.info);
  png_set_packing(png);
  for (int y = 0; y < pixels.rows; ++y) {
    std::transform(pixels.ptr(y), pixels.ptr(y) + pixels.cols, row->begin(),
                   [](uchar pixel) { return static_cast<png_byte>(pixel != 0); });
    png_write_row(png, row->data());
  }
  png_write_end(png, nullptr);
  return true;
}

}  // namespace

std::string mask_to_png(const cv::Mat& pixels) {
  const Writer writer;
  std::string bytes;
  std::vector<png_byte> row(static_cast<size_t>(pixels.cols));
  png_set_write_fn(writer.png, &bytes, add_bytes, nullptr);
  if (!write_pixels(writer, pixels, &row)) bytes.clear();
  return bytes;
}

cv::Mat mask_from_png(std::string_view png, const cv::Size& size) {
  const Reader reader;
  png_set_read_fn(reader.png, &png, take_bytes);
  std::vector<std::vector<png_byte>> rows;
  std::vector<png_bytep> pointers;
  if (!read_pixels(reader, size, &rows, &pointers) || rows.size() != static_cast<size_t>(size.height)) return {};
  const size_t sample = png_get_bit_depth(reader.png, reader.info) == 16 ? 2 : 1;
  const size_t channels = png_get_channels(reader.png, reader.info), stride = sample * channels;
  const size_t told =
      sample * (channels % 2 == 0 ? channels - 1 : channels);  // an even number: the last is the opacity
  if (rows.front().size() != stride * static_cast<size_t>(size.width)) return {};
  cv::Mat mask(size, CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const png_byte* pixel = rows[static_cast<size_t>(y)].data() + stride * static_cast<size_t>(x);
      if (std::any_of(pixel, pixel + told, [](png_byte byte) { return byte != 0; })) mask.at<uchar>(y, x) = 255;
    }
  return mask;
}

}  // namespace rumi
