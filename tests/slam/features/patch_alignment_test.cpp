// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/patch_alignment.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <opencv2/imgproc.hpp>
#include <random>

#include "slam/features/orb_extractor.h"

namespace rumi {
namespace {

// Blocks drawn four times as large as in the views, so that a view is as smooth as an image from a lens.
const cv::Mat& fine_texture() {
  static const cv::Mat image = [] {
    cv::Mat drawn(4 * 480, 4 * 640, CV_8U, cv::Scalar(120));
    cv::RNG rng(7);
    for (int i = 0; i < 1500; ++i) {
      const cv::Rect block(rng.uniform(0, drawn.cols), rng.uniform(0, drawn.rows), rng.uniform(10, 120),
                           rng.uniform(10, 120));
      cv::rectangle(drawn, block, cv::Scalar(rng.uniform(20, 235)), cv::FILLED);
    }
    cv::GaussianBlur(drawn, drawn, {0, 0}, 3.0);
    return drawn;
  }();
  return image;
}

// A view of the texture. Its pixel p shows the pixel linear * p + shift of the plain view, which shows the whole
// texture.
struct View {
  Eigen::Matrix2d linear = Eigen::Matrix2d::Identity();
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  Eigen::Vector2d operator()(const Eigen::Vector2d& pixel) const { return linear * pixel + shift; }
};

cv::Mat take(const View& view) {
  cv::Mat map(480, 640, CV_32FC2);
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x) {
      const Eigen::Vector2d p = 4 * (view({x, y}) + Eigen::Vector2d(0.5, 0.5)) - Eigen::Vector2d(0.5, 0.5);
      map.at<cv::Vec2f>(y, x) = {static_cast<float>(p.x()), static_cast<float>(p.y())};
    }
  cv::Mat image;
  cv::remap(fine_texture(), image, map, {}, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return image;
}

ImagePyramid pyramid(const cv::Mat& image) { return {image, Pyramid().scales()}; }

std::optional<Eigen::Vector2f> align(const ImagePyramid& reference, const Eigen::Vector2f& pixel,
                                     const Eigen::Matrix2f& image_from_reference, const PatchPlace& at) {
  const auto patch = make_patch_template(reference, pixel, image_from_reference, at.images.pixel_size(at.level).x());
  return patch ? align_patch(*patch, at) : std::nullopt;
}

struct Outcome {
  int tried = 0, aligned = 0;
  double rms_px = 0;  // root mean square error after alignment, pixels of the level
  double before_px = 0;
};

// Looks in `image` for each corner of the plain view. The search starts up to one pixel of the level beside the true
// place, in x and in y.
Outcome align_corners(const cv::Mat& image, const View& view) {
  const ImagePyramid reference = pyramid(take({})), images = pyramid(image);
  const Eigen::Matrix2d view_from_texture = view.linear.inverse();
  std::mt19937 rng(3);
  std::uniform_real_distribution<float> offset(-1.0F, 1.0F);
  Outcome out;
  for (const Keypoint& k : OrbExtractor({}).extract(reference).keypoints) {
    const Eigen::Vector2f truth = (view_from_texture * (k.pixel.cast<double>() - view.shift)).cast<float>();
    if (!(truth.array() > 60).all() || truth.x() > 580 || truth.y() > 420) continue;
    const float scale = images.pixel_size(k.octave).x();
    const Eigen::Vector2f start = truth + scale * Eigen::Vector2f(offset(rng), offset(rng));
    ++out.tried;
    const auto found = align(reference, k.pixel, view_from_texture.cast<float>(), {images, start, k.octave});
    if (!found) continue;
    ++out.aligned;
    out.rms_px += (*found - truth).squaredNorm() / (scale * scale);
    out.before_px += (start - truth).squaredNorm() / (scale * scale);
  }
  out.rms_px = std::sqrt(out.rms_px / out.aligned);
  out.before_px = std::sqrt(out.before_px / out.aligned);
  return out;
}

View turned(double degrees, double zoom) {
  View view;
  const double a = degrees * M_PI / 180;
  view.linear << std::cos(a), -std::sin(a), std::sin(a), std::cos(a);
  view.linear *= zoom;
  const Eigen::Vector2d middle(320, 240);
  view.shift = middle - view.linear * middle + Eigen::Vector2d(3.37, -2.71);
  return view;
}

TEST(PatchAlignment, FindsAPlaceToATenthOfAPixel) {
  for (const auto& [degrees, zoom] : {std::pair{0.0, 1.0}, {0.0, 1.15}, {25.0, 1.0}, {-60.0, 0.8}}) {
    const View view = turned(degrees, zoom);
    const Outcome o = align_corners(take(view), view);
    SCOPED_TRACE(testing::Message() << degrees << " degrees, zoom " << zoom);
    EXPECT_GT(o.tried, 200);
    EXPECT_GT(o.aligned, 0.9 * o.tried);
    EXPECT_GT(o.before_px, 0.7);
    EXPECT_LT(o.rms_px, 0.08);
  }
}

TEST(PatchAlignment, DoesNotMindExposureNorNoise) {
  const View view = turned(5, 1.05);
  cv::Mat image = take(view);
  image.convertTo(image, CV_8U, 0.6, 50);
  cv::Mat noise(image.size(), CV_16S);
  cv::theRNG().state = 5;
  cv::randn(noise, 0, 4);
  cv::add(image, noise, image, {}, CV_8U);
  const Outcome o = align_corners(image, view);
  EXPECT_GT(o.aligned, 0.85 * o.tried);
  EXPECT_LT(o.rms_px, 0.08);
}

TEST(PatchAlignment, RefusesWhatIsNotThere) {
  const View elsewhere = turned(0, 1);
  const Outcome mirrored = [&] {
    cv::Mat image;
    cv::flip(take(elsewhere), image, 1);
    return align_corners(image, elsewhere);
  }();
  EXPECT_LT(mirrored.aligned, 0.1 * mirrored.tried);
  cv::Mat flat(480, 640, CV_8U, cv::Scalar(90));
  EXPECT_EQ(align_corners(flat, elsewhere).aligned, 0);
}

TEST(PatchAlignment, RefusesPlacesOutsideAndImpossibleViews) {
  const ImagePyramid images = pyramid(take({}));
  const Eigen::Matrix2f same = Eigen::Matrix2f::Identity();
  const Eigen::Vector2f inside(320, 240);
  const auto is_found = [&](const Eigen::Vector2f& reference, const Eigen::Matrix2f& view, const Eigen::Vector2f& at) {
    return align(images, reference, view, {images, at, 0}).has_value();
  };
  EXPECT_TRUE(is_found(inside, same, inside));
  for (const Eigen::Vector2f& p :
       {Eigen::Vector2f(2, 240), {637, 240}, {320, 2}, {320, 477}, {-50, 9000}, {NAN, 240}}) {
    EXPECT_FALSE(is_found(p, same, inside)) << p.transpose();
    EXPECT_FALSE(is_found(inside, same, p)) << p.transpose();
  }
  EXPECT_FALSE(is_found(inside, Eigen::Matrix2f::Zero(), inside));
  EXPECT_FALSE(is_found(inside, same * NAN, inside));
  EXPECT_FALSE(is_found(inside, Eigen::Vector2f(1, -1).asDiagonal(), inside));
}

}  // namespace
}  // namespace rumi
