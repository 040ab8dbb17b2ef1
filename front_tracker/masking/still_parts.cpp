// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/masking/still_parts.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace rumi::front_tracker {
namespace {

constexpr int64_t kBetweenLooks_us = 200'000;  // least time between two images that are used: the world has to move on
constexpr float kEdge = 6;                     // grey levels per pixel: smaller gradients are ignored
constexpr double kLeastChange = 1.0 / 3;       // share of the edges that must change; with fewer the image stands still
constexpr int kFirstVerdict = 16;              // images that are used before the first mask
constexpr double kForget = 0.98;               // factor on the weight of earlier images with each new one: about 50
                                               // images count
constexpr float kAgree = 0.7F;                 // share of a pixel's gradients (by their squares) that agree, from which
                                               // the pixel is still
constexpr int kCell = 8;                       // side of a cell, px
constexpr int kStillPixels = 5, kWorldPixels = 2;  // still pixels that make a cell still, and that keep it still
constexpr double kLargePart = 0.0015;              // share of the image from which a still part is large, so that its
                                                   // bays are filled
constexpr double kBay = 0.08;                      // half the width of a bay that is filled, at most, as a share of the
                                                   // image's height

void gradients(const cv::Mat& grey, cv::Mat* dx, cv::Mat* dy) {
  cv::Scharr(grey, *dx, CV_32F, 1, 0, 1.0 / 32);
  cv::Scharr(grey, *dy, CV_32F, 0, 1, 1.0 / 32);
}

// Fills narrow bays between large still parts, and between them and the image's border: a bonnet's paint has no edges
// of its own, it only mirrors some.
cv::Mat fill_bays(const cv::Mat& cells) {
  cv::Mat labels, stats, centroids;
  const int parts = cv::connectedComponentsWithStats(cells, labels, stats, centroids, 8);
  cv::Mat large = cv::Mat::zeros(cells.size(), CV_8U);
  for (int i = 1; i < parts; ++i)
    if (stats.at<int>(i, cv::CC_STAT_AREA) >= kLargePart * static_cast<double>(cells.total())) large |= labels == i;
  const int reach = std::max(1, cvRound(kBay * cells.rows));
  cv::Mat padded;
  cv::copyMakeBorder(large, padded, 2 * reach, 2 * reach, 2 * reach, 2 * reach, cv::BORDER_CONSTANT, 255);
  cv::morphologyEx(padded, padded, cv::MORPH_CLOSE,
                   cv::getStructuringElement(cv::MORPH_RECT, {2 * reach + 1, 2 * reach + 1}));
  cv::Mat filled = padded(cv::Rect({2 * reach, 2 * reach}, cells.size())).clone();
  if (cv::countNonZero(large) == 0) filled.setTo(0);
  return filled | cells;
}

// Fills enclosed regions: leaves only the largest connected region of the cells that are not still, if it has at least
// half of them.
void fill_holes(cv::Mat* cells) {
  constexpr double kMost = 0.5;
  const cv::Mat rest = *cells == 0;
  cv::Mat labels, stats, centroids;
  const int parts = cv::connectedComponentsWithStats(rest, labels, stats, centroids, 4);
  int largest = 0, all = 0;
  for (int i = 1; i < parts; ++i) {
    const int area = stats.at<int>(i, cv::CC_STAT_AREA);
    all += area;
    if (largest == 0 || area > stats.at<int>(largest, cv::CC_STAT_AREA)) largest = i;
  }
  if (largest > 0 && stats.at<int>(largest, cv::CC_STAT_AREA) >= kMost * all) cells->setTo(255, labels != largest);
}

}  // namespace

bool StillParts::add(int64_t utime_us, const cv::Mat& grey, const ImageMask& known) {
  if (last_utime_us_ != INT64_MIN && utime_us - last_utime_us_ < kBetweenLooks_us) return false;
  last_utime_us_ = utime_us;
  cv::Mat dx, dy;
  gradients(grey, &dx, &dy);
  if (!last_dx_.empty() && !has_changed(dx, dy)) return false;
  accumulate(dx, dy);
  last_dx_ = dx;
  last_dy_ = dy;
  return ++looks_ >= kFirstVerdict && judge(known);
}

bool StillParts::has_changed(const cv::Mat& dx, const cv::Mat& dy) const {
  int edges = 0, changed = 0;
  for (int y = 0; y < dx.rows; ++y) {
    const float *ax = last_dx_.ptr<float>(y), *ay = last_dy_.ptr<float>(y), *bx = dx.ptr<float>(y),
                *by = dy.ptr<float>(y);
    for (int x = 0; x < dx.cols; ++x) {
      const float a = ax[x] * ax[x] + ay[x] * ay[x], b = bx[x] * bx[x] + by[x] * by[x], longer = std::max(a, b);
      const float difference = (ax[x] - bx[x]) * (ax[x] - bx[x]) + (ay[x] - by[x]) * (ay[x] - by[x]);
      const int is_edge = longer >= kEdge * kEdge;
      edges += is_edge;
      changed += is_edge & static_cast<int>(2 * difference >= longer);
    }
  }
  return changed > kLeastChange * edges;
}

void StillParts::accumulate(const cv::Mat& dx, const cv::Mat& dy) {
  if (sum_dx_.empty())
    for (cv::Mat* sum : {&sum_dx_, &sum_dy_, &sum_square_}) *sum = cv::Mat::zeros(dx.size(), CV_32F);
  weight_ = kForget * weight_ + 1;
  const auto keep = static_cast<float>(kForget);
  for (int y = 0; y < dx.rows; ++y) {
    const float *gx = dx.ptr<float>(y), *gy = dy.ptr<float>(y);
    float *sx = sum_dx_.ptr<float>(y), *sy = sum_dy_.ptr<float>(y), *square = sum_square_.ptr<float>(y);
    for (int x = 0; x < dx.cols; ++x) {
      sx[x] = keep * sx[x] + gx[x];
      sy[x] = keep * sy[x] + gy[x];
      square[x] = keep * square[x] + gx[x] * gx[x] + gy[x] * gy[x];
    }
  }
}

// Returns 255 for cells whose edges stand still. A cell that was still stays so until it clearly is not.
cv::Mat StillParts::still_cells() const {
  const cv::Size size((sum_dx_.cols + kCell - 1) / kCell, (sum_dx_.rows + kCell - 1) / kCell);
  cv::Mat still = cv::Mat::zeros(size, CV_8U);
  const auto weight = static_cast<float>(weight_);
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column) {
      int pixels = 0;
      for (int y = row * kCell; y < std::min((row + 1) * kCell, sum_dx_.rows); ++y)
        for (int x = column * kCell; x < std::min((column + 1) * kCell, sum_dx_.cols); ++x) {
          const float square = sum_square_.at<float>(y, x) / weight;
          if (square < kEdge * kEdge / 4) continue;
          const float sx = sum_dx_.at<float>(y, x) / weight, sy = sum_dy_.at<float>(y, x) / weight;
          pixels += sx * sx + sy * sy >= kAgree * square;
        }
      const bool was_still = !cells_.empty() && cells_.at<uchar>(row, column) != 0;
      if (pixels >= (was_still ? kWorldPixels : kStillPixels)) still.at<uchar>(row, column) = 255;
    }
  return still;
}

bool StillParts::judge(const ImageMask& known) {
  cv::Mat cells = still_cells();
  for (int row = 0; row < cells.rows && !known.is_everything(); ++row)
    for (int column = 0; column < cells.cols; ++column)
      if (!known.allows({(static_cast<float>(column) + 0.5F) * kCell, (static_cast<float>(row) + 0.5F) * kCell}))
        cells.at<uchar>(row, column) = 0;
  const bool is_same = !cells_.empty() && cv::norm(cells, cells_, cv::NORM_INF) == 0;
  cells_ = cells;
  if (is_same) return false;
  const bool was_everything = mask_.is_everything();
  if (cv::countNonZero(cells) == 0) {
    mask_ = {};
    return !was_everything;
  }
  cv::Mat left_out = fill_bays(cells);
  fill_holes(&left_out);
  cv::Mat pixels;
  cv::resize(left_out, pixels, {}, kCell, kCell, cv::INTER_NEAREST);
  mask_ = ImageMask(pixels({0, 0, sum_dx_.cols, sum_dx_.rows}) == 0);
  return true;
}

}  // namespace rumi::front_tracker
