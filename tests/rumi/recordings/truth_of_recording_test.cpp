// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/recordings/truth_of_recording.h"

#include <gmock/gmock.h>

#include "tests/formats/bag/write_bag.h"
#include "tests/formats/downloads.h"

namespace rumi::tool {
namespace {

using namespace testing;
using ::testing::HasSubstr;

class TruthOfRecording : public ::testing::Test {
 protected:
  static std::string found(const fs::path& recording) { return find_truth(recording.string()).file; }
  TemporaryFolder folder_;
};

TEST_F(TruthOfRecording, OfTumLiesInItsFolder) {
  const fs::path tum = write_tum_download(folder_.path() / "unpacked");
  for (const fs::path& given : {tum, tum / "", tum.parent_path(), tum / "rgb"})
    EXPECT_EQ(found(given), tum / "groundtruth.txt") << given;
  EXPECT_EQ(read_truth(found(tum), {}).poses.size(), kImagesOfDownload);
}

TEST_F(TruthOfRecording, OfEurocIsTheStateEstimate) {
  const fs::path euroc = write_euroc_download(folder_.path() / "unpacked");
  for (const fs::path& given :
       {euroc, euroc.parent_path(), euroc / "mav0", euroc / "mav0/cam0", euroc / "mav0/cam0/data"})
    EXPECT_EQ(found(given), euroc / "mav0/state_groundtruth_estimate0/data.csv") << given;
  // The bag is in the folder of the sequence.
  write_file(euroc / "MH_01_easy.bag", "#ROSBAG V2.0\n");
  EXPECT_EQ(found(euroc / "MH_01_easy.bag"), euroc / "mav0/state_groundtruth_estimate0/data.csv");
  const TruthFile truth = read_truth(found(euroc), {});
  EXPECT_EQ(truth.error, "");
  EXPECT_EQ(truth.poses.size(), kImagesOfDownload);
}

TEST_F(TruthOfRecording, OfIclCountsImages) {
  const fs::path icl = write_icl_download(folder_.path() / "unpacked");
  for (const fs::path& given : {icl, icl / "rgb", icl.parent_path()}) {
    const FoundTruth truth = find_truth(given.string());
    EXPECT_EQ(truth.file, icl / "livingRoom0.gt.freiburg") << given;
    EXPECT_EQ(truth.frames_per_second, 30);
  }
}

TEST_F(TruthOfRecording, OfABagIsBesideItOrInIt) {
  const std::string bag = folder_.write("rgbd_dataset_freiburg1_xyz.bag", "#ROSBAG V2.0\n");
  EXPECT_EQ(found(bag), bag);
  const std::string beside = folder_.write("rgbd_dataset_freiburg1_xyz-groundtruth.txt", "1 0 0 0 0 0 0 1\n");
  EXPECT_EQ(found(bag), beside);
  EXPECT_THAT(read_truth(bag, {}).error, HasSubstr("give its true path as a file of poses"));
}

TEST_F(TruthOfRecording, ThatIsNotThereIsToldOf) {
  write_tum(folder_ / "walk", 2);
  EXPECT_THAT(find_truth(folder_ / "walk").error, HasSubstr("there is no truth beside"));
  EXPECT_THAT(find_truth(folder_ / "gone").error, HasSubstr("is no longer there"));
  // A truth beside the folder may be that of another recording, so it is not taken.
  folder_.write("groundtruth.txt", "1 0 0 0 0 0 0 1\n");
  EXPECT_EQ(found(folder_ / "walk"), "");
}

}  // namespace
}  // namespace rumi::tool
