// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/calibration/board_page.h"

#include <cairo/cairo-pdf.h>
#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "base/files/whole_file.h"

namespace rumi::tool {
namespace {

constexpr double kMmPerInch = 25.4;
constexpr double kPointsPerMm = 72 / kMmPerInch;  // points are the unit of PDF
constexpr double kMarginMm = 10;  // around the board, as printers leave an edge white; contains the legend
constexpr double kLetterMm = 2.6, kLetterFromEdgeMm = 5.5;

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;

struct Page {
  double width_mm, height_mm;
};

Result<Page> place_on(const Board& board, const Paper& paper) {
  const double across = board.width_mm() + 2 * kMarginMm, down = board.height_mm() + 2 * kMarginMm;
  const Page page = across >= down ? Page{paper.long_mm, paper.short_mm} : Page{paper.short_mm, paper.long_mm};
  if (across <= page.width_mm && down <= page.height_mm) return page;
  return Error{fmt::format(
      "the board {} is {:g} x {:g} mm and does not fit on {} ({:g} x {:g} mm with {:g} mm of margin all around): "
      "take smaller or fewer squares, or larger paper (--paper)",
      board.to_string(), board.width_mm(), board.height_mm(), paper.name, paper.long_mm, paper.short_mm, kMarginMm)};
}

std::string legend(const Board& board) {
  return fmt::format("{}   |   {} x {} squares of {:g} mm: {:g} x {:g} mm in all. Print at 100 %, measure, mount flat.",
                     board.to_string(), board.columns, board.rows, board.square_mm, board.width_mm(),
                     board.height_mm());
}

// Draws white paper with the black board in its middle and the legend below. units_per_mm: units of the surface.
void draw_page(cairo_surface_t* surface, double units_per_mm, const Board& board, const Page& page) {
  const std::unique_ptr<cairo_t, decltype(&cairo_destroy)> context(cairo_create(surface), cairo_destroy);
  cairo_t* c = context.get();
  cairo_scale(c, units_per_mm, units_per_mm);
  cairo_set_source_rgb(c, 1, 1, 1);
  cairo_paint(c);
  cairo_set_source_rgb(c, 0, 0, 0);
  const double left = (page.width_mm - board.width_mm()) / 2, top = (page.height_mm - board.height_mm()) / 2;
  // All rectangles are one path: otherwise a hairline could appear between two that touch.
  for (const cv::Rect2d& r : board.black_mm()) cairo_rectangle(c, left + r.x, top + r.y, r.width, r.height);
  cairo_fill(c);
  // This font is built into Cairo, so no fonts need to be installed.
  cairo_select_font_face(c, "@cairo:", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(c, kLetterMm);
  cairo_set_source_rgb(c, 0.35, 0.35, 0.35);
  const std::string text = legend(board);
  cairo_text_extents_t extents;
  cairo_text_extents(c, text.c_str(), &extents);
  const double fit = std::min(1.0, (page.width_mm - 2 * kMarginMm) / extents.width);
  cairo_set_font_size(c, kLetterMm * fit);
  cairo_move_to(c, (page.width_mm - fit * extents.width) / 2, page.height_mm - kLetterFromEdgeMm);
  cairo_show_text(c, text.c_str());
}

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

std::string pdf(const Board& board, const Page& page) {
  std::string bytes;
  const Surface surface(
      cairo_pdf_surface_create_for_stream(append, &bytes, page.width_mm * kPointsPerMm, page.height_mm * kPointsPerMm),
      cairo_surface_destroy);
  cairo_pdf_surface_restrict_to_version(surface.get(), CAIRO_PDF_VERSION_1_4);  // a version that every printer can read
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, board.to_string().c_str());
  draw_page(surface.get(), kPointsPerMm, board, page);
  cairo_surface_finish(surface.get());
  return bytes;
}

// Returns a PNG file; empty if libpng fails. pixels: rows of `stride` bytes, one grey byte per pixel.
std::string encode_png(const unsigned char* pixels, int width, int height, int stride, double dpi) {
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  if (setjmp(png_jmpbuf(png))) {  // libpng reports errors by longjmp() to this place
    png_destroy_write_struct(&png, &info);
    return {};
  }
  png_set_write_fn(
      png, &bytes,
      [](png_structp p, png_bytep data, size_t size) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<const char*>(data), size);
      },
      [](png_structp) {});
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8, PNG_COLOR_TYPE_GRAY,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  const auto per_metre = static_cast<png_uint_32>(std::lround(dpi / kMmPerInch * 1000));
  png_set_pHYs(png, info, per_metre, per_metre, PNG_RESOLUTION_METER);
  png_write_info(png, info);
  for (int row = 0; row < height; ++row) png_write_row(png, pixels + static_cast<ptrdiff_t>(row) * stride);
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

std::string png(const Board& board, const Page& page, double dpi) {
  const double per_mm = dpi / kMmPerInch;
  const int width = static_cast<int>(std::lround(page.width_mm * per_mm));
  const int height = static_cast<int>(std::lround(page.height_mm * per_mm));
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height), cairo_surface_destroy);
  draw_page(surface.get(), per_mm, board, page);
  cairo_surface_flush(surface.get());
  const unsigned char* data = cairo_image_surface_get_data(surface.get());
  const int stride = cairo_image_surface_get_stride(surface.get());
  std::vector<unsigned char> grey(static_cast<size_t>(width) * height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) grey[static_cast<size_t>(y) * width + x] = data[y * stride + 4 * x];
  return encode_png(grey.data(), width, height, width, dpi);
}

}  // namespace

const std::vector<Paper>& papers() {
  static const std::vector<Paper> kAll = {{"a4", 210, 297}, {"a3", 297, 420}, {"letter", 215.9, 279.4}};
  return kAll;
}

Result<> write_board_page(const Board& board, const Paper& paper, double png_dpi, const std::string& file) {
  const std::string ending = std::filesystem::path(file).extension().string();
  if (ending != ".pdf" && ending != ".png")
    return Error{"its name must end in .pdf or .png, which tells what is written", file};
  const Result<Page> page = place_on(board, paper);
  if (!page) return page.error();
  const std::string bytes = ending == ".pdf" ? pdf(board, *page) : png(board, *page, png_dpi);
  if (bytes.empty()) return Error{"the picture could not be made", file};
  WholeFile out(file);
  out.write(bytes);
  return out.commit();
}

}  // namespace rumi::tool
