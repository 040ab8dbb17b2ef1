// SPDX-License-Identifier: BSD-3-Clause
// Runs `rumi replay` on images that do not show only the world: repeated ones, and a bonnet.
#include <gmock/gmock.h>

#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "tests/rumi/commands/replay_fixture.h"

namespace rumi::tool {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ReplayOfOddImages : public ReplayTest {};

// Changes the list so that it names the image before `from` in place of the images `from` to `to` - 1.
void stand_still(const fs::path& list, int from, int to) {
  std::istringstream before(read_file(list));
  std::ofstream after(list);
  std::string shown;
  int number = 0;
  for (std::string line; std::getline(before, line);) {
    if (line.empty() || line[0] == '#') continue;
    const size_t space = line.find(' ');
    if (number < from || number >= to) shown = line.substr(space);
    ++number;
    after << line.substr(0, space) << shown << '\n';
  }
}

TEST_F(ReplayOfOddImages, ACameraThatStandsStillHasNoPoseMeanwhileAndItIsSaid) {
  const fs::path recording = work_->path() / "frozen", out = work_->path() / "of_frozen";
  fs::copy(sequence_, recording, fs::copy_options::recursive);
  stand_still(recording / "rgb.txt", 60, 90);
  const Outcome outcome = replay_aloud(recording, out, "--duration 4");
  EXPECT_EQ(outcome.exit_code, 3) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("of 120 images are the same as the one before them (the longest row: 30 images "
                                        "from 2.00 s on): the camera or the recorder stood still"));
  const nlohmann::json run = read_json_file(out / "run.json");
  const int repeated = run["skipped_images"]["repeated"];
  EXPECT_GE(repeated, 27) << "one or two in a row are no row";
  EXPECT_LE(repeated, 30);
  EXPECT_EQ(run["counts"]["frames"], 120 - repeated);
  EXPECT_GE(run["counts"]["frames_in_map"], 88);
  EXPECT_LE(evaluate(out, sequence_ / "groundtruth.txt")["ate_rmse_m"], 0.05);
}

// Replaces the lowest rows of each image by a pattern that never moves.
void put_bonnet_on(const fs::path& images, int rows) {
  cv::Mat bonnet;
  for (const auto& entry : fs::directory_iterator(images)) {
    cv::Mat image = cv::imread(entry.path().string(), cv::IMREAD_GRAYSCALE);
    if (bonnet.empty()) {
      bonnet.create(rows, image.cols, CV_8U);
      for (int y = 0; y < bonnet.rows; ++y)
        for (int x = 0; x < bonnet.cols; ++x) bonnet.at<uchar>(y, x) = (x / 31 + y / 17) % 2 == 0 ? 40 : 200;
    }
    bonnet.copyTo(image.rowRange(image.rows - rows, image.rows));
    cv::imwrite(entry.path().string(), image);
  }
}

TEST_F(ReplayOfOddImages, ABonnetIsToldAndLeftAsAMask) {
  const fs::path recording = work_->path() / "bonnet", out = work_->path() / "of_bonnet";
  fs::copy(sequence_, recording, fs::copy_options::recursive);
  put_bonnet_on(recording / "rgb", 72);
  const Outcome outcome = replay_aloud(recording, out, "--duration 5 --set ruminator.rebuild=false");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("of the image never moves (bonnet or caption): left out, mask.png shows it"));
  const nlohmann::json masks = read_json_file(out / "run.json")["masks"];
  ASSERT_EQ(masks.size(), 1u);
  EXPECT_NEAR(masks[0]["left_out"], 0.15, 0.03);
  const cv::Mat mask = cv::imread((out / "mask.png").string(), cv::IMREAD_GRAYSCALE);
  ASSERT_EQ(mask.size(), cv::Size(640, 480));
  EXPECT_GE(cv::countNonZero(mask.rowRange(0, 395)), 0.97 * 395 * 640);
  EXPECT_LE(cv::countNonZero(mask.rowRange(420, 480)), 0.03 * 60 * 640);

  // The mask can be used by another run. A run that would replace the mask that it uses is refused.
  const std::string flag = "--duration 2 --mask '" + (out / "mask.png").string() + "'";
  EXPECT_EQ(replay(recording, work_->path() / "with_mask", flag).exit_code, 0);
  const Outcome itself = replay(recording, out, flag);
  EXPECT_EQ(itself.exit_code, 1);
  EXPECT_THAT(itself.output, HasSubstr("give the mask another name"));
  EXPECT_TRUE(fs::exists(out / "mask.png"));

  const Outcome without = replay_aloud(sequence_, out, "--duration 2");
  EXPECT_THAT(without.output, Not(HasSubstr("never moves")));
  EXPECT_FALSE(fs::exists(out / "mask.png")) << "that of the run before";
}

}  // namespace
}  // namespace rumi::tool
