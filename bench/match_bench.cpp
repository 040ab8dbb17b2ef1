// SPDX-License-Identifier: BSD-3-Clause
// How well corners are recognised in other images of a recording (or of a rendered walk): by OpenCV's ORB, as
// OrbExtractor has it, and by SteeredBrief at the same keypoints. Matches are mutual nearest neighbours; right are
// those that agree with one fundamental matrix.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>

#include "bench/rendered_images.h"
#include "bench/steered_brief.h"
#include "slam/features/orb_extractor.h"

namespace rumi {
namespace {

// Ours instead of the extractor's, which are OpenCV's.
Features described_by_us(const ImagePyramid& pyramid, Features features) {
  std::vector<cv::Mat> smooth;
  for (int octave = 0; octave < pyramid.levels(); ++octave)
    smooth.push_back(SteeredBrief::smooth(pyramid.level(octave)));
  for (size_t i = 0; i < features.size(); ++i) {
    const Keypoint& k = features.keypoints[i];
    const Eigen::Vector2f at = pyramid.to_level(k.pixel, k.octave);
    features.descriptors[i] = SteeredBrief::describe(smooth[k.octave], {at.x(), at.y()}, k.angle_rad);
  }
  return features;
}

std::vector<int> nearest(const Features& from, const Features& to) {
  std::vector<int> best(from.size(), kNone);
  for (size_t i = 0; i < from.size(); ++i) {
    int least = 257;
    for (size_t j = 0; j < to.size(); ++j)
      if (const int d = hamming_distance(from.descriptors[i], to.descriptors[j]); d < least) {
        least = d;
        best[i] = static_cast<int>(j);
      }
  }
  return best;
}

struct Score {
  size_t matches = 0, right = 0, distance = 0;

  void add(const Features& a, const Features& b, int max_distance) {
    const std::vector<int> ab = nearest(a, b), ba = nearest(b, a);
    std::vector<cv::Point2f> there, here;
    std::vector<int> distances;
    for (size_t i = 0; i < ab.size(); ++i) {
      if (ab[i] == kNone || ba[ab[i]] != static_cast<int>(i)) continue;
      const int d = hamming_distance(a.descriptors[i], b.descriptors[ab[i]]);
      if (d > max_distance) continue;
      here.emplace_back(a.keypoints[i].pixel.x(), a.keypoints[i].pixel.y());
      there.emplace_back(b.keypoints[ab[i]].pixel.x(), b.keypoints[ab[i]].pixel.y());
      distances.push_back(d);
    }
    matches += here.size();
    if (here.size() < 15) return;
    cv::Mat agrees;
    cv::findFundamentalMat(here, there, cv::USAC_MAGSAC, 1.5, 0.999, 5000, agrees);
    for (int i = 0; i < agrees.rows; ++i) {
      right += agrees.at<uchar>(i);
      distance += agrees.at<uchar>(i) * static_cast<size_t>(distances[i]);
    }
  }

  void print(const char* name, size_t pairs) const {
    fmt::print("{:12} {:.1f} matches, {:.1f} of them right ({:.1f} %), their distance {:.1f}\n", name,
               static_cast<double>(matches) / static_cast<double>(pairs),
               static_cast<double>(right) / static_cast<double>(pairs),
               100 * static_cast<double>(right) / static_cast<double>(std::max<size_t>(1, matches)),
               static_cast<double>(distance) / static_cast<double>(std::max<size_t>(1, right)));
  }
};

int main_of(int argc, char** argv) {
  CLI::App app("How well corners are recognised in other images: our descriptors beside cv::ORB's");
  std::string folder;
  size_t step = 1, pairs = 60;
  int max_distance = 64;
  app.add_option("folder", folder, "of images, in the order of their names")->check(CLI::ExistingDirectory);
  app.add_option("--step", step, "images from one of a pair to the other")->capture_default_str();
  app.add_option("--pairs", pairs, "of images, spread over the folder")->capture_default_str();
  app.add_option("--max-distance", max_distance, "of a match, bits")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::vector<std::filesystem::path> files;
  if (!folder.empty())
    for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  const size_t images = folder.empty() ? rendered_images().grey.size() : files.size();
  if (images <= step) {
    fmt::print(stderr, "there are {} images; more than {} are needed\n", images, step);
    return 1;
  }
  OrbExtractor extractor({});
  Score ours, opencv;
  for (size_t pair = 0; pair < pairs; ++pair) {
    const size_t first = (images - step - 1) * pair / pairs;
    std::vector<Features> own, theirs;
    for (const size_t i : {first, first + step}) {
      const cv::Mat grey =
          folder.empty() ? rendered_images().grey[i] : cv::imread(files[i].string(), cv::IMREAD_GRAYSCALE);
      if (grey.empty()) {
        fmt::print(stderr, "cannot read {}\n", files[i].string());
        return 1;
      }
      const ImagePyramid pyramid = extractor.pyramid(grey);
      theirs.push_back(extractor.extract(pyramid));
      own.push_back(described_by_us(pyramid, theirs.back()));
    }
    ours.add(own[0], own[1], max_distance);
    opencv.add(theirs[0], theirs[1], max_distance);
  }
  ours.print("ours", pairs);
  opencv.print("cv::ORB", pairs);
  return 0;
}

}  // namespace
}  // namespace rumi

int main(int argc, char** argv) { return rumi::main_of(argc, argv); }
