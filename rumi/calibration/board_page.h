// SPDX-License-Identifier: BSD-3-Clause
// A board on paper, in its exact size, with its description in small letters below it.
#pragma once

#include <string>
#include <vector>

#include "rumi/calibration/board.h"

namespace rumi::tool {

struct Paper {
  const char* name;
  double short_mm, long_mm;
};
// a4, a3, letter.
const std::vector<Paper>& papers();

// Writes FILE.pdf or FILE.png (with its resolution in pHYs), at once. The paper is turned as fits. An Error if the
// file cannot be written, or if the board is too large for the paper. Precondition: board.check() succeeds.
Result<> write_board_page(const Board& board, const Paper& paper, double png_dpi, const std::string& file);

}  // namespace rumi::tool
