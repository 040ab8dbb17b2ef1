// SPDX-License-Identifier: BSD-3-Clause
// The list of images of a recording. Byte 0 chooses what the rest is: rgb.txt, data.csv, or the name of the only image
// in a folder.
#include <filesystem>

#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "camera_driver/open_source.h"
#include "formats/recording/file_list.h"
#include "formats/times/timestamps.h"
#include "fuzz/good_messages.h"
#include "fuzz/scratch.h"

namespace rumi::fuzz {
namespace {

namespace fs = std::filesystem;
using namespace camera_driver;

constexpr int kMostImages = 8;
constexpr size_t kLongestName = 60;

void open(const std::string& folder, CameraOptions options) {
  options.camera_file = scratch().write("calibration.yaml", to_bytes(camera_to_yaml(good_camera())));
  const OpenedSource opened = open_recording(folder, options);
  for (int i = 0; opened && i < kMostImages && (*opened)->next(); ++i) {
  }
}

void list_folder(const std::string& name) {
  const std::string folder = scratch() / "images";
  fs::create_directory(folder);
  const bool is_name = !name.empty() && name.size() < kLongestName && name.find('/') == std::string::npos &&
                       name.find('\0') == std::string::npos && name != "." && name != "..";
  if (is_name) scratch().write("images/" + name, good_jpeg(1).data);
  (void)list_image_folder(folder, {});  // an Error is accepted here, but no crash
  open(folder, {});
  if (is_name) fs::remove(folder + "/" + name);
}

void run(View input) {
  if (input.empty()) return;
  const View rest = input.subspan(1);
  if (input[0] % 3 == 2) return list_folder(to_text(rest));
  const std::string folder = scratch() / (input[0] % 3 == 0 ? "tum" : "euroc");
  fs::create_directory(folder);
  fs::create_directory(folder + "/data");
  scratch().write(input[0] % 3 == 0 ? "tum/a.jpg" : "euroc/data/a.jpg", good_jpeg(1).data);
  scratch().write(input[0] % 3 == 0 ? "tum/rgb.txt" : "euroc/data.csv", rest);
  CameraOptions options;
  options.every = 1 + (input[0] >> 4) % 3;
  options.start_s = input[0] & 8 ? 0.5 : 0;
  options.duration_s = input[0] & 8 ? 1 : 0;
  options.rate_hz = input[0] & 128 ? 30 : 0;
  options.files = input[0] & 64 ? "a*" : "";
  open(folder, options);
}

std::vector<Bytes> seeds() {
  const std::string first(1, '\0'), second(1, '\1'), third(1, '\2');
  return {to_bytes(first + "# times\n1.5 a.jpg\n1.6e0 a.jpg\n2 b.jpg\n"),
          to_bytes(second + "#timestamp,name\n1403636579763555584,a.jpg\n1403636579813555456,a.jpg\n"),
          to_bytes(first + "1.5 a.jpg 1.51 depth/a.png\n1.6 a.jpg 1.61 depth/b.png\n"),
          to_bytes("\xC0# names\na.jpg\nb.jpg\n1400000000000.0,a.jpg\n"),
          to_bytes(third + "1403636579763555584.jpg"),
          to_bytes(third + "12.5000.png")};
}

const Registered registered({"image_list", run, seeds});

}  // namespace
}  // namespace rumi::fuzz
