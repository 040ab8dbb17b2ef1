// SPDX-License-Identifier: BSD-3-Clause
// Finds a board in an image, with OpenCV (cv::aruco, cv::findChessboardCornersSB).
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "rumi/calibration/board.h"

namespace rumi::tool {

// A board as one image shows it.
struct BoardView {
  int64_t utime_us = 0;
  std::string where;                // name of the image, for messages
  std::vector<int> corners;         // numbers of the corners that were seen (see Board), ascending
  std::vector<cv::Point2f> pixels;  // their places in the image; (0, 0) is the centre of the upper left pixel
  double blur_px = 0;    // median width of the edges between black and white, px, in the more blurred direction
  double square_px = 0;  // median side of the squares, px
};

struct BoardDetection {
  enum class Outcome {
    kFound,
    kNone,        // no part of the board was found
    kTooLittle,   // too few corners to locate the board
    kOtherBoard,  // markers of its dictionary, but not where this board has them
  };
  Outcome outcome = Outcome::kNone;
  BoardView view;  // set if the outcome is kFound
};

class BoardDetector {
 public:
  explicit BoardDetector(const Board& board);  // precondition: board.check() succeeds
  ~BoardDetector();

  // Finds the board in an image, which must be CV_8UC1. A chessboard is found as a whole or not at all.
  BoardDetection detect(const cv::Mat& grey) const;
  // Returns the dictionary of the markers within a chessboard that was found; empty if there are no markers.
  static std::string markers_within(const cv::Mat& grey, const BoardView& chessboard);

 private:
  struct Markers;
  BoardDetection detect_chessboard(const cv::Mat& grey) const;
  BoardDetection detect_charuco(const cv::Mat& grey) const;

  Board board_;
  std::unique_ptr<Markers> markers_;  // only for a ChArUco board
};

}  // namespace rumi::tool
