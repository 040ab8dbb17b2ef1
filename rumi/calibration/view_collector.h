// SPDX-License-Identifier: BSD-3-Clause
// Chooses views of a board from images: sharp ones that differ from those already taken.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lcmtypes/rumi/image_t.hpp"
#include "rumi/calibration/coverage.h"

namespace rumi::tool {

struct CollectorOptions {
  double min_difference = 0.1;  // ViewShape::difference() to every view already taken, at least
  // The width of the edges is at most max_blur_px, or the part max_blur_part of a square's side if that is more (large
  // images of large boards).
  double max_blur_px = 5;
  double max_blur_part = 0.1;
  size_t max_spare = 500;
  CoverageGoal goal;
};

// Numbers of images by their outcome.
struct ImageCounts {
  int64_t images = 0;      // all images
  int64_t unreadable = 0;  // the image was missing or broken
  int64_t no_board = 0;
  int64_t too_little = 0;   // too little of the board was seen
  int64_t other_board = 0;  // markers were seen, but not where this board has them
  int64_t blurred = 0;
  int64_t similar = 0;  // too similar to a view that was already taken
  int64_t taken = 0;
  int64_t with_board() const { return blurred + similar + taken; }
  // Returns, for example, "40 images: 24 views taken, 10 like these, 2 blurred, 4 without the board".
  std::string to_string() const;
};

class ViewCollector {
 public:
  ViewCollector(const Board& board, const CollectorOptions& options);

  // Looks for the board in the image. False if no more images should be added: this one has another size than those
  // before, or shows markers within a chessboard. problem() says which.
  bool add(const image_t& image, const std::string& where);
  void add_unreadable(const std::string& problem);

  const Board& board() const { return board_; }
  cv::Size image_size() const { return image_size_; }  // 0 x 0: no image yet
  const ImageCounts& counts() const { return counts_; }
  const std::string& problem() const { return problem_; }
  const std::string& first_unreadable() const { return first_unreadable_; }
  const std::vector<BoardView>& taken() const { return taken_; }
  // Sharp views that were too similar to those taken.
  const std::vector<BoardView>& spare() const { return spare_; }
  // Returns the coverage by the views taken.
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
  std::vector<ViewShape> shapes_;  // shapes of taken_
  int looked_for_markers_ = 0;     // number of images in which markers were looked for
};

}  // namespace rumi::tool
