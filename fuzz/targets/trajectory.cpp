// SPDX-License-Identifier: BSD-3-Clause
// Files that `rumi evaluate` and `rumi synth` read. Byte 0 chooses which file the rest is: one of a run's folder, one
// of the truth, or the path of a camera. All other files are good.
#include <filesystem>

#include "base/text/json_text.h"
#include "fuzz/scratch.h"
#include "rumi/evaluation/run_evaluation.h"
#include "synth/camera_path.h"

namespace rumi::fuzz {
namespace {

constexpr const char* kTum = "1.0 0 0 0 0 0 0 1\n1.1 0.1 0 0 0 0 0 1\n1.2 0.2 0.1 0 0 0 0 1\n1.3 0.3 0 0.1 0 0 0 1\n";
constexpr const char* kFrames =
    "utime,state,submap,in_map,position_sigma,rotation_sigma_rad,log_scale_sigma\n"
    "1000000,TRACKING,1,1,0.01,0.01,0.01\n1100000,TRACKING,1,1,0.01,0.01,0.01\n1200000,LOST,0,0,,,\n";
constexpr const char* kEuroc = "#timestamp,x,y,z,w,x,y,z\n1000000000,0,0,0,1,0,0,0\n1100000000,1,0,0,1,0,0,0\n";
constexpr const char* kKitti = "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n";
constexpr const char* kPositions = "1000,0,0,0\n1100,1,0,0\n1200,2,1,0\n";
constexpr const char* kNamed = "\"time\";\"x\";\"y\";\"z\";\"qw\";\"qx\";\"qy\";\"qz\"\n1,0;0;0;0;1;0;0;0\n";
constexpr const char* kSensor = "T_BS:\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n";
constexpr const char* kRun = "{\"program\": \"rumi\", \"images\": 4, \"cpu_ms_per_frame\": {\"front_tracker\": 1.5}}";

struct File {
  const char* name;
  const char* good;
};
constexpr File kFiles[] = {{"run/trajectory.txt", kTum}, {"run/frames.csv", kFrames}, {"run/submaps/001.txt", kTum},
                           {"run/run.json", kRun},       {"truth/truth.txt", kTum},   {"gt/data.csv", kEuroc},
                           {"cam0/sensor.yaml", kSensor}};
constexpr size_t kFileCount = std::size(kFiles);

void make_folder() {
  for (const char* name : {"run", "run/submaps", "truth", "gt", "cam0"})
    std::filesystem::create_directory(scratch() / name);
  for (const File& file : kFiles) scratch().write(file.name, to_bytes(std::string(file.good)));
}

void evaluate(const std::string& truth) {
  const Result<tool::RunEvaluation> evaluation = tool::evaluate_folder(scratch() / "run", scratch() / truth);
  if (evaluation) json_text(tool::to_json(*evaluation), 2);
}

void follow(const std::string& file) {
  const Result<synth::CameraPath> path = synth::CameraPath::load(file);
  if (!path) return;
  path->at(path->times_s().front());
  path->up();
}

void run(View input) {
  if (input.empty()) return;
  static const bool made = (make_folder(), true);
  if (!made) return;
  const size_t which = input[0] % (kFileCount + 1);
  if (which == kFileCount) return follow(scratch().write("path.txt", input.subspan(1)));
  const File& file = kFiles[which];
  scratch().write(file.name, input.subspan(1));
  evaluate(which >= 5 ? "gt/data.csv" : "truth/truth.txt");
  scratch().write(file.name, to_bytes(std::string(file.good)));
}

std::vector<Bytes> seeds() {
  std::vector<Bytes> all;
  for (size_t i = 0; i <= kFileCount; ++i) {
    Bytes& bytes = all.emplace_back(to_bytes(std::string(i < kFileCount ? kFiles[i].good : kTum)));
    bytes.insert(bytes.begin(), static_cast<uint8_t>(i));
  }
  constexpr uint8_t kTruth = 4;  // index of truth/truth.txt in kFiles
  for (const char* text : {kKitti, kPositions, kNamed}) {
    all.push_back(to_bytes(std::string(text)));
    all.back().insert(all.back().begin(), kTruth);
  }
  return all;
}

const Registered registered({"trajectory", run, seeds});

}  // namespace
}  // namespace rumi::fuzz
