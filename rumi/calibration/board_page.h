// SPDX-License-Identifier: BSD-3-Clause
// Writes a board on paper in its exact size, with its description in small letters below.
#pragma once

#include <string>
#include <vector>

#include "rumi/calibration/board.h"

namespace rumi::tool {

struct Paper {
  const char* name;
  double short_mm, long_mm;
};
// Returns a4, a3 and letter.
const std::vector<Paper>& papers();

// Writes the board to `file`, whose name must end in .pdf or .png (with the resolution in pHYs). The file is complete
// or absent. The paper is turned so that the board fits. An Error if the board is too large for the paper, or if the
// file cannot be written. Precondition: board.check() succeeds.
Result<> write_board_page(const Board& board, const Paper& paper, double png_dpi, const std::string& file);

}  // namespace rumi::tool
