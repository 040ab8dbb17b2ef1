// SPDX-License-Identifier: BSD-3-Clause
// Calibration boards: their pattern, and the positions of its corners.
#pragma once

#include <cstdint>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "base/result.h"

namespace rumi::tool {

struct Board {
  enum class Kind {
    kChessboard,  // must be visible as a whole
    kCharuco,     // a chessboard with ArUco markers in its white squares; parts of it are enough
  };

  Kind kind = Kind::kCharuco;
  int columns = 9, rows = 7;  // squares, not inner corners
  double square_mm = 26;
  double marker_mm = 19;              // side of a marker; ChArUco only
  std::string dictionary = "4X4_50";  // ChArUco only: a name in board_dictionaries()

  // Returns "charuco:9x7:26:19:4X4_50" or "chessboard:9x7:26", which parse_board() reads back.
  std::string to_string() const;
  // Returns an Error, which names the field and its value, if there cannot be such a board.
  Result<> check() const;

  double width_mm() const { return columns * square_mm; }
  double height_mm() const { return rows * square_mm; }
  // Inner corners: the points where four squares meet. Number i is in row i / corner_columns().
  int corner_columns() const { return columns - 1; }
  int corner_rows() const { return rows - 1; }
  int corners() const { return corner_columns() * corner_rows(); }
  cv::Point2d corner_mm(int corner) const;
  // Returns all black areas: squares, and the black parts of the markers. They do not overlap.
  std::vector<cv::Rect2d> black_mm() const;
};

// Reads KIND:COLUMNSxROWS:SQUARE_MM[:MARKER_MM[:DICTIONARY]]; a ChArUco board needs MARKER_MM. An Error if the text
// cannot be read, or if check() refuses the board.
Result<Board> parse_board(const std::string& text);

// A name such as "4X4_50", and OpenCV's number (cv::aruco::PREDEFINED_DICTIONARY_NAME).
struct BoardDictionary {
  const char* name;
  int number;
};
const std::vector<BoardDictionary>& board_dictionaries();
// Returns the number of a dictionary. Precondition: `name` is in board_dictionaries().
int dictionary_number(const std::string& name);

inline constexpr const char* kBoardSyntax = "KIND:COLUMNSxROWS:SQUARE_MM[:MARKER_MM[:DICTIONARY]]";

}  // namespace rumi::tool
