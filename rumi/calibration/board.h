// SPDX-License-Identifier: BSD-3-Clause
// Calibration boards: their pattern, and where its corners are.
//
// The frame of a board: origin at the outer corner of the upper left square, x right, y down, z into the paper, mm.
#pragma once

#include <cstdint>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "base/result.h"

namespace rumi::tool {

struct Board {
  enum class Kind {
    kChessboard,  // must be seen as a whole
    kCharuco,     // a chessboard with ArUco markers in its white squares: parts of it are enough
  };

  Kind kind = Kind::kCharuco;
  int columns = 9, rows = 7;  // squares, not inner corners
  double square_mm = 26;
  double marker_mm = 19;              // ChArUco only
  std::string dictionary = "4X4_50";  // ChArUco only: one of OpenCV's, see board_dictionaries()

  // "charuco:9x7:26:19:4X4_50" or "chessboard:9x7:26"; parse_board() reads it back.
  std::string to_string() const;
  // An Error names the field and its value.
  Result<> check() const;

  double width_mm() const { return columns * square_mm; }
  double height_mm() const { return rows * square_mm; }
  // Inner corners: where four squares meet. Number i is in row i / corner_columns().
  int corner_columns() const { return columns - 1; }
  int corner_rows() const { return rows - 1; }
  int corners() const { return corner_columns() * corner_rows(); }
  cv::Point2d corner_mm(int corner) const;
  // All black areas: squares, and the black parts of the markers. They do not overlap.
  std::vector<cv::Rect2d> black_mm() const;
};

// KIND:COLUMNSxROWS:SQUARE_MM[:MARKER_MM[:DICTIONARY]]; a ChArUco board needs MARKER_MM. An Error if the text cannot be
// read, or if check() refuses the board.
Result<Board> parse_board(const std::string& text);

// "4X4_50", ... and OpenCV's number (cv::aruco::PREDEFINED_DICTIONARY_NAME).
struct BoardDictionary {
  const char* name;
  int number;
};
const std::vector<BoardDictionary>& board_dictionaries();
// Precondition: `name` is one of these.
int dictionary_number(const std::string& name);

inline constexpr const char* kBoardSyntax = "KIND:COLUMNSxROWS:SQUARE_MM[:MARKER_MM[:DICTIONARY]]";

}  // namespace rumi::tool
