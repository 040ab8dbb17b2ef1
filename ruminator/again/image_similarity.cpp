// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/again/image_similarity.h"

#include <algorithm>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace rumi::ruminator {
namespace {

// Places are recognized by coarse structure: small images are enough, and cost a tenth.
constexpr int kImageSide_px = 480;
constexpr int kKeypoints = 300;
constexpr int kWords = 32;
constexpr int kTrainingDescriptors = 6000;
constexpr int kDimensions = std::tuple_size_v<SiftDescriptor>;

cv::Mat row_of(const SiftDescriptor& descriptor) {
  cv::Mat row;
  cv::Mat(1, kDimensions, CV_8U, const_cast<uint8_t*>(descriptor.data())).convertTo(row, CV_32F, 1.0 / 512);
  return row;
}

}  // namespace

bool ImageSimilarity::add(const cv::Mat& grey, const Camera& camera, const ImageMask& mask) {
  const double shrink = std::min(1.0, static_cast<double>(kImageSide_px) / std::max(grey.cols, grey.rows));
  const cv::Size size(static_cast<int>(grey.cols * shrink), static_cast<int>(grey.rows * shrink));
  cv::Mat small;
  cv::resize(grey, small, size, 0, 0, cv::INTER_AREA);
  const Camera small_camera = camera.resized(size.width, size.height);
  SiftFeatures features =
      extract_sift(small, small_camera, kKeypoints, mask.is_everything() ? mask : mask.resized(size));
  if (features.size() < kMinKeypoints) return false;
  descriptors_.push_back(std::move(features.descriptors));
  return true;
}

cv::Mat ImageSimilarity::words() const {
  size_t all = 0;
  for (const auto& image : descriptors_) all += image.size();
  const size_t step = std::max<size_t>(1, all / kTrainingDescriptors);
  cv::Mat training;
  size_t n = 0;
  for (const auto& image : descriptors_)
    for (const SiftDescriptor& descriptor : image)
      if (n++ % step == 0) training.push_back(row_of(descriptor));
  if (training.rows < kWords) return {};
  cv::Mat labels, centres;
  cv::theRNG().state = 1;  // the same words whenever it is run
  cv::kmeans(training, kWords, labels, cv::TermCriteria(cv::TermCriteria::COUNT, 10, 0), 1, cv::KMEANS_PP_CENTERS,
             centres);
  return centres;
}

Eigen::VectorXf ImageSimilarity::vector_of(const cv::Mat& words, const std::vector<SiftDescriptor>& descriptors) const {
  using Row = Eigen::Map<const Eigen::RowVectorXf>;
  Eigen::MatrixXf residuals = Eigen::MatrixXf::Zero(kDimensions, words.rows);
  for (const SiftDescriptor& descriptor : descriptors) {
    const cv::Mat row = row_of(descriptor);
    const Row value(row.ptr<float>(), kDimensions);
    int nearest = 0;
    float best = std::numeric_limits<float>::max();
    for (int w = 0; w < words.rows; ++w) {
      const float distance = (value - Row(words.ptr<float>(w), kDimensions)).squaredNorm();
      if (distance < best) best = distance, nearest = w;
    }
    residuals.col(nearest) += (value - Row(words.ptr<float>(nearest), kDimensions)).transpose();
  }
  // Each word counts the same: texture that repeats would else outvote the rest (Arandjelovic and Zisserman, CVPR
  // 2013).
  for (Eigen::Index w = 0; w < residuals.cols(); ++w) residuals.col(w).normalize();
  return Eigen::Map<Eigen::VectorXf>(residuals.data(), residuals.size()).normalized();
}

void ImageSimilarity::build() {
  const cv::Mat centres = words();
  vectors_.assign(descriptors_.size(), Eigen::VectorXf());
  for (size_t i = 0; i < descriptors_.size() && !centres.empty(); ++i)
    if (!descriptors_[i].empty()) vectors_[i] = vector_of(centres, descriptors_[i]);
  for (auto& image : descriptors_) image = {};
}

double ImageSimilarity::similarity(size_t first, size_t second) const {
  const Eigen::VectorXf &a = vectors_[first], &b = vectors_[second];
  return a.size() == 0 || b.size() == 0 ? 0 : a.dot(b);
}

}  // namespace rumi::ruminator
