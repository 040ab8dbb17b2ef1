// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/calibration/view_collector.h"

#include <fmt/format.h>

#include <algorithm>

#include "bus/wire/image_codec.h"

namespace rumi::tool {

std::string ImageCounts::to_string() const {
  std::string text = fmt::format("{} images: {} views taken", images, taken);
  const auto add = [&text](int64_t count, const char* what) {
    if (count > 0) text += fmt::format(", {} {}", count, what);
  };
  add(similar, "like these");
  add(blurred, "blurred");
  add(too_little, "with too little of the board");
  add(other_board, "of another board");
  add(no_board, "without the board");
  add(unreadable, "unreadable");
  return text;
}

ViewCollector::ViewCollector(const Board& board, const CollectorOptions& options)
    : board_(board), options_(options), detector_(board) {}

void ViewCollector::add_unreadable(const std::string& problem) {
  ++counts_.images;
  if (counts_.unreadable++ == 0) first_unreadable_ = problem;
}

bool ViewCollector::add(const image_t& image, const std::string& where) {
  const Result<cv::Mat> decoded = decode_grey(image);
  if (!decoded) {
    add_unreadable(where + ": " + decoded.error_text());
    return true;
  }
  const cv::Mat& grey = *decoded;
  if (image_size_.empty()) image_size_ = grey.size();
  if (grey.size() != image_size_) {
    problem_ = fmt::format(
        "{}: is {} x {} pixels, the images before it are {} x {}; a calibration is for one size: give the images of "
        "one",
        where, grey.cols, grey.rows, image_size_.width, image_size_.height);
    return false;
  }
  add_pixels(grey, image.utime, where);
  return problem_.empty();
}

void ViewCollector::add_pixels(const cv::Mat& grey, int64_t utime_us, const std::string& where) {
  using Outcome = BoardDetection::Outcome;
  ++counts_.images;
  BoardDetection detection = detector_.detect(grey);
  counts_.no_board += detection.outcome == Outcome::kNone ? 1 : 0;
  counts_.too_little += detection.outcome == Outcome::kTooLittle ? 1 : 0;
  counts_.other_board += detection.outcome == Outcome::kOtherBoard ? 1 : 0;
  if (detection.outcome != Outcome::kFound) return;
  detection.view.utime_us = utime_us;
  detection.view.where = where;
  look_for_markers(grey, detection.view);
  add_view(std::move(detection.view));
}

// A ChArUco board is found as a chessboard, too. But its markers reach into the windows in which corners are refined,
// which made the error of a calibration seven times as large. Sets problem_ if there are markers.
void ViewCollector::look_for_markers(const cv::Mat& grey, const BoardView& chessboard) {
  constexpr int kImages = 3;  // looking for markers takes as long as looking for the board
  if (board_.kind != Board::Kind::kChessboard || looked_for_markers_++ >= kImages) return;
  const std::string dictionary = BoardDetector::markers_within(grey, chessboard);
  if (dictionary.empty()) return;
  problem_ = fmt::format(
      "{}: the board has markers in its white squares: it is a ChArUco board, whose corners would be found worse as "
      "those of "
      "a chessboard; give --board charuco:{}x{}:{}:MARKER_MM:{}, where MARKER_MM is the side of a marker",
      chessboard.where, board_.columns, board_.rows, board_.square_mm, dictionary);
}

void ViewCollector::add_view(BoardView view) {
  if (view.blur_px > std::max(options_.max_blur_px, options_.max_blur_part * view.square_px)) {
    ++counts_.blurred;
    return;
  }
  const ViewShape shape = shape_of(view, board_, image_size_);
  const bool similar = std::any_of(shapes_.begin(), shapes_.end(), [&](const ViewShape& other) {
    return shape.difference(other) < options_.min_difference;
  });
  if (similar) {
    ++counts_.similar;
    if (spare_.size() < options_.max_spare) spare_.push_back(std::move(view));
    return;
  }
  ++counts_.taken;
  shapes_.push_back(shape);
  taken_.push_back(std::move(view));
}

Coverage ViewCollector::coverage() const {
  Coverage coverage(image_size_, options_.goal);
  for (size_t i = 0; i < taken_.size(); ++i) coverage.add(taken_[i], shapes_[i]);
  return coverage;
}

}  // namespace rumi::tool
