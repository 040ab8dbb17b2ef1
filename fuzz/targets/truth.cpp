// SPDX-License-Identifier: BSD-3-Clause
// The truth of `rumi evaluate`, in the formats of various tools. Byte 0 chooses what is known of the run and which file
// the rest is: the truth, or a file beside it with its times or with the pose of a sensor.
#include <filesystem>
#include <stdexcept>

#include "formats/truth/truth.h"
#include "fuzz/scratch.h"

namespace rumi::fuzz {
namespace {

struct File {
  const char *name, *good;
  const char* truth;  // the truth to read: this file, or a truth beside which this file is read
};
constexpr const char* kEuroc =
    "#timestamp,x,y,z,w,x,y,z\n1403636579763555584,0,0,0,1,0,0,0\n1403636579813555456,1,0,0,1,0,0,0\n";
constexpr const char* kKitti = "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n";
constexpr const char* kTum = "# time tx ty tz qx qy qz qw\n1.0 0 0 0 0 0 0 1\n1.1 0.1 0 0 0 0 0 1\n1.2 0 0 0 0 0 0 1\n";
constexpr const char* kPose = "T_BS:\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n";
constexpr const char* kChain = "cam0:\n  T_cam_imu: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n";
constexpr File kFiles[] = {{"truth.txt", kTum, "truth.txt"},
                           {"mav0/gt/data.csv", kEuroc, "mav0/gt/data.csv"},
                           {"mav0/cam0/sensor.yaml", kPose, "mav0/gt/data.csv"},
                           {"mav0/gt/sensor.yaml", kPose, "mav0/gt/data.csv"},
                           {"vi/camchain.yaml", kChain, "vi/gt/data.csv"},
                           {"kitti/times.txt", "0\n0.1\n", "kitti/00.txt"}};
constexpr size_t kFileCount = std::size(kFiles);

void make_folder() {
  for (const char* name : {"mav0", "mav0/gt", "mav0/cam0", "vi", "vi/gt", "kitti"})
    std::filesystem::create_directory(scratch() / name);
  for (const File& file : kFiles) scratch().write(file.name, to_bytes(std::string(file.good)));
  scratch().write("vi/gt/data.csv", to_bytes(std::string(kEuroc)));
  scratch().write("kitti/00.txt", to_bytes(std::string(kKitti)));
}

void check(const TruthFile& truth) {
  for (size_t i = 1; i < truth.poses.size(); ++i)
    if (truth.poses[i].utime_us <= truth.poses[i - 1].utime_us) throw std::logic_error("the times do not rise");
  if (truth.ok() && truth.poses.empty()) throw std::logic_error("no poses, and no error");
}

void run(View input) {
  if (input.empty()) return;
  static const bool made = (make_folder(), true);
  if (!made) return;
  const File& file = kFiles[(input[0] & 7) % kFileCount];
  TruthOptions options;
  options.frames_per_second = (input[0] & 16) != 0 ? 30 : 0;
  constexpr int64_t kSecond_us = 1'000'000, kSince1970_us = 1'403'636'579 * kSecond_us;
  const int64_t first_us = (input[0] & 64) != 0 ? kSince1970_us : 0;
  if ((input[0] & 32) != 0) options.run = RunTimes{first_us, first_us + 9 * kSecond_us, kSecond_us / 30};
  scratch().write(file.name, input.subspan(1));
  check(read_groundtruth(scratch() / file.truth, options));
  scratch().write(file.name, to_bytes(std::string(file.good)));
}

Bytes seed(uint8_t options, const std::string& text) {
  Bytes bytes = to_bytes(text);
  bytes.insert(bytes.begin(), options);
  return bytes;
}

std::vector<Bytes> seeds() {
  std::vector<Bytes> all;
  for (size_t i = 0; i < kFileCount; ++i) all.push_back(seed(static_cast<uint8_t>(i), kFiles[i].good));
  constexpr uint8_t kRate = 16, kRun = 32, kSince1970 = 64;
  for (const uint8_t options : {uint8_t{0}, kRate, kRun, uint8_t{kRun + kRate}, uint8_t{kRun + kSince1970}})
    for (const char* text :
         {kKitti, "1,0,0,0\n2,1,0,0\n3,2,1,0\n",
          "\"time\";\"x\";\"y\";\"z\";\"qw\";\"qx\";\"qy\";\"qz\"\n1,0;0;0;0;1;0;0;0\n",
          "%time,field.header.seq,field.header.stamp,field.pose.position.x,field.pose.position.y,field.pose.position.z,"
          "field.pose.orientation.x,field.pose.orientation.y,field.pose.orientation.z,field.pose.orientation.w\n"
          "1403636579763555584,1,1403636579763555584,0,0,0,0,0,0,1\n",
          "timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n"
          "1403636579763555584,0,0,0,1,0,0,0\n",
          "0 0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "0 0 0 0 0 0 1\n1 0 0 0 0 0 1\n",
          "1403636579763 0 0 0 0 0 0 0\n1403636579813 1 0 0 nan nan nan nan\n",
          "time,latitude,longitude,height\n1,2,3,4\n",
          "1.5 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n2e0 1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1\n", "{\"poses\": []}",
          "#ROSBAG V2.0\n"})
      all.push_back(seed(options, text));
  return all;
}

const Registered registered({"truth", run, seeds});

}  // namespace
}  // namespace rumi::fuzz
