// SPDX-License-Identifier: BSD-3-Clause
// Finds a board in an image, by OpenCV (cv::aruco; cv::findChessboardCornersSB).
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
  std::string where;                // the image, for messages
  std::vector<int> corners;         // their numbers (see Board), ascending
  std::vector<cv::Point2f> pixels;  // where they are; (0, 0) is the centre of the upper left pixel
  double blur_px = 0;               // width of the edges from black to white, in the more blurred direction
  double square_px = 0;             // side of its squares, median
};

struct BoardDetection {
  enum class Outcome {
    kFound,
    kNone,        // no part of the board
    kTooLittle,   // too few corners to tell where it is
    kOtherBoard,  // markers of the dictionary, but not in the places where this board has them
  };
  Outcome outcome = Outcome::kNone;
  BoardView view;  // of kFound
};

class BoardDetector {
 public:
  explicit BoardDetector(const Board& board);  // precondition: board.check() succeeds
  ~BoardDetector();

  // grey: CV_8UC1. A chessboard is found as a whole or not at all.
  BoardDetection detect(const cv::Mat& grey) const;
  // The dictionary of the markers within a chessboard that was found; empty if it has no markers.
  static std::string markers_within(const cv::Mat& grey, const BoardView& chessboard);

 private:
  struct Markers;
  BoardDetection detect_chessboard(const cv::Mat& grey) const;
  BoardDetection detect_charuco(const cv::Mat& grey) const;

  Board board_;
  std::unique_ptr<Markers> markers_;  // of a ChArUco board
};

}  // namespace rumi::tool
