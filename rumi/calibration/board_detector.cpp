// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/calibration/board_detector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "rumi/calibration/opencv_aruco.h"
#include "slam/numeric/median.h"

namespace rumi::tool {
namespace {

constexpr int kMinCorners = 8;  // corners that must be found of a board that is seen in part, at least
// Pairs of markers that must contradict the board to show that it is another one, at least.
constexpr int kMinMarkerPairs = 3;
// Markers that must be found in a chessboard to show that it is a ChArUco board, at least.
constexpr size_t kMinMarkers = 4;
constexpr double kNear = 2.1;  // squares between the markers of a pair, at most: beside or diagonal to each other
constexpr double kMaxMarkerShift = 0.5;  // squares between the expected and the seen place of a marker, at most

constexpr double kChessboardReach = 0.35;
constexpr int kMinWindow = 2, kMaxWindow = 11;  // half the side of the window for the refinement of corners, px
const cv::TermCriteria kUntilConverged(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 0.001);

using Corners = std::vector<cv::Point2f>;

double median_or_zero(std::vector<double> values) { return values.empty() ? 0 : median(&values); }

double intensity(const cv::Mat& grey, const cv::Point2f& at) {
  const int x = cvFloor(at.x), y = cvFloor(at.y);
  if (x < 0 || y < 0 || x + 1 >= grey.cols || y + 1 >= grey.rows) return std::numeric_limits<double>::quiet_NaN();
  const double fx = at.x - x, fy = at.y - y;
  const uint8_t* above = grey.ptr(y) + x;
  const uint8_t* below = grey.ptr(y + 1) + x;
  return (1 - fy) * ((1 - fx) * above[0] + fx * above[1]) + fy * ((1 - fx) * below[0] + fx * below[1]);
}

// Returns the width in px of the edge between two squares: the line from a to b is their common side, and the
// brightness is sampled across its middle. The width is contrast / steepest slope. NaN if it cannot be measured.
double edge_width(const cv::Mat& grey, const cv::Point2f& a, const cv::Point2f& b) {
  constexpr double kReach = 0.4;  // half the length of the profile / length of the side
  constexpr double kStep = 0.25;  // px between two samples
  constexpr int kPixel = 4;       // samples per pixel
  const cv::Point2f along = b - a;
  const double side = cv::norm(along);
  const cv::Point2f across(static_cast<float>(-along.y / side), static_cast<float>(along.x / side));
  const int steps = static_cast<int>(kReach * side / kStep);
  std::vector<double> profile;
  for (int i = -steps; i <= steps; ++i)
    profile.push_back(intensity(grey, (a + b) / 2 + across * static_cast<float>(i * kStep)));
  double low = 255, high = 0, slope = 0;
  for (size_t i = 0; i < profile.size(); ++i) {
    if (std::isnan(profile[i])) return profile[i];
    low = std::min(low, profile[i]);
    high = std::max(high, profile[i]);
    if (i >= 2 * kPixel) slope = std::max(slope, std::abs(profile[i] - profile[i - 2 * kPixel]) / 2);
  }
  return slope > 0 ? (high - low) / slope : std::numeric_limits<double>::quiet_NaN();
}

// Returns for each corner of the board its index in view.corners; -1 if it was not seen.
std::vector<int> places_of_corners(const Board& board, const BoardView& view) {
  std::vector<int> places(board.corners(), -1);
  for (size_t i = 0; i < view.corners.size(); ++i) places[view.corners[i]] = static_cast<int>(i);
  return places;
}

// Returns for each corner of the view its distance, in pixels, to the nearest of its neighbours on the board that were
// seen; 0 if none was.
std::vector<double> shortest_sides(const Board& board, const BoardView& view) {
  const std::vector<int> index = places_of_corners(board, view);
  std::vector<double> shortest(view.corners.size(), std::numeric_limits<double>::infinity());
  const auto compare = [&](size_t i, int other) {
    if (other < 0 || other >= board.corners() || index[other] < 0) return;
    shortest[i] = std::min(shortest[i], cv::norm(view.pixels[i] - view.pixels[index[other]]));
  };
  for (size_t i = 0; i < view.corners.size(); ++i) {
    const int corner = view.corners[i], column = corner % board.corner_columns();
    if (column > 0) compare(i, corner - 1);
    if (column + 1 < board.corner_columns()) compare(i, corner + 1);
    compare(i, corner - board.corner_columns());
    compare(i, corner + board.corner_columns());
    if (std::isinf(shortest[i])) shortest[i] = 0;
  }
  return shortest;
}

void measure_edges(const cv::Mat& grey, const Board& board, BoardView* view) {
  const std::vector<int> index = places_of_corners(board, *view);
  std::vector<double> widths[2], sides;  // widths of edges along the rows, along the columns
  for (int corner = 0; corner < board.corners(); ++corner) {
    const bool last_in_row = (corner + 1) % board.corner_columns() == 0;
    const int next[2] = {last_in_row ? -1 : corner + 1, corner + board.corner_columns()};
    for (int direction = 0; direction < 2; ++direction) {
      const int other = next[direction];
      if (other < 0 || other >= board.corners() || index[corner] < 0 || index[other] < 0) continue;
      const cv::Point2f a = view->pixels[index[corner]], b = view->pixels[index[other]];
      sides.push_back(cv::norm(b - a));
      const double width = edge_width(grey, a, b);
      if (!std::isnan(width)) widths[direction].push_back(width);
    }
  }
  view->blur_px = std::max(median_or_zero(widths[0]), median_or_zero(widths[1]));
  view->square_px = median_or_zero(sides);
}

// Refines corners to a small part of a pixel. `reach` is a share of a square's side: within that distance of a corner,
// only the four squares around it are seen. The corners of OpenCV's detectors are not good enough: versions differ in
// where (0, 0) is, and some corners are not refined.
void refine(const cv::Mat& grey, const Board& board, double reach, BoardView* view) {
  const std::vector<double> sides = shortest_sides(board, *view);
  for (size_t i = 0; i < view->pixels.size(); ++i) {
    const int half = std::clamp(static_cast<int>(reach * sides[i]), kMinWindow, kMaxWindow);
    Corners corner = {view->pixels[i]};
    cv::cornerSubPix(grey, corner, {half, half}, {-1, -1}, kUntilConverged);
    view->pixels[i] = corner[0];
  }
}

// True if there are enough corners, and they lie in at least two rows and two columns, so that they have a homography.
bool spread_out(const Board& board, const std::vector<int>& corners) {
  std::set<int> rows, columns;
  for (const int corner : corners) {
    rows.insert(corner / board.corner_columns());
    columns.insert(corner % board.corner_columns());
  }
  return static_cast<int>(corners.size()) >= std::min(kMinCorners, board.corners()) && rows.size() > 1 &&
         columns.size() > 1;
}

}  // namespace

struct BoardDetector::Markers {
  explicit Markers(const Board& board)
      : dictionary(marker_dictionary(dictionary_number(board.dictionary))),
        // The unit is a square, because only ratios matter.
        charuco(charuco_board({board.columns, board.rows}, 1, static_cast<float>(board.marker_mm / board.square_mm),
                              dictionary)) {}

  size_t count() const { return marker_corners(charuco).size(); }

  cv::Point2f centre(int id) const {
    const std::vector<cv::Point3f>& c = marker_corners(charuco)[id];
    return {(c[0].x + c[2].x) / 2, (c[0].y + c[2].y) / 2};
  }
  bool fits(const std::vector<Corners>& corners, const std::vector<int>& ids) const;

  MarkerDictionary dictionary;
  CharucoBoard charuco;
};

// True if the markers do not contradict the board. Each marker predicts the places of its neighbours: distortion moves
// them little, but most predictions are wrong on another board.
bool BoardDetector::Markers::fits(const std::vector<Corners>& corners, const std::vector<int>& ids) const {
  int right = 0, wrong = 0;
  for (size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] >= static_cast<int>(count())) {
      ++wrong;
      continue;
    }
    Corners on_board;
    for (const cv::Point3f& p : marker_corners(charuco)[ids[i]]) on_board.emplace_back(p.x, p.y);
    const cv::Mat board_from_image = cv::getPerspectiveTransform(corners[i], on_board);
    for (size_t k = 0; k < ids.size(); ++k) {
      if (k == i || ids[k] >= static_cast<int>(count())) continue;
      const cv::Point2f expected = centre(ids[k]);
      const Corners image = {(corners[k][0] + corners[k][1] + corners[k][2] + corners[k][3]) / 4};
      Corners seen;
      cv::perspectiveTransform(image, seen, board_from_image);
      if (std::min(cv::norm(expected - centre(ids[i])), cv::norm(seen[0] - centre(ids[i]))) > kNear) continue;
      ++(cv::norm(seen[0] - expected) < kMaxMarkerShift ? right : wrong);
    }
  }
  return wrong < kMinMarkerPairs || wrong < right;
}

BoardDetector::BoardDetector(const Board& board) : board_(board) {
  if (board.kind == Board::Kind::kCharuco) markers_ = std::make_unique<Markers>(board);
}
BoardDetector::~BoardDetector() = default;

BoardDetection BoardDetector::detect(const cv::Mat& grey) const try {
  BoardDetection detection = markers_ ? detect_charuco(grey) : detect_chessboard(grey);
  if (detection.outcome != BoardDetection::Outcome::kFound) return detection;
  const double rim = (board_.square_mm - board_.marker_mm) / 2 / board_.square_mm;
  refine(grey, board_, markers_ ? rim : kChessboardReach, &detection.view);
  measure_edges(grey, board_, &detection.view);
  return detection;
} catch (const cv::Exception&) {  // the image is too small for OpenCV's windows, or a corner is at its very edge
  return {};
}

std::string BoardDetector::markers_within(const cv::Mat& grey, const BoardView& chessboard) try {
  const cv::Rect whole(cv::Point(0, 0), grey.size());
  const cv::Mat board = grey(cv::boundingRect(chessboard.pixels) & whole);
  size_t most = kMinMarkers - 1;
  std::string found;
  for (const BoardDictionary& dictionary : board_dictionaries()) {
    std::vector<Corners> corners;
    std::vector<int> ids;
    cv::aruco::detectMarkers(board, marker_dictionary(dictionary.number), corners, ids);
    if (ids.size() <= most) continue;
    most = ids.size();
    found = dictionary.name;
  }
  return found;
} catch (const cv::Exception&) {  // the board is only a few pixels large
  return {};
}

BoardDetection BoardDetector::detect_chessboard(const cv::Mat& grey) const {
  BoardDetection detection;
  Corners& pixels = detection.view.pixels;
  const cv::Size size(board_.corner_columns(), board_.corner_rows());
  if (!cv::findChessboardCornersSB(grey, size, pixels, cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_ACCURACY))
    return detection;
  detection.outcome = BoardDetection::Outcome::kFound;
  for (int i = 0; i < board_.corners(); ++i) detection.view.corners.push_back(i);
  return detection;
}

BoardDetection BoardDetector::detect_charuco(const cv::Mat& grey) const {
  using Outcome = BoardDetection::Outcome;
  BoardDetection detection;
  std::vector<Corners> corners;
  std::vector<int> ids;
  cv::aruco::detectMarkers(grey, markers_->dictionary, corners, ids);
  if (ids.empty()) return detection;
  if (!markers_->fits(corners, ids)) {
    detection.outcome = Outcome::kOtherBoard;
    return detection;
  }
  Corners pixels;
  std::vector<int> numbers;
  cv::aruco::interpolateCornersCharuco(corners, ids, grey, markers_->charuco, pixels, numbers);
  std::vector<std::pair<int, cv::Point2f>> found;
  for (size_t i = 0; i < numbers.size(); ++i) found.emplace_back(numbers[i], pixels[i]);
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [number, pixel] : found) {
    detection.view.corners.push_back(number);
    detection.view.pixels.push_back(pixel);
  }
  detection.outcome = spread_out(board_, detection.view.corners) ? Outcome::kFound : Outcome::kTooLittle;
  return detection;
}

}  // namespace rumi::tool
