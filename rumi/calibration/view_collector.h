// SPDX-License-Identifier: BSD-3-Clause
// Chooses views of a board from images: sharp ones that differ from those taken already.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lcmtypes/rumi/image_t.hpp"
#include "rumi/calibration/coverage.h"

namespace rumi::tool {

struct CollectorOptions {
  double min_difference = 0.1;  // least difference to every view taken, see ViewShape::difference()
  double max_blur_px = 5;       // widest edges, or
  double max_blur_part = 0.1;   // as part of a square's side, if that is more (large images of large boards)
  size_t max_spare = 500;
  CoverageGoal goal;
};

// The number of images by their outcome.
struct ImageCounts {
  int64_t images = 0;      // all
  int64_t unreadable = 0;  // missing or broken
  int64_t no_board = 0;
  int64_t too_little = 0;   // too little of the board
  int64_t other_board = 0;  // markers, but not as on this board
  int64_t blurred = 0;
  int64_t similar = 0;  // like a view that was taken
  int64_t taken = 0;
  int64_t with_board() const { return blurred + similar + taken; }
  std::string to_string() const;  // "40 images: 24 views taken, 10 like these, 2 blurred, 4 without the board"
};

class ViewCollector {
 public:
  ViewCollector(const Board& board, const CollectorOptions& options);

  // False if the image has another size than those before, or shows a chessboard with markers in it; problem() says
  // which.
  bool add(const image_t& image, const std::string& where);
  void add_unreadable(const std::string& problem);

  const Board& board() const { return board_; }
  cv::Size image_size() const { return image_size_; }  // 0 x 0: no image yet
  const ImageCounts& counts() const { return counts_; }
  const std::string& problem() const { return problem_; }
  const std::string& first_unreadable() const { return first_unreadable_; }
  const std::vector<BoardView>& taken() const { return taken_; }
  // Sharp views that were like those taken.
  const std::vector<BoardView>& spare() const { return spare_; }
  // Coverage by the views taken.
  Coverage coverage() const;

 private:
  void add_pixels(const cv::Mat& grey, int64_t utime_us, const std::string& where);
  void add_view(BoardView view);
  void look_for_markers(const cv::Mat& grey, const BoardView& chessboard);

  Board board_;
  CollectorOptions options_;
  BoardDetector detector_;
  cv::Size image_size_;
  ImageCounts counts_;
  std::string problem_, first_unreadable_;
  std::vector<BoardView> taken_, spare_;
  std::vector<ViewShape> shapes_;  // of taken_
  int looked_for_markers_ = 0;     // images in which markers were looked for
};

}  // namespace rumi::tool
