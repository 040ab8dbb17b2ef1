// SPDX-License-Identifier: BSD-3-Clause
// A recording as an ImageSource: selects, checks, restamps and encodes what a FrameReader reads.
#pragma once

#include "bus/wire/camera_file.h"
#include "camera_driver/recording/frame_reader.h"
#include "camera_driver/source/frame_selector.h"
#include "camera_driver/source/image_source.h"

namespace rumi::camera_driver {

class RecordedSource : public ImageSource {
 public:
  RecordedSource(std::string name, std::unique_ptr<FrameReader> reader, const CameraFileResult& calibration,
                 const CameraOptions& options);

  // Reads the first image. Returns an empty string, or why the recording cannot be used with this camera.
  std::string start();

  std::optional<image_t> next() override;
  const Camera& camera() const override { return camera_; }
  const std::string& name() const override { return name_; }
  int64_t total() const override { return total_; }
  const SkippedFrames& skipped() const override { return skipped_; }

 private:
  void name_stream();
  std::optional<image_t> fetch();
  std::optional<FrameStamp> next_wanted();
  bool begin_next_pass();
  int64_t new_time(int64_t recorded_us);
  std::optional<image_t> load_checked(const FrameStamp& stamp);
  void skip(int64_t SkippedFrames::*reason, const std::string& message);
  void report_end();

  std::string name_, calibration_;
  std::unique_ptr<FrameReader> reader_;
  CameraFileResult calibration_file_;
  Camera camera_;
  CameraOptions options_;
  FrameSelector selector_;
  int64_t total_ = -1;
  int64_t stream_ = 0;
  std::optional<image_t> ahead_;
  bool starting_ = false;  // the first image decides whether the calibration fits
  bool have_ahead_ = false, reported_ = false;
  std::string first_problem_;
  SkippedFrames skipped_;
  int pass_ = 0;
  int64_t taken_ = 0;  // over all passes
  int64_t taken_in_pass_ = 0;
  int64_t handed_out_in_pass_ = 0;                // of those taken: could be read, and fit
  int64_t pass_first_us_ = 0, pass_last_us_ = 0;  // recorded times of taken frames
  int64_t origin_us_ = 0;                         // recorded time of the first taken frame
  int64_t offset_us_ = 0;                         // added to recorded times in later passes
};

}  // namespace rumi::camera_driver
