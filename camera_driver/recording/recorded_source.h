// SPDX-License-Identifier: BSD-3-Clause
// A recording as an ImageSource: selects, checks, restamps and encodes what a FrameReader reads.
#pragma once

#include <map>

#include "camera_driver/recording/frame_order.h"
#include "camera_driver/source/image_source.h"
#include "formats/camera/camera_file.h"
#include "formats/recording/frame_reader.h"
#include "formats/recording/recording_masks.h"

namespace rumi::camera_driver {

class RecordedSource : public ImageSource {
 public:
  RecordedSource(std::string name, std::unique_ptr<FrameReader> reader, const CameraFile& calibration,
                 const CameraOptions& options);

  // Decides on the order of the images and reads the first one. An Error says why the recording cannot be used with
  // this camera.
  Result<> start();
  // Finds the masks of the images; to be called before the first image is handed out. An Error if one cannot be used.
  Result<> use_masks(const MaskPlaces& places);

  std::optional<image_t> next() override;
  const Camera& camera() const override { return camera_; }
  const std::string& name() const override { return name_; }
  int64_t total() const override { return options_.loop ? -1 : static_cast<int64_t>(frames_.size()); }
  const SkippedFrames& skipped() const override { return skipped_; }
  void play_again(const std::set<int64_t>& utimes_us, Pixels pixels) override;
  bool plays_few_quickly() const override { return reader_->loads_any_frame_alone(); }
  std::filesystem::path file_of_last() const override { return reader_->file(fetched_); }
  std::filesystem::path image_folder() const override;

 private:
  Result<> plan();
  Result<FrameOrder> order() const;
  void count_left_out(const FrameOrder& order);
  void name_streams();
  std::optional<image_t> fetch();
  void put_mask(image_t* image);
  bool begin_next_pass();
  int64_t new_time(const OrderedFrame& frame);
  std::optional<image_t> load_checked(size_t frame);
  const Result<CameraFile>& camera_of(const image_t& image);
  void tell_of_other_camera(size_t frame, const CameraFile& camera);
  void skip(int64_t SkippedFrames::*reason, const std::string& message);
  void report_end();

  std::string name_;
  std::unique_ptr<FrameReader> reader_;
  Result<CameraFile> calibration_file_;
  std::map<std::string, Result<CameraFile>, std::less<>> cameras_;  // by the calibration text in images of a log
  std::string last_calibration_;
  Camera camera_;
  CameraOptions options_;
  std::vector<OrderedFrame> frames_;  // the frames that are played
  size_t next_ = 0;                   // index in frames_
  size_t fetched_ = 0;                // the frame that was fetched last
  RecordingMasks masks_;
  std::vector<int64_t> streams_;  // stream of each part
  std::optional<image_t> ahead_;
  std::optional<std::set<int64_t>> only_;  // times of the images to play again; without it all are played
  bool starting_ = false;                  // inside start(): the first image decides whether the calibration fits
  bool have_ahead_ = false, reported_ = false;
  std::string first_problem_;
  SkippedFrames skipped_;
  int pass_ = 0;
  int64_t taken_ = 0;               // frames that have been given a time, over all passes
  int64_t handed_out_in_pass_ = 0;  // images that could be read and fit the camera
  int64_t offset_us_ = 0;           // added to the times in later passes
};

}  // namespace rumi::camera_driver
